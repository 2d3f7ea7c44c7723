//! Which numbers can be computed with.

use crate::error::{Error, Result};

/// Arguments must be smaller: products of a few such numbers stay finite.
pub const LARGEST: f64 = 1e60;

/// Checks that `values` has `length` finite entries of a size that can be computed with.
#[inline]
pub(super) fn check_vector(argument: &'static str, values: &[f64], length: usize) -> Result<()> {
    if values.len() != length {
        return Err(wrong_length(argument, values.len(), length));
    }
    if values.iter().all(|x| x.abs() < LARGEST) {
        Ok(())
    } else {
        Err(not_finite(argument, values))
    }
}

#[cold]
fn wrong_length(argument: &'static str, found: usize, wanted: usize) -> Error {
    Error::input(argument, format!("expected {wanted} numbers, got {found}"))
}

#[cold]
fn not_finite(argument: &'static str, values: &[f64]) -> Error {
    let index = values.iter().position(|x| x.is_nan() || x.abs() >= LARGEST).unwrap_or(0);
    let value = values[index];
    Error::input(argument, format!("entry {index} is {value}; all must be finite and below {LARGEST:e}"))
}
