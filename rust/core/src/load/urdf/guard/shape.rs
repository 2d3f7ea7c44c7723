//! Shapes: kind and sizes.

use roxmltree::Node;

use super::clean::{child, Clean};
use super::writer::row;
use crate::error::{Error, Result};
use crate::load::urdf::numbers::{attribute, parse, LARGEST};

const SHAPES: &str = "mesh, box, cylinder, sphere, capsule";

impl Clean {
    pub(super) fn shape(&mut self, node: Node<'_, '_>, tag: &str, owner: &str) -> Result<()> {
        let shapes: Vec<Node<'_, '_>> = child(node, "geometry")
            .map(|geometry| geometry.children().filter(Node::is_element).collect())
            .unwrap_or_default();
        let &[shape] = shapes.as_slice() else {
            return Err(Error::geometry(format!("{owner} needs one <geometry> with one of {SHAPES}")));
        };
        self.xml.open(tag, &[]);
        self.origin(node, owner, Error::geometry)?;
        self.xml.open("geometry", &[]);
        match shape.tag_name().name() {
            _ if shape.tag_name().namespace().is_some() => return Err(unknown_shape(shape, owner)),
            "mesh" => self.mesh(shape, owner)?,
            "box" => {
                let text = shape.attribute("size").unwrap_or_default();
                let size = parse::<3>(text, &format!("{owner}: 'size' of <box>"), Error::geometry, LARGEST)?;
                check_positive(&size, "box", owner)?;
                self.xml.empty("box", &[("size", &row(&size))]);
            }
            "sphere" => self.sizes(shape, owner, &["radius"])?,
            "cylinder" | "capsule" => self.sizes(shape, owner, &["radius", "length"])?,
            _ => return Err(unknown_shape(shape, owner)),
        }
        self.xml.close("geometry");
        self.xml.close(tag);
        Ok(())
    }

    fn sizes(&mut self, node: Node<'_, '_>, owner: &str, keys: &[&str]) -> Result<()> {
        let tag = node.tag_name().name();
        let mut values = Vec::with_capacity(keys.len());
        for key in keys {
            values.push(attribute(node, key, owner, Error::geometry, None, LARGEST)?);
        }
        check_positive(&values, tag, owner)?;
        let words: Vec<String> = values.iter().map(|value| row(&[*value])).collect();
        let pairs: Vec<(&str, &str)> = keys.iter().copied().zip(words.iter().map(String::as_str)).collect();
        self.xml.empty(tag, &pairs);
        Ok(())
    }

    fn mesh(&mut self, node: Node<'_, '_>, owner: &str) -> Result<()> {
        let filename = node.attribute("filename").unwrap_or_default().trim();
        if filename.is_empty() {
            return Err(Error::geometry(format!("{owner}: <mesh> needs the attribute 'filename'")));
        }
        let text = node.attribute("scale").unwrap_or("1 1 1");
        let scale = parse::<3>(text, &format!("{owner}: 'scale' of <mesh>"), Error::geometry, LARGEST)?;
        if scale.contains(&0.0) {
            return Err(Error::geometry(format!(
                "{owner}: 'scale' of <mesh> must not be zero, not '{text}'"
            )));
        }
        self.xml.empty("mesh", &[("filename", filename), ("scale", &row(&scale))]);
        Ok(())
    }
}
fn unknown_shape(node: Node<'_, '_>, owner: &str) -> Error {
    let tag = node.tag_name().name();
    Error::geometry(format!("{owner} has the unknown shape <{tag}>; supported: {SHAPES}"))
}

fn check_positive(sizes: &[f64], tag: &str, owner: &str) -> Result<()> {
    if sizes.iter().all(|size| *size > 0.0) {
        return Ok(());
    }
    let shown: Vec<String> = sizes.iter().map(f64::to_string).collect();
    Err(Error::geometry(format!("{owner}: the sizes of <{tag}> must be positive, not {}", shown.join(", "))))
}
