//! The end of a contact that leaves a torque behind.
//!
//! Gears and torque sensors keep a part of what loaded them: after a touch a joint's torque stands still at a new
//! level, which a bias that waits for the old one would take for a contact for ever.

/// A contact is over once the torque has fallen below this share of the contact's greatest (norms).
const SHARE: f64 = 0.1;
/// How long the torque must have stood still by then [s]; a hand's push does not.
const STILL_TIME: f64 = 0.1;
/// Still: within this part of the threshold of its mean so far, every joint.
const STILL_BAND: f64 = 0.5;

/// Watches the torque during a contact for its fall to a small remainder that stands still.
#[derive(Debug, Clone)]
pub struct ReleaseDetector {
    /// A torque that stands still for this long at any level is taken for a bias [s].
    settle_time: Option<f64>,
    /// Mean since the torque stands still.
    mean: Vec<f64>,
    still_ticks: u64,
    still_time: f64,
    /// Greatest norm of the bias-free torque in this contact.
    peak: f64,
}

impl ReleaseDetector {
    /// For `nv` torques; `settle_time` [s] also ends contacts that stand still at full force.
    pub fn new(nv: usize, settle_time: Option<f64>) -> Self {
        Self { settle_time, mean: vec![0.0; nv], still_ticks: 0, still_time: 0.0, peak: 0.0 }
    }

    /// A tick of `dt` in contact with a torque still including the bias; true when the contact is over and
    /// [`ReleaseDetector::remainder`] is the new bias.
    pub fn update(&mut self, torque: &[f64], bias: &[f64], threshold: &[f64], dt: f64) -> bool {
        self.peak = self.peak.max(distance(torque, bias));
        let near = |((torque, mean), threshold): ((&f64, &f64), &f64)| {
            (torque - mean).abs() <= STILL_BAND * threshold
        };
        if self.still_ticks > 0 && torque.iter().zip(&self.mean).zip(threshold).all(near) {
            self.still_ticks += 1;
            self.still_time += dt;
            let share = 1.0 / self.still_ticks as f64;
            self.mean.iter_mut().zip(torque).for_each(|(mean, torque)| *mean += share * (torque - *mean));
        } else {
            self.still_ticks = 1;
            self.still_time = dt;
            self.mean.copy_from_slice(torque);
        }
        let released = self.still_time >= STILL_TIME && distance(&self.mean, bias) < SHARE * self.peak;
        released || self.settle_time.is_some_and(|settle| self.still_time >= settle)
    }

    /// The mean torque since it stands still `(nv,)`.
    pub fn remainder(&self) -> &[f64] {
        &self.mean
    }

    /// Prepares for another contact.
    pub fn reset(&mut self) {
        self.still_ticks = 0;
        self.still_time = 0.0;
        self.peak = 0.0;
    }
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::ReleaseDetector;

    const DT: f64 = 1e-3;
    const THRESHOLD: [f64; 2] = [0.5, 0.1];

    /// Time at which the contact is called over.
    fn released(settle: Option<f64>, duration: f64, torque: impl Fn(f64) -> [f64; 2]) -> Option<f64> {
        let mut release = ReleaseDetector::new(2, settle);
        (0..(duration / DT) as usize)
            .map(|tick| tick as f64 * DT)
            .find(|time| release.update(&torque(*time), &[0.0; 2], &THRESHOLD, DT))
    }

    #[test]
    fn a_remainder_ends_the_contact() {
        let push = |t: f64| if t < 0.5 { [10.0 * (6.0 * t).sin(), 1.0] } else { [0.1, 0.3] };
        let over = released(None, 2.0, push);
        assert!(over.is_some_and(|time| (0.59..0.61).contains(&time)), "{over:?}");
    }

    #[test]
    fn a_steady_push_goes_on() {
        let push = |t: f64| if t < 0.3 { [8.0, 1.0] } else { [2.0, 0.0] };
        assert_eq!(released(None, 20.0, push), None);
        let over = released(Some(3.0), 20.0, push);
        assert!(over.is_some_and(|time| (3.29..3.31).contains(&time)), "{over:?}");
    }

    #[test]
    fn a_remainder_that_moves_is_a_contact() {
        let push = |t: f64| if t < 0.3 { [30.0, 1.0] } else { [1.5 * (40.0 * t).sin(), 0.0] };
        assert_eq!(released(Some(1.0), 5.0, push), None);
    }

    #[test]
    fn the_remainder_is_a_mean() {
        let mut release = ReleaseDetector::new(2, Some(0.2));
        for tick in 0..500 {
            let sign = if tick % 2 == 0 { 1.0 } else { -1.0 };
            if release.update(&[1.0 + 0.1 * sign, 0.2], &[0.0; 2], &THRESHOLD, DT) {
                break;
            }
        }
        assert!((release.remainder()[0] - 1.0).abs() < 1e-3, "{:?}", release.remainder());
    }
}
