//! Array arguments, read into memory of our own, and arrays that are returned.

use contactsense::robot::LARGEST;
use nalgebra::DMatrix;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::types::PyString;

pub use crate::arguments::{whole, Number};
use crate::errors::{input, refused};

/// Numbers that a vector argument holds without an allocation: an arm's. More would cost every call their initialisation.
const INLINE: usize = 16;
/// The same for rows of readings.
const INLINE_ROWS: usize = 4;

/// A copy of an argument. Nothing that a later argument runs when it is read can change it or take its memory away.
struct Copied<T, const N: usize> {
    short: [T; N],
    long: Vec<T>,
    length: usize,
}

impl<T: Copy, const N: usize> Copied<T, N> {
    fn new(zero: T, slice: &[T]) -> PyResult<Self> {
        let mut copied = Self { short: [zero; N], long: vec![], length: slice.len() };
        match copied.short.get_mut(..slice.len()) {
            Some(short) => short.copy_from_slice(slice),
            None => {
                reserve(&mut copied.long, slice.len())?;
                copied.long.extend_from_slice(slice);
            }
        }
        Ok(copied)
    }

    fn slice(&self) -> &[T] {
        self.short.get(..self.length).unwrap_or(&self.long)
    }
}

/// A vector argument.
pub struct Vector(Copied<f64, INLINE>);

impl Vector {
    pub fn new(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(array) = object.cast::<PyArray1<f64>>() {
            // Neither strided nor unaligned, as a field of a packed record is.
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
        self.0.slice()
    }

    /// Exactly `N` numbers.
    pub fn fixed<const N: usize>(&self, py: Python<'_>, name: &str) -> PyResult<[f64; N]> {
        let slice = self.slice();
        <[f64; N]>::try_from(slice)
            .map_err(|_| input(py, format!("{name}: expected {N} numbers, got {}", slice.len())))
    }
}

/// The numbers of an array that can be read in place; `None` of another.
fn copy(array: &Bound<'_, PyArray1<f64>>) -> PyResult<Option<Copied<f64, INLINE>>> {
    match array.try_readonly() {
        Ok(view) => view.as_slice().ok().map(|slice| Copied::new(0.0, slice)).transpose(),
        Err(_) => Ok(None),
    }
}

/// Whether an array can be read in place.
fn is_readable(array: &Bound<'_, PyArray2<f64>>) -> bool {
    array.try_readonly().is_ok_and(|view| view.as_slice().is_ok())
}

/// Sensor readings `(n, 6)`; NaN, for no reading, is let through.
pub struct Readings(Copied<[f64; 6], INLINE_ROWS>);

impl Readings {
    pub fn new(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let wrong = || input(object.py(), "wrenches: expected an array of shape (n_sensors, 6)".into());
        let array = match object.cast::<PyArray2<f64>>() {
            Ok(array) if array.is_c_contiguous() && is_readable(array) => array.clone(),
            _ => convert("wrenches", object)?.cast_into().map_err(|_| wrong())?,
        };
        let view = array.try_readonly().map_err(|_| wrong())?;
        if view.shape()[1] != 6 {
            return Err(wrong());
        }
        match view.as_slice() {
            Ok(slice) => Ok(Self(Copied::new([0.0; 6], slice.as_chunks().0)?)),
            Err(_) => Err(wrong()),
        }
    }

    pub fn rows(&self) -> &[[f64; 6]] {
        self.0.slice()
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

/// Room for `more` entries, or a `MemoryError`.
pub fn reserve<T>(vector: &mut Vec<T>, more: usize) -> PyResult<()> {
    let bytes = more.saturating_mul(size_of::<T>());
    let full = |_| PyMemoryError::new_err(format!("there is no memory for {bytes} more bytes"));
    // As `Vec::reserve` grows, so that repeated calls take linear time; exact where that is too much.
    vector.try_reserve(more).or_else(|_| vector.try_reserve_exact(more)).map_err(full)
}

/// A fresh `(rows, columns)` array.
pub fn matrix<'py>(py: Python<'py>, matrix: &DMatrix<f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let row_major: Vec<f64> = matrix.transpose().as_slice().to_vec();
    PyArray1::from_vec(py, row_major).reshape([matrix.nrows(), matrix.ncols()])
}

/// A fresh `(n, N)` array.
pub fn from_rows<const N: usize>(
    py: Python<'_>,
    rows: impl ExactSizeIterator<Item = [f64; N]>,
) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let count = rows.len();
    // Flattened iterators do not know their length.
    let mut flat = vec![];
    reserve(&mut flat, count * N)?;
    rows.for_each(|row| flat.extend_from_slice(&row));
    PyArray1::from_vec(py, flat).reshape([count, N])
}

/// A fresh `(4, 4)` array of a pose.
pub fn pose<'py>(py: Python<'py>, pose: &contactsense::spatial::Pose) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (r, t) = (&pose.rotation, &pose.translation);
    let row = |i: usize| [r[(i, 0)], r[(i, 1)], r[(i, 2)], t[i]];
    from_rows(py, [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]].into_iter())
}
