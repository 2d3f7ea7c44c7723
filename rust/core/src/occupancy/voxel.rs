//! The grid that space is divided into.

use nalgebra::Vector3;

/// A voxel by its place in the grid: it begins at so many resolutions from the origin of the world.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) struct Voxel(pub [i32; 3]);

/// Greatest index along an axis, either way; the indices beyond it are those of points whose own do not fit in 32 bits.
const LARGEST_INDEX: i32 = i32::MAX - 1;

/// How far voxels reach from the origin of the world along each axis (m).
pub(super) fn range(resolution: f64) -> f64 {
    f64::from(LARGEST_INDEX) * resolution
}

impl Voxel {
    /// The one that holds a point.
    pub fn at(point: &Vector3<f64>, resolution: f64) -> Self {
        Voxel([0, 1, 2].map(|axis| (point[axis] / resolution).floor() as i32))
    }

    /// Its centre (m).
    pub fn centre(self, resolution: f64) -> Vector3<f64> {
        Vector3::from(self.0.map(|index| (f64::from(index) + 0.5) * resolution))
    }
}
