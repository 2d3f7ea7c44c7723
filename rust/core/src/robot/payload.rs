//! A body that the description does not have, held by a link.

use nalgebra::{Matrix3, Vector3};

use super::check::principal_moments;
use super::ids::LinkIndex;
use super::lump::{joined, placed};
use super::numbers::LARGEST;
use super::robot::Robot;
use crate::error::{Error, Result};

/// Share of the largest entry: what computing an inertia in other axes leaves.
const ROUNDING: f64 = 1e-9;

impl Robot {
    /// The robot with a payload fixed to a link: `mass` (kg), centre of mass `com` in the link's frame (m), `inertia`
    /// about it in the link's axes (kg m^2; zero for a point mass).
    ///
    /// The payload has no surface.
    ///
    /// ```
    /// use contactsense::robot::Robot;
    /// use nalgebra::{Matrix3, Vector3};
    ///
    /// let robot = Robot::example_arm();
    /// let loaded = robot.with_payload(robot.link("link_7")?, 1.5, Vector3::z(), Matrix3::zeros())?;
    /// assert!((loaded.mass() - robot.mass() - 1.5).abs() < 1e-12);
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] where the robot has no such link, a number is not finite or too large, the mass is negative, or the
    /// inertia is none of a rigid body.
    pub fn with_payload(
        &self,
        link: LinkIndex,
        mass: f64,
        com: Vector3<f64>,
        inertia: Matrix3<f64>,
    ) -> Result<Robot> {
        self.check_link("link", link)?;
        if !(0.0..LARGEST).contains(&mass) {
            let text = format!("must be finite and not negative, below {LARGEST:e} [kg], not {mass}");
            return Err(Error::input("mass", text));
        }
        if !com.iter().all(|x| x.abs() < LARGEST) {
            return Err(Error::input("com", format!("must be 3 finite numbers below {LARGEST:e} [m]")));
        }
        let slack = ROUNDING * inertia.amax();
        let is_symmetric = (inertia - inertia.transpose()).amax() <= slack;
        let is_finite = inertia.iter().all(|x| x.is_finite());
        if !(is_finite
            && is_symmetric
            && principal_moments(&inertia).is_ok_and(|moments| moments[0] >= -slack))
        {
            let text = "must be (3, 3), symmetric, with no negative principal moment [kg m^2]";
            return Err(Error::input("inertia", text));
        }
        let mut loaded = self.clone();
        let held = &mut loaded.links[link.get()];
        let (body, placement) = (held.body, held.placement);
        (held.mass, held.com, held.inertia) =
            joined((held.mass, held.com, held.inertia), (mass, com, inertia));
        if let Some(body) = loaded.bodies.get_mut(body).filter(|_| body != 0) {
            let added = placed((mass, com, inertia), &placement);
            (body.mass, body.com, body.inertia) = joined((body.mass, body.com, body.inertia), added);
        }
        Ok(loaded)
    }

    /// Mass of all that moves (kg).
    pub fn mass(&self) -> f64 {
        self.bodies.iter().map(|body| body.mass).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_are_none_are_refused_in_bounded_time() {
        let robot = Robot::example_arm();
        for number in [f64::NAN, f64::INFINITY] {
            let refused = robot.with_payload(
                LinkIndex::new(6),
                1.0,
                Vector3::zeros(),
                Matrix3::from_diagonal_element(number),
            );
            assert!(refused.unwrap_err().to_string().contains("inertia"));
        }
    }

    #[test]
    fn a_payload_that_cannot_be_held_is_refused() {
        let robot = Robot::example_arm();
        let refused = |link: usize, mass: f64, com: f64| {
            let com = Vector3::new(com, 0.0, 0.0);
            robot.with_payload(LinkIndex::new(link), mass, com, Matrix3::zeros()).unwrap_err().to_string()
        };
        assert!(refused(robot.links().len(), 1.0, 0.0).contains("link"));
        assert!(refused(6, 1e300, 0.0).contains("mass"));
        assert!(refused(6, 1.0, 1e300).contains("com"));
    }
}
