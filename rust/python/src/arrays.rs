//! Array arguments, copied into memory of our own: code that runs while a later argument is read can neither change
//! them nor take their memory away.

use contactsense::robot::LARGEST;
use numpy::ndarray::Dimension;
use numpy::{PyArray, PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::errors::{input, refused};
use crate::returned::reserve;

/// Numbers in the vectors of the largest robots; 8 kB always find room.
const SHORT: usize = 1024;

/// A vector argument.
pub struct Vector(Vec<f64>);

impl Vector {
    pub fn new(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(array) = object.cast::<PyArray1<f64>>() {
            if let Some(copied) = copy(array)? {
                return Ok(Self(copied));
            }
        }
        let converted = convert(name, object)?;
        let copied = match converted.cast::<PyArray1<f64>>() {
            Ok(array) => copy(array)?,
            Err(_) => None,
        };
        let wrong = || input(object.py(), format!("{name}: expected an array with one dimension"));
        copied.map(Self).ok_or_else(wrong)
    }

    /// `None` where the argument is Python's `None`.
    pub fn optional(name: &str, object: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Self>> {
        object.map(|object| Self::new(name, object)).transpose()
    }

    pub fn slice(&self) -> &[f64] {
        &self.0
    }

    pub fn into_vec(self) -> Vec<f64> {
        self.0
    }

    /// Exactly `N` numbers.
    pub fn fixed<const N: usize>(&self, py: Python<'_>, name: &str) -> PyResult<[f64; N]> {
        let slice = self.slice();
        <[f64; N]>::try_from(slice)
            .map_err(|_| input(py, format!("{name}: expected {N} numbers, got {}", slice.len())))
    }
}

/// Sensor readings `(n, 6)`; NaN, for no reading, is let through.
pub struct Readings(Vec<f64>);

impl Readings {
    pub fn new(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let wrong = || input(object.py(), "wrenches: expected an array of shape (n_sensors, 6)".into());
        let mut copied = None;
        if let Ok(array) = object.cast::<PyArray2<f64>>() {
            copied = copy_rows(array, 6)?;
        }
        if copied.is_none() {
            let converted = convert("wrenches", object)?;
            copied = copy_rows(converted.cast().map_err(|_| wrong())?, 6)?;
        }
        copied.map(Self).ok_or_else(wrong)
    }

    pub fn rows(&self) -> &[[f64; 6]] {
        self.0.as_chunks().0
    }
}

/// The numbers of an array; `None` where they are strided, or unaligned as a field of a packed record is.
fn copy<D: Dimension>(array: &Bound<'_, PyArray<f64, D>>) -> PyResult<Option<Vec<f64>>> {
    if !array.is_c_contiguous() {
        return Ok(None);
    }
    if array.len() <= SHORT {
        // No look at NumPy's table of borrows, which takes longer than the copy.
        return Ok(array.to_vec().ok());
    }
    let Ok(view) = array.try_readonly() else { return Ok(None) };
    let Ok(slice) = view.as_slice() else { return Ok(None) };
    let mut copied = vec![];
    reserve(&mut copied, slice.len())?;
    copied.extend_from_slice(slice);
    Ok(Some(copied))
}

fn copy_rows(array: &Bound<'_, PyArray2<f64>>, columns: usize) -> PyResult<Option<Vec<f64>>> {
    if array.shape()[1] == columns {
        copy(array)
    } else {
        Ok(None)
    }
}

/// Rows of `N` numbers of a size that can be computed with; a single row may be given flat.
pub fn rows<const N: usize>(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; N]>> {
    let py = object.py();
    let wrong = || input(py, format!("{name}: expected an array of shape (n, {N})"));
    let converted = convert(name, object)?;
    let mut rows: Vec<[f64; N]> = vec![];
    if let Ok(array) = converted.cast::<PyArray2<f64>>() {
        let view = array.try_readonly().map_err(|_| wrong())?;
        if view.shape()[1] != N {
            return Err(wrong());
        }
        let slice = view.as_slice().map_err(|_| wrong())?;
        reserve(&mut rows, slice.len() / N)?;
        rows.extend_from_slice(slice.as_chunks().0);
    } else if let Ok(array) = converted.cast::<PyArray1<f64>>() {
        let view = array.try_readonly().map_err(|_| wrong())?;
        let slice = view.as_slice().map_err(|_| wrong())?;
        rows.push(<[f64; N]>::try_from(slice).map_err(|_| wrong())?);
    } else {
        return Err(wrong());
    }
    match rows.iter().position(|row| !row.iter().all(|x| x.abs() < LARGEST)) {
        Some(row) => Err(input(py, format!("{name}: row {row} must be finite and below {LARGEST:e}"))),
        None => Ok(rows),
    }
}

/// Any real array-like as a fresh or given contiguous float64 array.
fn convert<'py>(name: &str, object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = object.py();
    let text = || format!("{name}: expected an array of real numbers");
    if object.is_none() || object.is_instance_of::<PyString>() {
        return Err(input(py, text()));
    }
    let numpy = py.import("numpy")?;
    let array = numpy.call_method1("asarray", (object,)).map_err(|error| refused(py, error, text))?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "f" | "i" | "u" | "b") {
        return Err(input(py, text()));
    }
    numpy.call_method1("require", (array, "float64", ["C", "A"])).map_err(|error| refused(py, error, text))
}
