//! Memory for as many particles as a user asks for: refused where there is not enough, before any of it is filled.

use crate::error::{Error, Result};

/// An empty vector with space for `count` values.
///
/// # Errors
/// [`Error::Memory`] where there is no space.
pub(crate) fn space<T>(count: usize) -> Result<Vec<T>> {
    let mut values = Vec::new();
    match values.try_reserve_exact(count) {
        Ok(()) => Ok(values),
        Err(_) => Err(Error::Memory(format!(
            "particles: there is no memory for so many ({:.1} MB more are needed)",
            count as f64 * std::mem::size_of::<T>() as f64 * 1e-6
        ))),
    }
}

/// `count` times the same value.
///
/// # Errors
/// [`Error::Memory`] where there is no space.
pub(crate) fn filled<T: Clone>(value: T, count: usize) -> Result<Vec<T>> {
    let mut values = space(count)?;
    values.resize(count, value);
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_than_there_is_is_refused() {
        let error = filled(0.0f64, usize::MAX / 64).expect_err("no machine has that");
        assert!(matches!(error, Error::Memory(text) if text.starts_with("particles")));
        assert_eq!(filled(1u8, 3).expect("three bytes"), [1, 1, 1]);
    }
}
