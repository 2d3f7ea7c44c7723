//! What stands between a file and `urdf-rs`: every element checked, and rewritten with only what is needed.
//!
//! On its own `urdf-rs` cannot tell a missing `<inertial>` or `<limit>` from zeros, skips words that are no numbers,
//! reads "nan", refuses a whole file for an odd material, names no element in its messages, and overflows the stack
//! on deeply nested elements.

mod joint;
mod shape;
mod writer;

use std::collections::HashSet;
use std::path::Path;

use roxmltree::{Document, Node};

use super::guard::writer::{row, Writer};
use super::numbers::{attribute, parse, Kind, LARGEST};
use super::{text, UrdfGeometry};
use crate::error::{Error, Result};
use crate::load::problem::Problem;

pub(super) const SUPPORTED_JOINTS: &str =
    "revolute, continuous, prismatic, fixed, and a free flyer as the root";

/// A URDF whose every number and name was checked.
pub(super) struct Checked {
    pub robot: urdf_rs::Robot,
    /// Links without `<inertial>`; `urdf-rs` gives them zeros.
    pub without_inertial: HashSet<String>,
    /// The first shape that cannot be used; left out of `robot`.
    pub bad_shape: Option<Error>,
}

/// Reads a file; [`Error::Model`] names the element that is wrong.
pub(super) fn read(path: &Path, role: UrdfGeometry) -> Result<Checked> {
    let shown = path.display();
    let text = text::read(path)?;
    let not_xml = |said: Problem| Error::model(format!("'{shown}' is not XML: {said}")).because(said.cause);
    crate::load::xml_limits::check(&text).map_err(|said| not_xml(said.into()))?;
    let document = Document::parse(&text).map_err(|cause| not_xml(Problem::from_error(cause)))?;
    let root = document.root_element();
    if !is(root, "robot") {
        let tag = root.tag_name();
        let space = tag.namespace().map(|space| format!("{{{space}}}")).unwrap_or_default();
        return Err(Error::model(format!(
            "'{shown}' is not a URDF: its root element is <{space}{}>, not <robot>",
            tag.name()
        )));
    }
    if child(root, "link").is_none() {
        return Err(Error::model(format!("'{shown}' has no links (a xacro file must be expanded first)")));
    }
    let name = match root.attribute("name") {
        Some(name) if !name.is_empty() => name.to_owned(),
        _ => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    let mut clean = Clean { xml: Writer::default(), role, without_inertial: HashSet::new(), bad_shape: None };
    clean.xml.open("robot", &[("name", &name)]);
    for node in children(root, "link") {
        clean.link(node).map_err(|error| error.of(&element(node)))?;
    }
    for node in children(root, "joint") {
        clean.joint(node).map_err(|error| error.of(&element(node)))?;
    }
    clean.xml.close("robot");
    let robot = urdf_rs::read_from_string(&clean.xml.text)
        .map_err(Problem::from_error)
        .map_err(|said| Error::model(format!("'{shown}' cannot be read: {said}")).because(said.cause))?;
    check_names(root, &robot)?;
    let Clean { without_inertial, bad_shape, .. } = clean;
    Ok(Checked { robot: urdf_rs::Robot { name, ..robot }, without_inertial, bad_shape })
}

/// Names that a second pass through XML changes cannot be kept.
fn check_names(root: Node<'_, '_>, robot: &urdf_rs::Robot) -> Result<()> {
    let written = children(root, "link").chain(children(root, "joint")).map(|node| node.attribute("name"));
    let links = robot.links.iter().map(|link| &link.name);
    let read = links.chain(robot.joints.iter().map(|joint| &joint.name));
    for (written, read) in written.zip(read) {
        if written != Some(read) {
            return Err(Error::model(format!("{written:?} cannot be a name; leave control characters out")));
        }
    }
    Ok(())
}

fn is(node: Node<'_, '_>, tag: &str) -> bool {
    node.is_element() && node.tag_name().namespace().is_none() && node.tag_name().name() == tag
}

fn children<'a, 'i>(node: Node<'a, 'i>, tag: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| is(*child, tag))
}

fn child<'a, 'i>(node: Node<'a, 'i>, tag: &'static str) -> Option<Node<'a, 'i>> {
    children(node, tag).next()
}

/// A link or joint as messages name it.
fn element(node: Node<'_, '_>) -> String {
    format!("{} '{}'", node.tag_name().name(), node.attribute("name").unwrap_or_default())
}

/// The rewritten text.
struct Clean {
    xml: Writer,
    role: UrdfGeometry,
    without_inertial: HashSet<String>,
    bad_shape: Option<Error>,
}

impl Clean {
    fn link(&mut self, node: Node<'_, '_>) -> Result<()> {
        let name = node.attribute("name").unwrap_or_default();
        if name.is_empty() {
            return Err(Error::model("a <link> has no name"));
        }
        self.xml.open("link", &[("name", name)]);
        match child(node, "inertial") {
            Some(inertial) => self.inertial(inertial, &format!("link '{name}'"))?,
            None => {
                self.without_inertial.insert(name.to_owned());
            }
        }
        let tag = self.role.tag();
        for shape in children(node, tag) {
            let before = self.xml.text.len();
            if let Err(error) = self.shape(shape, tag, &format!("link '{name}': <{tag}>")) {
                self.xml.text.truncate(before);
                self.bad_shape.get_or_insert(error.of(&element(node)));
            }
        }
        self.xml.close("link");
        Ok(())
    }

    fn inertial(&mut self, node: Node<'_, '_>, owner: &str) -> Result<()> {
        let (Some(mass), Some(inertia)) = (child(node, "mass"), child(node, "inertia")) else {
            return Err(Error::model(format!("{owner}: <inertial> needs <mass> and <inertia>")));
        };
        let keys = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
        let mut moments = Vec::with_capacity(6);
        for key in keys {
            // Products of inertia may be left out; URDF's default is zero.
            let default = if matches!(key, "ixx" | "iyy" | "izz") { None } else { Some(0.0) };
            moments.push(row(&[attribute(inertia, key, owner, Error::model, default, LARGEST)?]));
        }
        let mass = row(&[attribute(mass, "value", owner, Error::model, None, LARGEST)?]);
        self.xml.open("inertial", &[]);
        self.origin(node, owner, Error::model)?;
        self.xml.empty("mass", &[("value", &mass)]);
        let moments: Vec<(&str, &str)> = keys.into_iter().zip(moments.iter().map(String::as_str)).collect();
        self.xml.empty("inertia", &moments);
        self.xml.close("inertial");
        Ok(())
    }

    fn origin(&mut self, node: Node<'_, '_>, owner: &str, kind: Kind) -> Result<()> {
        let Some(origin) = child(node, "origin") else { return Ok(()) };
        let numbers = |key: &str| {
            let text = origin.attribute(key).unwrap_or("0 0 0");
            parse::<3>(text, &format!("{owner}: '{key}' of <origin>"), kind, LARGEST)
        };
        let (xyz, rpy) = (row(&numbers("xyz")?), row(&numbers("rpy")?));
        self.xml.empty("origin", &[("xyz", &xyz), ("rpy", &rpy)]);
        Ok(())
    }
}
