//! Evidence: how likely measurements are under all samples together (a by-product of weighing them).

/// What a weighing shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Weighed {
    /// Effective sample size.
    pub effective: f64,
    /// Logarithm of the sum of the weights as they were given, and as they are left: divided by the greatest.
    pub log_sum: f64,
    pub log_rest: f64,
}

/// The evidence of one measurement after another.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Evidence {
    /// Logarithm of the sum of the weights so far.
    log_before: f64,
}

impl Evidence {
    /// Of so many samples with a weight of one each.
    pub fn of(count: usize) -> Self {
        Evidence { log_before: (count as f64).ln() }
    }

    /// The logarithm of the likelihood of what was weighed last, given all that was weighed before.
    pub fn take_in(&mut self, weighed: &Weighed) -> f64 {
        let evidence = weighed.log_sum - self.log_before;
        self.log_before = weighed.log_rest;
        evidence
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::posterior::parallel::Course;
    use crate::posterior::resampling::normalise;

    #[test]
    fn it_is_the_normalising_constant_of_a_gaussian() {
        // Samples of a uniform prior on a fine grid, weighed as a standard normal one and by two measurements of noise s.
        let (count, span, s) = (20_000, 24.0, 0.7_f64);
        let at = |k: usize| span * ((k as f64 + 0.5) / count as f64 - 0.5);
        let mut logs: Vec<f64> = (0..count).map(|k| -0.5 * at(k).powi(2)).collect();
        let mut weights = vec![0.0; count];
        let mut evidence = Evidence::of(count);
        evidence.take_in(&normalise(&mut logs, &mut weights, Course::alone()));
        let (mut mean, mut variance) = (0.0, 1.0_f64);
        for measured in [1.3, -0.4] {
            for (k, log) in logs.iter_mut().enumerate() {
                *log -= 0.5 * ((measured - at(k)) / s).powi(2);
            }
            let found = evidence.take_in(&normalise(&mut logs, &mut weights, Course::alone()));
            let spread = variance + s * s;
            let exact = (s / spread.sqrt()).ln() - 0.5 * (measured - mean).powi(2) / spread;
            assert!((found - exact).abs() < 1e-6, "{found} {exact}");
            let gain = variance / spread;
            (mean, variance) = (mean + gain * (measured - mean), variance * (1.0 - gain));
        }
        let found: f64 = weights.iter().enumerate().map(|(k, weight)| weight * at(k)).sum();
        assert!((found - mean).abs() < 1e-6, "{found} {mean}");
    }
}
