//! `Surface` and what its queries return.

use std::sync::Arc;

use contactsense::robot::Robot;
use contactsense::surface::{RayHit, Surface};
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

use crate::arrays::{from_rows, rows, whole};
use crate::errors::{input, to_python};
use contactsense::Error;

/// Samples of one call at most: they fit into memory.
const MOST_SAMPLES: u64 = 100_000_000;

/// One link's surface, in the link frame.
#[pyclass(frozen, name = "Surface", module = "contactsense._core")]
pub struct PySurface {
    pub robot: Arc<Robot>,
    pub link: usize,
}

/// Nearest points, one row a query.
#[pyclass(frozen, get_all, module = "contactsense._core")]
pub struct ClosestPoints {
    /// `(n, 3)`, link frame [m].
    points: Py<PyArray2<f64>>,
    /// `(n, 3)`, outward.
    normals: Py<PyArray2<f64>>,
    /// `(n,)`, unsigned [m].
    distances: Py<PyArray1<f64>>,
    /// `(n,)`, rows of `Surface.triangles`; -1 on an exact primitive.
    triangles: Py<PyArray1<i64>>,
}

/// Every hit of a batch of rays, sorted per ray.
#[pyclass(frozen, get_all, module = "contactsense._core")]
pub struct RayHits {
    /// `(k,)`, row of the query.
    ray: Py<PyArray1<i64>>,
    /// `(k,)`, from the origin [m].
    distance: Py<PyArray1<f64>>,
    /// `(k, 3)`, link frame [m].
    point: Py<PyArray2<f64>>,
    /// `(k, 3)`, outward.
    normal: Py<PyArray2<f64>>,
    /// `(k,)`; -1 on an exact primitive.
    triangle: Py<PyArray1<i64>>,
}

/// Random points of a surface.
#[pyclass(frozen, get_all, module = "contactsense._core")]
pub struct SurfaceSamples {
    /// `(n, 3)`, link frame [m].
    points: Py<PyArray2<f64>>,
    /// `(n, 3)`, outward.
    normals: Py<PyArray2<f64>>,
    /// `(n,)`; -1 on an exact primitive.
    triangles: Py<PyArray1<i64>>,
}

impl PySurface {
    fn core(&self, py: Python<'_>) -> PyResult<&Surface> {
        let surface = self.robot.links()[self.link].surface.as_ref();
        surface.ok_or_else(|| to_python(py, Error::Geometry("this link has no surface".into())))
    }
}

fn array(vector: &Vector3<f64>) -> [f64; 3] {
    [vector.x, vector.y, vector.z]
}

#[pymethods]
impl PySurface {
    /// Vertices, `(n, 3)`, link frame [m]; of exact primitives a tessellation, for display.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        from_rows(py, self.core(py)?.vertices().iter().copied())
    }

    /// Vertex indices, `(m, 3)`, counter-clockwise seen from outside.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        use numpy::PyArrayMethods;
        let triangles = self.core(py)?.triangles();
        let flat: Vec<i64> = triangles.iter().flatten().map(|index| i64::from(*index)).collect();
        PyArray1::from_vec(py, flat).reshape([triangles.len(), 3])
    }

    /// Sum of the parts' areas [m^2]; where parts overlap, both count.
    #[getter]
    fn area(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.core(py)?.area())
    }

    /// Whether every part is closed.
    #[getter]
    fn watertight(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.core(py)?.watertight())
    }

    /// The nearest surface point of each query; the minimum over the link's parts.
    ///
    /// `points` is `(n, 3)` in the link frame [m]. Distances are unsigned. Raises `InputError` that names the argument.
    fn closest_points(&self, py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<ClosestPoints> {
        let surface = self.core(py)?;
        let points = rows::<3>("points", points)?;
        let found: Vec<_> =
            py.detach(|| points.iter().map(|p| surface.closest_point(&Vector3::from(*p))).collect());
        Ok(ClosestPoints {
            points: from_rows(py, found.iter().map(|hit| array(&hit.point)))?.unbind(),
            normals: from_rows(py, found.iter().map(|hit| array(&hit.normal)))?.unbind(),
            distances: PyArray1::from_iter(py, found.iter().map(|hit| hit.distance)).unbind(),
            triangles: PyArray1::from_iter(py, found.iter().map(|hit| hit.triangle)).unbind(),
        })
    }

    /// Every hit of each ray, sorted by distance per ray. Watertight: a closed mesh is entered as often as left.
    ///
    /// `origins` and `directions` are `(n, 3)` in the link frame; directions need not be unit, distances are in metres.
    /// Hits inside another closed part of the link are left out. Raises `InputError` that names the argument.
    fn cast_rays(
        &self,
        py: Python<'_>,
        origins: &Bound<'_, PyAny>,
        directions: &Bound<'_, PyAny>,
    ) -> PyResult<RayHits> {
        let surface = self.core(py)?;
        let origins = rows::<3>("origins", origins)?;
        let directions = rows::<3>("directions", directions)?;
        if origins.len() != directions.len() {
            let text = format!(
                "directions: expected {} rows, as many as origins, got {}",
                origins.len(),
                directions.len()
            );
            return Err(input(py, text));
        }
        if let Some(row) = directions.iter().position(|d| Vector3::from(*d).amax() < f64::MIN_POSITIVE) {
            return Err(input(py, format!("directions: row {row} is zero")));
        }
        let (ray, hits) = py.detach(|| cast_all(surface, &origins, &directions));
        Ok(RayHits {
            ray: PyArray1::from_vec(py, ray).unbind(),
            distance: PyArray1::from_iter(py, hits.iter().map(|hit| hit.distance)).unbind(),
            point: from_rows(py, hits.iter().map(|hit| array(&hit.point)))?.unbind(),
            normal: from_rows(py, hits.iter().map(|hit| array(&hit.normal)))?.unbind(),
            triangle: PyArray1::from_iter(py, hits.iter().map(|hit| hit.triangle)).unbind(),
        })
    }

    /// `n` random points, uniform by area over the exposed surface; the same for the same seed.
    ///
    /// A larger `n` appends to the same points.
    #[pyo3(signature = (n, seed=None), text_signature = "($self, n, seed=0)")]
    fn sample(
        &self,
        py: Python<'_>,
        n: &Bound<'_, PyAny>,
        seed: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<SurfaceSamples> {
        let n = whole("n", n, MOST_SAMPLES)?;
        let seed = seed.map_or(Ok(0), |seed| whole("seed", seed, u64::MAX))?;
        let surface = self.core(py)?;
        let found = py.detach(|| surface.sample(n as usize, seed));
        Ok(SurfaceSamples {
            points: from_rows(py, found.iter().map(|hit| array(&hit.point)))?.unbind(),
            normals: from_rows(py, found.iter().map(|hit| array(&hit.normal)))?.unbind(),
            triangles: PyArray1::from_iter(py, found.iter().map(|hit| hit.triangle)).unbind(),
        })
    }
}

/// Hits of all rays, and the ray of each.
fn cast_all(surface: &Surface, origins: &[[f64; 3]], directions: &[[f64; 3]]) -> (Vec<i64>, Vec<RayHit>) {
    let mut rays = Vec::new();
    let mut all = Vec::with_capacity(4 * origins.len());
    let mut hits = Vec::with_capacity(64);
    for (index, (origin, direction)) in origins.iter().zip(directions).enumerate() {
        // Scaled first, so that no square overflows.
        let direction = Vector3::from(*direction);
        let direction = (direction / direction.amax()).normalize();
        hits.clear();
        while !surface.cast_line_into(&Vector3::from(*origin), &direction, 0.0, &mut hits) {
            hits.clear();
            hits.reserve(2 * hits.capacity());
        }
        rays.resize(rays.len() + hits.len(), index as i64);
        all.extend_from_slice(&hits);
    }
    (rays, all)
}
