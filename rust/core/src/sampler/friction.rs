//! How large friction can be at each pose: in proportion to normal forces that all measurements tell together.
//!
//! One measurement alone hardly tells the forces of several contacts that turn the same joints, and friction misleads it: sized by
//! such forces, friction is too small where it matters, and one more contact takes its place.

use nalgebra::Vector2;

use super::sums::{Prior, Sums};
use crate::torque::{AllDirections, ForceModel};

/// Normal forces of the contacts with obstacles at any pose.
#[derive(Debug, Clone, Copy)]
pub(super) struct NormalForces<const N: usize> {
    /// At the first touch (N), and the stiffness (N/m), of each.
    pub numbers: [Vector2<f64>; N],
    /// At most (N).
    greatest: f64,
}

impl<const N: usize> NormalForces<N> {
    /// As large as can be, whatever was measured.
    pub fn greatest(prior: &Prior) -> Self {
        let greatest = prior.force[1];
        NormalForces { numbers: [Vector2::new(greatest, 0.0); N], greatest }
    }

    /// Those that explain the torques best.
    pub fn best(prior: &Prior, sums: &Sums<N>) -> Self {
        NormalForces { numbers: prior.best(sums), greatest: prior.force[1] }
    }

    /// Where the contacts are so much `deeper` than at the first touch (m).
    fn at(&self, deeper: &[f64; N]) -> [f64; N] {
        std::array::from_fn(|i| {
            let [force, stiffness] = self.numbers[i].into();
            (force + stiffness * deeper[i]).clamp(0.0, self.greatest)
        })
    }
}

/// What one measurement says of the contacts.
#[derive(Debug, Clone, Copy)]
pub(super) enum Felt<const N: usize> {
    /// Whatever the forces are elsewhere.
    Known(Sums<N>),
    /// Of forces in all directions, of contacts that are so much deeper than at the first touch (m).
    WithFriction(AllDirections<N>, [f64; N]),
}

impl<const N: usize> Felt<N> {
    /// What the measurement, of so many torques that tell of the noise, says where friction is as large as `forces` allow.
    pub fn sums(&self, force_model: ForceModel, forces: &NormalForces<N>, rows: f64) -> Sums<N> {
        let mut sums = match self {
            Felt::Known(sums) => *sums,
            Felt::WithFriction(all, deeper) => {
                let deviation = forces.at(deeper).map(|force| force_model.deviation_of_sliding(force));
                Sums::along(&all.without_friction(deviation), deeper)
            }
        };
        sums.rows = rows;
        sums
    }
}
