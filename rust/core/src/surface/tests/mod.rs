//! Tests of the surface as a whole.

mod brute_force;
mod files;
mod meshes;
mod primitives;
mod repairs;
mod samples;
mod trees;
mod unions;
mod watertight;
