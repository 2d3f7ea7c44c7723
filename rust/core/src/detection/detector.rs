//! Thresholds with a hold time (Vorndamme 2017, eq. 21).

use std::sync::Arc;

use super::tips::TipSearch;
use crate::error::{Error, Result};
use crate::robot::configuration::check_vector;
use crate::robot::Robot;

/// Element-wise thresholds; a signal stays on for a hold time after it was last over its threshold.
#[derive(Debug, Clone)]
pub struct Detector {
    robot: Arc<Robot>,
    threshold: Vec<f64>,
    hold_time: f64,
    /// Time left until a signal goes off [s].
    remaining: Vec<f64>,
    tips: TipSearch,
    links: Vec<usize>,
    collision: bool,
    onset: bool,
}

impl Detector {
    /// `threshold` per velocity variable, or one for all [Nm; N for prismatic joints and a base's linear part];
    /// `hold_time` [s].
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    pub fn new(robot: Arc<Robot>, threshold: &[f64], hold_time: f64) -> Result<Self> {
        let threshold = check_threshold(&robot, threshold)?;
        if !(hold_time.is_finite() && hold_time >= 0.0) {
            return Err(Error::Input(format!(
                "hold_time: must be finite and not negative [s], not {hold_time}"
            )));
        }
        Ok(Self {
            remaining: vec![-1.0; robot.nv()],
            tips: TipSearch::new(&robot),
            links: Vec::with_capacity(robot.touchable_links().len()),
            robot,
            threshold,
            hold_time,
            collision: false,
            onset: false,
        })
    }

    /// One tick of `dt` [s] with the external torque `(nv,)`; true while there is a contact.
    pub fn update(&mut self, external_torque: &[f64], dt: f64) -> bool {
        let before = self.collision;
        self.collision = false;
        for ((remaining, threshold), torque) in
            self.remaining.iter_mut().zip(&self.threshold).zip(external_torque)
        {
            *remaining = if torque.abs() > *threshold { self.hold_time } else { *remaining - dt };
            self.collision |= *remaining >= 0.0;
        }
        self.onset = self.collision && !before;
        self.links.clear();
        let remaining = &self.remaining;
        for &body in self.tips.find(&self.robot, |k| remaining[k] >= 0.0) {
            self.links.extend_from_slice(self.robot.links_of_body(body));
        }
        self.collision
    }

    /// Forgets all signals.
    pub fn reset(&mut self) {
        self.remaining.fill(-1.0);
        self.links.clear();
        self.collision = false;
        self.onset = false;
    }

    /// Whether there is a contact.
    pub fn collision(&self) -> bool {
        self.collision
    }

    /// Whether the contact began with the last update.
    pub fn onset(&self) -> bool {
        self.onset
    }

    /// Touchable links between the last signal over its threshold and the next under it, on every branch.
    pub fn links(&self) -> &[usize] {
        &self.links
    }

    /// The thresholds `(nv,)`.
    pub fn threshold(&self) -> &[f64] {
        &self.threshold
    }
}

/// One threshold for all velocity variables, or one for each; positive and finite.
pub(crate) fn check_threshold(robot: &Robot, threshold: &[f64]) -> Result<Vec<f64>> {
    let threshold = match threshold {
        [one] => vec![*one; robot.nv()],
        _ => threshold.to_vec(),
    };
    check_vector("torque_threshold", &threshold, robot.nv())?;
    if threshold.iter().any(|x| *x <= 0.0) {
        return Err(Error::Input("torque_threshold: must be positive [Nm]".into()));
    }
    Ok(threshold)
}
