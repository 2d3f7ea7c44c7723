//! Detection: is there a contact, and behind which joints (Vorndamme 2017, eq. 21); when it has ended.

mod detector;
mod gate;
mod release;
mod signal_tree;

pub(crate) use detector::Detector;
pub(crate) use gate::{check_threshold, check_wrench_threshold, is_over, Gate};
pub(crate) use release::{ReleaseDetector, ReleaseRule};
