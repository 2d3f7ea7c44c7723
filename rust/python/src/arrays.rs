//! Array arguments: float64 and C-contiguous ones are read in place, other array-likes are converted.

use contactsense::robot::LARGEST;
use nalgebra::DMatrix;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::errors::input;

/// A vector argument that can be read as a slice.
pub struct Vector<'py>(PyReadonlyArray1<'py, f64>);

impl<'py> Vector<'py> {
    pub fn new(name: &str, object: &Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(array) = object.cast::<PyArray1<f64>>() {
            let view = array.readonly();
            // Neither strided nor unaligned, as a field of a packed record is.
            if view.as_slice().is_ok() {
                return Ok(Self(view));
            }
        }
        let converted = convert(name, object)?;
        match converted.cast_into::<PyArray1<f64>>() {
            Ok(array) => Ok(Self(array.readonly())),
            Err(_) => Err(input(object.py(), format!("{name}: expected an array with one dimension"))),
        }
    }

    /// `None` where the argument is Python's `None`.
    pub fn optional(name: &str, object: Option<&Bound<'py, PyAny>>) -> PyResult<Option<Self>> {
        object.map(|object| Self::new(name, object)).transpose()
    }

    pub fn slice(&self) -> &[f64] {
        // Contiguous by construction.
        self.0.as_slice().unwrap_or(&[])
    }

    /// Exactly `N` numbers.
    pub fn fixed<const N: usize>(&self, py: Python<'_>, name: &str) -> PyResult<[f64; N]> {
        let slice = self.slice();
        <[f64; N]>::try_from(slice)
            .map_err(|_| input(py, format!("{name}: expected {N} numbers, got {}", slice.len())))
    }
}

/// Sensor readings `(n, 6)`; NaN, for no reading, is let through.
pub struct Readings<'py>(PyReadonlyArray2<'py, f64>);

impl<'py> Readings<'py> {
    pub fn new(object: &Bound<'py, PyAny>) -> PyResult<Self> {
        let wrong = || input(object.py(), "wrenches: expected an array of shape (n_sensors, 6)".into());
        let array = match object.cast::<PyArray2<f64>>() {
            Ok(array) if array.readonly().as_slice().is_ok() => array.clone(),
            _ => convert("wrenches", object)?.cast_into().map_err(|_| wrong())?,
        };
        let view = array.readonly();
        if view.shape()[1] == 6 {
            Ok(Self(view))
        } else {
            Err(wrong())
        }
    }

    pub fn rows(&self) -> &[[f64; 6]] {
        // Contiguous by construction.
        self.0.as_slice().unwrap_or(&[]).as_chunks().0
    }
}

/// A real number; NaN, which the core refuses by name, for anything else.
#[derive(Clone, Copy)]
pub struct Number(pub f64);

impl<'a, 'py> FromPyObject<'a, 'py> for Number {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        Ok(Number(object.extract::<f64>().unwrap_or(f64::NAN)))
    }
}

/// A whole number from 0 to `most`.
pub fn whole(name: &str, object: &Bound<'_, PyAny>, most: u64) -> PyResult<u64> {
    match object.extract::<u64>() {
        Ok(number) if number <= most => Ok(number),
        _ => {
            Err(input(object.py(), format!("{name}: expected a whole number from 0 to {most}, got {object}")))
        }
    }
}

/// Rows of `N` numbers of a size that can be computed with; a single row may be given flat.
pub fn rows<const N: usize>(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; N]>> {
    let py = object.py();
    let wrong = || input(py, format!("{name}: expected an array of shape (n, {N})"));
    let converted = convert(name, object)?;
    let rows: Vec<[f64; N]> = if let Ok(array) = converted.cast::<PyArray2<f64>>() {
        let view: PyReadonlyArray2<'_, f64> = array.readonly();
        if view.shape()[1] != N {
            return Err(wrong());
        }
        let slice = view.as_slice().map_err(|_| wrong())?;
        slice.chunks_exact(N).map(|row| std::array::from_fn(|i| row[i])).collect()
    } else if let Ok(array) = converted.cast::<PyArray1<f64>>() {
        let view = array.readonly();
        let slice = view.as_slice().map_err(|_| wrong())?;
        vec![<[f64; N]>::try_from(slice).map_err(|_| wrong())?]
    } else {
        return Err(wrong());
    };
    match rows.iter().position(|row| !row.iter().all(|x| x.abs() < LARGEST)) {
        Some(row) => Err(input(py, format!("{name}: row {row} must be finite and below {LARGEST:e}"))),
        None => Ok(rows),
    }
}

/// Any real array-like as a fresh or given contiguous float64 array.
fn convert<'py>(name: &str, object: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = object.py();
    let refused = |_| input(py, format!("{name}: expected an array of real numbers"));
    if object.is_none() || object.is_instance_of::<PyString>() {
        return Err(input(py, format!("{name}: expected an array of real numbers")));
    }
    let numpy = py.import("numpy")?;
    let array = numpy.call_method1("asarray", (object,)).map_err(refused)?;
    let kind: String = array.getattr("dtype")?.getattr("kind")?.extract()?;
    if !matches!(kind.as_str(), "f" | "i" | "u" | "b") {
        return Err(input(py, format!("{name}: expected an array of real numbers")));
    }
    numpy.call_method1("require", (array, "float64", ["C", "A"])).map_err(refused)
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
    let mut flat = Vec::with_capacity(count * N);
    rows.for_each(|row| flat.extend_from_slice(&row));
    PyArray1::from_vec(py, flat).reshape([count, N])
}

/// A fresh `(4, 4)` array of a pose.
pub fn pose<'py>(py: Python<'py>, pose: &contactsense::spatial::Pose) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let (r, t) = (&pose.rotation, &pose.translation);
    let row = |i: usize| [r[(i, 0)], r[(i, 1)], r[(i, 2)], t[i]];
    from_rows(py, [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]].into_iter())
}
