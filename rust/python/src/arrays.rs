//! Array arguments, copied into memory of our own: code that runs while a later argument is read can neither change
//! them nor take their memory away.

use contactsense::robot::LARGEST;
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyString;

use crate::arguments::number_if_any;
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

/// A scalar, or one number per velocity variable.
pub fn scalar_or_vector(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    match number_if_any(object)? {
        Some(number) => Ok(vec![number]),
        None => Ok(Vector::new(name, object)?.into_vec()),
    }
}

/// A table argument, row by row.
pub struct Table {
    pub numbers: Vec<f64>,
    /// Lengths along each dimension.
    pub shape: Vec<usize>,
}

impl Table {
    /// An array of so many dimensions, described as `expected`.
    pub fn new(name: &str, object: &Bound<'_, PyAny>, dimensions: usize, expected: &str) -> PyResult<Self> {
        let wrong = || input(object.py(), format!("{name}: expected an array of shape {expected}"));
        let converted = convert(name, object)?;
        let array = converted.cast::<PyArrayDyn<f64>>().map_err(|_| wrong())?;
        let view = array.try_readonly().map_err(|_| wrong())?;
        if view.shape().len() != dimensions {
            return Err(wrong());
        }
        Ok(Self { numbers: own(view.as_slice().map_err(|_| wrong())?)?, shape: view.shape().to_vec() })
    }
}

/// Sensor readings `(n, 6)`; a NaN says that there is none.
pub struct Readings(Vec<Option<[f64; 6]>>);

impl Readings {
    pub fn new(object: &Bound<'_, PyAny>) -> PyResult<Self> {
        let wrong = || input(object.py(), "wrenches: expected an array of shape (n_sensors, 6)".into());
        let mut copied = None;
        if let Ok(array) = object.cast::<PyArray2<f64>>() {
            copied = copy_rows(array)?;
        }
        if copied.is_none() {
            let converted = convert("wrenches", object)?;
            copied = copy_rows(converted.cast().map_err(|_| wrong())?)?;
        }
        let rows = copied.ok_or_else(wrong)?;
        Ok(Self(rows.into_iter().map(reading).collect()))
    }

    /// Several rows `(n, n_sensors, 6)`, flat; of as many rows as given, if so.
    pub fn several(object: &Bound<'_, PyAny>, rows: Option<usize>, sensors: usize) -> PyResult<Self> {
        let expected = rows.map_or_else(|| format!("(n, {sensors}, 6)"), |n| format!("({n}, {sensors}, 6)"));
        let table = Table::new("wrenches", object, 3, &expected)?;
        if table.shape[1..] != [sensors, 6] || rows.is_some_and(|rows| rows != table.shape[0]) {
            let text = format!("wrenches: expected shape {expected}, got {:?}", table.shape);
            return Err(input(object.py(), text));
        }
        Ok(Self(table.numbers.as_chunks().0.iter().map(|row| reading(*row)).collect()))
    }

    /// One row `(n_sensors, 6)`, or several, flat.
    pub fn one_or_several(object: &Bound<'_, PyAny>, sensors: usize) -> PyResult<Self> {
        let converted = convert("wrenches", object)?;
        match converted.cast::<PyArrayDyn<f64>>() {
            Ok(array) if array.ndim() == 3 => Self::several(&converted, None, sensors),
            _ => {
                let readings = Self::new(&converted)?;
                if readings.0.len() == sensors {
                    return Ok(readings);
                }
                let text = format!("wrenches: expected shape ({sensors}, 6) or (n, {sensors}, 6)");
                Err(input(object.py(), text))
            }
        }
    }

    /// One sensor's readings in several poses, `(n, 6)`, or equally many in each, `(n, k, 6)`; flat.
    pub fn in_poses(object: &Bound<'_, PyAny>, poses: usize) -> PyResult<Self> {
        let wrong = |_| {
            let text = format!("wrenches: expected an array of shape ({poses}, 6) or ({poses}, k, 6)");
            input(object.py(), text)
        };
        let converted = convert("wrenches", object)?;
        let array = converted.cast::<PyArrayDyn<f64>>().map_err(|_| wrong(()))?;
        let view = array.try_readonly().map_err(|_| wrong(()))?;
        match view.shape() {
            [n, 6] | [n, _, 6] if *n == poses => {}
            _ => return Err(wrong(())),
        }
        let rows = own(view.as_slice().map_err(|_| wrong(()))?)?;
        Ok(Self(rows.as_chunks().0.iter().map(|row| reading(*row)).collect()))
    }

    pub fn rows(&self) -> &[Option<[f64; 6]>] {
        &self.0
    }
}

/// A NaN leaves its sensor out, unless the row is refused for another number.
fn reading(row: [f64; 6]) -> Option<[f64; 6]> {
    let none = row.iter().any(|x| x.is_nan()) && !row.iter().any(|x| x.abs() >= LARGEST);
    (!none).then_some(row)
}

/// The numbers of a vector; `None` where they are strided, or unaligned as a field of a packed record is.
fn copy(array: &Bound<'_, PyArray1<f64>>) -> PyResult<Option<Vec<f64>>> {
    if array.len() <= SHORT {
        // No look at NumPy's table of borrows, which takes longer than the copy.
        return Ok(array.to_vec().ok());
    }
    let Ok(view) = array.try_readonly() else { return Ok(None) };
    view.as_slice().ok().map(own).transpose()
}

/// The same of rows of `N` numbers.
fn copy_rows<const N: usize>(array: &Bound<'_, PyArray2<f64>>) -> PyResult<Option<Vec<[f64; N]>>> {
    let Ok(view) = array.try_readonly() else { return Ok(None) };
    match view.as_slice() {
        Ok(slice) if view.is_c_contiguous() && view.shape()[1] == N => own(slice.as_chunks().0).map(Some),
        _ => Ok(None),
    }
}

fn own<T: Copy>(slice: &[T]) -> PyResult<Vec<T>> {
    let mut copied = vec![];
    reserve(&mut copied, slice.len())?;
    copied.extend_from_slice(slice);
    Ok(copied)
}

/// Rows of `N` numbers of a size that can be computed with; a single row may be given flat.
pub fn rows<const N: usize>(name: &str, object: &Bound<'_, PyAny>) -> PyResult<Vec<[f64; N]>> {
    let py = object.py();
    let wrong = || input(py, format!("{name}: expected an array of shape (n, {N})"));
    let mut copied = None;
    if let Ok(array) = object.cast::<PyArray2<f64>>() {
        copied = copy_rows(array)?;
    }
    if copied.is_none() {
        let converted = convert(name, object)?;
        copied = if let Ok(array) = converted.cast::<PyArray1<f64>>() {
            copy(array)?.and_then(|row| Some(vec![<[f64; N]>::try_from(row).ok()?]))
        } else {
            copy_rows(converted.cast().map_err(|_| wrong())?)?
        };
    }
    let rows = copied.ok_or_else(wrong)?;
    let computable = |x: &f64| x.abs() < LARGEST;
    // Without a branch a number, which makes it several times faster.
    if rows.as_flattened().iter().fold(true, |all, x| all & computable(x)) {
        return Ok(rows);
    }
    let row = rows.iter().position(|row| !row.iter().all(computable)).unwrap_or(0);
    Err(input(py, format!("{name}: row {row} must be finite and below {LARGEST:e}")))
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
