//! What the library says against what Pinocchio and trimesh say.

mod contacts;
mod data;
mod dynamics;
mod filter;
