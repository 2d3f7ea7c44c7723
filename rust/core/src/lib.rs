//! contactsense: a robot's sense of touch over its whole body, from joint positions, velocities and torques.
#![warn(missing_docs)]

pub mod detection;
pub mod error;
pub mod isolation;
pub mod monitor;
pub mod observer;
pub mod robot;
pub mod spatial;
pub mod surface;

pub use error::{Error, Result};
