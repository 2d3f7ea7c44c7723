//! The torques that were measured of one contact, at poses that differ.

use crate::particle::{Instant, NEW_POSE};
use crate::spatial::Pose;
use crate::torque::{Frame, Target};

/// One pose with its torques.
#[derive(Debug, Clone)]
pub(super) struct Measurement {
    /// One a link of the robot.
    pub links: Vec<Frame>,
    pub target: Target,
    /// Whether it counted before the newest one came, and counts now.
    pub before: bool,
    pub now: bool,
}

/// A window of measurements.
#[derive(Debug, Clone)]
pub(super) struct Measurements {
    all: Vec<Measurement>,
    /// Places of those that count before or now, in the order of time.
    order: Vec<usize>,
    dropped: Option<usize>,
    /// Where links were at the first touch, one a link.
    pub first: Vec<Pose>,
    most: usize,
}

impl Measurements {
    /// As many poses at most.
    pub fn new(instant: &Instant, most: usize) -> Self {
        let links = instant.frames.links.clone();
        let first = links.iter().map(|frame| frame.pose).collect();
        let one = Measurement { links, target: instant.target.clone(), before: false, now: false };
        // One more than count: for that which no longer does.
        Measurements {
            all: vec![one; most + 1],
            order: Vec::with_capacity(most + 1),
            dropped: None,
            first,
            most,
        }
    }

    /// Forgets all: another contact begins.
    pub fn clear(&mut self) {
        self.order.clear();
        self.dropped = None;
        for measurement in &mut self.all {
            (measurement.before, measurement.now) = (false, false);
        }
    }

    /// Those that count before or now, in the order of time.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Measurement> {
        self.order.iter().map(|place| &self.all[*place])
    }

    /// How many count now.
    pub fn len(&self) -> usize {
        self.iter().filter(|measurement| measurement.now).count()
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
    pub fn take_in(&mut self, instant: &Instant) {
        self.settle();
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
            self.all[dropped].now = false;
        }
        let free = (0..self.all.len()).find(|place| !self.order.contains(place)).unwrap_or(0);
        let measurement = &mut self.all[free];
        for &link in &instant.frames.wanted {
            measurement.links[link].copy(&instant.frames.links[link]);
        }
        measurement.target.copy(&instant.target, &instant.frames.wanted);
        (measurement.before, measurement.now) = (false, true);
        self.order.push(free);
    }

    /// What counts now counts from here on as before.
    fn settle(&mut self) {
        if let Some(dropped) = self.dropped.take() {
            self.order.retain(|place| *place != dropped);
        }
        for measurement in &mut self.all {
            measurement.before = measurement.now;
        }
    }
}
