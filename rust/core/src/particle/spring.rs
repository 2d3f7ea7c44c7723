//! Whether the force of a contact follows the link's motion, as that of an obstacle that stays does.
//!
//! What pulls at a link, weighs on it or turns it may look like a push somewhere at every single update, but its force
//! does not rise where that place moves towards the obstacle and fall where it moves away. So a line is fitted to the
//! found forces over how far the place has moved outwards (weighted linear regression): its slope is the obstacle's
//! stiffness. How the normal force changes depends to first order on no curvature, neither the link's nor the
//! obstacle's.

use nalgebra::Vector3;

use crate::spatial::Pose;

/// Updates over which the line is fitted, each with a motion to a new pose: three or four motions of three samples.
const WINDOW: f64 = 10.0;
/// A line has so many parameters.
const FITTED: f64 = 2.0;

/// A contact on a link: where the link is, and the point and its outward normal in the link's frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub link: usize,
    pub pose: Pose,
    pub point: Vector3<f64>,
    pub normal: Vector3<f64>,
}

impl Place {
    /// How far the link's surface moves outwards from here to another place of the same link [m]: the mean of what it
    /// does at either, which is exact to second order.
    fn outward_to(&self, then: &Place) -> f64 {
        let moved =
            |place: &Place| then.pose.transform_point(&place.point) - self.pose.transform_point(&place.point);
        let before = (self.pose.rotation * self.normal).dot(&moved(self));
        let now = (then.pose.rotation * then.normal).dot(&moved(then));
        0.5 * (before + now)
    }
}

/// A line through found forces over outward motion, older updates counting less.
#[derive(Debug, Clone, Default)]
pub(super) struct Spring {
    /// The contact at the update before.
    last: Option<Place>,
    /// How far the contact has moved outwards against where it began [m].
    outward: f64,
    /// Sum of the updates' weights, and of their squares.
    weight: f64,
    square: f64,
    /// Weighted means of outward motion [m] and of force [N].
    mean: [f64; 2],
    /// Their variances [m^2, N^2] and covariance [N m].
    variance: [f64; 2],
    covariance: f64,
    /// Variance of a force by the stated noise [N^2].
    noise: f64,
}

/// Slope of the line, its standard error [N/m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slope {
    pub value: f64,
    pub error: f64,
}

impl Spring {
    /// The link that is looked at.
    pub fn link(&self) -> Option<usize> {
        self.last.map(|place| place.link)
    }

    /// Forgets all updates: another contact is looked at.
    pub fn restart(&mut self) {
        *self = Self::default();
    }

    /// Takes in a force that was found at a place [N], and its variance by the stated noise; `news` is how much the
    /// motion to there counts, one where it makes a new pose.
    pub fn take_in(&mut self, place: Place, force: f64, noise: f64, news: f64) {
        let mut weight = news;
        match self.last {
            Some(last) if last.link == place.link => self.outward += last.outward_to(&place),
            _ => {
                self.restart();
                weight = 1.0;
            }
        }
        self.last = Some(place);
        if weight <= 0.0 {
            return;
        }
        let kept = 1.0 - weight / WINDOW;
        self.weight = kept * self.weight + weight;
        self.square = kept * kept * self.square + weight * weight;
        let newest = weight / self.weight;
        let apart = [self.outward - self.mean[0], force - self.mean[1]];
        for ((mean, variance), apart) in self.mean.iter_mut().zip(&mut self.variance).zip(&apart) {
            *mean += newest * apart;
            *variance = (1.0 - newest) * (*variance + newest * apart * apart);
        }
        self.covariance = (1.0 - newest) * (self.covariance + newest * apart[0] * apart[1]);
        self.noise += newest * (noise - self.noise);
    }

    /// The slope; none before there are enough updates with motion.
    pub fn slope(&self) -> Option<Slope> {
        let count = self.weight * self.weight / self.square;
        if !(count > FITTED && self.variance[0] > 0.0) {
            return None;
        }
        let value = self.covariance / self.variance[0];
        let scatter = (self.variance[1] - value * self.covariance).max(0.0) * count / (count - FITTED);
        // Errors of the stated size may be slow, so that the scatter does not show them.
        let error = ((scatter + self.noise) / (count * self.variance[0])).sqrt();
        (value.is_finite() && error.is_finite()).then_some(Slope { value, error })
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Rotation3;

    use super::*;

    /// A ball of 5 cm about the link's origin that rolls on a fixed one of 2 cm at the world's; forces of a spring.
    fn follow(stiffness: f64, constant: f64) -> Option<Slope> {
        let mut spring = Spring::default();
        for k in 0..30 {
            let phase = f64::from(k);
            let apart =
                Vector3::new(0.004 * phase.sin(), 0.003 * (1.7 * phase).cos(), 0.069 + 4e-4 * phase.cos());
            let rotation = Rotation3::from_euler_angles(0.02 * phase.cos(), 0.03 * phase.sin(), 0.0);
            let pose = Pose { rotation: *rotation.matrix(), translation: apart };
            let normal = -apart.normalize();
            let local = pose.inverse_transform_vector(&normal);
            let force = constant + stiffness * (0.07 - apart.norm());
            spring.take_in(Place { link: 1, pose, point: local * 0.05, normal: local }, force, 1e-4, 1.0);
        }
        spring.slope()
    }

    #[test]
    fn the_slope_is_the_stiffness_whatever_the_curvature() {
        let slope = follow(2000.0, 5.0).expect("thirty updates");
        assert!((slope.value - 2000.0).abs() < 40.0, "{slope:?}");
        assert!(slope.value > 10.0 * slope.error, "{slope:?}");
        let constant = follow(0.0, 5.0).expect("thirty updates");
        assert!(constant.value.abs() < 1e-6, "{constant:?}");
    }

    #[test]
    fn what_does_not_move_shows_no_slope() {
        let mut spring = Spring::default();
        let place = Place { link: 1, pose: Pose::identity(), point: Vector3::zeros(), normal: Vector3::z() };
        for k in 0..50 {
            spring.take_in(place, f64::from(k), 1.0, 0.0);
        }
        assert_eq!(spring.slope(), None);
    }
}
