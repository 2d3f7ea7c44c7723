//! What is assumed before anything is measured.

use super::weights::{INTENDED, SHARES};
use crate::error::{Error, Result};

/// Shares of a prior are kept from 0 and 1 by this.
const LEAST_SHARE: f64 = 1e-3;

/// What is assumed of contacts before anything is measured of them.
///
/// ```
/// use contactsense::classification::ClassifierOptions;
///
/// let options = ClassifierOptions::default();
/// assert!((options.clamped + options.transient + options.sustained - 1.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClassifierOptions {
    /// Time between two calls (s).
    pub dt: f64,
    /// Shares of contacts that are clamped, transient and sustained.
    pub clamped: f64,
    /// See `clamped`.
    pub transient: f64,
    /// See `clamped`.
    pub sustained: f64,
    /// Share of contacts that are intended.
    pub intended: f64,
}

impl Default for ClassifierOptions {
    fn default() -> Self {
        let [clamped, transient, sustained] = SHARES;
        Self { dt: 1e-3, clamped, transient, sustained, intended: INTENDED }
    }
}

/// What another prior than that of the weights adds to the logits.
pub(super) fn prior(options: &ClassifierOptions) -> Result<[f64; 4]> {
    let shares = [options.clamped, options.transient, options.sustained];
    let is_share = |share: &f64| (0.0..=1.0).contains(share);
    if !shares.iter().all(is_share) || (shares.iter().sum::<f64>() - 1.0).abs() > 1e-6 {
        return Err(Error::input(
            "prior",
            format!(
                "must be shares of clamped, transient and sustained contacts that sum to 1, got {shares:?}"
            ),
        ));
    }
    if !is_share(&options.intended) {
        return Err(Error::input(
            "intended_prior",
            format!("must be a share from 0 to 1, got {}", options.intended),
        ));
    }
    let inside = |share: f64| share.clamp(LEAST_SHARE, 1.0 - LEAST_SHARE);
    let odds = |share: f64| (inside(share) / (1.0 - inside(share))).ln();
    let of = |kind: usize| (inside(shares[kind]) / SHARES[kind]).ln();
    Ok([of(0), of(1), of(2), odds(options.intended) - odds(INTENDED)])
}
