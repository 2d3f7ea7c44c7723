//! contactsense: a robot's sense of touch over its whole body, from joint positions, velocities and torques.
//!
//! [`monitor::ContactMonitor`] is the place to start: one call a control tick, with a [`Sample`]. [`robot::Robot`] comes from a URDF file
//! or a description; all vectors are in its joints' order, in SI units, and vectors of the world in its axes.
#![warn(missing_docs)]

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

pub mod calibration;
pub mod classification;
mod detection;
pub mod diagnosis;
pub mod error;
pub mod isolation;
pub mod load;
pub mod map;
mod math;
pub mod monitor;
pub mod next_motion;
pub mod observer;
pub mod occupancy;
pub mod particle;
mod posterior;
pub mod reaction;
pub mod robot;
mod sample;
pub mod sampler;
pub mod sensor;
pub mod spatial;
pub mod surface;
mod torque;
mod tracking;

pub use error::{Error, Result};
pub use nalgebra;
pub use sample::{ExternalSample, Sample};
pub use torque::{best_cone_force, ConeForce, ConePart, NoiseModel};
