//! Whether the force of a contact follows the motion, as that of an obstacle that stays does.
//!
//! What pulls at a link, weighs on it or turns it may look like a push somewhere at every single pose, but its force does
//! not rise where that place moves towards the obstacle and fall where it moves away. So a line is fitted to the forces
//! over how deep the obstacle is in the link (weighted linear regression): its slope is the contact's stiffness.

use super::contacts::Contacts;

/// A line has so many parameters.
const FITTED: usize = 2;

/// Stiffness of a contact and its standard error [N/m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slope {
    pub value: f64,
    pub error: f64,
}

impl Slope {
    /// Of the contacts at so many poses; none where they are too few or one and the same.
    pub fn of(contacts: &Contacts, poses: usize) -> Option<Slope> {
        if poses <= FITTED {
            return None;
        }
        let numbers = contacts.distance.iter().zip(&contacts.force).zip(&contacts.variance).take(poses);
        // Each pose counts by how exact its force is [1/N^2].
        let weighted =
            || numbers.clone().map(|((distance, force), variance)| (variance.recip(), -distance, force));
        let (mut weight, mut depth, mut force) = (0.0, 0.0, 0.0);
        for (w, d, f) in weighted() {
            weight += w;
            depth += w * d;
            force += w * f;
        }
        let mean = (depth / weight, force / weight);
        let (mut spread, mut both, mut scatter) = (0.0, 0.0, 0.0);
        for (w, d, f) in weighted() {
            spread += w * (d - mean.0).powi(2);
            both += w * (d - mean.0) * (f - mean.1);
        }
        let value = both / spread;
        for (w, d, f) in weighted() {
            scatter += w * (f - mean.1 - value * (d - mean.0)).powi(2);
        }
        // Errors of the stated size, one in these units, may be slow, so that the scatter does not show them.
        let error = ((scatter / (poses - FITTED) as f64 + 1.0) / spread).sqrt();
        (value.is_finite() && error.is_finite()).then_some(Slope { value, error })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::particle::window::POSES;

    #[test]
    fn the_slope_is_that_of_force_over_depth() {
        let mut contacts = Contacts::default();
        for k in 0..9 {
            let depth = 1e-3 * f64::from(k).sin();
            contacts.distance[k as usize] = 0.05 - depth;
            contacts.force[k as usize] = 5.0 + 2000.0 * depth;
            contacts.variance[k as usize] = 0.01;
        }
        let slope = Slope::of(&contacts, 9).expect("nine poses");
        assert!((slope.value - 2000.0).abs() < 1e-6, "{slope:?}");
        // The standard deviation of the depths is 0.7 mm: the stated noise alone gives an error.
        assert!((slope.error - 0.1 / (3.0 * 0.7e-3)).abs() < 10.0, "{slope:?}");
        assert_eq!(Slope::of(&contacts, 2), None);
    }

    #[test]
    fn what_does_not_move_shows_no_slope() {
        let mut contacts = Contacts::default();
        for (k, force) in contacts.force.iter_mut().enumerate() {
            *force = k as f64;
        }
        contacts.variance.fill(1.0);
        assert_eq!(Slope::of(&contacts, POSES), None);
    }
}
