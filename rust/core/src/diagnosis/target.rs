//! What the model is compared with: the measured torque as a hypothesis reads it, less the model's.

use nalgebra::DVector;

use super::terms::{Parts, DELAYS};

/// For each joint a combination of [`Parts`], and how much a change of the measured torque changes it.
#[derive(Debug, Clone)]
pub(super) struct Target {
    pub coefficients: Vec<DVector<f64>>,
    /// The measured torque times this is the joint's.
    pub factor: Vec<f64>,
}

impl Target {
    /// The measured torque less the model's.
    pub fn plain(parts: Parts) -> Target {
        Target::reordered(parts, &(0..parts.nv).collect::<Vec<_>>())
    }

    /// The same where joint `k` has the torque of column `order[k]`.
    pub fn reordered(parts: Parts, order: &[usize]) -> Target {
        let one = |column: &usize| {
            let mut coefficients = DVector::zeros(parts.len());
            coefficients[parts.torque(*column)] = 1.0;
            coefficients[parts.model()] = -1.0;
            coefficients
        };
        Target { coefficients: order.iter().map(one).collect(), factor: vec![1.0; order.len()] }
    }

    /// The measured torque of a joint divided by a scale.
    pub fn scaled(mut self, parts: Parts, joint: usize, scale: f64) -> Target {
        self.coefficients[joint][parts.torque(joint)] = 1.0 / scale;
        self.factor[joint] = 1.0 / scale.abs();
        self
    }

    /// Gravity in the model changed.
    pub fn with_gravity_change(mut self, parts: Parts, change: &[f64; 3]) -> Target {
        for coefficients in &mut self.coefficients {
            for (axis, change) in change.iter().enumerate() {
                coefficients[parts.gravity(axis)] = -change;
            }
        }
        self
    }

    /// The measured torque taken later, of all joints or of one.
    pub fn later(mut self, parts: Parts, delay: f64, joint: Option<usize>) -> Target {
        let above = DELAYS.iter().position(|known| *known >= delay).unwrap_or(DELAYS.len() - 1).max(1);
        let share = ((delay - DELAYS[above - 1]) / (DELAYS[above] - DELAYS[above - 1])).clamp(0.0, 1.0);
        for (k, coefficients) in self.coefficients.iter_mut().enumerate() {
            if joint.is_none_or(|joint| joint == k) {
                coefficients[parts.torque(k)] = 0.0;
                coefficients[parts.delayed(above - 1)] = 1.0 - share;
                coefficients[parts.delayed(above)] = share;
            }
        }
        self
    }
}
