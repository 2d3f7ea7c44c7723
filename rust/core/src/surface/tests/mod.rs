//! Tests of the surface as a whole.

mod meshes;
mod watertight;
