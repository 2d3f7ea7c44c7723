//! Vectors from values by joint name, in any order.

use super::description::JointKind;
use super::robot::Robot;
use crate::error::{Error, Result};

impl Robot {
    /// Names of the joints that an actuator can move: all but a floating base's.
    pub fn actuated_joint_names(&self) -> &[String] {
        &self.joint_names()[usize::from(self.floating_base())..]
    }

    /// A configuration from joint positions (rad or m) by name, the others neutral.
    ///
    /// `base`: position (m) and quaternion (x, y, z, w) of a floating base in the world.
    ///
    /// ```
    /// use contactsense::robot::Robot;
    ///
    /// let robot = Robot::example_arm();
    /// let q = robot.configuration(&[("joint_3", 0.5), ("joint_1", -1.0)], None)?;
    /// assert_eq!(q, [-1.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0]);
    /// assert!(robot.configuration(&[("elbow", 1.0)], None).is_err());
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] for a name that is no joint's (it lists those that are), a position that is not finite, or a
    /// base that the robot does not have.
    pub fn configuration(&self, positions: &[(&str, f64)], base: Option<&[f64; 7]>) -> Result<Vec<f64>> {
        let mut q = self.neutral();
        if let Some(base) = base {
            self.check_has_base()?;
            q[..7].copy_from_slice(base);
        }
        for (name, position) in positions {
            let body = &self.bodies[self.joint_body("positions", name, *position)?];
            match body.kind {
                JointKind::Continuous => {
                    (q[body.idx_q + 1], q[body.idx_q]) = position.sin_cos();
                }
                _ => q[body.idx_q] = *position,
            }
        }
        self.check_configuration(&q)?;
        Ok(q)
    }

    /// A velocity, `nv` numbers, from joint velocities (rad/s or m/s) by name, the others zero.
    ///
    /// `base`: linear (m/s) and angular (rad/s) velocity of a floating base, in its own frame.
    ///
    /// # Errors
    /// As for [`configuration`](Self::configuration).
    pub fn velocity(&self, velocities: &[(&str, f64)], base: Option<&[f64; 6]>) -> Result<Vec<f64>> {
        let mut v = self.tangent("velocities", velocities)?;
        if let Some(base) = base {
            self.check_has_base()?;
            v[..6].copy_from_slice(base);
        }
        self.check_tangent("base", &v)?;
        Ok(v)
    }

    /// Torques, `nv` numbers, from joint torques (Nm or N) by name, the others and those of a floating base zero.
    ///
    /// # Errors
    /// As for [`configuration`](Self::configuration).
    pub fn torque(&self, torques: &[(&str, f64)]) -> Result<Vec<f64>> {
        self.tangent("torques", torques)
    }

    fn tangent(&self, argument: &'static str, values: &[(&str, f64)]) -> Result<Vec<f64>> {
        let mut tangent = vec![0.0; self.nv()];
        for (name, value) in values {
            tangent[self.bodies[self.joint_body(argument, name, *value)?].idx_v] = *value;
        }
        Ok(tangent)
    }

    /// The body that an actuated joint moves; the value that is meant for it must be finite.
    fn joint_body(&self, argument: &'static str, name: &str, value: f64) -> Result<usize> {
        let names = self.actuated_joint_names();
        let Some(place) = names.iter().position(|known| known == name) else {
            let text = format!("there is no joint '{name}' that moves; the joints are {}", names.join(", "));
            return Err(Error::input(argument, text));
        };
        if !value.is_finite() {
            return Err(Error::input(argument, format!("the value of '{name}' must be finite, not {value}")));
        }
        Ok(place + 1 + usize::from(self.floating_base()))
    }

    fn check_has_base(&self) -> Result<()> {
        if self.floating_base() {
            return Ok(());
        }
        Err(Error::input("base", "this robot's base is fixed; leave it out"))
    }
}
