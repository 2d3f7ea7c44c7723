//! Where obstacles are and where none are, from contacts and from the space that the robot has been in.
//!
//! Space is divided into cubes (voxels) in the world frame. The body of a robot that touches nothing is where no obstacle is
//! (`swept.rs`); a contact says that one of the places where it may be is occupied (`contact_memory.rs`). Both are kept as the logarithm of the
//! odds that a voxel is occupied (Moravec and Elfes 1985), of those voxels of which something is known.

mod boxes;
mod contact_memory;
mod options;
mod swept;
mod voxel;

pub use boxes::VoxelBox;
pub use contact_memory::{ContactMemory, PossiblePlace};
pub use options::MemoryOptions;
