//! Files: robots from URDF, meshes.

#[cfg(feature = "mesh-files")]
pub(crate) mod mesh_file;
#[cfg(feature = "mesh-files")]
mod regular_file;
#[cfg(feature = "urdf")]
pub(crate) mod urdf;
#[cfg(feature = "mesh-files")]
mod xml_limits;
