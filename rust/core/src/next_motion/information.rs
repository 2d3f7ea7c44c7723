//! How well the torques after a motion tell hypotheses apart.

use nalgebra::Vector3;

use super::obstacle::Obstacle;
use super::prediction::Prediction;
use crate::math::random::Stream;
use crate::torque::TorqueNoise;

/// Errors of the force that motion adds, as in the filter's beliefs: shares of the force, and of the change that the stiffness
/// makes.
const FORCE_ERROR: f64 = 0.04;
const STIFFNESS_ERROR: f64 = 0.5;

/// What a motion is expected to tell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Told {
    /// By which the entropy of the hypotheses falls (nats).
    pub information: f64,
    /// Root mean square distance of the point from its mean (m).
    pub spread: f64,
}

/// What an obstacle predicts, each joint over its noise.
#[derive(Debug, Clone)]
struct Predicted {
    /// By which the torque changes.
    change: Vec<f64>,
    /// The torque of a standard deviation of the force.
    doubt: Vec<f64>,
    /// The same, so that its product with a residual is what the doubt explains.
    explained: Vec<f64>,
    /// Logarithm of the determinant of the covariance.
    log_det: f64,
}

/// Expected information about equally probable obstacles.
pub(super) struct Information<'a> {
    obstacles: &'a [Obstacle],
    /// Torques before the motion, one an obstacle (Nm).
    before: Vec<Vec<f64>>,
    /// Standard deviation of each torque (Nm).
    deviation: Vec<f64>,
    random: Stream,
}

impl<'a> Information<'a> {
    pub fn new(obstacles: &'a [Obstacle], here: &Prediction, noise: &TorqueNoise, random: Stream) -> Self {
        let joints = noise.at_rest().len();
        let mut mean = vec![0.0; joints];
        let before: Vec<Vec<f64>> = obstacles
            .iter()
            .map(|obstacle| {
                let mut torque = vec![0.0; joints];
                if let Some(touch) = here.touch(obstacle, obstacle.triangle) {
                    here.add_unit_torque(obstacle.link, &touch, &mut torque);
                }
                for (mean, torque) in mean.iter_mut().zip(&mut torque) {
                    *torque *= obstacle.force;
                    *mean += *torque / obstacles.len() as f64;
                }
                torque
            })
            .collect();
        let mut deviation = vec![0.0; joints];
        noise.set_deviations(&mean, &mut deviation);
        Information { obstacles, before, deviation, random }
    }

    /// Root mean square distance of the points from their mean (m).
    pub fn spread(&self) -> f64 {
        let share = 1.0 / self.obstacles.len() as f64;
        spread(self.obstacles.iter().map(|obstacle| (share, obstacle.point))).sqrt()
    }

    /// Of a motion to the pose `there`: each obstacle in turn is the true one, and what is measured, with its noise, leaves
    /// the others their share (the expectation of the posterior, by Monte Carlo).
    pub fn told(&self, there: &Prediction) -> Told {
        let predicted: Vec<Predicted> = self
            .obstacles
            .iter()
            .zip(&self.before)
            .map(|(o, before)| self.predict(o, before, there))
            .collect();
        let count = self.obstacles.len();
        let joints = self.deviation.len();
        let (mut entropy, mut variance) = (0.0, 0.0);
        let mut residual = vec![0.0; joints];
        let mut logs = vec![0.0; count];
        for (k, truth) in predicted.iter().enumerate() {
            // The same numbers for every motion, so that these differ by what they tell alone.
            let random = self.random.fork(k as u64);
            let [doubt, _] = random.normals(0);
            let measured: Vec<f64> = (0..joints)
                .map(|i| truth.change[i] + doubt * truth.doubt[i] + random.normals(2 + 2 * i as u64)[0])
                .collect();
            for (log, other) in logs.iter_mut().zip(&predicted) {
                for ((residual, measured), change) in residual.iter_mut().zip(&measured).zip(&other.change) {
                    *residual = measured - change;
                }
                let squared: f64 = residual.iter().map(|x| x * x).sum();
                let along: f64 = residual.iter().zip(&other.explained).map(|(a, b)| a * b).sum();
                *log = -0.5 * (squared - along * along + other.log_det);
            }
            let greatest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let mut sum = 0.0;
            let mut weighted = 0.0;
            for log in &mut logs {
                *log -= greatest;
                let weight = log.exp();
                sum += weight;
                weighted += weight * *log;
                *log = weight;
            }
            entropy += sum.ln() - weighted / sum;
            let points = self.obstacles.iter().zip(&logs);
            variance += spread(points.map(|(obstacle, weight)| (weight / sum, obstacle.point)));
        }
        let (entropy, variance) = (entropy / count as f64, variance / count as f64);
        Told { information: ((count as f64).ln() - entropy).max(0.0), spread: variance.sqrt() }
    }

    fn predict(&self, obstacle: &Obstacle, before: &[f64], there: &Prediction) -> Predicted {
        let mut unit = vec![0.0; before.len()];
        let touch = there.touch(obstacle, obstacle.triangle);
        if let Some(touch) = &touch {
            there.add_unit_torque(obstacle.link, touch, &mut unit);
        }
        let stiffened = obstacle.stiffness * touch.map_or(0.0, |touch| touch.deeper);
        let force = (obstacle.force + stiffened).max(0.0);
        let error = (FORCE_ERROR * force).hypot(STIFFNESS_ERROR * stiffened);
        unit.iter_mut().zip(&self.deviation).for_each(|(unit, deviation)| *unit /= deviation);
        let changes = unit.iter().zip(before).zip(&self.deviation);
        let change = changes.map(|((unit, before), deviation)| unit * force - before / deviation).collect();
        let doubt: Vec<f64> = unit.iter().map(|unit| unit * error).collect();
        let squared: f64 = doubt.iter().map(|x| x * x).sum();
        // The inverse of a covariance I + d d^T (Sherman and Morrison 1950).
        let scale = (1.0 + squared).sqrt().recip();
        let explained = doubt.iter().map(|x| x * scale).collect();
        Predicted { change, doubt, explained, log_det: (1.0 + squared).ln() }
    }
}

/// Mean squared distance of points from their mean; the weights sum to one.
fn spread(points: impl Iterator<Item = (f64, Vector3<f64>)>) -> f64 {
    let (mut mean, mut square) = (Vector3::zeros(), 0.0);
    for (weight, point) in points {
        mean += point * weight;
        square += weight * point.norm_squared();
    }
    (square - mean.norm_squared()).max(0.0)
}
