//! COLLADA meshes: every instance in the scene, with its nodes' transforms and the document's unit.

use std::collections::HashMap;

use nalgebra::Matrix4;
use roxmltree::{Document, Node, ParsingOptions};

use super::collada_reader::{child, Reader, Result};
use super::soup::Soup;
use crate::load::problem::Problem;

/// Most XML nodes; in memory they take 300 MB.
const MOST_NODES: u32 = 1 << 22;
/// Deepest nesting of nodes; deeper can only be a loop of references.
const MAX_NESTING: usize = 64;
/// Steps of a visit to an element of the scene.
const VISIT: usize = 20;

/// Vertices (m) and triangles of the document's scene. The up axis is ignored, as ROS does.
pub(super) fn parse(text: &str) -> std::result::Result<Soup, Problem> {
    crate::load::xml_limits::check(text)?;
    let options = ParsingOptions { nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(Problem::from_error)?;
    let root = document.root_element();
    let unit = child(root, "asset")
        .and_then(|asset| child(asset, "unit"))
        .and_then(|unit| unit.attribute("meter"))
        .map_or(Ok(1.0), |meter| {
            meter.trim().parse::<f64>().map_err(|_| format!("unit '{meter}' is no number"))
        })?;
    let mut reader = Reader::new(root);
    let visual = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
    let start = match visual {
        Some(instance) => reader.referenced(instance)?,
        // A document may leave out the scene if it is clear which one it is.
        None => root.descendants().find(|n| n.has_tag_name("visual_scene")).ok_or("has no scene")?,
    };
    let mut scene = Scene { meshes: HashMap::new(), placed: Soup::default() };
    scene.visit(&mut reader, start, &Matrix4::new_scaling(unit), 0)?;
    Ok(scene.placed)
}

struct Scene<'a> {
    /// By the geometry's id.
    meshes: HashMap<&'a str, Soup>,
    placed: Soup,
}

impl<'a> Scene<'a> {
    /// Adds what hangs below `node`, whose frame is `to_world` once its own transforms are applied.
    fn visit<'i>(
        &mut self,
        reader: &mut Reader<'a, 'i>,
        node: Node<'a, 'i>,
        to_world: &Matrix4<f64>,
        depth: usize,
    ) -> Result<()> {
        if depth > MAX_NESTING {
            return Err("has nodes that contain themselves".into());
        }
        let mut frame = *to_world;
        for element in node.children() {
            reader.work(VISIT)?;
            match element.tag_name().name() {
                "node" => self.visit(reader, element, &frame, depth + 1)?,
                "instance_node" => {
                    let target = reader.referenced(element)?;
                    self.visit(reader, target, &frame, depth + 1)?;
                }
                "instance_geometry" => self.place(reader, element, &frame)?,
                "" => {} // text
                _ => frame *= reader.transform(element)?,
            }
        }
        Ok(())
    }

    fn place<'i>(
        &mut self,
        reader: &mut Reader<'a, 'i>,
        instance: Node<'a, 'i>,
        frame: &Matrix4<f64>,
    ) -> Result<()> {
        let geometry = reader.referenced(instance)?;
        let id = geometry.attribute("id").unwrap_or("");
        if !self.meshes.contains_key(id) {
            let mesh = super::collada_mesh::mesh(reader, geometry)?;
            self.meshes.insert(id, mesh);
        }
        let mesh = &self.meshes[id];
        let first = self.placed.vertices.len() as u32;
        let (linear, offset) = (frame.fixed_view::<3, 3>(0, 0), frame.fixed_view::<3, 1>(0, 3));
        for vertex in &mesh.vertices {
            self.placed.add_vertex(linear * vertex + offset)?;
        }
        // A transform that mirrors turns the triangles.
        let mirrored = linear.determinant() < 0.0;
        for &[a, b, c] in &mesh.triangles {
            let t = if mirrored { [a, c, b] } else { [a, b, c] };
            self.placed.add_triangle(t.map(|v| v + first))?;
        }
        Ok(())
    }
}
