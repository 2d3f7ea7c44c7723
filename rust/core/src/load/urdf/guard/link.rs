//! Links: name, inertia, shapes.

use roxmltree::Node;

use super::clean::{child, children, element, Clean};
use super::writer::row;
use crate::error::{Error, Result};
use crate::load::urdf::numbers::{attribute, LARGEST};

impl Clean {
    pub(super) fn link(&mut self, node: Node<'_, '_>) -> Result<()> {
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
}
