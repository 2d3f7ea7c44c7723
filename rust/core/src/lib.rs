//! contactsense: a robot's sense of touch over its whole body, from joint positions, velocities and torques.
#![warn(missing_docs)]
#![allow(rustdoc::broken_intra_doc_links)] // units such as [m] look like links

mod chi_square;
mod detection;
pub mod error;
pub mod isolation;
pub mod monitor;
pub mod observer;
pub mod particle;
mod random;
mod regular_file;
pub mod robot;
pub mod sensor;
pub mod spatial;
pub mod surface;
mod xml_limits;

pub use error::{Error, Result};
