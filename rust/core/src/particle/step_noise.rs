//! Sharpness and noise of one update.

use super::options::{FilterOptions, Likelihood};
use super::schedule::Schedule;

/// A motion of the robot that makes a measurement a new one, and the model's noise its full size [m].
pub(crate) const NEW_POSE: f64 = 0.005;
/// Adaptive noise of a force, relative, and of a distance [m].
const FORCE_NOISE: f64 = 0.04;
const DISTANCE_NOISE: f64 = 1e-4;
/// Share of particles whose radius is drawn anew: a real obstacle is no sphere.
const REDRAW: f64 = 0.2;

/// Noise and sharpness of one update.
#[derive(Debug, Clone, Copy)]
pub(super) struct StepNoise {
    /// Share of particles whose radius is drawn anew.
    pub redraw: f64,
    /// Of the force, relative.
    pub force: f64,
    /// Of the stiffness, relative.
    pub stiffness: f64,
    /// Of the distance to the obstacle's centre, which stiffness turns into force [m].
    pub distance: f64,
    /// Of the point, where the schedule says it [m].
    pub point: Option<f64>,
    /// Alpha, where the schedule says it [1/Nm].
    pub sharpness: Option<f64>,
}

impl StepNoise {
    /// Nothing moves.
    pub fn none() -> Self {
        StepNoise { redraw: 0.0, force: 0.0, stiffness: 0.0, distance: 0.0, point: None, sharpness: None }
    }

    /// At an update since the particles were spread, after a motion [m].
    pub fn at(options: &FilterOptions, update: u64, moved: f64) -> Self {
        let share = (moved / NEW_POSE).min(1.0);
        // The paper draws every radius anew.
        let redraw = match options.likelihood {
            Likelihood::Gaussian => REDRAW * share,
            Likelihood::Exponential => 1.0,
        };
        match &options.schedule {
            Schedule::Adaptive => StepNoise {
                redraw,
                force: FORCE_NOISE * share.sqrt(),
                stiffness: FORCE_NOISE * share.sqrt(),
                distance: DISTANCE_NOISE * share.sqrt(),
                point: None,
                sharpness: None,
            },
            Schedule::Explicit { sharpness, point_noise, force_noise, stiffness_noise, updates } => {
                let value = |[first, last]: [f64; 2]| {
                    let share = if *updates == 0 { 1.0 } else { (update as f64 / *updates as f64).min(1.0) };
                    first * (last / first).powf(share)
                };
                StepNoise {
                    redraw,
                    force: value(*force_noise),
                    stiffness: value(*stiffness_noise),
                    distance: 0.0,
                    point: Some(value(*point_noise)),
                    sharpness: Some(value(*sharpness)),
                }
            }
        }
    }
}
