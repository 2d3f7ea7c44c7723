//! Weights of hypotheses by how well they explain the torque at hand.
//!
//! A filter takes a measurement in little by little, and draws some particles anew from all of the surface: right after an update
//! its weights are wider than what the torque says.

/// Torques may err by so many times what is stated, as in the filter: only what contradicts them clearly loses its weight, and a
/// mode that the filter holds possible stays.
const GRANTED: f64 = 3.0;
/// So many hypotheses stay effective.
const LEAST_EFFECTIVE: f64 = 64.0;
/// Where they do not, the torque is held to err by twice the variance, so often.
const WIDENINGS: usize = 60;

/// Multiplies weights by the likelihood of their misfits, squared norms of what is left over in standard deviations of `joints`
/// torques, and makes them sum to one; false where there is no weight.
pub(super) fn sharpen(weights: &mut [f64], misfits: &[f64], joints: usize) -> bool {
    let held = weights.iter().zip(misfits).filter(|(weight, _)| **weight > 0.0);
    let least = held.clone().map(|(_, misfit)| *misfit).fold(f64::INFINITY, f64::min);
    let total: f64 = weights.iter().sum();
    if !(total > 0.0 && total.is_finite() && least.is_finite()) {
        return false;
    }
    let wanted = LEAST_EFFECTIVE.min(0.5 * effective(weights.iter().copied()));
    // One degree of freedom is the force's.
    let mut variance = (least / joints.saturating_sub(1).max(1) as f64).max(GRANTED * GRANTED);
    let weight =
        |weight: f64, misfit: f64, variance: f64| weight * (-0.5 * (misfit - least) / variance).exp();
    for _ in 0..WIDENINGS {
        let sharpened = weights.iter().zip(misfits).map(|(w, misfit)| weight(*w, *misfit, variance));
        if effective(sharpened) >= wanted {
            break;
        }
        variance *= 2.0;
    }
    for (w, misfit) in weights.iter_mut().zip(misfits) {
        *w = weight(*w, *misfit, variance);
    }
    let total: f64 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= total);
    true
}

/// Effective number of weighted samples.
fn effective(weights: impl Iterator<Item = f64>) -> f64 {
    let (sum, squares) = weights.fold((0.0, 0.0), |(sum, squares), w| (sum + w, squares + w * w));
    if squares > 0.0 {
        sum * sum / squares
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_explains_the_torque_gets_the_weight() {
        let mut weights = vec![1.0; 1000];
        let misfits: Vec<f64> = (0..1000).map(|k| if k < 100 { 3.0 } else { 300.0 }).collect();
        assert!(sharpen(&mut weights, &misfits, 7));
        let good: f64 = weights[..100].iter().sum();
        assert!(good > 0.999 && (weights.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_single_best_one_does_not_take_all() {
        let mut weights = vec![1.0; 1000];
        let misfits: Vec<f64> = (0..1000).map(|k| f64::from(k) * 100.0).collect();
        assert!(sharpen(&mut weights, &misfits, 7));
        assert!(effective(weights.iter().copied()) >= 64.0);
    }

    #[test]
    fn without_weight_there_is_nothing() {
        assert!(!sharpen(&mut [0.0, 0.0], &[1.0, 2.0], 7));
        assert!(!sharpen(&mut [], &[], 7));
    }
}
