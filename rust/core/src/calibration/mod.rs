//! What contact-free motion teaches of one robot: bias, friction, inertias, payload, delays and noise.

mod excitation;
mod log;
#[allow(dead_code)] // until calibration reads them
pub(crate) mod rows;

pub use excitation::{exciting_motion, Excitation, ExcitationPlanner, Motion};
pub use log::Log;
