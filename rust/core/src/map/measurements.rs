//! The measurements of one contact that stays where it is on its link.

use super::measurement::Measurement;
use crate::robot::{Kinematics, Robot};
use crate::torque::{ForcePrior, PlaceBlock, PushLikelihood, SensorMount, LANES};

/// More than this are not kept.
const MOST: usize = 4;

/// Logarithms of likelihoods of a block of pieces: of contacts that push, and of those that pull.
pub(super) type Logs = [[f64; LANES]; 2];

/// Measurements of one contact.
#[derive(Debug, Clone)]
pub(super) struct Measurements {
    /// Newest last.
    all: Vec<Measurement>,
    count: usize,
    keeps_newest: bool,
}

impl Measurements {
    pub fn new(robot: &Robot, wanted: &[usize], sensors: &[SensorMount]) -> Self {
        let all = vec![Measurement::new(robot, wanted.to_vec(), sensors); MOST];
        Measurements { all, count: 0, keeps_newest: true }
    }

    pub fn forget(&mut self) {
        self.count = 0;
    }

    /// Only the newest counts from now on.
    pub fn forget_older(&mut self) {
        if self.count > 1 {
            self.all.swap(0, self.count - 1);
            (self.count, self.keeps_newest) = (1, true);
        }
    }

    /// Takes in one more, in place of the last if that is not kept, and of the oldest where there are as many as are kept.
    pub fn take_in(
        &mut self,
        robot: &Robot,
        kinematics: &Kinematics,
        torque: &[f64],
        deviation: &[f64],
        keep: bool,
    ) {
        if self.count > 0 && !self.keeps_newest {
            self.count -= 1;
        }
        self.keeps_newest = keep;
        if self.count == MOST {
            self.all.rotate_left(1);
            self.count -= 1;
        }
        self.all[self.count].set(robot, kinematics, torque, deviation);
        self.count += 1;
    }

    pub fn all(&self) -> &[Measurement] {
        &self.all[..self.count]
    }

    pub fn older(&self) -> &[Measurement] {
        &self.all[..self.count.saturating_sub(1)]
    }

    pub fn newest(&self) -> &Measurement {
        &self.all[self.count.saturating_sub(1)]
    }

    /// Weighs torques and moments with another standard deviation beside the stated one (Nm), as these links feel them.
    pub fn blur(&mut self, more: f64, links: &[usize]) {
        self.all[..self.count].iter_mut().for_each(|measurement| measurement.blur(more, links));
    }

    /// Mean log-likelihood without contact, at the present weights.
    pub fn without_contact(&self) -> f64 {
        self.all().iter().map(Measurement::without_contact).sum::<f64>() / self.count.max(1) as f64
    }

    /// What all say of contacts on a block of pieces: the mean of the logarithms, since they are correlated and together count
    /// as one (algorithm D4); the forces of the newest.
    #[inline]
    pub fn likelihood(&self, prior: &ForcePrior, link: usize, block: &PlaceBlock) -> PushLikelihood {
        let mut found = self.newest().likelihood(prior, link, block);
        if self.count > 1 {
            self.mix(&mut found.log, &self.older_likelihood(prior, link, block));
        }
        found
    }

    /// What the older ones say, which together count as one too.
    #[inline]
    pub fn older_likelihood(&self, prior: &ForcePrior, link: usize, block: &PlaceBlock) -> Logs {
        let (mut mean, older) = (Logs::default(), self.older());
        let share = 1.0 / older.len().max(1) as f64;
        for measurement in older {
            let found = measurement.likelihood(prior, link, block).log;
            let pairs = mean.iter_mut().flatten().zip(found.iter().flatten());
            pairs.for_each(|(mean, log)| *mean += share * log);
        }
        mean
    }

    /// Makes what the newest says what all say.
    #[inline]
    pub fn mix(&self, newest: &mut Logs, older: &Logs) {
        for (log, mean) in newest.iter_mut().flatten().zip(older.iter().flatten()) {
            *log = self.together(*log, *mean);
        }
    }

    /// What all say, of what the newest and the older ones say.
    #[inline]
    pub fn together(&self, newest: f64, older: f64) -> f64 {
        if self.count < 2 {
            return newest;
        }
        let share = 1.0 / self.count as f64;
        share * newest + (1.0 - share) * older
    }
}
