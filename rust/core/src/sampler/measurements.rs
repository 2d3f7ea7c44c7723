//! The torques that were measured of the contacts, at poses that differ.

use nalgebra::Matrix6;

use super::between::Between;
use crate::particle::{Instant, NEW_POSE};
use crate::spatial::Pose;
use crate::torque::{Frame, Target};

/// A torque of so many standard deviations is clearly above its noise.
const CLEAR: f64 = 3.0;

/// One pose with its torques.
#[derive(Debug, Clone)]
pub(super) struct Measurement {
    /// One a link of the robot.
    pub links: Vec<Frame>,
    /// Where there may be several contacts.
    pub between: Option<Between>,
    pub target: Target,
    /// Torques that are clearly above their noise: the others tell nothing of how much greater it is in proportion to the torque.
    pub rows: f64,
    /// How much it counted before the newest one came, and counts now: from zero to one.
    pub before: f64,
    pub now: f64,
}

impl Measurement {
    /// Inner products of the torques of unit forces and moments on one link, and on another where there may be several contacts.
    #[inline]
    pub fn gram_of(&self, link: usize, other: usize) -> &Matrix6<f64> {
        match &self.between {
            Some(between) if link != other => between.of(link, other),
            _ => self.links[link].gram(),
        }
    }
}

/// A window of measurements.
#[derive(Debug, Clone)]
pub(super) struct Measurements {
    all: Vec<Measurement>,
    /// Places of those that count before or now, in the order of time.
    order: Vec<usize>,
    /// The same, the newest first and then from far apart to near.
    scattered: Vec<usize>,
    dropped: Option<usize>,
    /// Share that is kept of the measurements before the newest one.
    pub kept: f64,
    /// Rows that count before the newest one came, and now.
    pub rows: [f64; 2],
    /// Where links were at the first touch, one a link.
    pub first: Vec<Pose>,
    most: usize,
}

impl Measurements {
    /// As many poses at most, of one contact or several.
    pub fn new(instant: &Instant, most: usize, several: bool) -> Self {
        let links = instant.frames.links.clone();
        let first = links.iter().map(|frame| frame.pose).collect();
        let between = several.then(|| Between::new(links.len(), &instant.frames.wanted));
        let one =
            Measurement { links, between, target: instant.target.clone(), rows: 0.0, before: 0.0, now: 0.0 };
        // One more than count: for that which no longer does.
        Measurements {
            all: vec![one; most + 1],
            order: Vec::with_capacity(most + 1),
            scattered: Vec::with_capacity(most + 1),
            dropped: None,
            kept: 1.0,
            rows: [0.0; 2],
            first,
            most,
        }
    }

    /// Forgets all: another contact begins.
    pub fn clear(&mut self) {
        self.order.clear();
        self.scattered.clear();
        self.dropped = None;
        for measurement in &mut self.all {
            (measurement.before, measurement.now) = (0.0, 0.0);
        }
    }

    /// Those that count before or now, in the order of time.
    pub fn all(&self) -> impl Iterator<Item = &Measurement> {
        self.order.iter().map(|place| &self.all[*place])
    }

    /// Those that count before or now, the newest first and then from far apart to near: a hypothesis that does not fit shows
    /// it early.
    pub fn scattered(&self) -> impl Iterator<Item = &Measurement> {
        self.scattered.iter().map(|place| &self.all[*place])
    }

    /// How many count now.
    pub fn len(&self) -> usize {
        self.scattered().filter(|measurement| measurement.now > 0.0).count()
    }

    /// The newest one; before any, what stands in its place.
    pub fn newest(&self) -> &Measurement {
        &self.all[self.order.last().copied().unwrap_or(0)]
    }

    /// The one that counts no longer, if there is one.
    pub fn dropped(&self) -> Option<&Measurement> {
        self.dropped.map(|place| &self.all[place])
    }

    /// Takes in the present pose: in place of the newest one if that is the same pose, and of the oldest where there are too many.
    /// What is `kept` of those before is a share from zero to one.
    pub fn take_in(&mut self, instant: &Instant, kept: f64) {
        self.settle(kept);
        self.kept = kept;
        if self.order.is_empty() {
            for &link in &instant.frames.wanted {
                self.first[link] = *instant.pose(link);
            }
        }
        let moved = |before: &Measurement| {
            let apart = |link: &usize| instant.apart(*link, instant.pose(*link), &before.links[*link].pose);
            instant.frames.wanted.iter().map(apart).fold(0.0, f64::max) >= NEW_POSE
        };
        // The first stays: where links were then is what hypotheses are stated by.
        let same = self.order.len() > 1 && !moved(self.newest());
        self.dropped = if same {
            self.order.last().copied()
        } else if self.order.len() == self.most {
            self.order.first().copied()
        } else {
            None
        };
        if let Some(dropped) = self.dropped {
            self.all[dropped].now = 0.0;
        }
        let free = (0..self.all.len()).find(|place| !self.order.contains(place)).unwrap_or(0);
        let measurement = &mut self.all[free];
        for &link in &instant.frames.wanted {
            measurement.links[link].copy(&instant.frames.links[link]);
        }
        measurement.target.copy(&instant.target, &instant.frames.wanted);
        if let Some(between) = &mut measurement.between {
            between.set(&measurement.links, &instant.frames.wanted);
        }
        let clear = instant
            .torque
            .iter()
            .zip(&instant.deviation)
            .filter(|(torque, noise)| torque.abs() > CLEAR * **noise);
        measurement.rows = clear.count() as f64;
        (measurement.before, measurement.now) = (0.0, 1.0);
        self.order.push(free);
        self.scatter();
        let sum = |share: fn(&Measurement) -> f64| self.scattered().map(share).sum();
        self.rows = [
            sum(|measurement| measurement.before * measurement.rows),
            sum(|measurement| measurement.now * measurement.rows),
        ];
    }

    fn scatter(&mut self) {
        let count = self.order.len();
        self.scattered.clear();
        self.scattered.extend(self.order.last());
        let mut stride = count.next_power_of_two();
        while stride > 0 {
            // Steps back from the newest.
            let steps = (stride..count).step_by(2 * stride);
            self.scattered.extend(steps.map(|back| self.order[count - 1 - back]));
            stride /= 2;
        }
    }

    /// What counts now counts from here on as before, and of it a share as now.
    fn settle(&mut self, kept: f64) {
        if let Some(dropped) = self.dropped.take() {
            self.order.retain(|place| *place != dropped);
        }
        for measurement in &mut self.all {
            measurement.before = measurement.now;
            measurement.now *= kept;
        }
    }
}
