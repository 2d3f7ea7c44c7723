//! The places of one contact, one after another.

use nalgebra::Vector3;

use crate::isolation::{Contact, PathPoint, MOST_POINTS};

/// Nearer places are one (m), and those of closed forms also within so many of their standard deviations.
const FAR: f64 = 0.01;
const SURELY: f64 = 3.0;

/// Where a contact has been, oldest first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Path {
    points: [PathPoint; MOST_POINTS],
    count: usize,
}

impl Path {
    /// A contact that is nowhere yet.
    pub fn new(contact: &Contact) -> Self {
        let none = PathPoint { time: 0.0, link: contact.link, point_local: Vector3::zeros() };
        Path { points: [none; MOST_POINTS], count: 0 }
    }

    pub fn points(&self) -> &[PathPoint] {
        &self.points[..self.count]
    }

    /// Takes in the place of a tick (s). A posterior's that is not another, as `is_elsewhere` says, is a better estimate of the
    /// last.
    pub fn follow(&mut self, contact: &Contact, is_elsewhere: bool, time: f64) {
        let Some(place) = contact.place else { return };
        let new = PathPoint { time, link: contact.link, point_local: place.point_local };
        let last = self.points().last().copied();
        let is_beyond = |distance: f64| {
            let far = |last: PathPoint| (last.point_local - new.point_local).norm() > distance;
            last.is_none_or(|last| last.link != new.link || far(last))
        };
        match (last, &contact.posterior) {
            (Some(last), Some(_)) if !(is_elsewhere && is_beyond(FAR)) => {
                self.points[self.count - 1] = PathPoint { time: last.time, ..new };
            }
            (_, Some(_)) => self.add(new),
            (_, None) if contact.located && is_beyond(FAR.max(SURELY * place.std)) => self.add(new),
            (_, None) => {}
        }
    }

    /// Where there is no room, every second point is left out.
    fn add(&mut self, new: PathPoint) {
        if self.count == MOST_POINTS {
            self.count /= 2;
            for k in 1..self.count {
                self.points[k] = self.points[2 * k];
            }
        }
        self.points[self.count] = new;
        self.count += 1;
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Matrix3;

    use super::*;
    use crate::isolation::{ContactPlace, ContactPosterior};
    use crate::robot::LinkIndex;

    fn at(x: f64) -> Contact {
        let point = Vector3::new(x, 0.0, 0.0);
        let place = ContactPlace { point, point_local: point, normal: Vector3::z(), std: 0.002 };
        Contact { place: Some(place), located: true, ..Contact::unlocated(LinkIndex::new(3)) }
    }

    fn places(path: &Path) -> Vec<f64> {
        path.points().iter().map(|point| point.point_local.x).collect()
    }

    #[test]
    fn only_another_place_is_a_new_point() {
        let mut path = Path::new(&at(0.0));
        for (tick, x) in [0.1, 0.102, 0.103, 0.12, 0.125].into_iter().enumerate() {
            path.follow(&at(x), false, tick as f64);
        }
        // One that is not located, or nowhere, is no other.
        path.follow(&Contact { located: false, ..at(0.4) }, false, 6.0);
        path.follow(&Contact::unlocated(LinkIndex::new(2)), false, 7.0);
        assert_eq!(places(&path), [0.1, 0.12]);
        assert_eq!(path.points()[1].time, 3.0);
    }

    #[test]
    fn a_posterior_says_itself_whether_the_place_is_another() {
        let mut path = Path::new(&at(0.0));
        let posterior = ContactPosterior {
            probability: 1.0,
            covariance: Matrix3::zeros(),
            region_radius: 0.01,
            modes: 0..0,
            link_probabilities: 0..0,
        };
        let told = |x: f64| Contact { posterior: Some(posterior.clone()), ..at(x) };
        for (tick, x) in [0.1, 0.14, 0.16].into_iter().enumerate() {
            path.follow(&told(x), false, tick as f64);
        }
        assert_eq!((places(&path), path.points()[0].time), (vec![0.16], 0.0));
        path.follow(&told(0.2), true, 4.0);
        path.follow(&told(0.203), true, 5.0);
        assert_eq!((places(&path), path.points()[1].time), (vec![0.16, 0.203], 4.0));
    }

    #[test]
    fn a_long_path_keeps_its_ends_and_is_thinned() {
        let mut path = Path::new(&at(0.0));
        for step in 0..1000 {
            path.follow(&at(0.1 * f64::from(step)), false, f64::from(step));
            assert!(path.points().len() <= MOST_POINTS);
            assert_eq!(path.points().last().map(|last| last.time), Some(f64::from(step)));
        }
        let times: Vec<f64> = path.points().iter().map(|point| point.time).collect();
        assert_eq!(times[0], 0.0);
        assert!(times.len() > MOST_POINTS / 2 && times.is_sorted());
    }
}
