//! Detection: is there a contact, and behind which joints (Vorndamme 2017, eq. 21); when it has ended.

mod contact_test;
mod detector;
mod false_alarms;
mod free_directions;
mod friction_errors;
mod gate;
mod model_errors;
mod payload_errors;
mod recent_torque;
mod release;
mod signal;
mod signal_tree;
mod slow_errors;
mod standstill;
mod timing_errors;
mod velocity_covariance;
mod white_noise;
mod whitening;

pub(crate) use contact_test::{ContactTest, Level, FOLLOW_TIME, GAINS, LARGEST_STEP};
pub(crate) use detector::Detector;
pub use false_alarms::Tail;
pub(crate) use false_alarms::{gaussian_level, PEAK_TIME};
pub(crate) use free_directions::FreeDirections;
pub(crate) use friction_errors::{FrictionErrors, SLOW};
pub(crate) use gate::{check_threshold, check_wrench_threshold, is_over, Gate};
pub(crate) use payload_errors::Load;
pub(crate) use release::{ReleaseDetector, ReleaseRule};
pub(crate) use standstill::Standstill;
pub(crate) use white_noise::WhiteShares;
pub(crate) use whitening::Whitening;
