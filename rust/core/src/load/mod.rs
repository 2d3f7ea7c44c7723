//! Files: robots from URDF, meshes.

pub(crate) mod mesh_file;
mod regular_file;
pub(crate) mod urdf;
mod xml_limits;
