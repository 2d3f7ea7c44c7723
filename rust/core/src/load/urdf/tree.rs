//! Links and joints of a URDF as one tree, in Pinocchio's order.

use std::collections::HashMap;

use urdf_rs::{Joint, JointType, Robot};

use crate::error::{Error, Result};
use crate::robot::check::{check_unique, list};

/// The joint that a floating base adds.
pub(super) const ROOT_JOINT: &str = "root_joint";

/// Far beyond any robot.
const LONGEST_CHAIN: usize = 1000;
const MOST_JOINTS: usize = 1000;

/// A link, the joint that carries it, and which visit its parent link was.
pub(super) struct Visit {
    pub link: usize,
    pub joint: Option<usize>,
    pub parent: usize,
}

/// The links depth-first from the root, a link's child joints by name (urdfdom keeps joints sorted).
pub(super) fn visits(robot: &Robot, floating_base: bool) -> Result<Vec<Visit>> {
    let names = || robot.links.iter().map(|link| link.name.as_str());
    check_unique("link", names())?;
    check_unique("joint", robot.joints.iter().map(|joint| joint.name.as_str()))?;
    let links: HashMap<&str, usize> = names().zip(0..).collect();
    let mut parents: Vec<Option<&str>> = vec![None; robot.links.len()];
    let mut children: Vec<Vec<usize>> = vec![vec![]; robot.links.len()];
    for (number, joint) in robot.joints.iter().enumerate() {
        let owner = format!("joint '{}'", joint.name);
        if joint.name == "universe" || floating_base && joint.name == ROOT_JOINT {
            let text = format!("{owner} has a name that Pinocchio uses itself; rename it");
            return Err(Error::model(text).of(&owner));
        }
        let end = |name: &String| {
            let text = || format!("{owner} names the link '{name}', which the description does not have");
            links.get(name.as_str()).copied().ok_or_else(|| Error::model(text()).of(&owner))
        };
        let (parent, child) = (end(&joint.parent.link)?, end(&joint.child.link)?);
        if let Some(first) = parents[child].replace(&joint.parent.link) {
            return Err(Error::model(format!(
                "link '{}' has two parents, '{first}' and '{}'; the links must form a tree",
                joint.child.link, joint.parent.link
            ))
            .of(&format!("link '{}'", joint.child.link)));
        }
        children[parent].push(number);
    }
    let roots: Vec<usize> = (0..parents.len()).filter(|link| parents[*link].is_none()).collect();
    if roots.len() > 1 {
        let roots: Vec<&str> = roots.iter().map(|link| robot.links[*link].name.as_str()).collect();
        return Err(Error::model(format!(
            "the links must form one tree with one root; links without a parent: {}",
            list(&roots)
        )));
    }
    for joint in robot.joints.iter().filter(|joint| joint.joint_type == JointType::Floating) {
        if floating_base || !roots.contains(&links[joint.parent.link.as_str()]) {
            let owner = format!("joint '{}'", joint.name);
            let text =
                "floats inside the robot; a joint can float from the root link only, without floating_base";
            return Err(Error::model(format!("{owner} {text}")).of(&owner));
        }
    }
    let mut visits: Vec<Visit> = Vec::with_capacity(robot.links.len());
    let mut ahead: Vec<(Visit, usize)> =
        roots.iter().map(|&link| (Visit { link, joint: None, parent: 0 }, 0)).collect();
    while let Some((visit, depth)) = ahead.pop() {
        let name = &robot.links[visit.link].name;
        if depth > LONGEST_CHAIN {
            return Err(Error::model(format!(
                "the chain of links down to '{name}' is longer than {LONGEST_CHAIN}"
            )));
        }
        children[visit.link].sort_by(|a, b| robot.joints[*b].name.cmp(&robot.joints[*a].name));
        for &number in &children[visit.link] {
            let link = links[robot.joints[number].child.link.as_str()];
            ahead.push((Visit { link, joint: Some(number), parent: visits.len() }, depth + 1));
        }
        visits.push(visit);
    }
    let reached = |link: usize| visits.iter().any(|visit| visit.link == link);
    if visits.len() < robot.links.len() {
        let cycle: Vec<&str> =
            names().enumerate().filter(|(link, _)| !reached(*link)).map(|(_, name)| name).collect();
        return Err(Error::model(format!(
            "the links must form a tree; these form a cycle: {}",
            list(&cycle)
        )));
    }
    let count = moving(robot).count();
    if count > MOST_JOINTS {
        return Err(Error::model(format!("{count} joints move; supported: up to {MOST_JOINTS}")));
    }
    Ok(visits)
}

/// The joints that are not fixed, in the file's order.
pub(super) fn moving(robot: &Robot) -> impl Iterator<Item = &Joint> {
    robot.joints.iter().filter(|joint| joint.joint_type != JointType::Fixed)
}
