//! Options of a memory.

use crate::error::{Error, Result};

/// Voxels are no smaller (m): positions of robots are not known better.
const LEAST_RESOLUTION: f64 = 1e-3;
/// Voxels are no larger (m).
const MOST_RESOLUTION: f64 = 1.0;

/// Options of a [`ContactMemory`](super::ContactMemory).
///
/// ```
/// use contactsense::occupancy::MemoryOptions;
///
/// assert_eq!(MemoryOptions::default().resolution, 0.02);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MemoryOptions {
    /// Edge of a voxel (m).
    pub resolution: f64,
    /// Probability that a voxel is occupied of which nothing is known.
    pub prior: f64,
    /// Probability that a voxel is occupied although the centre of it was inside the robot's body: errors of the robot's model.
    pub free_error: f64,
    /// Probability that a contact is none of the places that are given.
    pub contact_error: f64,
    /// How many voxels are kept at most.
    pub max_voxels: usize,
}

impl Default for MemoryOptions {
    fn default() -> Self {
        MemoryOptions {
            resolution: 0.02,
            prior: 0.5,
            free_error: 0.01,
            contact_error: 0.05,
            max_voxels: 2_000_000,
        }
    }
}

impl MemoryOptions {
    pub(super) fn check(&self) -> Result<()> {
        if !(LEAST_RESOLUTION..=MOST_RESOLUTION).contains(&self.resolution) {
            let text =
                format!("must be from {LEAST_RESOLUTION} to {MOST_RESOLUTION} m, got {}", self.resolution);
            return Err(Error::input("resolution", text));
        }
        for (name, value) in
            [("prior", self.prior), ("free_error", self.free_error), ("contact_error", self.contact_error)]
        {
            if !(value > 0.0 && value < 1.0) {
                return Err(Error::input(name, format!("must be between 0 and 1, got {value}")));
            }
        }
        if self.max_voxels == 0 {
            return Err(Error::input("max_voxels", "must be at least 1, got 0"));
        }
        Ok(())
    }
}
