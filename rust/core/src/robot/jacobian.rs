//! Geometric Jacobians: linear rows first, world axes.

use nalgebra::{DMatrix, Vector3, Vector6};

use super::ids::LinkIndex;
use super::kinematics::Kinematics;
use super::numbers::LARGEST;
use super::robot::Robot;
use crate::error::{Error, Result};
use crate::robot::joint_axis::motion_axis;
use crate::spatial::vector::{split, stack};
use crate::spatial::Pose;

/// Velocity at `reference` and rotation that one unit of a joint's velocity gives the bodies behind it.
#[inline]
pub(crate) fn jacobian_column(
    robot: &Robot,
    kinematics: &Kinematics,
    body: usize,
    column: usize,
    reference: &Vector3<f64>,
) -> Vector6<f64> {
    let (linear, angular) = split(&motion_axis(robot.bodies[body].kind, &kinematics.bodies[body], column));
    stack(&(linear + angular.cross(reference)), &angular)
}

/// Calls `each` with every velocity variable from the base to `body` and its column at `reference`.
#[inline]
pub(crate) fn for_each_column(
    robot: &Robot,
    kinematics: &Kinematics,
    body: usize,
    reference: &Vector3<f64>,
    mut each: impl FnMut(usize, Vector6<f64>),
) {
    for &joint in robot.chain(body) {
        for (column, k) in robot.velocity_range(joint).enumerate() {
            each(k, jacobian_column(robot, kinematics, joint, column, reference));
        }
    }
}

impl Robot {
    /// `J` with `(velocity of the point; angular velocity) = J v`, `(6, nv)`.
    ///
    /// `point` is fixed to `link` and given in the world frame; default is the link's origin.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument.
    pub fn jacobian(&self, q: &[f64], link: LinkIndex, point: Option<[f64; 3]>) -> Result<DMatrix<f64>> {
        let (kinematics, pose) = self.placed(q, link)?;
        let point = match point {
            Some(point) if point.iter().all(|x| x.abs() < LARGEST) => Vector3::from(point),
            Some(_) => {
                return Err(Error::input(
                    "point",
                    format!("all entries must be finite and below {LARGEST:e}"),
                ))
            }
            None => pose.translation,
        };
        let from_origin = point - kinematics.origin;
        let mut matrix = DMatrix::zeros(6, self.nv());
        for_each_column(self, &kinematics, self[link].body, &from_origin, |k, column| {
            matrix.column_mut(k).copy_from(&column);
        });
        Ok(matrix)
    }

    /// A link's pose in the world.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument.
    pub fn link_pose(&self, q: &[f64], link: LinkIndex) -> Result<Pose> {
        Ok(self.placed(q, link)?.1)
    }

    pub(crate) fn check_link(&self, argument: &'static str, link: LinkIndex) -> Result<()> {
        if link.get() < self.links.len() {
            return Ok(());
        }
        Err(Error::input(argument, format!("index {} of {}", link.get(), self.links.len())))
    }

    fn placed(&self, q: &[f64], link: LinkIndex) -> Result<(Kinematics, Pose)> {
        self.check_configuration(q)?;
        self.check_link("link", link)?;
        let mut kinematics = Kinematics::new(self);
        kinematics.set_configuration(self, q);
        let pose = kinematics.link_pose(self, link);
        Ok((kinematics, pose))
    }
}
