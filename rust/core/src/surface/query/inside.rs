//! Whether a point lies inside a closed mesh.

use nalgebra::Vector3;

use crate::surface::answers::ClosestPoint;
use crate::surface::mesh::Mesh;

impl Mesh {
    /// Whether `p` lies inside, by more than `tolerance`. The mesh must be closed.
    pub fn contains(&self, p: &Vector3<f64>, tolerance: f64) -> bool {
        if (p - self.tree.center).norm() > self.tree.radius {
            return false;
        }
        // Any direction would do; this one is in no plane that CAD files favour.
        let direction = Vector3::new(0.537_725_1, 0.642_913_7, 0.545_305_9).normalize();
        let mut depth = 0;
        self.cross(p, &direction, 0.0, &mut |_, _, entering| {
            depth += if entering { -1 } else { 1 };
            true
        });
        if depth <= 0 {
            return false;
        }
        let mut nearest = ClosestPoint::NONE;
        self.closest_point(p, None, 0, &mut nearest);
        nearest.distance > tolerance
    }
}
