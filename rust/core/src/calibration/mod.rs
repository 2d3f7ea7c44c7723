//! What contact-free motion teaches of one robot: bias, friction, inertias, payload, delays and noise.

mod alignment;
mod calibrate;
#[allow(clippy::module_inception)] // the room is called after what it makes
mod calibration;
mod complete_fit;
mod contacts;
mod delay;
mod excitation;
mod false_alarms;
#[cfg(feature = "calibration-files")]
mod file;
mod fingerprint;
mod folds;
mod friction;
mod hysteresis;
mod judged;
mod log;
mod model_errors;
mod noise;
mod normal;
mod notes;
mod position_step;
mod pseudo_inertia;
mod rate;
mod rest_errors;
mod result;
pub(crate) mod rows;
mod scale;
mod shapes;
mod smooth;
mod solve;
mod threshold;
mod torque_model;
mod uncertainty;
mod unknowns;

pub use crate::detection::Tail;
pub use crate::torque::ModelError;
pub use calibrate::calibrate;
pub use calibration::{BodyInertia, Calibration, CalibrationOptions, Payload};
pub use excitation::{exciting_motion, Excitation, ExcitationPlanner, Motion};
pub use friction::{Friction, Reversal};
pub use log::Log;
pub(crate) use torque_model::TorqueModel;

/// A step from row to row that is so many times the usual one is a gap.
const LONGEST_STEPS: f64 = 10.0;
