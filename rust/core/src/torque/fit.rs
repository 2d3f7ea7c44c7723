//! The force at a point that explains torques best, and how well.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use super::force_model::{directions, ForceModel};
use super::frames::Frame;
use super::link_target::LinkTarget;

/// The torques of a unit of normal force against a target, each joint over its noise, with the force across the normal
/// integrated out.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NormalFit {
    /// Squared norm of the torques of a unit force [1/N^2].
    pub gain: f64,
    /// Inner product with the target [1/N].
    pub product: f64,
    /// Squared norm of the part of the target that friction does not explain.
    pub target: f64,
    /// What the freedom of friction costs in log-likelihood.
    pub penalty: f64,
}

impl NormalFit {
    /// Integrates out forces across the normal (rows 1 and 2) of variance `slack`: what is left for the normal force.
    pub fn without_friction(gram: &Matrix3<f64>, products: &Vector3<f64>, target: f64, slack: f64) -> Self {
        let all = NormalFit { gain: gram[(0, 0)], product: products[0], target, penalty: 0.0 };
        let across = gram.fixed_view::<2, 2>(1, 1) + Matrix2::identity() / slack;
        let Some(inverse) = across.try_inverse().filter(|inverse| inverse.iter().all(|x| x.is_finite()))
        else {
            return all;
        };
        let beside = Vector2::new(gram[(1, 0)], gram[(2, 0)]);
        let product = Vector2::new(products[1], products[2]);
        let share = inverse * product;
        NormalFit {
            gain: (all.gain - beside.dot(&(inverse * beside))).max(0.0),
            product: all.product - beside.dot(&share),
            target: (target - product.dot(&share)).max(0.0),
            penalty: 0.5 * (across.determinant() * slack * slack).ln(),
        }
    }
}

/// A force on a link, in its frame [N].
#[derive(Debug, Clone, Copy)]
pub(crate) struct BestForce {
    pub force: Vector3<f64>,
    /// Its part along the inward normal, never negative: a push does not pull [N].
    pub normal: f64,
    /// Variance of that part by the noise, infinite where no torque shows it [N^2].
    pub variance: f64,
    /// Its parts across the normal, over their standard deviations.
    pub across: [f64; 2],
}

impl BestForce {
    /// At a point of a link, with its outward normal (both in the link's frame).
    pub fn of(
        frame: &Frame,
        target: &LinkTarget,
        force_model: ForceModel,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
    ) -> BestForce {
        let bare = BestForce::without_friction(frame, target, point, normal);
        bare.and_friction(frame, target, force_model, point, normal).unwrap_or(bare)
    }

    /// The same, but none where forces across the normal explain the torques without a push.
    pub fn beside_friction(
        frame: &Frame,
        target: &LinkTarget,
        force_model: ForceModel,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
    ) -> Option<BestForce> {
        BestForce::without_friction(frame, target, point, normal).and_friction(
            frame,
            target,
            force_model,
            point,
            normal,
        )
    }

    /// With the force across the normal that this force along it allows; none as above.
    fn and_friction(
        self,
        frame: &Frame,
        target: &LinkTarget,
        force_model: ForceModel,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
    ) -> Option<BestForce> {
        let Some(deviation) = force_model.deviation_across(self.normal) else { return Some(self) };
        let directions = directions(normal);
        let (gram, products) = frame.responses(point, &directions, target);
        BestForce::with_friction(gram, &products, &directions, deviation)
    }

    /// Along the normal alone.
    fn without_friction(
        frame: &Frame,
        target: &LinkTarget,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
    ) -> BestForce {
        let (gain, product) = frame.response(point, normal, target);
        let size = if gain > 0.0 && product > 0.0 { product / gain } else { 0.0 };
        BestForce { force: -normal * size, normal: size, variance: gain.recip(), across: [0.0; 2] }
    }

    /// Where the part across the normal is Gaussian with this standard deviation [N].
    fn with_friction(
        mut gram: Matrix3<f64>,
        products: &Vector3<f64>,
        directions: &[Vector3<f64>; 3],
        deviation: f64,
    ) -> Option<BestForce> {
        gram[(1, 1)] += deviation.powi(-2);
        gram[(2, 2)] += deviation.powi(-2);
        let inverse = gram.try_inverse()?;
        let found = inverse * products;
        let usable = found[0] > 0.0 && inverse[(0, 0)] > 0.0 && found.iter().all(|x| x.is_finite());
        usable.then(|| BestForce {
            force: directions[0] * found[0] + directions[1] * found[1] + directions[2] * found[2],
            normal: found[0],
            variance: inverse[(0, 0)],
            across: [found[1] / deviation, found[2] / deviation],
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn friction_is_integrated_out_as_a_covariance_would() {
        // Columns: torques of unit forces along the normal and across it, on five joints of unit noise.
        let torques =
            nalgebra::SMatrix::<f64, 5, 3>::from_fn(|i, j| ((1 + i) as f64 * (1.3 + j as f64)).sin());
        let measured = nalgebra::SVector::<f64, 5>::from_fn(|i, _| (2.0 + i as f64).cos());
        let slack = 0.7;
        let found = NormalFit::without_friction(
            &(torques.transpose() * torques),
            &(torques.transpose() * measured),
            measured.norm_squared(),
            slack,
        );
        let beside = torques.fixed_columns::<2>(1);
        let covariance = nalgebra::SMatrix::<f64, 5, 5>::identity() + beside * beside.transpose() * slack;
        let inverse = covariance.try_inverse().expect("positive definite");
        let normal = torques.column(0);
        assert!((found.gain - normal.dot(&(inverse * normal))).abs() < 1e-12);
        assert!((found.product - normal.dot(&(inverse * measured))).abs() < 1e-12);
        assert!((found.target - measured.dot(&(inverse * measured))).abs() < 1e-12);
        assert!((found.penalty - 0.5 * covariance.determinant().ln()).abs() < 1e-12);
    }
}
