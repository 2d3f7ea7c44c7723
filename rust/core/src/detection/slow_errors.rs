//! What is known of the errors that change slowly: bias, friction and masses that are a little off, gears that keep a part
//! of their load. While nothing touches they are followed; during a contact they drift away from what was known.

use crate::torque::SlowNoise;

/// A shorter mean of a first bias holds too much noise (s).
const FIRST_TIME: f64 = 0.3;
/// A bias does not go beyond so many standard deviations of what it can be: a held force cannot hide behind it.
const LARGEST_BIAS: f64 = 4.0;
/// Time over which the bias of a robot that is not followed becomes unknown again (s).
const BIAS_TIME: f64 = 10.0;
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
    limit: Vec<f64>,
    bias: Vec<f64>,
    /// Followed so far (s).
    age: f64,
    /// Not followed since (s); while it is followed again, that time wears off.
    lost: f64,
    /// Share of the start's uncertainty that is left.
    unknown: f64,
    /// Variance of what a contact may have left in each joint (Nm squared), and the most that it can be.
    kept: Vec<f64>,
    largest_kept: Vec<f64>,
}

impl SlowErrors {
    /// Errors of a noise are followed by a low-pass of a time constant (s).
    pub fn new(noise: SlowNoise, time_constant: f64) -> Self {
        let spread = noise.model.iter().zip(&noise.bias);
        let kept = |of_forces: bool| {
            let alike = spread.clone().zip(&noise.is_force).filter(|(_, is_force)| **is_force == of_forces);
            LARGEST_KEPT.powi(2) * alike.map(|((model, bias), _)| model + bias).sum::<f64>()
        };
        let largest_kept = [kept(false), kept(true)];
        SlowErrors {
            followed: noise.model_time.iter().map(|time| time / (time + time_constant)).collect(),
            limit: spread.map(|(model, bias)| LARGEST_BIAS * (model + bias).sqrt()).collect(),
            bias: vec![0.0; noise.model.len()],
            age: 0.0,
            lost: 0.0,
            unknown: 1.0,
            kept: vec![0.0; noise.model.len()],
            largest_kept: noise
                .is_force
                .iter()
                .map(|is_force| largest_kept[usize::from(*is_force)])
                .collect(),
            time_constant,
            noise,
        }
    }

    /// A step of `dt` (s) without contact, with a torque `(nv,)`: a mean at first, then a low-pass.
    #[inline]
    pub fn follow(&mut self, torque: &[f64], dt: f64) {
        self.age += dt;
        let time_constant = self.age.clamp(FIRST_TIME, self.time_constant);
        let share = (dt / time_constant).min(1.0);
        for ((bias, torque), limit) in self.bias.iter_mut().zip(torque).zip(&self.limit) {
            *bias = (*bias + share * (torque - *bias)).clamp(-limit, *limit);
        }
        let left = (1.0 - share).powi(2);
        self.unknown *= left;
        self.lost *= left;
        self.kept.iter_mut().for_each(|kept| *kept *= left);
    }

    /// A step of `dt` (s) that tells nothing of the errors, with a torque `(nv,)` of which joints may keep a share.
    #[inline]
    pub fn lose(&mut self, torque: &[f64], dt: f64) {
        self.lost += dt;
        let forgotten = (dt / BIAS_TIME).min(1.0);
        self.unknown = 1.0 - (1.0 - self.unknown) * (1.0 - forgotten).powi(2);
        for (k, kept) in self.kept.iter_mut().enumerate() {
            let load = self.noise.relative[k] * (torque[k] - self.bias[k]);
            *kept = kept.max((load * load).min(self.largest_kept[k]));
            self.bias[k] *= 1.0 - forgotten;
        }
    }

    /// The variance of what is not known of joint `j`'s errors behind an observer that follows them by a share.
    #[inline]
    pub fn variance(&self, j: usize, share: f64) -> f64 {
        let followed = self.followed[j];
        let kept = if self.lost > 0.0 { (-self.lost / self.noise.model_time[j]).exp() } else { 1.0 };
        // Of an error m that its low-pass b follows: var(m) = 1, var(b) = cov(m, b) = followed, and the covariance
        // falls off with the time since.
        share * self.noise.model[j] * (1.0 + followed * (1.0 - 2.0 * kept))
            + self.unknown * self.noise.bias[j]
            + self.kept[j]
    }

    /// Takes a torque that a contact left behind for the bias.
    pub fn set(&mut self, bias: &[f64]) {
        self.bias.copy_from_slice(bias);
        self.lost = 0.0;
    }

    /// Whether a torque may be the bias after a contact that may have left so much in each joint (Nm).
    pub fn allows(&self, torque: &[f64], left: impl Fn(usize) -> f64) -> bool {
        let limits = self.limit.iter().enumerate().map(|(k, limit)| limit + left(k));
        torque.iter().zip(limits).all(|(torque, limit)| torque.abs() <= limit)
    }

    /// The bias `(nv,)`.
    pub fn bias(&self) -> &[f64] {
        &self.bias
    }

    /// Forgets the bias.
    pub fn reset(&mut self) {
        self.bias.fill(0.0);
        self.kept.fill(0.0);
        (self.age, self.lost, self.unknown) = (0.0, 0.0, 1.0);
    }
}
