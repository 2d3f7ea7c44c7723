//! contactsense: a robot's sense of touch over its whole body, from joint positions, velocities and torques.
#![warn(missing_docs)]

pub mod error;
pub mod spatial;
pub mod surface;

pub use error::{Error, Result};
