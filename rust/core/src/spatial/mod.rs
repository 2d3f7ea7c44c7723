//! Poses and spatial vectors: linear part first, as everywhere in this crate.

mod pose;
pub(crate) mod vector;

pub use pose::Pose;
