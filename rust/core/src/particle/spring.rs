//! Whether the force of a contact follows the motion, as that of an obstacle that stays does.
//!
//! What pulls at a link, weighs on it or turns it may look like a push somewhere at every single pose, but its force does
//! not rise where that place moves towards the obstacle and fall where it moves away. So a line is fitted to the forces
//! over how deep the obstacle is in the link (linear regression): its slope is the contact's stiffness.

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
        let count = poses as f64;
        let depth = contacts.distance[..poses].iter().map(|distance| -distance);
        let force = &contacts.force[..poses];
        let mean_depth = depth.clone().sum::<f64>() / count;
        let mean_force = force.iter().sum::<f64>() / count;
        let (mut spread, mut both, mut scatter) = (0.0, 0.0, 0.0);
        for (depth, force) in depth.clone().zip(force) {
            spread += (depth - mean_depth).powi(2);
            both += (depth - mean_depth) * (force - mean_force);
        }
        let value = both / spread;
        for (depth, force) in depth.zip(force) {
            scatter += (force - mean_force - value * (depth - mean_depth)).powi(2);
        }
        // Errors of the stated size may be slow, so that the scatter does not show them.
        let noise = contacts.variance[..poses].iter().sum::<f64>() / count;
        let error = ((scatter / (count - FITTED as f64) + noise) / spread).sqrt();
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
        assert_eq!(Slope::of(&contacts, POSES), None);
    }
}
