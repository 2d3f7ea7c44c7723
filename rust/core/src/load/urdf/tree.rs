//! Links and joints of a URDF as one tree, in Pinocchio's order.

use std::collections::{HashMap, HashSet};

use urdf_rs::{Joint, JointType};

use super::guard::Checked;
use super::names::name_list;
use crate::error::{Error, Result};

/// The joint that a floating base adds.
pub(super) const ROOT_JOINT: &str = "root_joint";

const LONGEST_CHAIN: usize = 1000;
/// The mass matrix is checked once, at a cost that grows with the cube.
const MOST_JOINTS: usize = 1000;

/// A link, the joint that carries it, and which visit its parent link was.
pub(super) struct Visit {
    pub link: usize,
    pub joint: Option<usize>,
    pub parent: usize,
}

/// A URDF whose links form one tree.
pub(super) struct Tree {
    pub robot: urdf_rs::Robot,
    pub without_inertial: HashSet<String>,
    /// Depth-first from the root; a link's child joints by name (urdfdom keeps joints sorted).
    pub visits: Vec<Visit>,
}

impl Tree {
    pub fn new(checked: Checked) -> Result<Self> {
        let Checked { robot, without_inertial, .. } = checked;
        let links = index("link", robot.links.iter().map(|link| link.name.as_str()))?;
        index("joint", robot.joints.iter().map(|joint| joint.name.as_str()))?;
        let mut parents: Vec<Option<&str>> = vec![None; robot.links.len()];
        let mut children: Vec<Vec<(usize, usize)>> = vec![vec![]; robot.links.len()];
        for (number, joint) in robot.joints.iter().enumerate() {
            let end = |name: &String| {
                links.get(name.as_str()).copied().ok_or_else(|| {
                    Error::model(format!(
                        "joint '{}' names the link '{name}', which the description does not have",
                        joint.name
                    ))
                    .of(&format!("joint '{}'", joint.name))
                })
            };
            let (parent, child) = (end(&joint.parent.link)?, end(&joint.child.link)?);
            if let Some(first) = parents[child].replace(&joint.parent.link) {
                return Err(Error::model(format!(
                    "link '{}' has two parents, '{first}' and '{}'; the links must form a tree",
                    joint.child.link, joint.parent.link
                ))
                .of(&format!("link '{}'", joint.child.link)));
            }
            children[parent].push((number, child));
        }
        for list in &mut children {
            list.sort_by(|a, b| robot.joints[a.0].name.cmp(&robot.joints[b.0].name));
        }
        let roots: Vec<usize> = (0..parents.len()).filter(|link| parents[*link].is_none()).collect();
        if roots.len() > 1 {
            let names: Vec<&str> = roots.iter().map(|link| robot.links[*link].name.as_str()).collect();
            return Err(Error::model(format!(
                "the links must form one tree with one root; links without a parent: {}",
                name_list(&names)
            )));
        }
        let visits = visits(&robot, &roots, &children)?;
        let tree = Self { visits, robot, without_inertial };
        let moving = tree.moving().count();
        if moving > MOST_JOINTS {
            return Err(Error::model(format!("{moving} joints move; supported: up to {MOST_JOINTS}")));
        }
        Ok(tree)
    }

    /// The joints that are not fixed, in the file's order.
    pub fn moving(&self) -> impl Iterator<Item = &Joint> {
        self.robot.joints.iter().filter(|joint| joint.joint_type != JointType::Fixed)
    }

    /// Refuses names that Pinocchio uses itself.
    pub fn check_reserved_names(&self, floating_base: bool) -> Result<()> {
        for joint in &self.robot.joints {
            if joint.name == "universe" || floating_base && joint.name == ROOT_JOINT {
                return Err(Error::model(format!(
                    "joint '{}' has a name that Pinocchio uses itself; rename it",
                    joint.name
                ))
                .of(&format!("joint '{}'", joint.name)));
            }
        }
        Ok(())
    }
}

/// Names and their places; refuses those given twice.
fn index<'a>(what: &str, names: impl Iterator<Item = &'a str>) -> Result<HashMap<&'a str, usize>> {
    let mut places = HashMap::new();
    let mut twice = vec![];
    for (place, name) in names.enumerate() {
        if places.insert(name, place).is_some() && !twice.contains(&name) {
            twice.push(name);
        }
    }
    if twice.is_empty() {
        return Ok(places);
    }
    Err(Error::model(format!("{what} names must be unique; given more than once: {}", name_list(&twice))))
}

fn visits(robot: &urdf_rs::Robot, roots: &[usize], children: &[Vec<(usize, usize)>]) -> Result<Vec<Visit>> {
    let mut visits: Vec<Visit> = Vec::with_capacity(robot.links.len());
    let mut reached = vec![false; robot.links.len()];
    let mut ahead: Vec<(Visit, usize)> =
        roots.iter().map(|&link| (Visit { link, joint: None, parent: 0 }, 0)).collect();
    while let Some((visit, depth)) = ahead.pop() {
        if depth > LONGEST_CHAIN {
            return Err(Error::model(format!(
                "the chain of links down to '{}' is longer than {LONGEST_CHAIN}",
                robot.links[visit.link].name
            )));
        }
        reached[visit.link] = true;
        let parent = visits.len();
        for &(joint, link) in children[visit.link].iter().rev() {
            ahead.push((Visit { link, joint: Some(joint), parent }, depth + 1));
        }
        visits.push(visit);
    }
    let cycle: Vec<&str> = robot
        .links
        .iter()
        .zip(&reached)
        .filter(|(_, seen)| !**seen)
        .map(|(link, _)| link.name.as_str())
        .collect();
    if cycle.is_empty() {
        return Ok(visits);
    }
    Err(Error::model(format!("the links must form a tree; these form a cycle: {}", name_list(&cycle))))
}
