//! Which forces a contact can exert.

use std::f64::consts::SQRT_2;

use nalgebra::Vector3;

use crate::error::{Error, Result};
use crate::spatial::basis::across;

/// Precision of the force across the normal where there is no friction (1/N^2).
pub(super) const NO_FRICTION: f64 = 1e24;

/// Which forces a contact can exert.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::particle::{ContactParticleFilter, FilterOptions, ForceModel};
/// use contactsense::robot::Robot;
///
/// let cone = |friction| FilterOptions {
///     particles: 500,
///     force_model: ForceModel::FrictionCone(friction),
///     ..FilterOptions::default()
/// };
/// let robot = Arc::new(Robot::example_arm());
/// assert!(ContactParticleFilter::new(robot.clone(), cone(0.5)).is_ok());
/// assert!(ContactParticleFilter::new(robot, cone(-1.0)).is_err());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum ForceModel {
    /// Along the inward normal only (Bimbo 2019, eq. 7).
    #[default]
    Normal,
    /// Across the normal, too, up to this share of the normal force: a friction cone (Manuelli and Tedrake 2016). The
    /// force across is integrated out as a Gaussian with half the cone's radius as its standard deviation.
    FrictionCone(f64),
}

/// Less is none.
const LEAST_FRICTION: f64 = 1e-9;

impl ForceModel {
    /// Whether the friction coefficient is one.
    ///
    /// # Errors
    /// [`Error::Input`] names it.
    pub fn check(&self) -> Result<()> {
        match self {
            ForceModel::FrictionCone(friction) if !(friction.is_finite() && *friction >= 0.0) => {
                Err(Error::input("friction", format!("must be zero or a positive number, got {friction}")))
            }
            _ => Ok(()),
        }
    }

    /// Standard deviation of each of the two forces across the normal beside a normal force, both [N]; none where there is
    /// no friction.
    #[inline]
    pub(crate) fn deviation_across(&self, normal_force: f64) -> Option<f64> {
        match self {
            ForceModel::FrictionCone(friction) if *friction > LEAST_FRICTION && normal_force > 0.0 => {
                Some(0.5 * friction * normal_force)
            }
            _ => None,
        }
    }

    /// The same of a contact that slides: friction is then all that the cone allows, in an unknown direction.
    #[inline]
    pub(crate) fn deviation_of_sliding(&self, normal_force: f64) -> Option<f64> {
        self.deviation_across(normal_force).map(|within| within * SQRT_2)
    }
}

/// Directions of unit forces at a point with this outward normal: along the inward normal, and two across it.
#[inline]
pub(crate) fn directions(normal: &Vector3<f64>) -> [Vector3<f64>; 3] {
    let first = across(normal);
    [-normal, first, normal.cross(&first)]
}
