//! What stands between a file and `urdf-rs`: every element checked, and rewritten with only what is needed.
//!
//! On its own `urdf-rs` cannot tell a missing `<inertial>` or `<limit>` from zeros, skips words that are no numbers,
//! reads "nan", refuses a whole file for an odd material, names no element in its messages, and overflows the stack
//! on deeply nested elements.

mod clean;
pub(super) mod joint;
mod link;
mod shape;
mod writer;

use std::collections::HashSet;
use std::path::Path;

use roxmltree::{Document, Node};

use self::clean::{child, children, element, is, Clean};
use self::writer::Writer;
use super::options::UrdfGeometry;
use super::text;
use crate::error::{Error, Result};
use crate::load::problem::Problem;

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
