//! The motion of the last minute with its mean external torque: what a payload that the model lacks is seen in.

/// Torques are averaged over this time (s): long against noise of velocities, short against the motion of an arm.
pub(super) const BLOCK: f64 = 0.1;
/// So many means are kept: a minute.
const MOST: usize = 600;

/// Means of the last minute, in memory of a fixed size.
#[derive(Debug, Clone)]
pub(super) struct RecentMotion {
    nq: usize,
    nv: usize,
    /// Rows of configuration, velocity, acceleration and mean external torque; the oldest is replaced.
    rows: Vec<f64>,
    count: usize,
    next: usize,
    /// Of the block that is not complete: its length so far (s), the integral of the torque (Nm s), and the row in the making.
    time: f64,
    halfway: bool,
    integral: Vec<f64>,
    first_velocity: Vec<f64>,
    middle: Vec<f64>,
}

/// A mean.
#[derive(Debug, Clone, Copy)]
pub(super) struct Block<'a> {
    pub q: &'a [f64],
    pub v: &'a [f64],
    pub a: &'a [f64],
    /// External torque, bias included (Nm, N).
    pub torque: &'a [f64],
}

impl RecentMotion {
    pub fn new(nq: usize, nv: usize) -> Self {
        RecentMotion {
            nq,
            nv,
            rows: vec![0.0; MOST * (nq + 3 * nv)],
            count: 0,
            next: 0,
            time: 0.0,
            halfway: false,
            integral: vec![0.0; nv],
            first_velocity: vec![0.0; nv],
            middle: vec![0.0; nq + nv],
        }
    }

    /// A step of `length` (s) to a configuration and velocity, with its mean external torque; none where that is not known.
    #[inline]
    pub fn advance(&mut self, q: &[f64], v: &[f64], torque: Option<&[f64]>, length: f64) {
        let Some(torque) = torque else { return self.begin(v) };
        self.time += length;
        self.integral.iter_mut().zip(torque).for_each(|(sum, torque)| *sum += length * torque);
        if !self.halfway && self.time >= 0.5 * BLOCK {
            let (middle_q, middle_v) = self.middle.split_at_mut(self.nq);
            middle_q.copy_from_slice(q);
            middle_v.copy_from_slice(v);
            self.halfway = true;
        }
        if self.time >= BLOCK {
            self.finish(v);
        }
    }

    fn finish(&mut self, v: &[f64]) {
        let inverse = 1.0 / self.time;
        let width = self.nq + 3 * self.nv;
        let row = &mut self.rows[self.next * width..][..width];
        let (middle, rest) = row.split_at_mut(self.nq + self.nv);
        let (acceleration, torque) = rest.split_at_mut(self.nv);
        middle.copy_from_slice(&self.middle);
        for ((a, now), before) in acceleration.iter_mut().zip(v).zip(&self.first_velocity) {
            *a = (now - before) * inverse;
        }
        torque.iter_mut().zip(&self.integral).for_each(|(mean, sum)| *mean = sum * inverse);
        self.next = (self.next + 1) % MOST;
        self.count = (self.count + 1).min(MOST);
        self.begin(v);
    }

    /// Begins a block anew.
    fn begin(&mut self, v: &[f64]) {
        (self.time, self.halfway) = (0.0, false);
        self.integral.fill(0.0);
        self.first_velocity.copy_from_slice(v);
    }

    /// All blocks, the oldest first.
    pub fn blocks(&self) -> impl Iterator<Item = Block<'_>> {
        let (nq, nv) = (self.nq, self.nv);
        let width = nq + 3 * nv;
        (0..self.count).map(move |age| {
            let index = (self.next + MOST - self.count + age) % MOST;
            let row = &self.rows[index * width..][..width];
            let (q, rest) = row.split_at(nq);
            let (v, rest) = rest.split_at(nv);
            let (a, torque) = rest.split_at(nv);
            Block { q, v, a, torque }
        })
    }

    /// Forgets all steps.
    pub fn reset(&mut self) {
        (self.count, self.next, self.time, self.halfway) = (0, 0, 0.0, false);
        self.integral.fill(0.0);
        self.first_velocity.fill(0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_minute_is_kept() {
        let mut recent = RecentMotion::new(1, 1);
        let dt = 1e-3;
        recent.advance(&[0.0], &[0.0], None, dt);
        for tick in 1..=70_000 {
            let time = f64::from(tick) * dt;
            recent.advance(&[0.5 * time * time], &[time], Some(&[3.0 * time]), dt);
        }
        let blocks: Vec<_> = recent.blocks().collect();
        assert_eq!(blocks.len(), MOST);
        for (age, block) in blocks.iter().rev().enumerate() {
            let middle = 70.0 - BLOCK * (age as f64 + 0.5);
            assert!((block.v[0] - middle).abs() < 2.0 * dt && (block.a[0] - 1.0).abs() < 1e-6, "{block:?}");
            assert!((block.torque[0] - 3.0 * middle).abs() < 5.0 * dt, "{block:?}");
        }
        recent.reset();
        assert_eq!(recent.blocks().count(), 0);
    }

    #[test]
    fn nothing_is_averaged_over_a_gap() {
        let mut recent = RecentMotion::new(1, 1);
        (0..99).for_each(|_| recent.advance(&[0.0], &[0.0], Some(&[1e3]), 1e-3));
        recent.advance(&[0.0], &[0.0], None, 1.0);
        (0..150).for_each(|_| recent.advance(&[0.0], &[0.0], Some(&[1.0]), 1e-3));
        let torques: Vec<f64> = recent.blocks().map(|block| block.torque[0]).collect();
        assert!(torques.len() == 1 && (torques[0] - 1.0).abs() < 1e-9, "{torques:?}");
    }
}
