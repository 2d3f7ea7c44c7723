//! Geometric Jacobians: linear rows first, world axes.

use nalgebra::{DMatrix, Vector3};

use super::kinematics::Kinematics;
use super::robot::Robot;
use crate::error::{Error, Result};
use crate::robot::joint_axis::motion_axis;
use crate::spatial::vector::split;
use crate::spatial::Pose;

impl Robot {
    /// `J` with `(velocity of the point; angular velocity) = J v`, `(6, nv)`.
    ///
    /// `point` is fixed to `link` and given in the world frame; default is the link's origin.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument.
    pub fn jacobian(&self, q: &[f64], link: usize, point: Option<[f64; 3]>) -> Result<DMatrix<f64>> {
        let (kinematics, pose) = self.placed(q, link)?;
        let point = match point {
            Some(point) if point.iter().all(|x| x.is_finite()) => Vector3::from(point),
            Some(_) => return Err(Error::Input("point: all entries must be finite".into())),
            None => pose.translation,
        };
        let from_origin = point - kinematics.origin;
        let mut matrix = DMatrix::zeros(6, self.nv());
        for &index in self.chain(self.links[link].body) {
            let body = &self.bodies[index];
            for column in 0..body.kind.nv() {
                let (linear, angular) = split(&motion_axis(body.kind, &kinematics.bodies[index], column));
                let linear = linear + angular.cross(&from_origin);
                let k = body.idx_v + column;
                matrix.fixed_view_mut::<3, 1>(0, k).copy_from(&linear);
                matrix.fixed_view_mut::<3, 1>(3, k).copy_from(&angular);
            }
        }
        Ok(matrix)
    }

    /// A link's pose in the world.
    ///
    /// # Errors
    /// [`crate::Error::Input`] names the argument.
    pub fn link_pose(&self, q: &[f64], link: usize) -> Result<Pose> {
        Ok(self.placed(q, link)?.1)
    }

    fn placed(&self, q: &[f64], link: usize) -> Result<(Kinematics, Pose)> {
        self.check_configuration(q)?;
        if link >= self.links.len() {
            return Err(Error::Input(format!("link: index {link} of {}", self.links.len())));
        }
        let mut kinematics = Kinematics::new(self);
        kinematics.set_configuration(self, q);
        let pose = kinematics.link_pose(self, link);
        Ok((kinematics, pose))
    }
}
