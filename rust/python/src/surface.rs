//! `Surface` and what its queries return.

use std::sync::Arc;

use contactsense::robot::Robot;
use contactsense::surface::{RayHit, Surface};
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::arguments::whole;
use crate::arrays::{from_rows, reserve, rows};
use crate::errors::{detached, input, to_python};
use contactsense::Error;

/// Samples of one call at most: they fit into memory.
const MOST_SAMPLES: u64 = 100_000_000;

/// Queries between two looks at signals: milliseconds of work.
const SLICE: usize = 4096;

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
    /// `points` is `(n, 3)` in the link frame [m]. Distances are unsigned. Raises `InputError` that names the argument,
    /// `MemoryError` where the answer does not fit into memory.
    fn closest_points(&self, py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<ClosestPoints> {
        let surface = self.core(py)?;
        let points = rows::<3>("points", points)?;
        let mut found = Places::with_room(points.len())?;
        let mut distances = vec![];
        reserve(&mut distances, points.len())?;
        in_slices(py, points.chunks(SLICE), |slice| {
            for point in slice {
                let hit = surface.closest_point(&Vector3::from(*point));
                found.push(&hit.point, &hit.normal, hit.triangle);
                distances.push(hit.distance);
            }
            Ok(())
        })?;
        let (points, normals, triangles) = found.arrays(py)?;
        Ok(ClosestPoints {
            points,
            normals,
            distances: PyArray1::from_vec(py, distances).unbind(),
            triangles,
        })
    }

    /// Every hit of each ray, sorted by distance per ray. Watertight: a closed mesh is entered as often as left.
    ///
    /// `origins` and `directions` are `(n, 3)` in the link frame; directions need not be unit, distances are in metres.
    /// Hits inside another closed part of the link are left out. Raises `InputError` that names the argument,
    /// `MemoryError` where the answer does not fit into memory.
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
        let mut found = Places::with_room(origins.len())?;
        let (mut rays, mut distances) = (vec![], vec![]);
        let (mut hits, mut all) = (Vec::with_capacity(64), vec![]);
        let mut index = 0;
        in_slices(py, origins.chunks(SLICE).zip(directions.chunks(SLICE)), |(origins, directions)| {
            for (origin, direction) in origins.iter().zip(directions) {
                cast(surface, origin, direction, &mut hits);
                reserve(&mut rays, hits.len())?;
                rays.resize(rays.len() + hits.len(), index);
                reserve(&mut all, hits.len())?;
                all.extend_from_slice(&hits);
                index += 1;
            }
            reserve(&mut distances, all.len())?;
            found.reserve(all.len())?;
            for hit in all.drain(..) {
                distances.push(hit.distance);
                found.push(&hit.point, &hit.normal, hit.triangle);
            }
            Ok(())
        })?;
        let (point, normal, triangle) = found.arrays(py)?;
        Ok(RayHits {
            ray: PyArray1::from_vec(py, rays).unbind(),
            distance: PyArray1::from_vec(py, distances).unbind(),
            point,
            normal,
            triangle,
        })
    }

    /// `n` random points, uniform by area over the exposed surface; the same for the same seed.
    ///
    /// A larger `n` appends to the same points. Raises `InputError` that names the argument, `MemoryError` where the points
    /// do not fit into memory.
    #[pyo3(signature = (n, seed=None), text_signature = "($self, n, seed=0)")]
    fn sample(
        &self,
        py: Python<'_>,
        n: &Bound<'_, PyAny>,
        seed: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<SurfaceSamples> {
        let n = whole("n", n, MOST_SAMPLES)? as usize;
        let seed = seed.map_or(Ok(0), |seed| whole("seed", seed, u64::MAX))?;
        let mut sampling = self.core(py)?.sampling(n, seed);
        let mut found = Places::with_room(n)?;
        let mut drawn = Vec::with_capacity(n.min(SLICE));
        let mut more = true;
        while more {
            more = detached(py, || {
                let more = sampling.draw(SLICE as u64, &mut drawn);
                drawn.drain(..).for_each(|hit| found.push(&hit.point, &hit.normal, hit.triangle));
                more
            })?;
            if more {
                py.check_signals()?;
            }
        }
        let (points, normals, triangles) = found.arrays(py)?;
        Ok(SurfaceSamples { points, normals, triangles })
    }
}

/// Every hit of one ray.
fn cast(surface: &Surface, origin: &[f64; 3], direction: &[f64; 3], hits: &mut Vec<RayHit>) {
    // Scaled first, so that no square overflows.
    let direction = Vector3::from(*direction);
    let direction = (direction / direction.amax()).normalize();
    hits.clear();
    while !surface.cast_line_into(&Vector3::from(*origin), &direction, 0.0, hits) {
        hits.clear();
        hits.reserve(2 * hits.capacity());
    }
}

/// Points with their normals and triangles, as columns.
#[derive(Default)]
struct Places {
    points: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    triangles: Vec<i64>,
}

type PlaceArrays = (Py<PyArray2<f64>>, Py<PyArray2<f64>>, Py<PyArray1<i64>>);

impl Places {
    fn with_room(count: usize) -> PyResult<Self> {
        let mut places = Self::default();
        places.reserve(count)?;
        Ok(places)
    }

    fn reserve(&mut self, more: usize) -> PyResult<()> {
        reserve(&mut self.points, more)?;
        reserve(&mut self.normals, more)?;
        reserve(&mut self.triangles, more)
    }

    fn push(&mut self, point: &Vector3<f64>, normal: &Vector3<f64>, triangle: i64) {
        self.points.push([point.x, point.y, point.z]);
        self.normals.push([normal.x, normal.y, normal.z]);
        self.triangles.push(triangle);
    }

    /// Without a copy.
    fn arrays(self, py: Python<'_>) -> PyResult<PlaceArrays> {
        let count = self.triangles.len();
        let rows = |rows: Vec<[f64; 3]>| {
            PyResult::Ok(PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3])?.unbind())
        };
        Ok((rows(self.points)?, rows(self.normals)?, PyArray1::from_vec(py, self.triangles).unbind()))
    }
}

/// Works slice by slice while other Python threads run; between slices Ctrl-C interrupts.
fn in_slices<T: Send>(
    py: Python<'_>,
    slices: impl Iterator<Item = T>,
    mut work: impl FnMut(T) -> PyResult<()> + Send,
) -> PyResult<()> {
    for (number, slice) in slices.enumerate() {
        if number > 0 {
            py.check_signals()?;
        }
        detached(py, || work(slice))??;
    }
    Ok(())
}
