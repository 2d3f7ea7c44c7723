//! The parts of a link's surface, as given and as searched.

use nalgebra::Vector3;

use super::answers::ClosestPoint;
use super::mesh::Mesh;
use super::primitive::{Placed, Primitive};
use crate::spatial::Pose;
use crate::{Error, Result};

/// A shape in its own frame (m).
///
/// ```
/// use contactsense::spatial::Pose;
/// use contactsense::surface::{Geometry, Part, Surface};
///
/// let geometry = Geometry::Box { half_extents: [0.1, 0.2, 0.3] };
/// let (surface, _) = Surface::new(vec![Part { geometry, pose: Pose::identity() }])?;
/// assert!((surface.area() - 0.88).abs() < 1e-12 && surface.watertight());
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Geometry {
    /// Triangles, counter-clockwise seen from outside (repaired where they are not).
    Mesh {
        /// Vertices (m).
        vertices: Vec<[f64; 3]>,
        /// Indices into `vertices`.
        triangles: Vec<[u32; 3]>,
    },
    /// An axis-aligned box around the origin.
    Box {
        /// Half the lengths of the edges (m).
        half_extents: [f64; 3],
    },
    /// A cylinder around the z axis, centred.
    Cylinder {
        /// Radius (m).
        radius: f64,
        /// Half the length (m).
        half_length: f64,
    },
    /// A sphere around the origin.
    Sphere {
        /// Radius (m).
        radius: f64,
    },
    /// A cylinder around the z axis, centred, with half spheres on its ends.
    Capsule {
        /// Radius (m).
        radius: f64,
        /// Half the length of the cylinder, without the half spheres (m).
        half_length: f64,
    },
}

/// A shape placed on a link.
///
/// ```
/// use contactsense::spatial::Pose;
/// use contactsense::surface::{Geometry, Part, Surface};
/// use nalgebra::Vector3;
///
/// let sphere = |x| Part {
///     geometry: Geometry::Sphere { radius: 0.1 },
///     pose: Pose { translation: Vector3::new(x, 0.0, 0.0), ..Pose::identity() },
/// };
/// let (surface, _) = Surface::new(vec![sphere(0.0), sphere(1.0)])?;
/// assert!((surface.closest_point(&Vector3::new(0.7, 0.0, 0.0)).distance - 0.2).abs() < 1e-12);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Part {
    /// The shape.
    pub geometry: Geometry,
    /// Its frame in the link's frame.
    pub pose: Pose,
}

/// A part ready to be searched.
#[derive(Debug, Clone)]
#[allow(clippy::large_enum_variant)] // a handful per link
pub(super) enum Solid {
    /// In the link's frame; its triangles start at `first` in the surface's.
    Mesh { mesh: Mesh, first: usize },
    /// In its own frame.
    Exact(Placed),
}

impl Solid {
    pub fn closed(&self) -> bool {
        match self {
            Solid::Mesh { mesh, .. } => mesh.closed,
            Solid::Exact(_) => true,
        }
    }

    /// The index in this part's mesh of a triangle of the surface; none where another part, or none, holds it.
    #[inline]
    pub fn holds(&self, triangle: u32) -> Option<usize> {
        let Solid::Mesh { mesh, first } = self else { return None };
        (triangle as usize).checked_sub(*first).filter(|&id| id < mesh.triangles.len())
    }

    /// Replaces `best` if this part is nearer.
    pub fn closest_point(&self, p: &Vector3<f64>, warm_start: Option<u32>, best: &mut ClosestPoint) {
        match self {
            Solid::Mesh { mesh, first } => {
                let hint = warm_start.and_then(|triangle| self.holds(triangle));
                mesh.closest_point(p, hint, *first, best);
            }
            Solid::Exact(placed) => placed.closest_point(p, best),
        }
    }

    /// Whether `p` lies inside this part (closed), by more than `tolerance`.
    pub fn contains(&self, p: &Vector3<f64>, tolerance: f64) -> bool {
        match self {
            Solid::Mesh { mesh, .. } => mesh.closed && mesh.contains(p, tolerance),
            Solid::Exact(placed) => placed.contains(p, tolerance),
        }
    }
}

/// Checks a primitive's sizes.
pub(super) fn primitive(geometry: &Geometry) -> Result<Primitive> {
    let positive = |kind: &str, name: &str, value: f64| {
        if value.is_finite() && value > 0.0 {
            Ok(value)
        } else {
            Err(Error::geometry(format!("{kind}: {name} is {value}; it must be positive and finite")))
        }
    };
    Ok(match *geometry {
        Geometry::Box { half_extents } => {
            for value in half_extents {
                positive("box", "half_extents", value)?;
            }
            Primitive::Box(half_extents.into())
        }
        Geometry::Cylinder { radius, half_length } => Primitive::Cylinder {
            radius: positive("cylinder", "radius", radius)?,
            half_length: positive("cylinder", "half_length", half_length)?,
        },
        Geometry::Sphere { radius } => Primitive::Sphere { radius: positive("sphere", "radius", radius)? },
        Geometry::Capsule { radius, half_length } => Primitive::Capsule {
            radius: positive("capsule", "radius", radius)?,
            half_length: positive("capsule", "half_length", half_length)?,
        },
        Geometry::Mesh { .. } => return Err(Error::geometry("a mesh is no primitive")),
    })
}
