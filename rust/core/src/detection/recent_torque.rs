//! The torque just before a contact: what slow errors were at its onset, whatever they are from one start to the next.

/// The torque is averaged over blocks of this length (s), of which so many are kept.
const BLOCK: f64 = 0.05;
const BLOCKS: usize = 10;
/// The newest blocks may hold the beginning of a contact, before it is seen.
const NEWEST: usize = 2;
/// So few blocks are too few for a mean.
const FEWEST: usize = 3;
/// Time after a contact in which the slowest observer still forgets it (s).
const SETTLING: f64 = 0.4;

/// Keeps means of the torque of a robot that nothing touches.
#[derive(Debug, Clone)]
pub(crate) struct RecentTorque {
    /// By block, oldest first, each `(nv,)` (Nm, N).
    blocks: Vec<Vec<f64>>,
    filled: usize,
    sum: Vec<f64>,
    /// Of the block that is not complete, and since the last contact (s).
    time: f64,
    free: f64,
    before: Vec<f64>,
    /// Whether there is a mean from before the contact that goes on, and how long ago that is (s).
    known: bool,
    touched: bool,
    age: f64,
}

impl RecentTorque {
    pub fn new(nv: usize) -> Self {
        RecentTorque {
            blocks: vec![vec![0.0; nv]; BLOCKS],
            filled: 0,
            sum: vec![0.0; nv],
            time: 0.0,
            free: 0.0,
            before: vec![0.0; nv],
            known: false,
            touched: false,
            age: 0.0,
        }
    }

    /// A step of `dt` (s) with a torque `(nv,)`; `touched`: something may touch the robot.
    #[inline]
    pub fn advance(&mut self, torque: &[f64], dt: f64, touched: bool) {
        if touched {
            if !self.touched {
                self.look_back();
            }
            (self.touched, self.age) = (true, self.age + dt);
            return;
        }
        if self.touched {
            self.reset();
        }
        self.free += dt;
        if self.free < SETTLING {
            return;
        }
        self.time += dt;
        self.sum.iter_mut().zip(torque).for_each(|(sum, torque)| *sum += dt * torque);
        if self.time >= BLOCK {
            if self.filled == BLOCKS {
                self.blocks.rotate_left(1);
                self.filled -= 1;
            }
            for (mean, sum) in self.blocks[self.filled].iter_mut().zip(&mut self.sum) {
                *mean = *sum / self.time;
                *sum = 0.0;
            }
            self.filled += 1;
            self.time = 0.0;
        }
    }

    fn look_back(&mut self) {
        let used = self.filled.saturating_sub(NEWEST);
        self.known = used >= FEWEST;
        if !self.known {
            return;
        }
        self.before.fill(0.0);
        for block in &self.blocks[..used] {
            self.before.iter_mut().zip(block).for_each(|(mean, torque)| *mean += torque / used as f64);
        }
        self.age = BLOCK * (NEWEST as f64 + 0.5 * used as f64);
    }

    /// The mean torque before the contact that goes on, and how long ago that was (s).
    pub fn before(&self) -> Option<(&[f64], f64)> {
        self.known.then_some((&self.before[..], self.age))
    }

    /// Forgets all steps.
    pub fn reset(&mut self) {
        self.sum.fill(0.0);
        (self.filled, self.time, self.free, self.age) = (0, 0.0, 0.0, 0.0);
        (self.known, self.touched) = (false, false);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-3;

    #[test]
    fn the_beginning_of_a_contact_is_not_in_it() {
        let mut recent = RecentTorque::new(1);
        (0..3000).for_each(|_| recent.advance(&[0.5], DT, false));
        (0..80).for_each(|_| recent.advance(&[1.5], DT, false));
        recent.advance(&[3.0], DT, true);
        let (torque, age) = recent.before().expect("long enough");
        assert!((torque[0] - 0.5).abs() < 1e-12 && (0.1..0.6).contains(&age), "{torque:?} {age}");
    }

    #[test]
    fn right_after_a_contact_or_a_start_nothing_is_known() {
        let mut recent = RecentTorque::new(1);
        (0..400).for_each(|_| recent.advance(&[0.5], DT, false));
        recent.advance(&[3.0], DT, true);
        assert!(recent.before().is_none());
        (0..500).for_each(|_| recent.advance(&[0.5], DT, false));
        recent.advance(&[3.0], DT, true);
        assert!(recent.before().is_none());
        (0..800).for_each(|_| recent.advance(&[0.7], DT, false));
        recent.advance(&[3.0], DT, true);
        assert!((recent.before().expect("long enough").0[0] - 0.7).abs() < 1e-12);
    }
}
