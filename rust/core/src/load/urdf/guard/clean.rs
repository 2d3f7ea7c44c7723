//! The text that is written anew, and what is read of the old one.

use std::collections::HashSet;

use roxmltree::Node;

use super::writer::{row, Writer};
use crate::error::{Error, Result};
use crate::load::urdf::numbers::{parse, Kind, LARGEST};
use crate::load::urdf::options::UrdfGeometry;

/// Whether a node is an element of a name, in no namespace.
pub(super) fn is(node: Node<'_, '_>, tag: &str) -> bool {
    node.is_element() && node.tag_name().namespace().is_none() && node.tag_name().name() == tag
}

/// The child elements of a name.
pub(super) fn children<'a, 'i>(node: Node<'a, 'i>, tag: &'static str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |child| is(*child, tag))
}

/// The first of them.
pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, tag: &'static str) -> Option<Node<'a, 'i>> {
    children(node, tag).next()
}

/// A link or joint as messages name it.
pub(super) fn element(node: Node<'_, '_>) -> String {
    let tag = node.tag_name().name();
    node.attribute("name").map_or_else(|| format!("<{tag}>"), |name| format!("{tag} '{name}'"))
}

/// The rewritten text.
pub(super) struct Clean {
    pub xml: Writer,
    pub role: UrdfGeometry,
    pub without_inertial: HashSet<String>,
    pub bad_shape: Option<Error>,
}

impl Clean {
    /// Copies the `<origin>`, where there is one.
    pub fn origin(&mut self, node: Node<'_, '_>, owner: &str, kind: Kind) -> Result<()> {
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
