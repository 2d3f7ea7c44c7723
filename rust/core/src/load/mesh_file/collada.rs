//! COLLADA meshes: every instance in the scene, with its nodes' transforms and the document's unit.

use std::collections::HashMap;
use std::f64::consts::PI;
use std::str::FromStr;

use nalgebra::{Matrix4, Rotation3, Unit, Vector3};
use roxmltree::{Document, Node, ParsingOptions};

use super::soup::Soup;
use crate::load::problem::Problem;

pub(super) type Result<T> = std::result::Result<T, String>;

/// Most XML nodes; in memory they take 300 MB.
const MOST_NODES: u32 = 1 << 22;
/// Deepest nesting of nodes; deeper can only be a loop of references.
const MAX_NESTING: usize = 64;
/// Most work, one step a number read. Each time that something is referenced counts, so that a short document whose
/// nodes hold each other twice, and those again, does not take for ever.
const MOST_WORK: usize = 50_000_000;
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

pub(super) fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    // By local name: documents come with and without the namespace.
    node.children().find(|n| n.tag_name().name() == name)
}

/// Follows references and reads numbers, as long as there is work left.
pub(super) struct Reader<'a, 'i> {
    ids: HashMap<&'a str, Node<'a, 'i>>,
    work_left: usize,
}

impl<'a, 'i> Reader<'a, 'i> {
    fn new(root: Node<'a, 'i>) -> Self {
        let ids = root.descendants().filter_map(|n| n.attribute("id").map(|id| (id, n))).collect();
        Reader { ids, work_left: MOST_WORK }
    }

    /// What an element's `url` or `source` names.
    pub fn referenced(&self, node: Node<'a, 'i>) -> Result<Node<'a, 'i>> {
        let url = node.attribute("url").or(node.attribute("source")).unwrap_or("");
        let id = url.strip_prefix('#').unwrap_or(url);
        self.ids
            .get(id)
            .copied()
            .ok_or_else(|| format!("'{url}' in <{}> names nothing", node.tag_name().name()))
    }

    /// Counts `steps` of work.
    pub fn work(&mut self, steps: usize) -> Result<()> {
        let left = self.work_left.checked_sub(steps);
        self.work_left = left.ok_or("has nodes or numbers that are used too many times; simplify it")?;
        Ok(())
    }

    /// All numbers in an element's text.
    pub fn numbers<T: FromStr>(&mut self, node: Node) -> Result<Vec<T>> {
        let mut numbers = Vec::new();
        for word in words(node) {
            self.work(1)?;
            numbers.push(number(word, node)?);
        }
        Ok(numbers)
    }

    /// The numbers in an element's text, which must be `N`.
    fn array<const N: usize>(&mut self, node: Node) -> Result<[f64; N]> {
        self.work(N)?;
        let found: Vec<f64> =
            words(node).take(N + 1).map(|word| number(word, node)).collect::<Result<_>>()?;
        found.try_into().map_err(|_| format!("<{}> needs {N} numbers", node.tag_name().name()))
    }

    fn transform(&mut self, element: Node) -> Result<Matrix4<f64>> {
        Ok(match element.tag_name().name() {
            "matrix" => Matrix4::from_row_slice(&self.array::<16>(element)?),
            "translate" => Matrix4::new_translation(&Vector3::from(self.array::<3>(element)?)),
            "scale" => Matrix4::new_nonuniform_scaling(&Vector3::from(self.array::<3>(element)?)),
            "rotate" => {
                let [x, y, z, degrees] = self.array::<4>(element)?;
                match Unit::try_new(Vector3::new(x, y, z), 0.0) {
                    Some(axis) => Rotation3::from_axis_angle(&axis, degrees * PI / 180.0).to_homogeneous(),
                    None => Matrix4::identity(),
                }
            }
            name @ ("lookat" | "skew") => return Err(format!("<{name}> transforms are not supported")),
            _ => Matrix4::identity(),
        })
    }
}

fn words<'a>(node: Node<'a, '_>) -> impl Iterator<Item = &'a str> {
    node.children().filter_map(|n| n.text()).flat_map(str::split_whitespace)
}

fn number<T: FromStr>(word: &str, node: Node) -> Result<T> {
    word.parse().map_err(|_| format!("'{word}' in <{}> is no number", node.tag_name().name()))
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
