//! Systematic resampling (Kitagawa 1996): a comb over the cumulated weights.

/// Weights from their logarithms, summing to one; returns the effective sample size.
///
/// All alike where no particle has a weight.
pub(super) fn normalise(log_weights: &mut [f64], weights: &mut [f64]) -> f64 {
    let greatest = log_weights.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut sum = 0.0;
    for (weight, log) in weights.iter_mut().zip(log_weights.iter()) {
        *weight = (log - greatest).exp();
        sum += *weight;
    }
    if !(sum.is_finite() && sum > 0.0) {
        let count = weights.len() as f64;
        weights.fill(1.0 / count);
        log_weights.fill(0.0);
        return count;
    }
    let mut squares = 0.0;
    for (weight, log) in weights.iter_mut().zip(log_weights.iter_mut()) {
        *weight /= sum;
        *log -= greatest;
        squares += *weight * *weight;
    }
    1.0 / squares
}

/// Effective sample size of every `stride`-th particle under `log_weight`, as a share.
pub(super) fn effective_share(count: usize, stride: usize, log_weight: impl Fn(usize) -> f64) -> f64 {
    let greatest = (0..count).step_by(stride).map(&log_weight).fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut squares, mut taken) = (0.0, 0.0, 0.0);
    for k in (0..count).step_by(stride) {
        let weight = (log_weight(k) - greatest).exp();
        sum += weight;
        squares += weight * weight;
        taken += 1.0;
    }
    if squares > 0.0 {
        sum * sum / squares / taken
    } else {
        1.0
    }
}

/// Draws `parents.len()` indices in proportion to `weights` (which sum to one), ascending; `offset` is in [0, 1).
pub(super) fn systematic(weights: &[f64], offset: f64, parents: &mut [u32]) {
    let step = 1.0 / parents.len() as f64;
    let last = weights.len().saturating_sub(1);
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
    fn weights_are_normalised_whatever_their_size() {
        let mut logs = [-1e6, -1e6 + 2f64.ln(), f64::NEG_INFINITY];
        let mut weights = [0.0; 3];
        let effective = normalise(&mut logs, &mut weights);
        assert!((weights[1] - 2.0 / 3.0).abs() < 1e-9 && weights[2] == 0.0);
        assert!((effective - 9.0 / 5.0).abs() < 1e-9);
        let mut none = [f64::NEG_INFINITY; 3];
        assert_eq!(normalise(&mut none, &mut weights), 3.0);
        assert_eq!(weights, [1.0 / 3.0; 3]);
    }
}
