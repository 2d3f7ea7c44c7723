//! Detection: is there a contact, and behind which joints (Vorndamme 2017, eq. 21).

mod detector;
mod signal_tree;

pub(crate) use detector::{check_threshold, check_wrench_threshold, Detector};
