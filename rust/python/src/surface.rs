//! `Surface` and what its queries return.

use std::sync::Arc;

use contactsense::robot::{LinkIndex, Robot};
use contactsense::surface::{RayHit, Surface};
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::whole;
use crate::arrays::rows;
use crate::columns::Columns;
use crate::errors::{detached, input, to_python};
use crate::plain::Reduced;
use crate::returned::{from_rows, read_only, reserve};
use contactsense::Error;

/// Samples of one call at most: they fit into memory.
const MOST_SAMPLES: u64 = 100_000_000;

/// Queries between two looks at signals: milliseconds of work.
const SLICE: usize = 4096;
/// Hits that are collected before they become columns: they stay in the processor's nearest cache.
const BLOCK: usize = 256;
/// Hits of one ray that have room at first: more than a ray has of any robot's link.
const RAY_HITS: usize = 64;

/// The surface of one link, in the link frame.
///
/// `Robot.surface` gives it.
///
/// Example:
///     >>> import contactsense as cs
///     >>> surface = cs.Robot.named("iiwa14").surface("iiwa_link_3")
///     >>> surface.closest_points([[0.0, 0.0, 1.0]]).points.shape
///     (1, 3)
#[pyclass(frozen, name = "Surface", module = "contactsense")]
pub struct PySurface {
    pub robot: Arc<Robot>,
    pub link: LinkIndex,
    /// The robot that it was asked of.
    pub owner: Py<PyAny>,
}

/// Nearest points of a surface, one row per query.
#[pyclass(frozen, get_all, module = "contactsense")]
pub struct ClosestPoints {
    /// Points, `(n, 3)`, link frame [m].
    points: Py<PyArray2<f64>>,
    /// Outward normals, `(n, 3)`, link frame.
    normals: Py<PyArray2<f64>>,
    /// Distances, `(n,)`, unsigned [m].
    distances: Py<PyArray1<f64>>,
    /// Triangles, `(n,)`: rows of `Surface.triangles`; -1 on an exact primitive.
    triangles: Py<PyArray1<i64>>,
}

/// All hits of a batch of rays, sorted by distance per ray.
#[pyclass(frozen, get_all, module = "contactsense")]
pub struct RayHits {
    /// Rays, `(k,)`: rows of the query.
    ray: Py<PyArray1<i64>>,
    /// Distances from the origin, `(k,)` [m].
    distance: Py<PyArray1<f64>>,
    /// Points, `(k, 3)`, link frame [m].
    point: Py<PyArray2<f64>>,
    /// Outward normals, `(k, 3)`, link frame.
    normal: Py<PyArray2<f64>>,
    /// Triangles, `(k,)`: rows of `Surface.triangles`; -1 on an exact primitive.
    triangle: Py<PyArray1<i64>>,
}

/// Random points of a surface.
#[pyclass(frozen, get_all, module = "contactsense")]
pub struct SurfaceSamples {
    /// Points, `(n, 3)`, link frame [m].
    points: Py<PyArray2<f64>>,
    /// Outward normals, `(n, 3)`, link frame.
    normals: Py<PyArray2<f64>>,
    /// Triangles, `(n,)`: rows of `Surface.triangles`; -1 on an exact primitive.
    triangles: Py<PyArray1<i64>>,
}

#[pymethods]
impl ClosestPoints {
    #[new]
    fn new(
        points: Bound<'_, PyArray2<f64>>,
        normals: Bound<'_, PyArray2<f64>>,
        distances: Bound<'_, PyArray1<f64>>,
        triangles: Bound<'_, PyArray1<i64>>,
    ) -> Self {
        Self {
            points: read_only(points).unbind(),
            normals: read_only(normals).unbind(),
            distances: read_only(distances).unbind(),
            triangles: read_only(triangles).unbind(),
        }
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        self.distances.bind(py).len()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let names = ["points", "normals", "distances", "triangles"];
        let columns = names.iter().map(|name| slf.getattr(*name)).collect::<PyResult<Vec<_>>>()?;
        Ok((slf.get_type().into_any(), PyTuple::new(slf.py(), columns)?))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!("ClosestPoints({} points)", self.__len__(py))
    }
}

#[pymethods]
impl RayHits {
    #[new]
    fn new(
        ray: Bound<'_, PyArray1<i64>>,
        distance: Bound<'_, PyArray1<f64>>,
        point: Bound<'_, PyArray2<f64>>,
        normal: Bound<'_, PyArray2<f64>>,
        triangle: Bound<'_, PyArray1<i64>>,
    ) -> Self {
        Self {
            ray: read_only(ray).unbind(),
            distance: read_only(distance).unbind(),
            point: read_only(point).unbind(),
            normal: read_only(normal).unbind(),
            triangle: read_only(triangle).unbind(),
        }
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        self.distance.bind(py).len()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let names = ["ray", "distance", "point", "normal", "triangle"];
        let columns = names.iter().map(|name| slf.getattr(*name)).collect::<PyResult<Vec<_>>>()?;
        Ok((slf.get_type().into_any(), PyTuple::new(slf.py(), columns)?))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!("RayHits({} hits)", self.__len__(py))
    }
}

#[pymethods]
impl SurfaceSamples {
    #[new]
    fn new(
        points: Bound<'_, PyArray2<f64>>,
        normals: Bound<'_, PyArray2<f64>>,
        triangles: Bound<'_, PyArray1<i64>>,
    ) -> Self {
        Self {
            points: read_only(points).unbind(),
            normals: read_only(normals).unbind(),
            triangles: read_only(triangles).unbind(),
        }
    }

    fn __len__(&self, py: Python<'_>) -> usize {
        self.triangles.bind(py).len()
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        let names = ["points", "normals", "triangles"];
        let columns = names.iter().map(|name| slf.getattr(*name)).collect::<PyResult<Vec<_>>>()?;
        Ok((slf.get_type().into_any(), PyTuple::new(slf.py(), columns)?))
    }

    fn __repr__(&self, py: Python<'_>) -> String {
        format!("SurfaceSamples({} points)", self.__len__(py))
    }
}

impl PySurface {
    fn core(&self, py: Python<'_>) -> PyResult<&Surface> {
        let surface = self.robot[self.link].surface.as_deref();
        surface.ok_or_else(|| to_python(py, Error::geometry("this link has no surface")))
    }
}

#[pymethods]
impl PySurface {
    /// Vertices, `(n, 3)`, link frame [m]; of exact primitives a tessellation, for display.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        from_rows(py, self.core(py)?.vertices().iter().copied()).map(read_only)
    }

    /// Vertex indices, `(m, 3)`, counter-clockwise seen from outside.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        let triangles = self.core(py)?.triangles();
        let flat: Vec<i64> = triangles.iter().flatten().map(|index| i64::from(*index)).collect();
        Ok(read_only(PyArray1::from_vec(py, flat).reshape([triangles.len(), 3])?))
    }

    /// Sum of the areas of the parts [m^2]; where parts overlap, both count.
    #[getter]
    fn area(&self, py: Python<'_>) -> PyResult<f64> {
        Ok(self.core(py)?.area())
    }

    /// Whether every part is closed.
    #[getter]
    fn watertight(&self, py: Python<'_>) -> PyResult<bool> {
        Ok(self.core(py)?.watertight())
    }

    /// With its robot.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let ask = self.owner.bind(py).getattr("surface")?;
        Ok((ask, PyTuple::new(py, [&self.robot[self.link].name])?))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let surface = self.core(py)?;
        let (link, closed) =
            (&self.robot[self.link].name, if surface.watertight() { "True" } else { "False" });
        let (count, area) = (surface.triangles().len(), surface.area());
        Ok(format!("Surface('{link}', {count} triangles, area={area:.4} m^2, watertight={closed})"))
    }

    /// The nearest surface point of each query, over all parts of the link.
    ///
    /// Args:
    ///     points: `(n, 3)`, link frame [m].
    ///
    /// Returns:
    ///     `ClosestPoints`; distances are unsigned.
    ///
    /// Raises:
    ///     InputError: the argument cannot be used.
    ///     MemoryError: the answer does not fit into memory.
    fn closest_points(&self, py: Python<'_>, points: &Bound<'_, PyAny>) -> PyResult<ClosestPoints> {
        let surface = self.core(py)?;
        let points = rows::<3>("points", points)?;
        let mut found = Columns::with_room(points.len())?;
        let mut distances = vec![];
        reserve(&mut distances, points.len())?;
        let mut hits = Vec::with_capacity(points.len().min(BLOCK));
        in_slices(py, points.chunks(SLICE), |slice| {
            for block in slice.chunks(BLOCK) {
                hits.clear();
                hits.extend(block.iter().map(|point| surface.closest_point(&Vector3::from(*point))));
                distances.extend(hits.iter().map(|hit| hit.distance));
                found.extend(&hits, |hit| (&hit.point, &hit.normal, hit.triangle))?;
            }
            Ok(())
        })?;
        let (points, normals, triangles) = found.arrays(py)?;
        Ok(ClosestPoints {
            points,
            normals,
            distances: read_only(PyArray1::from_vec(py, distances)).unbind(),
            triangles,
        })
    }

    /// All hits of each ray, sorted by distance per ray.
    ///
    /// It is watertight: a closed mesh is entered as often as left. Hits inside another closed part of the link are left out.
    ///
    /// Args:
    ///     origins: `(n, 3)`, link frame [m].
    ///     directions: `(n, 3)`, link frame; they need not be unit vectors.
    ///
    /// Returns:
    ///     `RayHits`; distances are in metres.
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it.
    ///     MemoryError: the answer does not fit into memory.
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
        let (mut rays, mut hits) = (vec![], vec![]);
        // All hits of most links fit; where they do not, or there is no such room, it is made below.
        let _ = hits.try_reserve(4 * origins.len());
        let mut index = 0;
        in_slices(py, origins.chunks(SLICE).zip(directions.chunks(SLICE)), |(origins, directions)| {
            for (origin, direction) in origins.iter().zip(directions) {
                let before = hits.len();
                reserve(&mut hits, RAY_HITS)?;
                cast(surface, origin, direction, &mut hits)?;
                if hits.len() > before {
                    reserve(&mut rays, hits.len() - before)?;
                    rays.resize(rays.len() + hits.len() - before, index);
                }
                index += 1;
            }
            Ok(())
        })?;
        let mut found = Columns::with_room(hits.len())?;
        let mut distances = vec![];
        reserve(&mut distances, hits.len())?;
        distances.extend(hits.iter().map(|hit| hit.distance));
        found.extend(&hits, |hit| (&hit.point, &hit.normal, hit.triangle))?;
        let (point, normal, triangle) = found.arrays(py)?;
        Ok(RayHits {
            ray: read_only(PyArray1::from_vec(py, rays)).unbind(),
            distance: read_only(PyArray1::from_vec(py, distances)).unbind(),
            point,
            normal,
            triangle,
        })
    }

    /// Random points, uniform by area over the exposed surface.
    ///
    /// Args:
    ///     n: number of points. A larger number appends to the same points.
    ///     seed: the same seed gives the same points.
    ///
    /// Returns:
    ///     `SurfaceSamples`.
    ///
    /// Raises:
    ///     InputError: an argument cannot be used; names it.
    ///     MemoryError: the points do not fit into memory.
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
        let mut found = Columns::with_room(n)?;
        let mut drawn = Vec::with_capacity(n.min(SLICE));
        let mut more = true;
        while more {
            more = detached(py, || {
                drawn.clear();
                let more = sampling.draw(SLICE as u64, &mut drawn);
                found.extend(&drawn, |hit| (&hit.point, &hit.normal, hit.triangle)).map(|()| more)
            })??;
            if more {
                py.check_signals()?;
            }
        }
        let (points, normals, triangles) = found.arrays(py)?;
        Ok(SurfaceSamples { points, normals, triangles })
    }
}

/// Appends every hit of one ray.
fn cast(surface: &Surface, origin: &[f64; 3], direction: &[f64; 3], hits: &mut Vec<RayHit>) -> PyResult<()> {
    // Scaled first, so that no square overflows.
    let direction = Vector3::from(*direction);
    let direction = (direction / direction.amax()).normalize();
    let before = hits.len();
    while !surface.cast_line_into(&Vector3::from(*origin), &direction, 0.0, hits) {
        hits.truncate(before);
        reserve(hits, 2 * hits.capacity())?;
    }
    Ok(())
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
