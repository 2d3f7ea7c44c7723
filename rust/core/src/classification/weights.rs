//! The weights of features, found by `python -m contactsense_studies.contact_classes.fit` on scenes of two arms (iiwa14, xArm7).

use super::features::FEATURES;

/// A row for each logit: clamped, transient, sustained, intended; the last weight is the constant.
pub(super) type Weights = [[f64; FEATURES + 1]; 4];

/// Shares of kinds, and of intended contacts, in the scenes that the weights were found on.
pub(super) const SHARES: [f64; 3] = [0.335, 0.443, 0.222];
pub(super) const INTENDED: f64 = 0.26;

/// Until a contact is so old (s), the weights are those of young contacts.
pub(super) const YOUNG: f64 = 0.15;

/// Of contacts that are younger.
pub(super) const OF_YOUNG: Weights = [
    [0.24, -0.07, 0.59, 1.21, 0.36, 0.49, 0.68, -0.26, -0.65, -1.02],
    [0.42, -0.26, -1.66, -0.16, -0.24, -0.02, -0.51, 0.04, 0.23, 1.69],
    [-0.65, 0.32, 1.07, -1.05, -0.12, -0.47, -0.17, 0.22, 0.42, -0.67],
    [-0.75, 0.48, 0.72, -2.46, 0.64, -1.43, 0.18, 0.71, 1.5, 0.06],
];
/// Of contacts that last.
pub(super) const OF_LASTING: Weights = [
    [0.17, 0.69, 0.81, 1.45, 0.39, 0.51, 1.63, -0.21, -0.81, -1.19],
    [0.09, -1.19, -1.59, -0.23, -0.32, -0.03, -0.27, 0.0, 0.23, 0.81],
    [-0.26, 0.5, 0.77, -1.22, -0.07, -0.48, -1.36, 0.21, 0.58, 0.38],
    [-0.54, -0.03, 1.27, -2.47, 0.3, -0.91, -1.09, 1.03, 1.47, -0.09],
];
/// Of contacts that have ended.
pub(super) const OF_ENDED: Weights = [
    [-0.45, 1.03, 0.19, 0.81, -0.37, 0.33, 1.28, -0.07, -0.27, -2.6],
    [0.92, -2.11, -0.86, -0.36, -0.15, 0.31, -0.16, 0.15, 0.12, 3.07],
    [-0.47, 1.07, 0.66, -0.45, 0.52, -0.64, -1.12, -0.08, 0.15, -0.47],
    [0.03, 1.18, 0.7, -1.64, 2.84, -0.98, -1.97, 1.39, 1.11, 0.03],
];
