//! What is known of a point of a surface: nearest to a query, hit by a line, sampled.

use nalgebra::Vector3;

/// The point of a surface nearest to a query.
///
/// ```
/// use contactsense::robot::Robot;
/// use nalgebra::Vector3;
///
/// let robot = Robot::example_arm();
/// let surface = robot.links()[0].surface.as_ref().expect("every link of this arm has one");
/// // A capsule of radius 0.05 m around z.
/// let found = surface.closest_point(&Vector3::new(0.25, 0.0, 0.15));
/// assert!((found.distance - 0.2).abs() < 1e-12 && (found.point.x - 0.05).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ClosestPoint {
    /// The nearest point (m).
    pub point: Vector3<f64>,
    /// Outward unit normal of the face that holds `point`; on an edge, of one of its faces.
    pub normal: Vector3<f64>,
    /// Euclidean distance from the query, never negative (m).
    pub distance: f64,
    /// Whether the query is on the inner side of the surface at `point`, also where that is on an edge or a corner.
    pub inside: bool,
    /// Index into [`Surface::triangles`](super::Surface::triangles); none on an exact primitive.
    pub triangle: Option<u32>,
}

impl ClosestPoint {
    /// No point, farther away than any.
    pub(crate) const NONE: ClosestPoint = ClosestPoint {
        point: Vector3::new(f64::NAN, f64::NAN, f64::NAN),
        normal: Vector3::new(0.0, 0.0, 1.0),
        distance: f64::INFINITY,
        inside: false,
        triangle: None,
    };
}

/// One crossing of a line with a surface.
///
/// ```
/// use contactsense::robot::Robot;
/// use nalgebra::Vector3;
///
/// let robot = Robot::example_arm();
/// let surface = robot.links()[0].surface.as_ref().expect("every link of this arm has one");
/// let mut hits = Vec::with_capacity(8);
/// let all = surface.cast_line_into(&Vector3::new(1.0, 0.0, 0.15), &-Vector3::x(), 0.0, &mut hits);
/// assert!(all && hits.len() == 2);
/// assert!(hits[0].entering && (hits[0].distance - 0.95).abs() < 1e-12);
/// assert!(!hits[1].entering && (hits[1].distance - 1.05).abs() < 1e-12);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RayHit {
    /// Where along the line, from its origin (m); negative behind it.
    pub distance: f64,
    /// `origin + distance * direction` (m).
    pub point: Vector3<f64>,
    /// Outward unit normal.
    pub normal: Vector3<f64>,
    /// Index into [`Surface::triangles`](super::Surface::triangles); none on an exact primitive.
    pub triangle: Option<u32>,
    /// Index of the part that was hit.
    pub part: u32,
    /// The line goes into the part here; otherwise it comes out.
    pub entering: bool,
    /// Inside another closed part.
    pub(super) hidden: bool,
}

/// One sample of a surface.
///
/// ```
/// use contactsense::robot::Robot;
///
/// let robot = Robot::example_arm();
/// let surface = robot.links()[0].surface.as_ref().expect("every link of this arm has one");
/// for sample in surface.sample(100, 7) {
///     assert!(surface.closest_point(&sample.point).distance < 1e-12);
///     assert!((sample.normal.norm() - 1.0).abs() < 1e-12);
/// }
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct SurfacePoint {
    /// The sampled point (m).
    pub point: Vector3<f64>,
    /// Outward unit normal.
    pub normal: Vector3<f64>,
    /// Index into [`Surface::triangles`](super::Surface::triangles); none on an exact primitive.
    pub triangle: Option<u32>,
}

impl From<ClosestPoint> for SurfacePoint {
    fn from(near: ClosestPoint) -> Self {
        SurfacePoint { point: near.point, normal: near.normal, triangle: near.triangle }
    }
}
