//! Results as plain Python data, and as bytes that cross processes.

use numpy::PyUntypedArray;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyFloat, PyList, PyTuple};
use serde::de::DeserializeOwned;
use serde::Serialize;

/// Attributes of an object as a dict: numbers, strings, lists and dicts; `None` for what is undetermined.
pub fn to_dict<'py>(object: &Bound<'py, PyAny>, names: &[&str]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(object.py());
    for name in names {
        dict.set_item(name, plain(object.getattr(*name)?)?)?;
    }
    Ok(dict)
}

fn plain<'py>(value: Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let py = value.py();
    if value.cast::<PyUntypedArray>().is_ok() {
        return plain(value.call_method0("tolist")?);
    }
    if let Ok(number) = value.cast::<PyFloat>() {
        return Ok(if number.extract::<f64>()?.is_nan() { py.None().into_bound(py) } else { value });
    }
    if let Ok(items) = value.cast::<PyTuple>() {
        return plain(PyList::new(py, items)?.into_any());
    }
    if let Ok(items) = value.cast::<PyList>() {
        let plain = items.iter().map(plain).collect::<PyResult<Vec<_>>>()?;
        let undetermined = !plain.is_empty() && plain.iter().all(|item| item.is_none());
        return Ok(if undetermined { py.None().into_bound(py) } else { PyList::new(py, plain)?.into_any() });
    }
    match value.getattr("to_dict") {
        Ok(nested) => nested.call0(),
        Err(_) => Ok(value),
    }
}

/// A function of this module and the arguments by which it makes an object again: what pickle and copy need.
pub type Reduced<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

/// An object of a class, from its state.
pub fn reduced<'py>(py: Python<'py>, class: &str, state: &impl Serialize) -> PyResult<Reduced<'py>> {
    let bytes = rmp_serde::to_vec_named(state).map_err(|error| PyValueError::new_err(error.to_string()))?;
    let restore = py.import("contactsense._core")?.getattr("_restore")?;
    Ok((
        restore,
        PyTuple::new(py, [class.into_pyobject(py)?.into_any(), PyBytes::new(py, &bytes).into_any()])?,
    ))
}

/// The state of an object of a class.
pub fn restored<T: DeserializeOwned>(bytes: &[u8]) -> PyResult<T> {
    rmp_serde::from_slice(bytes)
        .map_err(|error| PyValueError::new_err(format!("not a pickled state: {error}")))
}
