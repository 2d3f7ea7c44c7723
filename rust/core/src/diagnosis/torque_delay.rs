//! Torques late, or early, against positions and velocities.

use super::hypothesis::{Explained, Fault, Trial, PER_NUMBER};
use super::target::Target;
use super::terms::DELAYS;

impl Trial<'_> {
    /// The delay of all torques that explains them best.
    pub(super) fn delay(&self) -> Option<Explained> {
        if !self.evidence.moving {
            return None;
        }
        let at = |delay: f64| {
            let target = Target::plain(self.evidence.parts).later(self.evidence.parts, delay, None);
            self.explained(Fault::Delay(delay), target, self.prior, PER_NUMBER)
        };
        let coarse: Vec<Explained> = DELAYS.iter().filter_map(|delay| at(*delay)).collect();
        let best = (0..coarse.len()).max_by(|a, b| coarse[*a].score.total_cmp(&coarse[*b].score))?;
        let delay = DELAYS[best];
        let half = if best + 1 < DELAYS.len() { 0.5 * (DELAYS[best + 1] - delay) } else { 0.0 };
        let near = [-half, -0.5 * half, 0.5 * half, half].into_iter().filter_map(|step| at(delay + step));
        near.chain(std::iter::once(coarse[best].clone())).max_by(|a, b| a.score.total_cmp(&b.score))
    }
}
