//! `Surface` and what its queries return.

use contactsense::robot::LinkIndex;
use contactsense::surface::{RayHit, Surface};
use nalgebra::Vector3;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;

use crate::arguments::{text, whole};
use crate::arrays::rows;
use crate::columns::Columns;
use crate::errors::{detached, input, to_python};
use crate::once::Once;
use crate::pickle::{arrays_alone, Reduced};
use crate::returned::{from_rows, read_only, reserve};
use crate::robot::PyRobot;
use contactsense::Error;

/// Samples of one call at most: they fit into memory.
const MOST_SAMPLES: u64 = 100_000_000;

/// Queries between two looks at signals: milliseconds of work.
const SLICE: usize = 4096;
/// Hits that are collected before they become columns: they stay in the processor's nearest cache.
const BLOCK: usize = 256;
/// Hits of one ray that have room at first: more than a ray has of any robot's link.
const RAY_HITS: usize = 64;

/// One link's surface, in the link frame.
///
/// `Robot.surface` gives it. Frozen, shareable between threads; can be pickled and copied where its robot can.
///
/// Example:
///     >>> import contactsense as cs
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> surface = robot.surface(robot.link_names[-1])
///     >>> samples = surface.sample(100)
///     >>> bool((surface.closest_points(samples.points).distances < 1e-9).all())
///     True
#[pyclass(frozen, name = "Surface", module = "contactsense")]
pub struct PySurface {
    pub robot: Py<PyRobot>,
    pub link: LinkIndex,
    vertices: Once<PyArray2<f64>>,
    triangles: Once<PyArray2<i64>>,
}

/// Nearest points, one row a query; all arrays are read-only.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> surface = robot.surface(robot.link_names[-1])
///     >>> surface.closest_points([[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]).points.shape
///     (2, 3)
#[pyclass(frozen, get_all, module = "contactsense")]
pub struct ClosestPoints {
    /// Nearest point of each query, `(n, 3)`, link frame [m].
    points: Py<PyArray2<f64>>,
    /// Outward unit normals there, `(n, 3)`, link frame.
    normals: Py<PyArray2<f64>>,
    /// Unsigned distances, `(n,)` [m].
    distances: Py<PyArray1<f64>>,
    /// Rows of `Surface.triangles`, `(n,)`; -1 on an exact primitive.
    triangles: Py<PyArray1<i64>>,
}

/// Every intersection of a batch of rays, sorted per ray; all arrays are read-only.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> surface = robot.surface(robot.link_names[-1])
///     >>> hits = surface.cast_rays([[0.0, 0.0, 1.0]], [[0.0, 0.0, -1.0]])
///     >>> len(hits.ray) % 2
///     0
#[pyclass(frozen, get_all, module = "contactsense")]
pub struct RayHits {
    /// Row of the query, `(k,)`.
    ray: Py<PyArray1<i64>>,
    /// Distance from the ray's origin, `(k,)` [m].
    distance: Py<PyArray1<f64>>,
    /// Point of intersection, `(k, 3)`, link frame [m].
    point: Py<PyArray2<f64>>,
    /// Outward unit normal there, `(k, 3)`, link frame.
    normal: Py<PyArray2<f64>>,
    /// Row of `Surface.triangles`, `(k,)`; -1 on an exact primitive.
    triangle: Py<PyArray1<i64>>,
}

/// Random points of a surface; all arrays are read-only.
///
/// Frozen; can be pickled and copied.
///
/// Example:
///     >>> import contactsense as cs
///     >>> robot = cs.Robot.named("iiwa14")
///     >>> surface = robot.surface(robot.link_names[-1])
///     >>> surface.sample(100, seed=1).points.shape
///     (100, 3)
#[pyclass(frozen, get_all, module = "contactsense")]
pub struct SurfaceSamples {
    /// Points, `(n, 3)`, link frame [m].
    points: Py<PyArray2<f64>>,
    /// Outward unit normals there, `(n, 3)`, link frame.
    normals: Py<PyArray2<f64>>,
    /// Rows of `Surface.triangles`, `(n,)`; -1 on an exact primitive.
    triangles: Py<PyArray1<i64>>,
}

impl PySurface {
    fn new(robot: Py<PyRobot>, link: LinkIndex) -> Self {
        Self { robot, link, vertices: Once::default(), triangles: Once::default() }
    }

    fn core(&self, py: Python<'_>) -> PyResult<&Surface> {
        let surface = self.robot.get().0[self.link].surface.as_deref();
        surface.ok_or_else(|| to_python(py, Error::geometry("this link has no surface")))
    }
}

#[pymethods]
impl PyRobot {
    /// The surface of a link, in the link frame.
    ///
    /// Args:
    ///     link: name of a link that has a surface.
    ///
    /// Returns:
    ///     A `Surface`.
    ///
    /// Raises:
    ///     InputError: the link is unknown or has no surface; the message lists those that have one.
    fn surface(slf: &Bound<'_, Self>, link: &Bound<'_, PyAny>) -> PyResult<PySurface> {
        let (py, this) = (slf.py(), slf.get());
        let index = this.link(link)?;
        if this.0[index].surface.is_none() {
            let names: Vec<&str> =
                this.0.touchable_links().iter().map(|i| this.0[*i].name.as_str()).collect();
            return Err(input(
                py,
                format!(
                    "link: '{}' has no surface; links that have one: {}",
                    text("link", link)?,
                    names.join(", ")
                ),
            ));
        }
        Ok(PySurface::new(slf.clone().unbind(), index))
    }
}

#[pymethods]
impl PySurface {
    /// Vertices, `(n, 3)`, link frame [m]; of exact primitives a tessellation, for display; read-only.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        self.vertices.get(py, || Ok(read_only(from_rows(py, self.core(py)?.vertices().iter().copied())?)))
    }

    /// Vertex indices, `(m, 3)`, counter-clockwise seen from outside; read-only.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<i64>>> {
        self.triangles.get(py, || {
            let triangles = self.core(py)?.triangles();
            let flat: Vec<i64> = triangles.iter().flatten().map(|index| i64::from(*index)).collect();
            Ok(read_only(PyArray1::from_vec(py, flat).reshape([triangles.len(), 3])?))
        })
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

    /// The nearest surface point of each query: the minimum over the link's parts.
    ///
    /// Args:
    ///     points: Queries, `(n, 3)`, or one `(3,)`, link frame [m].
    ///
    /// Returns:
    ///     One row a query; distances are unsigned.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    ///     MemoryError: The answer does not fit into memory.
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

    /// Every intersection of each ray, sorted by distance per ray.
    ///
    /// Watertight: a closed mesh is entered as often as left. Intersections inside another closed part of the link are
    /// left out.
    ///
    /// Args:
    ///     origins: Where the rays begin, `(n, 3)`, or one `(3,)`, link frame [m].
    ///     directions: Of the rays, as many, link frame; they need not be unit vectors.
    ///
    /// Returns:
    ///     One row an intersection; distances are in metres.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    ///     MemoryError: The answer does not fit into memory.
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

    /// Draws random points, uniform by area over the exposed surface; the same for the same seed.
    ///
    /// Args:
    ///     n: How many; a larger number appends to the same points.
    ///     seed: A whole number.
    ///
    /// Returns:
    ///     One row a point, link frame.
    ///
    /// Raises:
    ///     InputError: Names the argument.
    ///     MemoryError: The points do not fit into memory.
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

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Reduced<'py>> {
        let link = &self.robot.get().0[self.link].name;
        Ok((self.robot.bind(py).getattr("surface")?, PyTuple::new(py, [link])?))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (name, core) = (&self.robot.get().0[self.link].name, self.core(py)?);
        Ok(format!("Surface('{name}', {} triangles, area={:.4})", core.triangles().len(), core.area()))
    }
}

arrays_alone!(ClosestPoints, "ClosestPoints", points, normals, distances, triangles);
arrays_alone!(RayHits, "RayHits", ray, distance, point, normal, triangle);
arrays_alone!(SurfaceSamples, "SurfaceSamples", points, normals, triangles);

/// Appends every intersection of one ray.
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
