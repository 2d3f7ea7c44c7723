//! What is known of the errors that change slowly: bias, friction and masses that are a little off, gears that keep a part
//! of their load. While nothing touches they are followed; during a contact they drift away from what was known.

use super::model_errors::ModelErrors;
use crate::torque::SlowNoise;

/// A shorter mean of a first bias holds too much noise (s).
const FIRST_TIME: f64 = 0.3;
/// The torque of a contact that has ended is still in the observers for so many times as long as it lasted, and at most for so long (s):
/// three time constants of the slowest.
const TAIL: f64 = 3.0;
const SETTLING: f64 = 0.375;
/// What a contact has left behind is not learnt faster (s): a weak contact that follows would be taken for a part of it.
const LEARNT_TIME: f64 = 0.7;
/// A bias does not go beyond so many standard deviations of what it can be: a held force cannot hide behind it.
const LARGEST_BIAS: f64 = 4.0;
/// Beyond that it may hold what contacts have left in a joint, up to so many standard deviations of it: gears without a load of their
/// own keep it for good.
const LARGEST_LEFT: f64 = 2.0;
/// Time over which the bias of a robot that is not followed becomes unknown again (s).
const BIAS_TIME: f64 = 60.0;
/// A joint keeps no more of a contact's load than all joints together err by: what is larger may be a force that is held.
const LARGEST_KEPT: f64 = 1.0;

/// Follows slow errors, and says how well they are known.
#[derive(Debug, Clone)]
pub(crate) struct SlowErrors {
    /// (s).
    time_constant: f64,
    noise: SlowNoise,
    /// Share of the errors that a low-pass of the time constant follows.
    followed: Vec<f64>,
    /// The bias of no errors: what was tared.
    zero: Vec<f64>,
    /// The bias stays this near to it.
    limit: Vec<f64>,
    of_model: ModelErrors,
    bias: Vec<f64>,
    /// By joint, for how long it has been followed (s): the mean of as long a time is as certain as the bias is.
    age: Vec<f64>,
    /// Not followed since (s); while it is followed again, that time wears off.
    lost: Vec<f64>,
    /// The torque of a contact, or of what looked like one, is in the observers for as long yet (s).
    unsettled: f64,
    /// Share of the bias at the start that is not known.
    unknown: Vec<f64>,
    /// Variance of what a contact may have left in each joint (Nm squared), and the most that it can be.
    kept: Vec<f64>,
    largest_kept: Vec<f64>,
    /// The largest of those variances since the bias was known (Nm squared).
    left: Vec<f64>,
}

impl SlowErrors {
    /// Errors of a noise are followed by a low-pass of a time constant (s).
    pub fn new(noise: SlowNoise, of_model: ModelErrors, time_constant: f64) -> Self {
        let spread = noise.model.iter().zip(&noise.bias);
        let kept = |of_forces: bool| {
            let alike = spread.clone().zip(&noise.is_force).filter(|(_, is_force)| **is_force == of_forces);
            LARGEST_KEPT.powi(2) * alike.map(|((model, bias), _)| model + bias).sum::<f64>()
        };
        let largest_kept = [kept(false), kept(true)];
        SlowErrors {
            followed: noise.model_time.iter().map(|time| time / (time + time_constant)).collect(),
            limit: spread.map(|(model, bias)| LARGEST_BIAS * (model + bias).sqrt()).collect(),
            zero: vec![0.0; noise.model.len()],
            bias: vec![0.0; noise.model.len()],
            age: vec![0.0; noise.model.len()],
            lost: vec![0.0; noise.model.len()],
            unsettled: 0.0,
            unknown: vec![1.0; noise.model.len()],
            kept: vec![0.0; noise.model.len()],
            left: vec![0.0; noise.model.len()],
            largest_kept: noise
                .is_force
                .iter()
                .map(|is_force| largest_kept[usize::from(*is_force)])
                .collect(),
            time_constant,
            noise,
            of_model,
        }
    }

    /// A step of `dt` (s) without contact, with a torque `(nv,)`: a mean at first, then a low-pass.
    #[inline]
    pub fn follow(&mut self, torque: &[f64], dt: f64) {
        if self.unsettled > 0.0 {
            self.unsettled -= dt;
            if self.unsettled > 0.0 {
                return;
            }
            self.doubt();
        }
        for (j, torque) in torque.iter().enumerate() {
            self.age[j] = (self.age[j] + dt).min(self.time_constant);
            let share = (dt / self.age[j].max(FIRST_TIME)).min(1.0);
            self.of_model.follow(j, share);
            let (zero, limit) = (self.zero[j], self.limit(j).hypot(LARGEST_LEFT * self.left[j].sqrt()));
            self.bias[j] = (self.bias[j] + share * (torque - self.bias[j])).clamp(zero - limit, zero + limit);
            let left = (1.0 - share).powi(2);
            self.unknown[j] *= 1.0 - share;
            self.lost[j] *= left;
            self.kept[j] *= left;
        }
        self.of_model.keep(dt);
    }

    /// After a contact a bias is less certain, and followed as one of as short a time: what gears have kept shows at once.
    fn doubt(&mut self) {
        for j in 0..self.age.len() {
            let certain = self.noise.model[j] * (1.0 - self.followed[j]);
            let doubtful = self.kept[j] + self.drift(j) + self.unknown[j].powi(2) * self.noise.bias[j];
            if doubtful > 0.0 {
                let known = self.time_constant * certain / (certain + doubtful);
                self.age[j] = self.age[j].min(known.max(LEARNT_TIME));
            }
        }
    }

    /// The variance by which joint `j`'s errors have drifted away from the bias since it was followed.
    fn drift(&self, j: usize) -> f64 {
        if self.lost[j] > 0.0 {
            let known = (-self.lost[j] / self.noise.model_time[j]).exp();
            2.0 * self.noise.model[j] * self.followed[j] * (1.0 - known)
        } else {
            0.0
        }
    }

    /// A step of `dt` (s) that tells nothing of the errors, with a torque `(nv,)` of which joints may keep a share.
    #[inline]
    pub fn lose(&mut self, torque: &[f64], dt: f64) {
        self.unsettled = (self.unsettled + TAIL * dt).min(SETTLING);
        self.lost.iter_mut().for_each(|lost| *lost += dt);
        let forgotten = (dt / BIAS_TIME).min(1.0);
        self.unknown.iter_mut().for_each(|unknown| *unknown += forgotten * (1.0 - *unknown));
        for (k, kept) in self.kept.iter_mut().enumerate() {
            let load = self.noise.relative[k] * (torque[k] - self.bias[k]);
            *kept = kept.max((load * load).min(self.largest_kept[k]));
            self.left[k] = self.left[k].max(*kept);
            self.bias[k] += forgotten * (self.zero[k] - self.bias[k]);
            self.of_model.forget(k, forgotten);
        }
    }

    /// The variance of what is not known of joint `j`'s errors behind an observer that follows them by a share.
    #[inline]
    pub fn variance(&self, j: usize, share: f64) -> f64 {
        // Of an error m that its low-pass b follows: var(m) = 1, var(b) = cov(m, b) = followed, and the covariance
        // falls off with the time since.
        share * (self.noise.model[j] * (1.0 - self.followed[j]) + self.drift(j))
            + self.unknown[j].powi(2) * self.noise.bias[j]
            + self.kept[j]
    }

    /// The variance of what joint `j`'s errors change by within `time` (s), behind an observer that follows them by a share.
    #[inline]
    pub fn change(&self, j: usize, share: f64, time: f64) -> f64 {
        2.0 * share * self.noise.model[j] * (1.0 - (-time / self.noise.model_time[j]).exp())
    }

    /// Takes a torque that a contact left behind for the bias.
    pub fn set(&mut self, bias: &[f64]) {
        self.of_model.take();
        self.bias.copy_from_slice(bias);
        self.lost.fill(0.0);
    }

    /// Whether a torque may be the bias after a contact that may have left so much in each joint (Nm).
    pub fn allows(&self, torque: &[f64], left: impl Fn(usize) -> f64) -> bool {
        let limits = (0..self.limit.len()).map(|k| self.limit(k) + left(k));
        let from_zero = torque.iter().zip(&self.zero).map(|(torque, zero)| torque - zero);
        from_zero.zip(limits).all(|(torque, limit)| torque.abs() <= limit)
    }

    /// Takes the torque of an untouched robot for the bias, which is then known, and which it falls back to.
    pub fn tare(&mut self, torque: &[f64]) {
        self.of_model.take();
        self.zero.copy_from_slice(torque);
        self.bias.copy_from_slice(torque);
        self.kept.fill(0.0);
        self.left.fill(0.0);
        self.age.fill(self.time_constant);
        self.lost.fill(0.0);
        self.unknown.fill(0.0);
        self.unsettled = 0.0;
    }

    /// How far joint `j`'s bias may be from zero (Nm).
    fn limit(&self, j: usize) -> f64 {
        self.limit[j].hypot(LARGEST_BIAS * self.of_model.variance(j).sqrt())
    }

    /// Errors of the model that change with pose and speed, beside the variances.
    pub fn of_model(&self) -> &ModelErrors {
        &self.of_model
    }

    /// The same, to be advanced.
    pub fn of_model_mut(&mut self) -> &mut ModelErrors {
        &mut self.of_model
    }

    /// The bias `(nv,)`.
    pub fn bias(&self) -> &[f64] {
        &self.bias
    }

    /// Forgets the bias.
    pub fn reset(&mut self) {
        self.of_model.reset();
        self.zero.fill(0.0);
        self.bias.fill(0.0);
        self.kept.fill(0.0);
        self.left.fill(0.0);
        self.age.fill(0.0);
        self.lost.fill(0.0);
        self.unknown.fill(1.0);
        self.unsettled = 0.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-3;

    /// Two joints with errors of 0.1 Nm over 10 s, and 0.2 Nm from start to start.
    fn errors() -> SlowErrors {
        let two = |value: f64| vec![value; 2];
        let noise = SlowNoise {
            model: two(0.01),
            model_time: two(10.0),
            bias: two(0.04),
            relative: two(0.05),
            is_force: vec![false; 2],
        };
        SlowErrors::new(noise, ModelErrors::new(vec![], 2), 3.0)
    }

    fn follow(errors: &mut SlowErrors, torque: [f64; 2], seconds: f64) {
        (0..(seconds / DT) as usize).for_each(|_| errors.follow(&torque, DT));
    }

    #[test]
    fn what_is_followed_becomes_certain_and_what_is_not_uncertain_again() {
        let mut errors = errors();
        let at_start = errors.variance(0, 1.0);
        assert!((at_start - (0.04 + 0.01 * (1.0 - 10.0 / 13.0))).abs() < 1e-12);
        follow(&mut errors, [0.15, -0.1], 10.0);
        assert!((errors.bias()[0] - 0.15).abs() < 0.01 && (errors.bias()[1] + 0.1).abs() < 0.01);
        // Of an error of 10 s, a low-pass of 3 s leaves 3/13 of the variance.
        assert!((errors.variance(0, 1.0) / (0.01 * 3.0 / 13.0) - 1.0).abs() < 0.05);
        let torque = [0.15, -0.1];
        (0..2000).for_each(|_| errors.lose(&torque, DT));
        let after_a_contact = errors.variance(0, 1.0);
        (0..360_000).for_each(|_| errors.lose(&torque, DT));
        assert!(after_a_contact < errors.variance(0, 1.0) && errors.bias()[0].abs() < 0.01);
        assert!((errors.variance(0, 1.0) - (0.04 + 0.01 * (1.0 + 10.0 / 13.0))).abs() < 2e-3);
    }

    #[test]
    fn what_a_joint_has_kept_is_learnt_soon_and_nothing_of_others() {
        let mut errors = errors();
        follow(&mut errors, [0.0; 2], 20.0);
        let before = errors.variance(0, 0.0);
        // Joint 1 may keep 5 % of 6 Nm, and does.
        (0..100).for_each(|_| errors.lose(&[0.0, 6.0], DT));
        let kept = errors.variance(1, 0.0);
        follow(&mut errors, [0.3; 2], 0.25);
        // The contact's own torque is left in the observers.
        assert!(errors.bias()[1] == 0.0 && errors.variance(1, 0.0) == kept && kept > 0.08);
        follow(&mut errors, [0.3; 2], 1.0);
        let [slow, fast] = [errors.bias()[0], errors.bias()[1]];
        assert!(fast > 0.17 && slow < 0.11, "{slow} {fast}");
        assert!(errors.variance(1, 0.0) < 0.25 * kept && errors.variance(0, 0.0) <= before + 1e-3);
    }

    #[test]
    fn a_held_force_does_not_become_the_bias() {
        let mut errors = errors();
        follow(&mut errors, [20.0, 0.0], 60.0);
        assert_eq!(errors.bias()[0], 4.0 * 0.05_f64.sqrt());
    }

    #[test]
    fn what_a_contact_has_left_can_become_the_bias_of_a_joint_that_errs_by_little() {
        let noise = SlowNoise {
            model: vec![0.01, 1e-6],
            model_time: vec![10.0; 2],
            bias: vec![0.04, 0.0],
            relative: vec![0.05; 2],
            is_force: vec![false; 2],
        };
        let mut errors = SlowErrors::new(noise, ModelErrors::new(vec![], 2), 3.0);
        follow(&mut errors, [0.0, 0.03], 20.0);
        assert!((errors.bias()[1] - 4e-3).abs() < 1e-9);
        // 5 % of 1 Nm.
        (0..300).for_each(|_| errors.lose(&[0.0, 1.0], DT));
        follow(&mut errors, [0.0, 0.03], 20.0);
        assert!((errors.bias()[1] - 0.03).abs() < 1e-3, "{}", errors.bias()[1]);
        follow(&mut errors, [0.0, 1.0], 20.0);
        assert!(errors.bias()[1] < 0.11);
    }

    #[test]
    fn a_joint_keeps_a_share_of_its_load_up_to_what_all_err_by() {
        let mut errors = errors();
        follow(&mut errors, [0.0, 0.0], 20.0);
        let before = errors.variance(1, 0.0);
        errors.lose(&[100.0, 2.0], DT);
        let kept = |j: usize, errors: &SlowErrors| errors.variance(j, 0.0) - before;
        assert!((kept(1, &errors) - 0.01).abs() < 1e-3, "5 % of 2 Nm");
        assert!((kept(0, &errors) - 0.1).abs() < 1e-3, "not 5 Nm, but what both joints err by");
        assert!(errors.allows(&[0.9, 0.0], |_| 0.1) && !errors.allows(&[1.1, 0.0], |_| 0.1));
    }
}
