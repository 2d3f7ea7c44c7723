//! Hysteresis of gears: what a torque sensor behind one reads lags the torque, by a share of its change since it turned round.

/// Widths of the elements as multiples of the first: the share falls off step by step as the change grows.
const ELEMENTS: [f64; 3] = [1.0, 3.0, 9.0];

/// The first width as a share of the standard deviation of a joint's torque: among these a log chooses.
pub(crate) const WIDTHS: [f64; 6] = [0.02, 0.04, 0.08, 0.16, 0.32, 0.64];

/// The one among them that is tried first.
pub(crate) const USUAL_WIDTH: usize = 3;

/// A sum of stop elements (Prandtl and Ishlinskii): each follows the change of the torque up to its width, either way. A gear
/// with hysteresis passes on the torque less a share of this sum. The torque that drives them is the measured one: it turns
/// round where the true one does, and is known at run time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stops {
    width: f64,
    states: [f64; ELEMENTS.len()],
    /// The torque of before; none at the start.
    last: Option<f64>,
}

impl Stops {
    /// Of a first width (Nm; N).
    pub fn new(width: f64) -> Self {
        Stops { width, states: [0.0; ELEMENTS.len()], last: None }
    }

    /// Forgets the torque.
    pub fn reset(&mut self) {
        *self = Stops::new(self.width);
    }

    /// The sum of the elements when the torque is now this (Nm; N).
    #[inline]
    pub fn advance(&mut self, torque: f64) -> f64 {
        let change = torque - self.last.unwrap_or(torque);
        self.last = Some(torque);
        let mut sum = 0.0;
        for (state, element) in self.states.iter_mut().zip(ELEMENTS) {
            let width = element * self.width;
            // No clamp: it would panic where a width is no number.
            *state = (*state + change).min(width).max(-width);
            sum += *state;
        }
        sum
    }

    /// The sum of the elements after the last torque.
    pub fn sum(&self) -> f64 {
        self.states.iter().sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_torque_that_rises_and_falls_back_leaves_a_rest() {
        let mut stops = Stops::new(1.0);
        assert_eq!(stops.advance(5.0), 0.0);
        // All elements follow, then fewer.
        assert!((stops.advance(5.5) - 1.5).abs() < 1e-12);
        assert!((stops.advance(7.0) - (1.0 + 2.0 + 2.0)).abs() < 1e-12);
        assert!((stops.advance(105.0) - 13.0).abs() < 1e-12);
        assert!((stops.advance(103.5) - (-0.5 + 1.5 + 7.5)).abs() < 1e-12);
        assert_eq!(stops.sum(), 8.5);
        stops.reset();
        assert_eq!(stops.advance(-3.0), 0.0);
    }
}
