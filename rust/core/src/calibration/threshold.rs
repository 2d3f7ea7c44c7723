//! Thresholds that contact-free motion exceeds at a chosen rate.

use super::Calibration;
use crate::error::Result;
use crate::math::chi_square::quantile;
use crate::robot::Robot;
use crate::torque::NoiseModel;

/// Poses that are looked at: noise of velocities grows with the mass matrix, which changes with the pose.
const POSES: u64 = 32;
/// A threshold is this many standard deviations at least, whatever the rate.
const FEWEST_DEVIATIONS: f64 = 2.0;
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
        let mut distinct = gain.to_vec();
        distinct.sort_by(f64::total_cmp);
        distinct.dedup();
        for pose in 0..POSES {
            let q = corrected.random_configuration(pose);
            for this in &distinct {
                let (variance, time) = self.noise.variance_and_time(corrected, &q, *this, dt)?;
                for joint in (0..nv).filter(|joint| gain[*joint] == *this) {
                    let root = variance[joint].sqrt();
                    deviation[joint] = deviation[joint].max(root);
                    threshold[joint] = threshold[joint].max(root * deviations(rate * time[joint].max(dt)));
                }
            }
        }
        let noise =
            NoiseModel { torque: deviation, velocity: vec![0.0], model: vec![0.0], ..self.noise.clone() };
        Ok((noise, threshold))
    }
}

/// So many standard deviations a Gaussian number exceeds, either way, with this probability; no fewer than
/// [`FEWEST_DEVIATIONS`].
fn deviations(probability: f64) -> f64 {
    quantile(1, probability).sqrt().max(FEWEST_DEVIATIONS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_are_those_of_tables() {
        for (probability, table) in [(1e-2, 2.575_83), (1e-4, 3.890_59), (1e-6, 4.891_64), (1e-8, 5.730_73)] {
            let z = deviations(probability);
            assert!((z - table).abs() < 1e-4, "{probability}: {z} instead of {table}");
        }
        assert_eq!(deviations(0.5), FEWEST_DEVIATIONS);
    }
}
