//! What a particle's contact does to the joints, beside what they measured.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use super::columns::Slice;
use super::frames::Frames;
use crate::error::{Error, Result};

/// Which forces a contact can exert.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum ForceModel {
    /// Along the inward normal only (Bimbo 2019, eq. 7).
    #[default]
    Normal,
    /// Across the normal, too, up to this share of the normal force: a friction cone (Manuelli and Tedrake 2016). The
    /// force across is integrated out as a Gaussian with half the cone's radius as its standard deviation.
    FrictionCone(f64),
}

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
}

/// Less is none.
const LEAST_FRICTION: f64 = 1e-9;

/// The torques of a unit of normal force against those measured, each joint over its noise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Response {
    /// Squared norm of the torques of a unit force [1/N^2].
    pub gain: f64,
    /// Inner product with the measured torques [1/N].
    pub product: f64,
    /// Squared norm of the measured torques that friction does not explain.
    pub measured: f64,
    /// What the freedom of friction costs in log-likelihood.
    pub penalty: f64,
}

/// What computing a response needs to know.
#[derive(Debug, Clone, Copy)]
pub(super) struct ResponseModel {
    pub force_model: ForceModel,
    /// Variance of the torques' error, in units of their noise.
    pub variance: f64,
}

impl ResponseModel {
    /// Sets what particle k's force does to the joints at the present pose.
    pub fn apply(&self, frames: &Frames, particles: &mut Slice<'_>, k: usize) -> Response {
        let response = self.response(
            frames,
            particles.link[k],
            &particles.point[k],
            &particles.normal[k],
            particles.force[k],
        );
        particles.gain[k] = response.gain;
        particles.product[k] = response.product;
        particles.measured[k] = response.measured;
        particles.penalty[k] = response.penalty;
        response
    }

    #[inline]
    fn response(
        &self,
        frames: &Frames,
        link: u32,
        point: &Vector3<f64>,
        normal: &Vector3<f64>,
        force: f64,
    ) -> Response {
        let frame = &frames.links[link as usize];
        let measured = frames.measured;
        match self.force_model {
            ForceModel::FrictionCone(friction) if friction > LEAST_FRICTION && force > 0.0 => {
                let first = across(normal);
                let directions = [-normal, first, normal.cross(&first)];
                let (gram, products) = frame.responses(point, &directions);
                let slack = (0.5 * friction * force).powi(2) / self.variance;
                without_friction(&gram, &products, measured, slack)
            }
            _ => {
                let (gain, product) = frame.response(point, normal);
                Response { gain, product, measured, penalty: 0.0 }
            }
        }
    }
}

/// Integrates out forces across the normal (rows 1 and 2) of variance `slack`: what is left for the normal force.
fn without_friction(gram: &Matrix3<f64>, products: &Vector3<f64>, measured: f64, slack: f64) -> Response {
    let all = Response { gain: gram[(0, 0)], product: products[0], measured, penalty: 0.0 };
    let across = gram.fixed_view::<2, 2>(1, 1) + Matrix2::identity() / slack;
    let Some(inverse) = across.try_inverse().filter(|inverse| inverse.iter().all(|x| x.is_finite())) else {
        return all;
    };
    let beside = Vector2::new(gram[(1, 0)], gram[(2, 0)]);
    let product = Vector2::new(products[1], products[2]);
    let share = inverse * product;
    Response {
        gain: (all.gain - beside.dot(&(inverse * beside))).max(0.0),
        product: all.product - beside.dot(&share),
        measured: (measured - product.dot(&share)).max(0.0),
        penalty: 0.5 * (across.determinant() * slack * slack).ln(),
    }
}

/// A unit vector across `normal`.
pub(super) fn across(normal: &Vector3<f64>) -> Vector3<f64> {
    let apart = if normal.x.abs() < 0.8 { Vector3::x() } else { Vector3::y() };
    normal.cross(&apart).normalize()
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
        let found = without_friction(
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
        assert!((found.measured - measured.dot(&(inverse * measured))).abs() < 1e-12);
        assert!((found.penalty - 0.5 * covariance.determinant().ln()).abs() < 1e-12);
    }
}
