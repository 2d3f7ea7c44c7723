//! Pickling, copying and plain dicts of what is frozen.
//!
//! What the core holds is written as MessagePack, which keeps every bit of a number. It is read only by the version that
//! wrote it: fields may differ in another.

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyList, PyTuple};
use serde::Serialize;

pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What `__reduce__` gives: the function that restores, and its arguments.
pub type Reduced<'py> = (Bound<'py, PyAny>, Bound<'py, PyTuple>);

fn restore(py: Python<'_>) -> PyResult<Bound<'_, PyAny>> {
    py.import("contactsense._core")?.getattr("_restore")
}

/// For an object of a class that is restored from what the core holds.
pub fn reduced<'py>(py: Python<'py>, kind: &str, content: &impl Serialize) -> PyResult<Reduced<'py>> {
    let bytes = rmp_serde::to_vec(content).map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    Ok((restore(py)?, (kind, VERSION, PyBytes::new(py, &bytes)).into_pyobject(py)?))
}

/// For an object that is nothing but its arrays.
pub fn reduced_arrays<'py>(
    py: Python<'py>,
    kind: &str,
    arrays: Bound<'py, PyTuple>,
) -> PyResult<Reduced<'py>> {
    Ok((restore(py)?, (kind, VERSION, arrays).into_pyobject(py)?))
}

/// The attributes of an object as a dict of plain values: lists in place of arrays and tuples, dicts in place of results.
pub fn plain_dict<'py>(object: &Bound<'py, PyAny>, attributes: &[&str]) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(object.py());
    for name in attributes {
        dict.set_item(name, plain(&object.getattr(*name)?)?)?;
    }
    Ok(dict)
}

fn plain<'py>(value: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    if let Ok(tuple) = value.cast::<PyTuple>() {
        let items: Vec<_> = tuple.iter().map(|item| plain(&item)).collect::<PyResult<_>>()?;
        return Ok(PyList::new(value.py(), items)?.into_any());
    }
    if let Ok(dict) = value.cast::<PyDict>() {
        let copy = PyDict::new(value.py());
        for (key, item) in dict {
            copy.set_item(key, plain(&item)?)?;
        }
        return Ok(copy.into_any());
    }
    for method in ["to_dict", "tolist"] {
        if value.hasattr(method)? {
            return value.call_method0(method);
        }
    }
    Ok(value.clone())
}

/// `__reduce__` and `__repr__` of a class that is nothing but its arrays, and its making from them.
macro_rules! arrays_alone {
    ($class:ident, $name:literal, $first:ident $(, $field:ident)*) => {
        #[pymethods]
        impl $class {
            fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<crate::pickle::Reduced<'py>> {
                let arrays = (self.$first.clone_ref(py), $(self.$field.clone_ref(py)),*).into_pyobject(py)?;
                crate::pickle::reduced_arrays(py, $name, arrays)
            }

            fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
                Ok(format!("{}({} rows)", $name, self.$first.bind(py).len()?))
            }
        }

        impl $class {
            pub fn from_arrays(content: &Bound<'_, PyAny>) -> PyResult<Self> {
                let py = content.py();
                let ($first, $($field),*) = content.extract()?;
                let array = read_only(Py::into_bound($first, py)).unbind();
                Ok(Self { $first: array, $($field: read_only(Py::into_bound($field, py)).unbind()),* })
            }
        }
    };
}
pub(crate) use arrays_alone;
