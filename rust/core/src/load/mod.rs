//! Files: robots from URDF, meshes.

#[cfg(feature = "mesh-files")]
mod mesh_file;
#[cfg(any(feature = "mesh-files", feature = "calibration-files"))]
mod problem;
#[cfg(any(feature = "mesh-files", feature = "calibration-files"))]
mod regular_file;
#[cfg(feature = "urdf")]
mod urdf;
#[cfg(feature = "mesh-files")]
mod xml_limits;

#[cfg(feature = "mesh-files")]
pub use mesh_file::{load_mesh, VerticesAndTriangles};
#[cfg(feature = "calibration-files")]
pub(crate) use regular_file::read as read_regular_file;
#[cfg(feature = "urdf")]
pub use urdf::{from_urdf, CheckedUrdf, MissingMeshes, UrdfGeometry, UrdfOptions};
