//! What stands between a file and `urdf-rs`: every element checked, and rewritten with only what is needed.
//!
//! On its own `urdf-rs` cannot tell a missing `<inertial>` or `<limit>` from zeros, skips words that are no numbers,
//! reads "nan", refuses a whole file for an odd material, names no element in its messages, and overflows the stack
//! on deeply nested elements.

use std::collections::HashSet;
use std::fmt::Write;
use std::path::Path;

use roxmltree::{Document, Node, ParsingOptions};

use super::numbers::{attribute, parse, Kind, LARGEST};
use super::{text, UrdfGeometry};
use crate::error::{Error, Result};

pub(super) const SUPPORTED_JOINTS: &str =
    "revolute, continuous, prismatic, fixed, and a free flyer as the root";
const SHAPES: &str = "mesh, box, cylinder, sphere, capsule";

/// A URDF whose every number and name was checked.
pub(super) struct Checked {
    pub robot: urdf_rs::Robot,
    /// Links without `<inertial>`; `urdf-rs` gives them zeros.
    pub without_inertial: HashSet<String>,
}

/// Reads a file; [`Error::Model`] or [`Error::Geometry`] names the element that is wrong.
pub(super) fn read(path: &Path, role: UrdfGeometry) -> Result<Checked> {
    let shown = path.display();
    let text = text::read(path)?;
    let options = ParsingOptions { allow_dtd: true, ..ParsingOptions::default() };
    let document = Document::parse_with_options(&text, options)
        .map_err(|cause| Error::Model(format!("'{shown}' is not XML: {cause}")))?;
    let root = document.root_element();
    if !is(root, "robot") {
        let tag = root.tag_name();
        let space = tag.namespace().map(|space| format!("{{{space}}}")).unwrap_or_default();
        return Err(Error::Model(format!(
            "'{shown}' is not a URDF: its root element is <{space}{}>, not <robot>",
            tag.name()
        )));
    }
    if child(root, "link").is_none() {
        return Err(Error::Model(format!("'{shown}' has no links (a xacro file must be expanded first)")));
    }
    let name = match root.attribute("name") {
        Some(name) if !name.is_empty() => name.to_owned(),
        _ => path.file_stem().unwrap_or_default().to_string_lossy().into_owned(),
    };
    let mut clean = Clean { text: String::new(), role, without_inertial: HashSet::new() };
    clean.open("robot", &[("name", &name)]);
    for node in children(root, "link") {
        clean.link(node)?;
    }
    for node in children(root, "joint") {
        clean.joint(node)?;
    }
    clean.close("robot");
    let robot = urdf_rs::read_from_string(&clean.text)
        .map_err(|cause| Error::Model(format!("'{shown}' cannot be read: {cause}")))?;
    check_names(root, &robot)?;
    Ok(Checked { robot: urdf_rs::Robot { name, ..robot }, without_inertial: clean.without_inertial })
}

/// Names that a second pass through XML changes cannot be kept.
fn check_names(root: Node<'_, '_>, robot: &urdf_rs::Robot) -> Result<()> {
    let written = children(root, "link").chain(children(root, "joint")).map(|node| node.attribute("name"));
    let links = robot.links.iter().map(|link| &link.name);
    let read = links.chain(robot.joints.iter().map(|joint| &joint.name));
    for (written, read) in written.zip(read) {
        if written != Some(read) {
            return Err(Error::Model(format!("{written:?} cannot be a name; leave control characters out")));
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

fn row(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(|value| format!("{value:?}")).collect();
    words.join(" ")
}

/// The rewritten text.
struct Clean {
    text: String,
    role: UrdfGeometry,
    without_inertial: HashSet<String>,
}

impl Clean {
    fn open(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.start(tag, attributes);
        self.text.push('>');
    }

    fn empty(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        self.start(tag, attributes);
        self.text.push_str("/>");
    }

    fn close(&mut self, tag: &str) {
        // Writing to a String cannot fail.
        let _ = write!(self.text, "</{tag}>");
    }

    fn start(&mut self, tag: &str, attributes: &[(&str, &str)]) {
        let _ = write!(self.text, "<{tag}");
        for (key, value) in attributes {
            let _ = write!(self.text, " {key}=\"");
            for character in value.chars() {
                match character {
                    '&' => self.text.push_str("&amp;"),
                    '<' => self.text.push_str("&lt;"),
                    '>' => self.text.push_str("&gt;"),
                    '"' => self.text.push_str("&quot;"),
                    '\'' => self.text.push_str("&apos;"),
                    other => self.text.push(other),
                }
            }
            self.text.push('"');
        }
    }

    fn link(&mut self, node: Node<'_, '_>) -> Result<()> {
        let name = node.attribute("name").unwrap_or_default();
        if name.is_empty() {
            return Err(Error::Model("a <link> has no name".into()));
        }
        self.open("link", &[("name", name)]);
        match child(node, "inertial") {
            Some(inertial) => self.inertial(inertial, &format!("link '{name}'"))?,
            None => {
                self.without_inertial.insert(name.to_owned());
            }
        }
        let tag = self.role.tag();
        for shape in children(node, tag) {
            self.shape(shape, tag, &format!("link '{name}': <{tag}>"))?;
        }
        self.close("link");
        Ok(())
    }

    fn inertial(&mut self, node: Node<'_, '_>, owner: &str) -> Result<()> {
        let (Some(mass), Some(inertia)) = (child(node, "mass"), child(node, "inertia")) else {
            return Err(Error::Model(format!("{owner}: <inertial> needs <mass> and <inertia>")));
        };
        let keys = ["ixx", "ixy", "ixz", "iyy", "iyz", "izz"];
        let mut moments = Vec::with_capacity(6);
        for key in keys {
            // Products of inertia may be left out; URDF's default is zero.
            let default = if matches!(key, "ixx" | "iyy" | "izz") { None } else { Some(0.0) };
            moments.push(row(&[attribute(inertia, key, owner, Error::Model, default, LARGEST)?]));
        }
        let mass = row(&[attribute(mass, "value", owner, Error::Model, None, LARGEST)?]);
        self.open("inertial", &[]);
        self.origin(node, owner, Error::Model)?;
        self.empty("mass", &[("value", &mass)]);
        let moments: Vec<(&str, &str)> = keys.into_iter().zip(moments.iter().map(String::as_str)).collect();
        self.empty("inertia", &moments);
        self.close("inertial");
        Ok(())
    }

    fn origin(&mut self, node: Node<'_, '_>, owner: &str, kind: Kind) -> Result<()> {
        let Some(origin) = child(node, "origin") else { return Ok(()) };
        let numbers = |key: &str| {
            let text = origin.attribute(key).unwrap_or("0 0 0");
            parse::<3>(text, &format!("{owner}: '{key}' of <origin>"), kind, LARGEST)
        };
        let (xyz, rpy) = (row(&numbers("xyz")?), row(&numbers("rpy")?));
        self.empty("origin", &[("xyz", &xyz), ("rpy", &rpy)]);
        Ok(())
    }

    fn joint(&mut self, node: Node<'_, '_>) -> Result<()> {
        let name = node.attribute("name").unwrap_or_default();
        if name.is_empty() {
            return Err(Error::Model("a <joint> has no name".into()));
        }
        let owner = format!("joint '{name}'");
        let kind = node.attribute("type").unwrap_or_default();
        if !["revolute", "continuous", "prismatic", "fixed"].contains(&kind) {
            let hint = if kind == "floating" { "; for a floating base use floating_base" } else { "" };
            return Err(Error::Model(format!(
                "{owner} has the type '{kind}'; supported: {SUPPORTED_JOINTS}{hint}"
            )));
        }
        self.open("joint", &[("name", name), ("type", kind)]);
        for end in ["parent", "child"] {
            match child(node, end).and_then(|end| end.attribute("link")) {
                Some(link) if !link.is_empty() => self.empty(end, &[("link", link)]),
                _ => return Err(Error::Model(format!("{owner} needs <{end} link=\"...\"/>"))),
            }
        }
        self.origin(node, &owner, Error::Model)?;
        if kind != "fixed" {
            self.axis(node, &owner)?;
            self.limit(node, kind, &owner)?;
            if let Some(mimic) = child(node, "mimic") {
                self.empty("mimic", &[("joint", mimic.attribute("joint").unwrap_or_default())]);
            }
        }
        self.close("joint");
        Ok(())
    }

    fn axis(&mut self, node: Node<'_, '_>, owner: &str) -> Result<()> {
        let Some(axis) = child(node, "axis") else { return Ok(()) };
        let text = axis.attribute("xyz").unwrap_or_default();
        let axis = parse::<3>(text, &format!("{owner}: 'xyz' of <axis>"), Error::Model, LARGEST)?;
        let norm = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(norm > 1e-6 && norm < 1e6) {
            return Err(Error::Model(format!(
                "{owner}: <axis> must be a direction of about unit length, not '{text}'"
            )));
        }
        self.empty("axis", &[("xyz", &row(&axis))]);
        Ok(())
    }

    fn limit(&mut self, node: Node<'_, '_>, kind: &str, owner: &str) -> Result<()> {
        let Some(limit) = child(node, "limit") else {
            if kind == "continuous" {
                return Ok(());
            }
            return Err(Error::Model(format!(
                "{owner} is {kind} and needs <limit> (a revolute joint without limits is 'continuous')"
            )));
        };
        let value = |key, default| attribute(limit, key, owner, Error::Model, Some(default), f64::MAX);
        let values = [
            ("lower", value("lower", 0.0)?),
            ("upper", value("upper", 0.0)?),
            ("effort", value("effort", f64::MAX)?),
            ("velocity", value("velocity", f64::MAX)?),
        ];
        for (key, value) in &values[2..] {
            if *value < 0.0 {
                return Err(Error::Model(format!(
                    "{owner}: '{key}' of <limit> must not be negative, not {value}"
                )));
            }
        }
        let words = values.map(|(key, value)| (key, row(&[value])));
        self.empty("limit", &words.each_ref().map(|(key, word)| (*key, word.as_str())));
        Ok(())
    }

    fn shape(&mut self, node: Node<'_, '_>, tag: &str, owner: &str) -> Result<()> {
        let shapes: Vec<Node<'_, '_>> = child(node, "geometry")
            .map(|geometry| geometry.children().filter(Node::is_element).collect())
            .unwrap_or_default();
        let &[shape] = shapes.as_slice() else {
            return Err(Error::Geometry(format!("{owner} needs one <geometry> with one of {SHAPES}")));
        };
        self.open(tag, &[]);
        self.origin(node, owner, Error::Geometry)?;
        self.open("geometry", &[]);
        match shape.tag_name().name() {
            _ if shape.tag_name().namespace().is_some() => return Err(unknown_shape(shape, owner)),
            "mesh" => self.mesh(shape, owner)?,
            "box" => {
                let text = shape.attribute("size").unwrap_or_default();
                let size = parse::<3>(text, &format!("{owner}: 'size' of <box>"), Error::Geometry, LARGEST)?;
                check_positive(&size, "box", owner)?;
                self.empty("box", &[("size", &row(&size))]);
            }
            "sphere" => self.sizes(shape, owner, &["radius"])?,
            "cylinder" | "capsule" => self.sizes(shape, owner, &["radius", "length"])?,
            _ => return Err(unknown_shape(shape, owner)),
        }
        self.close("geometry");
        self.close(tag);
        Ok(())
    }

    fn sizes(&mut self, node: Node<'_, '_>, owner: &str, keys: &[&str]) -> Result<()> {
        let tag = node.tag_name().name();
        let mut values = Vec::with_capacity(keys.len());
        for key in keys {
            values.push(attribute(node, key, owner, Error::Geometry, None, LARGEST)?);
        }
        check_positive(&values, tag, owner)?;
        let words: Vec<String> = values.iter().map(|value| row(&[*value])).collect();
        let pairs: Vec<(&str, &str)> = keys.iter().copied().zip(words.iter().map(String::as_str)).collect();
        self.empty(tag, &pairs);
        Ok(())
    }

    fn mesh(&mut self, node: Node<'_, '_>, owner: &str) -> Result<()> {
        let filename = node.attribute("filename").unwrap_or_default().trim();
        if filename.is_empty() {
            return Err(Error::Geometry(format!("{owner}: <mesh> needs the attribute 'filename'")));
        }
        let text = node.attribute("scale").unwrap_or("1 1 1");
        let scale = parse::<3>(text, &format!("{owner}: 'scale' of <mesh>"), Error::Geometry, LARGEST)?;
        if scale.contains(&0.0) {
            return Err(Error::Geometry(format!(
                "{owner}: 'scale' of <mesh> must not be zero, not '{text}'"
            )));
        }
        self.empty("mesh", &[("filename", filename), ("scale", &row(&scale))]);
        Ok(())
    }
}

fn unknown_shape(node: Node<'_, '_>, owner: &str) -> Error {
    let tag = node.tag_name().name();
    Error::Geometry(format!("{owner} has the unknown shape <{tag}>; supported: {SHAPES}"))
}

fn check_positive(sizes: &[f64], tag: &str, owner: &str) -> Result<()> {
    if sizes.iter().all(|size| *size > 0.0) {
        return Ok(());
    }
    let shown: Vec<String> = sizes.iter().map(f64::to_string).collect();
    Err(Error::Geometry(format!("{owner}: the sizes of <{tag}> must be positive, not {}", shown.join(", "))))
}
