//! Sharpness and noise, from wide to narrow.

use super::options::{FilterOptions, Likelihood};
use crate::error::{Error, Result};

/// How sharply torques are weighed and how far particles are moved at random.
///
/// ```
/// use contactsense::particle::Schedule;
///
/// let Schedule::Explicit { point_noise, updates, .. } = Schedule::paper() else { unreachable!() };
/// assert!(point_noise[0] > point_noise[1] && updates == 25);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Schedule {
    /// By what the data show: sharp as far as enough particles keep a say and as the torques left over allow, once
    /// for what a motion tells anew; copies are moved by a share of how far the particles of a place lie apart.
    #[default]
    Adaptive,
    /// Each quantity goes geometrically from its first to its second value in so many updates, and stays there
    /// (Bimbo 2019, section III).
    Explicit {
        /// The likelihood's alpha [1/Nm]; for the Gaussian one over the noise.
        sharpness: [f64; 2],
        /// Standard deviation of the point's noise (m).
        point_noise: [f64; 2],
        /// Standard deviation of the force's noise, relative.
        force_noise: [f64; 2],
        /// Standard deviation of the stiffness' noise, relative.
        stiffness_noise: [f64; 2],
        /// From first to second value.
        updates: usize,
    },
}

impl Schedule {
    /// One that suits the paper's experiments.
    pub fn paper() -> Self {
        Schedule::Explicit {
            sharpness: [1.0, 30.0],
            point_noise: [0.02, 5e-4],
            force_noise: [0.2, 0.01],
            stiffness_noise: [0.3, 0.02],
            updates: 25,
        }
    }

    pub(super) fn check(&self) -> Result<()> {
        let Schedule::Explicit { sharpness, point_noise, force_noise, stiffness_noise, .. } = self else {
            return Ok(());
        };
        for (name, pair) in [
            ("sharpness", sharpness),
            ("point_noise", point_noise),
            ("force_noise", force_noise),
            ("stiffness_noise", stiffness_noise),
        ] {
            if !pair.iter().all(|x| *x > 0.0 && *x < 1e9) {
                return Err(Error::input(
                    "schedule",
                    format!("{name} must be two positive numbers, got {} and {}", pair[0], pair[1]),
                ));
            }
        }
        Ok(())
    }
}

/// A motion of the robot that makes a measurement a new one, and the model's noise its full size [m].
pub(super) const NEW_POSE: f64 = 0.005;
/// Adaptive noise of a force, relative, and of a distance [m].
const FORCE_NOISE: f64 = 0.04;
const DISTANCE_NOISE: f64 = 1e-4;
/// Share of particles whose radius is drawn anew: a real obstacle is no sphere.
const REDRAW: f64 = 0.2;

/// Noise and sharpness of one update.
#[derive(Debug, Clone, Copy)]
pub(super) struct Noise {
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

impl Noise {
    /// Nothing moves.
    pub fn none() -> Self {
        Noise { redraw: 0.0, force: 0.0, stiffness: 0.0, distance: 0.0, point: None, sharpness: None }
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
            Schedule::Adaptive => Noise {
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
                Noise {
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
