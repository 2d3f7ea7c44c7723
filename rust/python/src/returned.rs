//! Arrays that are returned, and memory for them.

use nalgebra::{DMatrix, SVector, Vector6};
use numpy::ndarray::Dimension;
use numpy::{Element, PyArray, PyArray1, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;

/// Room for `more` entries, or a `MemoryError`.
pub fn reserve<T>(vector: &mut Vec<T>, more: usize) -> PyResult<()> {
    let bytes = more.saturating_mul(size_of::<T>());
    let full = |_| PyMemoryError::new_err(format!("there is no memory for {bytes} more bytes"));
    // As `Vec::reserve` grows, so that repeated calls take linear time; exact where that is too much.
    vector.try_reserve(more).or_else(|_| vector.try_reserve_exact(more)).map_err(full)
}

/// The array, which nobody can write to any more; it must be fresh.
pub fn read_only<T: Element, D: Dimension>(array: Bound<'_, PyArray<T, D>>) -> Bound<'_, PyArray<T, D>> {
    // Nobody else holds it, so that it can be borrowed.
    if let Ok(array) = array.try_readwrite() {
        array.make_nonwriteable();
    }
    array
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

/// A fresh `(n,)` array that cannot be written to.
pub fn numbers<'py>(py: Python<'py>, numbers: &[f64]) -> Bound<'py, PyArray1<f64>> {
    read_only(PyArray1::from_slice(py, numbers))
}

/// A fresh `(N,)` array that cannot be written to; NaN where there is no vector.
pub fn vector<const N: usize>(py: Python<'_>, vector: Option<SVector<f64, N>>) -> Bound<'_, PyArray1<f64>> {
    numbers(py, vector.unwrap_or_else(|| SVector::repeat(f64::NAN)).as_slice())
}

/// A fresh `(n, 6)` array of wrenches that cannot be written to; NaN where there is none.
pub fn wrench_rows<'py>(
    py: Python<'py>,
    wrenches: &[Option<Vector6<f64>>],
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let rows = wrenches.iter().map(|wrench| wrench.map_or([f64::NAN; 6], Into::into));
    Ok(read_only(from_rows(py, rows)?))
}
