//! Links: named frames on bodies, in a tree of their own, since bodies lump what fixed joints join.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::ids::{BodyIndex, LinkIndex};
use crate::spatial::Pose;
use crate::surface::Surface;

/// A link: a frame on a body, perhaps with a surface.
///
/// ```
/// use contactsense::robot::Robot;
///
/// let robot = Robot::example_arm();
/// let link = &robot.links()[6];
/// assert_eq!((link.name.as_str(), link.mass), ("link_7", 2.0));
/// assert!(link.surface.is_some() && link.parent() == Some(robot.link("link_6")?));
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Link {
    /// URDF name.
    pub name: String,
    /// Index of the body it is fixed to.
    pub(crate) body: usize,
    /// Link frame in the body's frame.
    pub(crate) placement: Pose,
    /// Index of the link that its joint, fixed or moving, hangs from; none for the root.
    pub(crate) parent: Option<usize>,
    /// Its own mass (kg).
    pub mass: f64,
    /// Its own centre of mass in the link frame (m).
    pub com: Vector3<f64>,
    /// Its own inertia about the centre of mass, in link axes (kg m^2).
    pub inertia: Matrix3<f64>,
    /// Its surface, in the link frame.
    pub surface: Option<Arc<Surface>>,
}

impl Link {
    /// The body it is fixed to.
    pub fn body(&self) -> BodyIndex {
        BodyIndex::new(self.body)
    }

    /// The link that its joint, fixed or moving, hangs from; none for the root.
    pub fn parent(&self) -> Option<LinkIndex> {
        self.parent.map(LinkIndex::new)
    }

    /// Link frame in the body's frame, whose z axis is the joint's.
    pub fn placement(&self) -> &Pose {
        &self.placement
    }
}
