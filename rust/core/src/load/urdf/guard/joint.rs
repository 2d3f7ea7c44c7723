//! Joints: type, ends, axis, limits.

use roxmltree::Node;

use super::clean::{child, Clean};
use super::writer::row;
use crate::error::{Error, Result};
use crate::load::urdf::numbers::{attribute, parse, LARGEST};

/// Types that are read.
pub(crate) const SUPPORTED_JOINTS: &str =
    "revolute, continuous, prismatic, fixed, and a free flyer as the root";

impl Clean {
    pub(super) fn joint(&mut self, node: Node<'_, '_>) -> Result<()> {
        let name = node.attribute("name").unwrap_or_default();
        if name.is_empty() {
            return Err(Error::model("a <joint> has no name"));
        }
        let owner = format!("joint '{name}'");
        let kind = node.attribute("type").unwrap_or_default();
        if !["revolute", "continuous", "prismatic", "fixed"].contains(&kind) {
            let hint = if kind == "floating" { "; for a floating base use floating_base" } else { "" };
            return Err(Error::model(format!(
                "{owner} has the type '{kind}'; supported: {SUPPORTED_JOINTS}{hint}"
            )));
        }
        self.xml.open("joint", &[("name", name), ("type", kind)]);
        for end in ["parent", "child"] {
            match child(node, end).and_then(|end| end.attribute("link")) {
                Some(link) if !link.is_empty() => self.xml.empty(end, &[("link", link)]),
                _ => return Err(Error::model(format!("{owner} needs <{end} link=\"...\"/>"))),
            }
        }
        self.origin(node, &owner, Error::model)?;
        if kind != "fixed" {
            self.axis(node, &owner)?;
            self.limit(node, kind, &owner)?;
            if let Some(mimic) = child(node, "mimic") {
                self.xml.empty("mimic", &[("joint", mimic.attribute("joint").unwrap_or_default())]);
            }
        }
        self.xml.close("joint");
        Ok(())
    }

    fn axis(&mut self, node: Node<'_, '_>, owner: &str) -> Result<()> {
        let Some(axis) = child(node, "axis") else { return Ok(()) };
        let text = axis.attribute("xyz").unwrap_or_default();
        let axis = parse::<3>(text, &format!("{owner}: 'xyz' of <axis>"), Error::model, LARGEST)?;
        let norm = axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        if !(norm > 1e-6 && norm < 1e6) {
            return Err(Error::model(format!(
                "{owner}: <axis> must be a direction of about unit length, not '{text}'"
            )));
        }
        self.xml.empty("axis", &[("xyz", &row(&axis))]);
        Ok(())
    }

    fn limit(&mut self, node: Node<'_, '_>, kind: &str, owner: &str) -> Result<()> {
        let Some(limit) = child(node, "limit") else {
            if kind == "continuous" {
                return Ok(());
            }
            return Err(Error::model(format!(
                "{owner} is {kind} and needs <limit> (a revolute joint without limits is 'continuous')"
            )));
        };
        let value = |key, default| attribute(limit, key, owner, Error::model, Some(default), f64::MAX);
        let values = [
            ("lower", value("lower", 0.0)?),
            ("upper", value("upper", 0.0)?),
            ("effort", value("effort", f64::MAX)?),
            ("velocity", value("velocity", f64::MAX)?),
        ];
        for (key, value) in &values[2..] {
            if *value < 0.0 {
                return Err(Error::model(format!(
                    "{owner}: '{key}' of <limit> must not be negative, not {value}"
                )));
            }
        }
        let words = values.map(|(key, value)| (key, row(&[value])));
        self.xml.empty("limit", &words.each_ref().map(|(key, word)| (*key, word.as_str())));
        Ok(())
    }
}
