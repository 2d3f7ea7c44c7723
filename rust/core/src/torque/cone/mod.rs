//! The force inside a friction cone that explains torques best.
//!
//! A second-order cone program of four variables, the three parts of the force and the multiplier of friction's limit,
//! in closed form but for one root (`limit.rs`).

mod limit;
mod misfit;
/// A force that rounding has put outside the cone, inside it.
fn inside(force: Vector3<f64>, friction: f64) -> Vector3<f64> {
    let (across, most) = (force[1].hypot(force[2]), friction * force[0]);
    let share = if across > most { most / across } else { 1.0 };
    Vector3::new(force[0], force[1] * share, force[2] * share)
}

#[cfg(test)]
mod tests;

use nalgebra::{Matrix3, Vector3};

use misfit::Misfit;

/// Largest coefficient of friction: beyond it friction is no limit.
const MOST_FRICTION: f64 = 1e6;
/// The square of a smaller one is no number any more: there is none.
const LEAST_FRICTION: f64 = 1e-100;
/// A smaller force has not all digits of a number any more: there is none (N).
const SMALLEST: f64 = 1e-290;
/// Largest sum of the numbers given, so that none of their products overflows.
const LARGEST: f64 = 1e150;

/// Where in the friction cone a force is.
///
/// ```
/// use contactsense::nalgebra::{Matrix3, Vector3};
/// use contactsense::{best_cone_force, ConePart};
///
/// let part = |products| best_cone_force(&Matrix3::identity(), &products, 0.5).part;
/// assert_eq!(part(Vector3::new(-1.0, 0.2, 0.0)), ConePart::Apex);
/// assert_eq!(part(Vector3::new(1.0, 0.2, 0.0)), ConePart::Interior);
/// assert_eq!(part(Vector3::new(1.0, 2.0, 0.0)), ConePart::Boundary);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum ConePart {
    /// No force: any inside the cone would explain the torques worse.
    Apex,
    /// Friction does not limit the force.
    Interior,
    /// Friction is at its limit.
    Boundary,
}

impl ConePart {
    /// In lower case.
    pub fn name(self) -> &'static str {
        match self {
            ConePart::Apex => "apex",
            ConePart::Interior => "interior",
            ConePart::Boundary => "boundary",
        }
    }
}

/// A force inside a friction cone, and how well it explains torques.
///
/// ```
/// use contactsense::nalgebra::{Matrix3, Vector3};
/// use contactsense::best_cone_force;
///
/// let found = best_cone_force(&Matrix3::identity(), &Vector3::new(1.0, 2.0, 0.0), 0.5);
/// assert!((found.force - Vector3::new(1.6, 0.8, 0.0)).norm() < 1e-15);
/// assert!((found.objective + 1.6).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ConeForce {
    /// Along the inward normal, and along the two directions across it (N).
    pub force: Vector3<f64>,
    /// `0.5 f' G f - p' f`, not positive: half of what the force takes off the squared norm of the torques.
    pub objective: f64,
    /// Where the force is.
    pub part: ConePart,
}

impl ConeForce {
    const NONE: ConeForce =
        ConeForce { force: Vector3::new(0.0, 0.0, 0.0), objective: 0.0, part: ConePart::Apex };
}

/// The force `f` that minimises `0.5 f' G f - p' f` where `|(f1, f2)| <= friction f0`, in bounded time.
///
/// `gram` is the Gram matrix `G` of the torques of unit forces, along the inward normal and in two directions across it,
/// and `products` are the inner products `p` of these torques with the measured ones, all relative to their noise. Where
/// the torques do not show some force, the force is about the smallest of those that explain the torques as well. There
/// is no force where a number is not finite or too large to compute with.
///
/// ```
/// use contactsense::nalgebra::{Matrix3, Vector3};
/// use contactsense::best_cone_force;
///
/// // Two joints: a force across the normal is not distinguished from a normal force.
/// let torques = Matrix3::new(1.0, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0);
/// let measured = Vector3::new(5.0, 0.0, 0.0);
/// let found = best_cone_force(&torques.tr_mul(&torques), &torques.tr_mul(&measured), 0.8);
/// assert!((torques * found.force - measured).norm() < 1e-6);
/// // About the smallest such force.
/// assert!((found.force - Vector3::new(4.0, 2.0, 0.0)).norm() < 1e-2);
/// ```
pub fn best_cone_force(gram: &Matrix3<f64>, products: &Vector3<f64>, friction: f64) -> ConeForce {
    let size = gram.iter().chain(products.iter()).fold(0.0, |sum, x| sum + x.abs());
    let (gain, product) = (gram.diagonal().max(), products.amax());
    if !(size < LARGEST && gain > 0.0 && product > 0.0) {
        return ConeForce::NONE;
    }
    let (gram, products) = (gram / gain, products / product);
    let friction = if friction > LEAST_FRICTION { friction.min(MOST_FRICTION) } else { 0.0 };
    if products[0] + friction * products[1].hypot(products[2]) <= 0.0 {
        return ConeForce::NONE;
    }
    let (misfit, tangents) = Misfit::new(&gram, &products);
    let (force, part) = misfit.best(friction);
    let force = inside(tangents.back(&force), friction);
    let objective = force.dot(&(gram * force * 0.5 - products)).min(0.0);
    let unit = product / gain;
    let found = ConeForce { force: force * unit, objective: objective * unit * product, part };
    let is_finite = found.objective.is_finite() && found.force.iter().all(|x| x.is_finite());
    if is_finite && found.force[0] > SMALLEST {
        found
    } else {
        ConeForce::NONE
    }
}
