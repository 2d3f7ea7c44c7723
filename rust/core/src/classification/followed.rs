//! One contact over time.

use super::features::Features;

/// About the onset, work counts for [`Features::onset_work`] (s).
pub(super) const ONSET: f64 = 0.05;
/// Time constants: of the force whose difference to the force is its rate, and of the present force (s).
const RATE: f64 = 0.005;
const PRESENT: f64 = 0.01;
/// Below this share of the greatest force, a power is divided by that share: torque errors have power too.
const LEAST_SHARE: f64 = 0.05;
/// Way over which work counts as much as the noise of power does (m).
const NOISE_WAY: f64 = 0.003;
/// So little is no force (N).
const NO_FORCE: f64 = 1e-9;

/// Force (N) and power (W) of an instant, and the time since the last (s).
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Instant {
    pub force: f64,
    pub power: f64,
    pub step: f64,
}

/// What is kept of a contact.
#[derive(Debug, Clone, Default)]
pub(super) struct Followed {
    /// Which of all contacts it is; stays where `id` changes.
    pub number: u64,
    pub id: Option<u64>,
    /// Among the contacts of this tick's report.
    pub place: Option<usize>,
    pub since: f64,
    pub last: f64,
    /// Velocities before the onset (rad/s, m/s).
    pub before: Vec<f64>,
    slow: f64,
    present: f64,
    rate: f64,
    impulse: f64,
    advance: f64,
    after_peak: f64,
    onset_work: f64,
    onset_sum: f64,
    work: f64,
    peak: f64,
    approach: f64,
}

impl Followed {
    /// Room for the velocities of a robot.
    pub fn with_room(nv: usize) -> Self {
        Followed { before: vec![0.0; nv], ..Self::default() }
    }

    /// A contact that begins at `time`; `before` are the velocities a little earlier.
    pub fn begin(&mut self, number: u64, id: Option<u64>, time: f64, before: &[f64]) {
        let mut room = std::mem::take(&mut self.before);
        room.copy_from_slice(before);
        *self = Followed { number, id, since: time, last: time, before: room, ..Self::default() };
    }

    /// What the torque was before it was noticed, oldest first.
    pub fn recall(&mut self, instant: Instant) {
        self.rise(instant);
        self.work(instant);
    }

    /// An instant of it, at its place in the report if it has one; `torque` is its own (Nm, N).
    pub fn take_in(&mut self, instant: Instant, torque: &[f64], time: f64, place: Option<usize>) {
        let Instant { force, power, step } = instant;
        (self.last, self.place) = (time, place);
        self.rise(instant);
        self.present += (1.0 - (-step / PRESENT).exp()) * (force - self.present);
        self.impulse += force * step;
        if force > self.peak {
            (self.peak, self.after_peak) = (force, 0.0);
            let against: f64 = torque.iter().zip(&self.before).map(|(torque, v)| -torque * v).sum();
            self.approach = against / force.max(NO_FORCE);
        }
        let speed = -power / force.max(LEAST_SHARE * self.peak).max(NO_FORCE);
        self.advance += speed * step;
        self.after_peak += speed * step;
        if time - self.since <= ONSET {
            self.work(instant);
        } else {
            self.work += power * step;
        }
    }

    fn rise(&mut self, Instant { force, step, .. }: Instant) {
        // A low-pass of a ramp lags by its time constant.
        self.slow += (1.0 - (-step / RATE).exp()) * (force - self.slow);
        self.rate = self.rate.max((force - self.slow) / RATE);
    }

    fn work(&mut self, Instant { power, step, .. }: Instant) {
        self.onset_work += power * step;
        self.onset_sum += power.abs() * step;
        self.work += power * step;
    }

    /// All that is known of it.
    pub fn features(&self) -> Features {
        let peak = self.peak.max(NO_FORCE);
        Features {
            rise_time: peak / self.rate.max(NO_FORCE),
            width: self.impulse / peak,
            remaining: (self.present / peak).clamp(0.0, 1.0),
            approach_speed: self.approach,
            onset_work: self.onset_work / (self.onset_sum + NOISE_WAY * peak),
            advance: self.advance,
            retreat: -self.after_peak,
            net_work: self.work / peak,
            peak: self.peak,
        }
    }
}
