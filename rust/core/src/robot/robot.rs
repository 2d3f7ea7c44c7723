//! The robot: a frozen tree of bodies, links and surfaces.

use std::collections::HashMap;
use std::ops::Index;
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::ancestry::Ancestry;
use super::check;
use super::description::{JointDescription, JointKind, RobotDescription};
use super::ids::LinkIndex;
use super::link::Link;
use crate::error::{Error, Result};
use crate::spatial::basis::across;
use crate::spatial::Pose;
use crate::surface::Surface;

/// The world's number among the bodies; body k is moved by the k-th joint.
pub(crate) const WORLD: usize = 0;

/// A body and the joint that moves it. Frames are turned so that the joint axis is z.
#[derive(Debug, Clone)]
pub(crate) struct Body {
    pub kind: JointKind,
    pub parent: usize,
    pub placement: Pose,
    pub idx_q: usize,
    pub idx_v: usize,
    pub mass: f64,
    pub com: Vector3<f64>,
    pub inertia: Matrix3<f64>,
    pub armature: f64,
    /// Of the position [rad or m], the effort [Nm or N] and the velocity [rad/s or m/s]; infinite where there is none.
    pub position_limits: [f64; 2],
    pub effort_limit: f64,
    pub velocity_limit: f64,
}

/// A robot: immutable, shareable between threads.
///
/// ```
/// use contactsense::robot::Robot;
///
/// let robot = Robot::example_arm();
/// let q = robot.neutral();
/// assert_eq!((robot.nq(), robot.nv()), (7, 7));
/// // Upright, no joint carries weight.
/// let weight = robot.inverse_dynamics(&q, &[0.0; 7], &[0.0; 7])?;
/// assert!(weight.iter().all(|torque| torque.abs() < 1e-12));
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Robot {
    name: String,
    pub(crate) gravity: Vector3<f64>,
    pub(crate) bodies: Vec<Body>,
    joint_names: Vec<String>,
    pub(crate) links: Vec<Link>,
    link_index: HashMap<String, LinkIndex>,
    touchable: Vec<LinkIndex>,
    body_links: Vec<Vec<LinkIndex>>,
    chains: Vec<Vec<usize>>,
    ancestry: Ancestry,
    nq: usize,
    nv: usize,
    warnings: Vec<String>,
}

/// A rotation that takes z to the joint's axis.
fn axis_frame(joint: &JointDescription) -> Matrix3<f64> {
    if joint.kind == JointKind::FreeFlyer {
        return Matrix3::identity();
    }
    let z = joint.axis.normalize();
    let y = across(&z);
    Matrix3::from_columns(&[y.cross(&z), y, z])
}

impl Robot {
    /// Checks a description and freezes it.
    ///
    /// # Errors
    /// [`Error::Model`] for joints and links that cannot be used, [`Error::Geometry`] for surfaces.
    pub fn new(description: RobotDescription) -> Result<Robot> {
        let odd = check::check(&description)?;
        let RobotDescription { name, joints, links, gravity, mut warnings } = description;
        warnings.extend(odd);
        let mut frames = vec![Matrix3::identity()];
        let mut bodies = vec![Body::world()];
        let mut chains: Vec<Vec<usize>> = vec![vec![]];
        let (mut nq, mut nv) = (0, 0);
        for (index, joint) in joints.iter().enumerate() {
            let frame = axis_frame(joint);
            let parent_frame = frames[joint.parent.get()];
            bodies.push(Body {
                kind: joint.kind,
                parent: joint.parent.get(),
                placement: Pose {
                    rotation: parent_frame.transpose() * joint.placement.rotation * frame,
                    translation: parent_frame.transpose() * joint.placement.translation,
                },
                idx_q: nq,
                idx_v: nv,
                mass: joint.mass,
                com: frame.transpose() * joint.com,
                inertia: frame.transpose() * joint.inertia * frame,
                armature: joint.armature,
                position_limits: [
                    joint.lower.unwrap_or(f64::NEG_INFINITY),
                    joint.upper.unwrap_or(f64::INFINITY),
                ],
                effort_limit: joint.effort.unwrap_or(f64::INFINITY),
                velocity_limit: joint.velocity.unwrap_or(f64::INFINITY),
            });
            let mut chain = chains[joint.parent.get()].clone();
            chain.push(index + 1);
            chains.push(chain);
            frames.push(frame);
            nq += joint.kind.nq();
            nv += joint.kind.nv();
        }
        let joint_names: Vec<String> = joints.into_iter().map(|joint| joint.name).collect();
        let mut link_index = HashMap::new();
        let mut body_links = vec![vec![]; bodies.len()];
        let mut touchable = vec![];
        let mut frozen = Vec::with_capacity(links.len());
        for (index, link) in links.into_iter().enumerate() {
            let owner = format!("link '{}'", link.name);
            let body = link.body.get();
            link_index.insert(link.name.clone(), LinkIndex::new(index));
            let frame = frames[body].transpose();
            let placement = Pose {
                rotation: frame * link.placement.rotation,
                translation: frame * link.placement.translation,
            };
            let surface = if link.geometry.is_empty() {
                None
            } else {
                let (surface, odd) = Surface::new(link.geometry).map_err(|error| error.within(&owner))?;
                warnings.extend(odd.into_iter().map(|text| format!("{owner}: {text}")));
                touchable.push(LinkIndex::new(index));
                body_links[body].push(LinkIndex::new(index));
                Some(Arc::new(surface))
            };
            frozen.push(Link {
                name: link.name,
                body,
                placement,
                parent: link.parent.map(LinkIndex::get),
                mass: link.mass,
                com: link.com,
                inertia: link.inertia,
                surface,
            });
        }
        check::check_link_tree(&frozen, &chains)?;
        let mut robot = Robot {
            name,
            gravity,
            bodies,
            joint_names,
            links: frozen,
            link_index,
            touchable,
            body_links,
            ancestry: Ancestry::new(&chains),
            chains,
            nq,
            nv,
            warnings,
        };
        robot.warnings.extend(check::check_mass_matrix(&robot)?);
        Ok(robot)
    }

    /// The robot's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Number of configuration variables.
    pub fn nq(&self) -> usize {
        self.nq
    }

    /// Number of velocity variables.
    pub fn nv(&self) -> usize {
        self.nv
    }

    /// Gravity in the world frame (m/s^2).
    pub fn gravity(&self) -> Vector3<f64> {
        self.gravity
    }

    /// Number of velocity variables without actuator: 6 for a floating base, else 0.
    pub fn unactuated(&self) -> usize {
        if self.floating_base() {
            6
        } else {
            0
        }
    }

    /// Whether the base is free to move.
    pub fn floating_base(&self) -> bool {
        self.bodies.get(1).is_some_and(|body| body.kind == JointKind::FreeFlyer)
    }

    /// Joint names; joint k (from 0) moves body k + 1.
    pub fn joint_names(&self) -> &[String] {
        &self.joint_names
    }

    /// How each joint moves.
    pub fn joint_kinds(&self) -> impl ExactSizeIterator<Item = JointKind> + '_ {
        self.bodies[1..].iter().map(|body| body.kind)
    }

    /// All links, also those without surface; `robot[link]` is the one with an index.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Indices of the links that have a surface.
    pub fn touchable_links(&self) -> &[LinkIndex] {
        &self.touchable
    }

    /// Indices of the links with a surface that are fixed to a body.
    pub(crate) fn links_of_body(&self, body: usize) -> &[LinkIndex] {
        &self.body_links[body]
    }

    /// The bodies from the base to `body`, both included, the world not.
    pub(crate) fn chain(&self, body: usize) -> &[usize] {
        &self.chains[body]
    }

    /// Whether the joint of body `joint` moves `body`: whether it is on the way from the base to there.
    #[inline]
    pub(crate) fn moves(&self, joint: usize, body: usize) -> bool {
        self.ancestry.leads_to(joint, body)
    }

    /// By velocity variable: whether its torque is a force (N).
    pub(crate) fn forces(&self) -> Vec<bool> {
        let of_joint = |kind: JointKind| match kind {
            JointKind::FreeFlyer => &[true, true, true, false, false, false][..],
            JointKind::Prismatic => &[true],
            JointKind::Revolute | JointKind::Continuous => &[false],
        };
        self.joint_kinds().flat_map(of_joint).copied().collect()
    }

    /// Number of bodies, the world included.
    pub fn body_count(&self) -> usize {
        self.bodies.len()
    }

    /// The body that carries a body; the world carries itself.
    pub(crate) fn parent_body(&self, body: usize) -> usize {
        self.bodies[body].parent
    }

    /// The velocity variables of the joint that moves a body.
    pub(crate) fn velocity_range(&self, body: usize) -> std::ops::Range<usize> {
        let body = &self.bodies[body];
        body.idx_v..body.idx_v + body.kind.nv()
    }

    /// What was odd in the description, and what was done about it.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// A link's index by its name.
    ///
    /// # Errors
    /// [`Error::Input`] lists the names there are.
    pub fn link(&self, name: &str) -> Result<LinkIndex> {
        self.link_index.get(name).copied().ok_or_else(|| {
            let names: Vec<&str> = self.links.iter().map(|link| link.name.as_str()).collect();
            Error::input("link", format!("there is no '{name}'; the links are {}", names.join(", ")))
        })
    }
}

/// A link of this robot.
///
/// # Panics
/// If it is the index of another robot's link.
impl Index<LinkIndex> for Robot {
    type Output = Link;

    #[inline]
    fn index(&self, link: LinkIndex) -> &Link {
        &self.links[link.get()]
    }
}

impl Body {
    fn world() -> Self {
        Self {
            kind: JointKind::Revolute,
            parent: WORLD,
            placement: Pose::identity(),
            idx_q: 0,
            idx_v: 0,
            mass: 0.0,
            com: Vector3::zeros(),
            inertia: Matrix3::zeros(),
            armature: 0.0,
            position_limits: [f64::NEG_INFINITY, f64::INFINITY],
            effort_limit: f64::INFINITY,
            velocity_limit: f64::INFINITY,
        }
    }
}
