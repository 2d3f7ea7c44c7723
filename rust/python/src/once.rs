//! Python objects of a result that are made on the first use.

use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;

/// The same object at every use.
pub struct Once<T>(PyOnceLock<Py<T>>);

impl<T> Default for Once<T> {
    fn default() -> Self {
        Self(PyOnceLock::new())
    }
}

impl<T> Once<T> {
    pub fn get<'py>(
        &self,
        py: Python<'py>,
        make: impl FnOnce() -> PyResult<Bound<'py, T>>,
    ) -> PyResult<Bound<'py, T>> {
        let object = self.0.get_or_try_init(py, || make().map(Bound::unbind))?;
        Ok(object.bind(py).clone())
    }
}
