//! The end of a contact that leaves a torque behind.
//!
//! Gears and torque sensors keep a part of what loaded them: after a contact a joint's torque stands still at a new level,
//! which a bias that waits for the old one would take for a contact for ever. A force that is still held, of a person who
//! is clamped after an impact, stands still as well, and no torque tells the two apart. So only what hysteresis leaves is
//! taken for a remainder, and never so much that a force worth detecting could hide behind it.

/// How long the torque must have stood still (s); a hand's push does not.
const STILL_TIME: f64 = 0.1;
/// And in how many samples at least, for slow or interrupted clocks.
const FEWEST_SAMPLES: u64 = 5;
/// Still: within this part of the threshold of its mean so far, every joint.
const STILL_BAND: f64 = 0.5;
/// A torque that does not stand still, of an arm that moves on, has ended when it stayed a remainder for this long (s),
const LOW_TIME: f64 = 0.4;
/// of which the last part tells what is left, when the observer has forgotten the contact (s),
const LEFT_TIME: f64 = 0.2;
/// and fell to this share of its greatest norm.
const LOW_SHARE: f64 = 0.3;
/// A joint counts as loaded by at least this share of the whole contact's greatest torque: gears and sensors also answer
/// to load across their axis. (On a real Franka arm touches of 14 Nm leave up to 0.65 Nm in joint 5, which itself bore
/// less than 1.1 Nm.)
const CROSS_LOAD: f64 = 0.25;
/// Greatest norm of a remainder, in norms of the thresholds: what may hide behind it is no larger than what all joints
/// together may bear undetected. Not joint by joint: a small threshold says that a joint is quiet, not that
/// its gear keeps less.
const LARGEST_REMAINDER: f64 = 1.0;

/// What the release rule needs to know of a robot, one number a joint.
#[derive(Debug, Clone)]
pub(crate) struct ReleaseRule {
    /// A torque that stands still for this long becomes the bias at any level (s).
    pub settle_time: Option<f64>,
    /// Share of its load that a joint may keep.
    pub hysteresis: Vec<f64>,
    /// (Nm, N).
    pub threshold: Vec<f64>,
    /// Whether a joint's torque is a force (N): only torques of one unit are summed.
    pub is_force: Vec<bool>,
}

/// Watches the torque during a contact for its fall to a small remainder that stands still.
#[derive(Debug, Clone)]
pub(crate) struct ReleaseDetector {
    rule: ReleaseRule,
    /// Greatest norm of a remainder's torques (Nm) and of its forces (N).
    limit: [f64; 2],
    /// Mean since the torque stands still.
    mean: Vec<f64>,
    samples: u64,
    still_time: f64,
    /// For how long the torque has been as low as a remainder (s), and its mean since.
    low_time: f64,
    low_samples: u64,
    low_mean: Vec<f64>,
    /// Whether the torque that ended the contact did not stand still.
    moving: bool,
    /// Each joint's greatest torque free of bias in this contact, with its sign.
    peak: Vec<f64>,
    /// Greatest norm of the torques (Nm) and of the forces (N).
    greatest: [f64; 2],
}

impl ReleaseDetector {
    pub fn new(rule: ReleaseRule) -> Self {
        let nv = rule.threshold.len();
        Self {
            limit: limit(&rule),
            mean: vec![0.0; nv],
            samples: 0,
            still_time: 0.0,
            low_time: 0.0,
            low_samples: 0,
            low_mean: vec![0.0; nv],
            moving: false,
            peak: vec![0.0; nv],
            greatest: [0.0; 2],
            rule,
        }
    }

    /// Another rule; what is known of the contact so far stays.
    pub fn set_rule(&mut self, rule: ReleaseRule) {
        self.limit = limit(&rule);
        self.rule = rule;
    }

    /// A step of `dt` (s) in contact with a torque still including the bias; true when the contact is over and
    /// [`ReleaseDetector::remainder`] is the new bias.
    pub fn update(&mut self, torque: &[f64], bias: &[f64], dt: f64) -> bool {
        self.find_peaks(torque, bias);
        let near = |((torque, mean), threshold): ((&f64, &f64), &f64)| {
            (torque - mean).abs() <= STILL_BAND * threshold
        };
        if self.samples > 0 && torque.iter().zip(&self.mean).zip(&self.rule.threshold).all(near) {
            self.samples += 1;
            self.still_time += dt;
            let share = 1.0 / self.samples as f64;
            self.mean.iter_mut().zip(torque).for_each(|(mean, torque)| *mean += share * (torque - *mean));
        } else {
            // One sample tells nothing of the time before it.
            self.samples = 1;
            self.still_time = 0.0;
            self.mean.copy_from_slice(torque);
        }
        self.moving = self.has_been_low(torque, bias, dt);
        if self.moving {
            return true;
        }
        if self.samples < FEWEST_SAMPLES {
            return false;
        }
        let settled = self.rule.settle_time.is_some_and(|settle| self.still_time >= settle);
        settled
            || (self.still_time >= STILL_TIME
                && (self.is_remainder(&self.mean, bias) || self.is_wrong_bias(bias)))
    }

    /// Whether the torque has been as low as a remainder for long enough, after a greater one.
    fn has_been_low(&mut self, torque: &[f64], bias: &[f64], dt: f64) -> bool {
        let left = norms(torque.iter().zip(bias).map(|(torque, bias)| torque - bias), &self.rule.is_force);
        let low = left.iter().zip(&self.greatest).all(|(left, greatest)| *left <= LOW_SHARE * greatest);
        if !(low && self.is_remainder(torque, bias)) {
            (self.low_time, self.low_samples) = (0.0, 0);
            return false;
        }
        self.low_time += dt;
        self.low_samples += 1;
        let share = (dt / (self.low_time - (LOW_TIME - LEFT_TIME)).max(dt)).min(1.0);
        self.low_mean.iter_mut().zip(torque).for_each(|(mean, torque)| *mean += share * (torque - *mean));
        self.low_time >= LOW_TIME && self.low_samples >= FEWEST_SAMPLES
    }

    fn find_peaks(&mut self, torque: &[f64], bias: &[f64]) {
        for ((torque, bias), peak) in torque.iter().zip(bias).zip(&mut self.peak) {
            let contact = torque - bias;
            if contact.abs() > peak.abs() {
                *peak = contact;
            }
        }
        let norms = norms(torque.iter().zip(bias).map(|(torque, bias)| torque - bias), &self.rule.is_force);
        self.greatest.iter_mut().zip(norms).for_each(|(greatest, norm)| *greatest = greatest.max(norm));
    }

    /// Whether hysteresis of the contact that has just ended may have left all of a torque that is over a threshold.
    fn is_remainder(&self, torque: &[f64], bias: &[f64]) -> bool {
        let ReleaseRule { hysteresis, threshold, is_force, .. } = &self.rule;
        let left = torque.iter().zip(bias).map(|(torque, bias)| torque - bias);
        if norms(left.clone(), is_force).iter().zip(&self.limit).any(|(left, limit)| left > limit) {
            return false;
        }
        left.enumerate().all(|(k, left)| {
            let load = self.peak[k].abs().max(CROSS_LOAD * self.greatest[usize::from(is_force[k])]);
            left.abs() <= threshold[k] || (left * self.peak[k] > 0.0 && left.abs() <= hysteresis[k] * load)
        })
    }

    /// Whether the bias is wrong rather than the robot touched: without it no joint's torque says anything. (It was learnt
    /// during a contact, and a contact that now cancels it in every joint is not to be expected.)
    fn is_wrong_bias(&self, bias: &[f64]) -> bool {
        self.mean.iter().zip(bias).zip(&self.rule.threshold).all(|((mean, bias), threshold)| {
            mean.abs() <= STILL_BAND * threshold
                && ((mean - bias).abs() <= *threshold || bias.abs() > *threshold)
        })
    }

    /// The torque that the contact left `(nv,)`: its mean since it stands still, or since it is low.
    pub fn remainder(&self) -> &[f64] {
        if self.moving {
            &self.low_mean
        } else {
            &self.mean
        }
    }

    /// What hysteresis may have left of this contact in joint `k` (Nm).
    pub fn could_keep(&self, k: usize) -> f64 {
        self.rule.hysteresis[k] * self.peak[k].abs()
    }

    /// Nothing is known of the torque between the last sample and the next.
    pub fn interrupt(&mut self) {
        self.samples = 0;
        (self.low_time, self.low_samples) = (0.0, 0);
    }

    /// Prepares for another contact.
    pub fn reset(&mut self) {
        self.samples = 0;
        (self.low_time, self.low_samples) = (0.0, 0);
        self.peak.fill(0.0);
        self.greatest = [0.0; 2];
    }
}

/// Greatest norm of a remainder's torques (Nm) and of its forces (N).
fn limit(rule: &ReleaseRule) -> [f64; 2] {
    norms(rule.threshold.iter().copied(), &rule.is_force).map(|norm| LARGEST_REMAINDER * norm)
}

/// Norm of the torques (Nm), and of the forces (N).
fn norms(values: impl Iterator<Item = f64>, is_force: &[bool]) -> [f64; 2] {
    let mut squares = [0.0; 2];
    values.zip(is_force).for_each(|(value, force)| squares[usize::from(*force)] += value * value);
    squares.map(f64::sqrt)
}

#[cfg(test)]
mod tests {
    use super::{ReleaseDetector, ReleaseRule};

    const DT: f64 = 1e-3;

    fn detector(settle_time: Option<f64>) -> ReleaseDetector {
        detector_of([0.5, 0.1], settle_time)
    }

    fn detector_of(threshold: [f64; 2], settle_time: Option<f64>) -> ReleaseDetector {
        let (hysteresis, is_force) = (vec![0.2; 2], vec![false; 2]);
        ReleaseDetector::new(ReleaseRule { settle_time, hysteresis, threshold: threshold.to_vec(), is_force })
    }

    /// Time at which the contact is called over.
    fn released(settle: Option<f64>, duration: f64, torque: impl Fn(f64) -> [f64; 2]) -> Option<f64> {
        released_by(detector(settle), duration, torque)
    }

    fn released_by(
        mut release: ReleaseDetector,
        duration: f64,
        torque: impl Fn(f64) -> [f64; 2],
    ) -> Option<f64> {
        (0..(duration / DT) as usize)
            .map(|tick| tick as f64 * DT)
            .find(|time| release.update(&torque(*time), &[0.0; 2], DT))
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
    fn a_force_held_after_an_impact_goes_on() {
        // 7.5 % of the peak, but four thresholds.
        let clamp = |t: f64| if t < 0.05 { [27.0, 3.0] } else { [2.0, 0.22] };
        assert_eq!(released(None, 20.0, clamp), None);
    }

    #[test]
    fn a_remainder_has_the_sign_of_the_contact() {
        for (left, over) in
            [([0.55, 0.2], true), ([-0.55, 0.2], false), ([0.4, 0.45], true), ([0.4, -0.45], false)]
        {
            let push = |t: f64| if t < 0.3 { [8.0, 4.0] } else { left };
            let release = detector_of([0.5, 0.39], None);
            assert_eq!(released_by(release, 2.0, push).is_some(), over, "{left:?}");
        }
    }

    #[test]
    fn a_joint_keeps_a_share_of_its_own_load() {
        for (left, over) in [(0.55, true), (0.7, false)] {
            let push = |t: f64| if t < 0.3 { [3.0, 0.0] } else { [left, 0.0] };
            let release = detector_of([0.5, 0.7], None);
            assert_eq!(released_by(release, 2.0, push).is_some(), over, "{left}");
        }
    }

    #[test]
    fn forces_and_torques_are_not_summed() {
        let rule = ReleaseRule {
            settle_time: None,
            hysteresis: vec![0.2; 2],
            threshold: vec![50.0, 0.5],
            is_force: vec![true, false],
        };
        // A force of 100 N says nothing of what a gear keeps of a torque, nor does its threshold.
        let push = |t: f64| if t < 0.3 { [100.0, 1.0] } else { [0.0, 0.6] };
        assert_eq!(released_by(ReleaseDetector::new(rule), 2.0, push), None);
    }

    #[test]
    fn a_remainder_that_moves_is_a_contact() {
        let push = |t: f64| if t < 0.3 { [30.0, 1.0] } else { [1.5 * (40.0 * t).sin(), 0.0] };
        assert_eq!(released(Some(1.0), 5.0, push), None);
    }

    #[test]
    fn a_bias_learnt_from_a_contact_is_given_up() {
        let mut release = detector(None);
        let over = (0..200).find(|_| release.update(&[0.01, -0.01], &[6.0, 0.0], DT));
        assert_eq!(over, Some(100));
        // A contact that cancels a bias in part stays one.
        let mut release = detector(None);
        assert!(!(0..2000).any(|_| release.update(&[2.0, 0.0], &[6.0, 0.0], DT)));
    }

    #[test]
    fn a_gap_is_no_standstill() {
        let mut release = detector(None);
        release.update(&[10.0, 1.0], &[0.0; 2], DT);
        assert!(!(0..4).any(|_| release.update(&[0.505, 0.0], &[0.0; 2], 0.2)));
        release.interrupt();
        assert!(!(0..4).any(|_| release.update(&[0.505, 0.0], &[0.0; 2], 0.2)));
        assert!(release.update(&[0.505, 0.0], &[0.0; 2], 0.2));
    }

    #[test]
    fn the_remainder_is_a_mean() {
        let mut release = detector(Some(0.2));
        for tick in 0..500 {
            let sign = if tick % 2 == 0 { 1.0 } else { -1.0 };
            if release.update(&[1.0 + 0.1 * sign, 0.2], &[0.0; 2], DT) {
                break;
            }
        }
        assert!((release.remainder()[0] - 1.0).abs() < 1e-3, "{:?}", release.remainder());
    }
}
