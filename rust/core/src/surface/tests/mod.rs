//! Tests of the surface as a whole.

mod brute_force;
mod crowded;
#[cfg(feature = "mesh-files")]
mod files;
mod large;
pub(crate) mod meshes;
mod primitives;
mod repairs;
mod samples;
mod sides;
mod trees;
mod unions;
mod watertight;
