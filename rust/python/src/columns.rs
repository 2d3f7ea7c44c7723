//! Points of a surface as columns of NumPy arrays.

use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::returned::{read_only, reserve};

/// Points with their normals and triangles.
#[derive(Default)]
pub struct Columns {
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    triangles: Vec<i64>,
}

type Arrays = (Py<PyArray2<f64>>, Py<PyArray2<f64>>, Py<PyArray1<i64>>);

impl Columns {
    pub fn with_room(count: usize) -> PyResult<Self> {
        let mut columns = Self::default();
        columns.reserve(count)?;
        Ok(columns)
    }

    fn reserve(&mut self, more: usize) -> PyResult<()> {
        reserve(&mut self.points, more)?;
        reserve(&mut self.normals, more)?;
        reserve(&mut self.triangles, more)
    }

    /// Column by column: much faster than row by row. `read` gives point, normal and triangle, which is -1 in NumPy if there is
    /// none.
    pub fn extend<T>(
        &mut self,
        rows: &[T],
        read: impl Fn(&T) -> (&Vector3<f64>, &Vector3<f64>, Option<u32>),
    ) -> PyResult<()> {
        self.reserve(rows.len())?;
        self.points.extend(rows.iter().map(|row| <[f64; 3]>::from(*read(row).0)));
        self.normals.extend(rows.iter().map(|row| <[f64; 3]>::from(*read(row).1)));
        self.triangles.extend(rows.iter().map(|row| read(row).2.map_or(-1, i64::from)));
        Ok(())
    }

    /// Without a copy; nobody can write to them.
    pub fn arrays(self, py: Python<'_>) -> PyResult<Arrays> {
        let count = self.triangles.len();
        let rows = |rows: Vec<[f64; 3]>| {
            let rows = PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3])?;
            PyResult::Ok(read_only(rows).unbind())
        };
        Ok((
            rows(self.points)?,
            rows(self.normals)?,
            read_only(PyArray1::from_vec(py, self.triangles)).unbind(),
        ))
    }
}
