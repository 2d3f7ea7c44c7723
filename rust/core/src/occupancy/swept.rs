//! The voxels that a robot's body is in.

use nalgebra::Vector3;

use super::voxel::{range, Voxel};
use crate::error::{Error, Result};
use crate::robot::{Kinematics, Robot};

/// Calls `found` with each voxel whose centre is inside a closed part of a link, at a checked configuration. A voxel that is in
/// several links comes several times.
///
/// # Errors
/// [`Error::Input`] names `q` where a link is further away than voxels reach, as on a base that is free to move.
pub(super) fn swept(robot: &Robot, q: &[f64], resolution: f64, mut found: impl FnMut(Voxel)) -> Result<()> {
    let mut kinematics = Kinematics::new(robot);
    kinematics.set_configuration(robot, q);
    for &index in robot.touchable_links() {
        let Some(surface) = robot.links()[index.get()].surface.as_deref() else { continue };
        let pose = kinematics.link_pose(robot, index);
        let (centre, radius) = surface.bounding_sphere();
        let centre = pose.transform_point(&centre);
        let most = range(resolution);
        if centre.amax() + radius + resolution >= most {
            let text = format!("links must be within {most:.3e} m of the origin along each axis");
            return Err(Error::input("q", text));
        }
        let indices = |axis: usize| {
            let low = ((centre[axis] - radius) / resolution).floor() as i32;
            let high = ((centre[axis] + radius) / resolution).ceil() as i32;
            low..=high
        };
        for x in indices(0) {
            for y in indices(1) {
                for z in indices(2) {
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
    Ok(())
}
