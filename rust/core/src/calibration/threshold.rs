//! Thresholds that contact-free motion exceeds at a chosen rate.

use super::Calibration;
use crate::error::Result;
use crate::robot::Robot;
use crate::torque::NoiseModel;

/// Poses that are looked at: noise of velocities grows with the mass matrix, which changes with the pose.
const POSES: u64 = 32;
const SECONDS: f64 = 3600.0;

impl Calibration {
    /// What the external torque behind an observer of this `gain` (1/s, `(nv,)`), called every `dt` (s), errs by in the worst
    /// of some poses of the corrected robot, and the thresholds that give the calibration's rate of false alarms, both
    /// `(nv,)` (Nm).
    ///
    /// # Errors
    /// [`crate::Error::Input`] names what cannot be used.
    pub(crate) fn noise_and_threshold(
        &self,
        corrected: &Robot,
        gain: &[f64],
        dt: f64,
    ) -> Result<(NoiseModel, Vec<f64>)> {
        let nv = corrected.nv();
        let rate = self.false_alarms_per_hour / (nv as f64 * SECONDS);
        let (mut deviation, mut threshold) = (vec![0.0_f64; nv], vec![0.0_f64; nv]);
        for pose in 0..POSES {
            let q = corrected.random_configuration(pose);
            for (joint, gain) in gain.iter().enumerate() {
                let variance = self.noise.covariance(corrected, &q, *gain, dt)?[(joint, joint)];
                let time = self.noise.correlation_time(corrected, &q, *gain, dt)?[joint].max(dt);
                deviation[joint] = deviation[joint].max(variance.sqrt());
                threshold[joint] = threshold[joint].max(variance.sqrt() * quantile(rate * time));
            }
        }
        let noise =
            NoiseModel { torque: deviation, velocity: vec![0.0], model: vec![0.0], ..self.noise.clone() };
        Ok((noise, threshold))
    }
}

/// So many standard deviations a Gaussian number exceeds, either way, with this probability; by its tail's expansion
/// (Abramowitz and Stegun 26.2.12), to a part in a thousand below 1 %.
fn quantile(probability: f64) -> f64 {
    let tail = |z: f64| {
        let w = 1.0 / (z * z);
        (2.0 / std::f64::consts::PI).sqrt() * (-0.5 * z * z).exp() / z
            * (1.0 - w * (1.0 - w * (3.0 - 15.0 * w)))
    };
    let (mut low, mut high) = (2.0, 40.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if tail(middle) > probability {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (probability, table) in [(1e-2, 2.575_83), (1e-4, 3.890_59), (1e-6, 4.891_64), (1e-8, 5.730_73)] {
            let z = quantile(probability);
            assert!((z - table).abs() < 0.02, "{probability}: {z} instead of {table}");
        }
    }
}
