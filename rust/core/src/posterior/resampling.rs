//! Systematic resampling (Kitagawa 1996): a comb over the cumulated weights.

use super::evidence::Weighed;
use super::parallel::Course;

/// Weights from their logarithms, summing to one.
///
/// A logarithm that is no number is a weight of zero. All alike where no particle has a weight.
pub(crate) fn normalise(log_weights: &mut [f64], weights: &mut [f64], course: Course<'_>) -> Weighed {
    log_weights.iter_mut().for_each(|log| *log = weightless(*log));
    let greatest = log_weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let weigh = |_: usize, (logs, weights): (&mut [f64], &mut [f64])| {
        for (log, weight) in logs.iter_mut().zip(weights) {
            *log -= greatest;
            *weight = log.exp();
        }
    };
    course.to_the_end().for_each((&mut *log_weights, &mut *weights), 0, &weigh);
    let sum: f64 = weights.iter().sum();
    if !(sum.is_finite() && sum > 0.0) {
        let count = weights.len() as f64;
        weights.fill(1.0 / count);
        log_weights.fill(0.0);
        return Weighed { effective: count, log_sum: f64::NEG_INFINITY, log_rest: count.ln() };
    }
    let mut squares = 0.0;
    for weight in weights.iter_mut() {
        *weight /= sum;
        squares += *weight * *weight;
    }
    Weighed { effective: 1.0 / squares, log_sum: greatest + sum.ln(), log_rest: sum.ln() }
}

/// A log-weight that is not a number, or infinite, is that of a weight of zero.
#[inline]
fn weightless(log: f64) -> f64 {
    if log < f64::INFINITY {
        log
    } else {
        f64::NEG_INFINITY
    }
}

/// Effective sample size of samples with these logarithms of weights, as a share.
pub(crate) fn effective_share(log_weights: impl ExactSizeIterator<Item = f64> + Clone) -> f64 {
    let logs = || log_weights.clone().map(weightless);
    let greatest = logs().fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut squares) = (0.0, 0.0);
    for log in logs() {
        let weight = (log - greatest).exp();
        sum += weight;
        squares += weight * weight;
    }
    if squares > 0.0 {
        sum * sum / squares / log_weights.len() as f64
    } else {
        1.0
    }
}

/// Draws `parents.len()` indices in proportion to `weights` (which sum to one), ascending; `offset` is in [0, 1). None has a
/// weight of zero, unless all have.
pub(crate) fn systematic(weights: &[f64], offset: f64, parents: &mut [u32]) {
    let step = 1.0 / parents.len() as f64;
    // Rounded weights may sum to less than the last tooth of the comb.
    let last = weights.iter().rposition(|weight| *weight > 0.0).unwrap_or(0);
    let (mut index, mut sum) = (0, weights.first().copied().unwrap_or(1.0));
    for (k, parent) in parents.iter_mut().enumerate() {
        let at = (k as f64 + offset) * step;
        while sum <= at && index < last {
            index += 1;
            sum += weights[index];
        }
        *parent = index as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn copies_are_as_many_as_weights_say() {
        let weights = [0.05, 0.0, 0.25, 0.3, 0.4];
        for offset in [0.0, 0.3, 0.999_999] {
            let mut parents = [0; 1000];
            systematic(&weights, offset, &mut parents);
            for (index, weight) in weights.iter().enumerate() {
                let copies = parents.iter().filter(|p| **p as usize == index).count() as f64;
                assert!((copies - 1000.0 * weight).abs() <= 1.0, "{index}: {copies}");
            }
            assert!(parents.is_sorted());
        }
    }

    #[test]
    fn no_copy_is_made_of_a_particle_without_weight() {
        // They sum to less than one by rounding, and more.
        let weights = [0.0, 0.3, 0.0, 0.699_999, 0.0, 0.0];
        let mut parents = [0; 1000];
        systematic(&weights, 0.999_999, &mut parents);
        assert!(parents.iter().all(|parent| weights[*parent as usize] > 0.0));
    }

    #[test]
    fn a_log_weight_that_is_no_number_is_a_weight_of_zero() {
        let mut weights = [0.0; 4];
        let mut logs = [f64::NAN, 0.0, f64::INFINITY, 3f64.ln()];
        let effective = normalise(&mut logs, &mut weights, Course::alone()).effective;
        assert!((weights[3] - 0.75).abs() < 1e-12 && weights[0] == 0.0 && weights[2] == 0.0, "{weights:?}");
        assert!((effective - 1.6).abs() < 1e-12);
        let share = effective_share([f64::NAN, 0.0, f64::INFINITY, 3f64.ln()].into_iter());
        assert!((share - 0.4).abs() < 1e-12);
    }

    #[test]
    fn weights_are_normalised_whatever_their_size() {
        let mut logs = [-1e6, -1e6 + 2f64.ln(), f64::NEG_INFINITY];
        let mut weights = [0.0; 3];
        let effective = normalise(&mut logs, &mut weights, Course::alone()).effective;
        assert!((weights[1] - 2.0 / 3.0).abs() < 1e-9 && weights[2] == 0.0);
        assert!((effective - 9.0 / 5.0).abs() < 1e-9);
        let mut none = [f64::NEG_INFINITY; 3];
        assert_eq!(normalise(&mut none, &mut weights, Course::alone()).effective, 3.0);
        assert_eq!(weights, [1.0 / 3.0; 3]);
    }
}
