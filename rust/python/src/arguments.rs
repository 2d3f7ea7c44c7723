//! Arguments that are no arrays: wrong ones are refused by name.

use std::sync::{Mutex, MutexGuard, TryLockError};

use pyo3::prelude::*;

use crate::errors::{input, is_fault, refused};

/// Characters of a wrong value that a message shows at most.
const SHOWN: usize = 80;

/// A number, not yet checked: `.0` is NaN for what is none.
#[derive(Clone, Copy)]
pub struct Number<'a, 'py>(pub f64, Borrowed<'a, 'py, PyAny>);

impl<'a, 'py> FromPyObject<'a, 'py> for Number<'a, 'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        Ok(Number(number_if_any(&object)?.unwrap_or(f64::NAN), object))
    }
}

impl Number<'_, '_> {
    /// The number; an `InputError` that names the argument where it is none.
    pub fn named(self, name: &str) -> PyResult<f64> {
        if self.0.is_nan() {
            return number(name, &self.1);
        }
        Ok(self.0)
    }
}

/// A real number.
pub fn number(name: &str, object: &Bound<'_, PyAny>) -> PyResult<f64> {
    object.extract::<f64>().map_err(|error| wrong(name, "a number", object, error))
}

/// A real number, `None` where the argument is something else.
pub fn number_if_any(object: &Bound<'_, PyAny>) -> PyResult<Option<f64>> {
    match object.extract::<f64>() {
        Ok(number) => Ok(Some(number)),
        Err(error) if is_fault(object.py(), &error) => Ok(None),
        Err(error) => Err(error),
    }
}

/// A whole number from 0 to `most`.
pub fn whole(name: &str, object: &Bound<'_, PyAny>, most: u64) -> PyResult<u64> {
    let wanted = || format!("a whole number from 0 to {most}");
    match object.extract::<u64>() {
        Ok(number) if number <= most => Ok(number),
        Ok(_) => Err(input(object.py(), format!("{name}: expected {}, got {}", wanted(), shown(object)))),
        Err(error) => Err(wrong(name, &wanted(), object, error)),
    }
}

/// A string.
pub fn text<'a>(name: &str, object: &'a Bound<'_, PyAny>) -> PyResult<&'a str> {
    object.extract::<&str>().map_err(|error| wrong(name, "a string", object, error))
}

/// True or False.
pub fn flag(name: &str, object: &Bound<'_, PyAny>) -> PyResult<bool> {
    object.extract::<bool>().map_err(|error| wrong(name, "True or False", object, error))
}

/// The argument `pushing`.
pub fn pushing(object: &Bound<'_, PyAny>) -> PyResult<bool> {
    flag("pushing", object)
}

/// The argument `gain`.
pub fn gain(object: &Bound<'_, PyAny>) -> PyResult<f64> {
    number("gain", object)
}

/// The argument `dt`.
pub fn time_step(object: &Bound<'_, PyAny>) -> PyResult<f64> {
    number("dt", object)
}

/// An argument of the wrong type.
pub fn wrong(name: &str, wanted: &str, object: &Bound<'_, PyAny>, cause: PyErr) -> PyErr {
    refused(object.py(), cause, || format!("{name}: expected {wanted}, got {}", shown(object)))
}

/// A value as a message shows it.
pub fn shown(object: &Bound<'_, PyAny>) -> String {
    let text = object.repr().map_or_else(|_| object.get_type().to_string(), |text| text.to_string());
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}...", &text[..end]),
        None => text,
    }
}

/// Sole use of an object's state during a call. Uncontended it takes nanoseconds, and it never waits.
pub fn sole<'a, T>(py: Python<'_>, class: &str, state: &'a Mutex<T>) -> PyResult<MutexGuard<'a, T>> {
    state.try_lock().map_err(|error| match error {
        TryLockError::WouldBlock => input(
            py,
            format!(
                "{class}: this object is in use by another thread; give each thread its own, or take turns"
            ),
        ),
        TryLockError::Poisoned(_) => input(
            py,
            format!("{class}: an internal error interrupted an earlier call of this object; make a new one"),
        ),
    })
}
