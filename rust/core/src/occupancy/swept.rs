//! The voxels that a robot's body is in.

use nalgebra::Vector3;

use super::voxel::Voxel;
use crate::robot::{Kinematics, Robot};

/// Calls `found` with each voxel whose centre is inside a closed part of a link, at a checked configuration. A voxel that is in
/// several links comes several times.
pub(super) fn swept(robot: &Robot, q: &[f64], resolution: f64, mut found: impl FnMut(Voxel)) {
    let mut kinematics = Kinematics::new(robot);
    kinematics.set_configuration(robot, q);
    for &index in robot.touchable_links() {
        let Some(surface) = robot.links()[index.get()].surface.as_deref() else { continue };
        let pose = kinematics.link_pose(robot, index);
        let (centre, radius) = surface.bounding_sphere();
        let centre = pose.transform_point(&centre);
        let range = |axis: usize| {
            let low = ((centre[axis] - radius) / resolution).floor() as i32;
            let high = ((centre[axis] + radius) / resolution).ceil() as i32;
            low..=high
        };
        for x in range(0) {
            for y in range(1) {
                for z in range(2) {
                    let voxel = Voxel([x, y, z]);
                    let point: Vector3<f64> = voxel.centre(resolution);
                    if (point - centre).norm_squared() > radius * radius {
                        continue;
                    }
                    if surface.contains(&pose.inverse_transform_point(&point)) {
                        found(voxel);
                    }
                }
            }
        }
    }
}
