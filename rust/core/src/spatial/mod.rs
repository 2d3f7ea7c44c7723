//! Poses and spatial vectors: linear part first, as everywhere in this crate.

pub(crate) mod basis;
mod pose;
pub(crate) mod vector;

pub use pose::Pose;
