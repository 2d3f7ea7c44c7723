//! Two bodies that may be touched.

use super::found::Entry;

/// Pairs of bodies that are tried in a call: what its work permits.
pub(super) const TRIED: usize = 96;

/// Two bodies that may be touched, and how well forces on them explain the torques.
#[derive(Debug, Clone, Copy)]
pub(super) struct Hypothesis {
    pub bodies: [usize; 2],
    /// Of all torques of the region, with what displaces a line so that it enters its body, and of forces across normals.
    pub chi_square: f64,
    pub entries: [Option<Entry>; 2],
}
