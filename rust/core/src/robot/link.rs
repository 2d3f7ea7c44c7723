//! Links: named frames on bodies, in a tree of their own, since bodies lump what fixed joints join.

use nalgebra::{Matrix3, Vector3};

use super::ids::{BodyIndex, LinkIndex};
use crate::error::{Error, Result};
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
#[derive(Debug)]
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
    pub surface: Option<Surface>,
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

/// Parents exist, lead to a root, and sit on the link's own body or one that carries it.
pub(super) fn check_link_tree(links: &[Link], chains: &[Vec<usize>]) -> Result<()> {
    for link in links {
        let owner = format!("link '{}'", link.name);
        let refuse = |text: &str| Err(Error::model(format!("{owner}: {text}")).of(&owner));
        if !link.com.iter().chain(&link.inertia).chain([&link.mass]).all(|x| x.is_finite()) || link.mass < 0.0
        {
            return refuse("mass and inertia must be finite, the mass not negative");
        }
        let mut ancestor = link.parent;
        for _ in 0..links.len() {
            match ancestor {
                Some(index) if index < links.len() => ancestor = links[index].parent,
                Some(_) => return refuse("a parent link does not exist"),
                None => break,
            }
        }
        if ancestor.is_some() {
            return refuse("the links must form a tree; its parents form a cycle");
        }
        if let Some(parent) = link.parent.map(|index| &links[index]) {
            if parent.body != 0 && !chains[link.body].contains(&parent.body) {
                return refuse("its parent link must sit on the same body or one that carries it");
            }
        }
    }
    Ok(())
}
