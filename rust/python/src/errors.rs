//! The core's errors as the package's exceptions.

use contactsense::Error;
use pyo3::exceptions::PyMemoryError;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

static CLASSES: PyOnceLock<[Py<PyType>; 3]> = PyOnceLock::new();

fn classes(py: Python<'_>) -> PyResult<&[Py<PyType>; 3]> {
    CLASSES.get_or_try_init(py, || {
        let module = py.import("contactsense.errors")?;
        let class =
            |name| -> PyResult<Py<PyType>> { Ok(module.getattr(name)?.cast_into::<PyType>()?.unbind()) };
        Ok([class("ModelError")?, class("GeometryError")?, class("InputError")?])
    })
}

/// A Python exception that says what the core said.
pub fn to_python(py: Python<'_>, error: Error) -> PyErr {
    let (index, text) = match error {
        Error::Model(text) => (0, text),
        Error::Geometry(text) => (1, text),
        Error::Input(text) => (2, text),
        Error::Memory(text) => return PyMemoryError::new_err(text),
    };
    match classes(py) {
        Ok(classes) => PyErr::from_type(classes[index].bind(py).clone(), text),
        Err(error) => error,
    }
}

/// An `InputError`.
pub fn input(py: Python<'_>, text: String) -> PyErr {
    to_python(py, Error::Input(text))
}
