//! COLLADA meshes: every instance in the scene, with its nodes' transforms and the document's unit.

use std::collections::HashMap;
use std::f64::consts::PI;

use nalgebra::{Matrix4, Rotation3, Unit, Vector3};
use roxmltree::{Document, Node};

type Soup = (Vec<Vector3<f64>>, Vec<[u32; 3]>);
type Result<T> = std::result::Result<T, String>;

/// Deepest nesting of nodes; deeper can only be a loop of references.
const MAX_NESTING: usize = 64;

/// Vertices (m) and triangles of the document's scene. The up axis is ignored, as ROS does.
pub(super) fn parse(text: &str) -> Result<Soup> {
    crate::xml_nesting::check(text)?;
    let document = Document::parse(text).map_err(|error| error.to_string())?;
    let root = document.root_element();
    let ids = root.descendants().filter_map(|n| n.attribute("id").map(|id| (id, n))).collect();
    let unit = child(root, "asset")
        .and_then(|asset| child(asset, "unit"))
        .and_then(|unit| unit.attribute("meter"))
        .map_or(Ok(1.0), |meter| {
            meter.trim().parse::<f64>().map_err(|_| format!("unit '{meter}' is no number"))
        })?;
    let mut scene = Scene { ids, meshes: HashMap::new(), vertices: Vec::new(), triangles: Vec::new() };
    let visual = child(root, "scene").and_then(|scene| child(scene, "instance_visual_scene"));
    let start = match visual {
        Some(instance) => scene.referenced(instance)?,
        // A document may leave out the scene if it is clear which one it is.
        None => root.descendants().find(|n| n.has_tag_name("visual_scene")).ok_or("has no scene")?,
    };
    scene.visit(start, &Matrix4::new_scaling(unit), 0)?;
    Ok((scene.vertices, scene.triangles))
}

fn child<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Node<'a, 'i>> {
    // By local name: documents come with and without the namespace.
    node.children().find(|n| n.tag_name().name() == name)
}

fn numbers<T: std::str::FromStr>(node: Node) -> Result<Vec<T>> {
    let text = node.children().filter_map(|n| n.text());
    text.flat_map(str::split_whitespace)
        .map(|word| {
            word.parse().map_err(|_| format!("'{word}' in <{}> is no number", node.tag_name().name()))
        })
        .collect()
}

struct Scene<'a, 'i> {
    ids: HashMap<&'a str, Node<'a, 'i>>,
    /// By the geometry's id.
    meshes: HashMap<&'a str, Soup>,
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
}

impl<'a, 'i> Scene<'a, 'i> {
    fn referenced(&self, node: Node<'a, 'i>) -> Result<Node<'a, 'i>> {
        let url = node.attribute("url").or(node.attribute("source")).unwrap_or("");
        let id = url.strip_prefix('#').unwrap_or(url);
        self.ids
            .get(id)
            .copied()
            .ok_or_else(|| format!("'{url}' in <{}> names nothing", node.tag_name().name()))
    }

    /// Adds what hangs below `node`, whose frame is `to_world` once its own transforms are applied.
    fn visit(&mut self, node: Node<'a, 'i>, to_world: &Matrix4<f64>, depth: usize) -> Result<()> {
        if depth > MAX_NESTING {
            return Err("has nodes that contain themselves".into());
        }
        let mut frame = *to_world;
        for element in node.children().filter(Node::is_element) {
            match element.tag_name().name() {
                "node" => self.visit(element, &frame, depth + 1)?,
                "instance_node" => {
                    let target = self.referenced(element)?;
                    self.visit(target, &frame, depth + 1)?;
                }
                "instance_geometry" => self.place(element, &frame)?,
                name => frame *= transform(name, element)?,
            }
        }
        Ok(())
    }

    fn place(&mut self, instance: Node<'a, 'i>, frame: &Matrix4<f64>) -> Result<()> {
        let geometry = self.referenced(instance)?;
        let id = geometry.attribute("id").unwrap_or("");
        if !self.meshes.contains_key(id) {
            let mesh = self.mesh(geometry)?;
            self.meshes.insert(id, mesh);
        }
        let (vertices, triangles) = &self.meshes[id];
        let first = self.vertices.len() as u32;
        self.vertices.extend(
            vertices.iter().map(|v| frame.fixed_view::<3, 3>(0, 0) * v + frame.fixed_view::<3, 1>(0, 3)),
        );
        // A transform that mirrors turns the triangles.
        let mirrored = frame.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
        self.triangles.extend(triangles.iter().map(|&[a, b, c]| {
            let t = if mirrored { [a, c, b] } else { [a, b, c] };
            t.map(|v| v + first)
        }));
        Ok(())
    }

    fn mesh(&self, geometry: Node<'a, 'i>) -> Result<Soup> {
        let mut soup: Soup = Default::default();
        let Some(mesh) = child(geometry, "mesh") else {
            return Ok(soup); // a spline: no surface
        };
        for primitive in mesh.children().filter(Node::is_element) {
            let kind = primitive.tag_name().name();
            if !["triangles", "polylist", "polygons", "tristrips", "trifans"].contains(&kind) {
                continue;
            }
            let inputs = || primitive.children().filter(|n| n.tag_name().name() == "input");
            let offset = |n: &Node| n.attribute("offset").and_then(|o| o.parse::<usize>().ok()).unwrap_or(0);
            let stride = inputs().map(|n| offset(&n)).max().map_or(1, |most| most + 1);
            let Some(input) = inputs().find(|n| n.attribute("semantic") == Some("VERTEX")) else {
                return Err(format!("<{kind}> has no vertices"));
            };
            let first = soup.0.len() as u32;
            soup.0.extend(self.positions(input)?);
            let counts: Option<Vec<usize>> = child(primitive, "vcount").map(numbers).transpose()?;
            for p in primitive.children().filter(|n| n.tag_name().name() == "p") {
                let indices: Vec<u32> = numbers(p)?;
                let corners: Vec<u32> =
                    indices.chunks_exact(stride).map(|c| c[offset(&input)].saturating_add(first)).collect();
                triangulate(kind, &corners, counts.as_deref(), &mut soup.1)?;
            }
        }
        match soup.1.iter().flatten().find(|&&v| v as usize >= soup.0.len()) {
            Some(_) => Err("has a triangle with an index out of range".into()),
            None => Ok(soup),
        }
    }

    fn positions(&self, input: Node<'a, 'i>) -> Result<Vec<Vector3<f64>>> {
        let vertices = self.referenced(input)?;
        let input = vertices.children().find(|n| n.attribute("semantic") == Some("POSITION"));
        let source = self.referenced(input.ok_or("<vertices> has no positions")?)?;
        let accessor = child(source, "technique_common").and_then(|common| child(common, "accessor"));
        let accessor = accessor.ok_or("<source> has no accessor")?;
        let values: Vec<f64> = numbers(self.referenced(accessor)?)?;
        let number = |name, otherwise| {
            accessor
                .attribute(name)
                .map_or(Ok(otherwise), str::parse::<usize>)
                .map_err(|_| format!("{name} is no number"))
        };
        let (stride, offset) = (number("stride", 3)?, number("offset", 0)?);
        if stride < 3 {
            return Err(format!("positions have {stride} coordinates"));
        }
        let count = number("count", values.len() / stride)?;
        let found = values.get(offset..).unwrap_or(&[]).chunks(stride).filter(|c| c.len() >= 3);
        let positions: Vec<_> = found.take(count).map(|c| Vector3::new(c[0], c[1], c[2])).collect();
        if positions.len() < count {
            return Err(format!("has {} positions where {count} are announced", positions.len()));
        }
        Ok(positions)
    }
}

/// Polygons become fans.
fn triangulate(kind: &str, p: &[u32], counts: Option<&[usize]>, out: &mut Vec<[u32; 3]>) -> Result<()> {
    let mut fan = |p: &[u32]| out.extend(p.windows(2).skip(1).map(|w| [p[0], w[0], w[1]]));
    match kind {
        "triangles" => p.chunks_exact(3).for_each(&mut fan),
        "polylist" => {
            let mut rest = p;
            for &count in counts.ok_or("<polylist> has no vcount")? {
                let (polygon, others) = rest.split_at_checked(count).ok_or("<polylist> is cut short")?;
                fan(polygon);
                rest = others;
            }
        }
        "tristrips" => {
            let strip = p.windows(3).enumerate();
            out.extend(strip.map(|(i, w)| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] }));
        }
        _ => fan(p),
    }
    Ok(())
}

fn transform(name: &str, element: Node) -> Result<Matrix4<f64>> {
    let length = match name {
        "matrix" => 16,
        "rotate" => 4,
        "translate" | "scale" => 3,
        "lookat" | "skew" => return Err(format!("<{name}> transforms are not supported")),
        _ => return Ok(Matrix4::identity()),
    };
    let v: Vec<f64> = numbers(element)?;
    if v.len() != length {
        return Err(format!("<{name}> has {} numbers instead of {length}", v.len()));
    }
    Ok(match name {
        "matrix" => Matrix4::from_row_slice(&v),
        "translate" => Matrix4::new_translation(&Vector3::new(v[0], v[1], v[2])),
        "scale" => Matrix4::new_nonuniform_scaling(&Vector3::new(v[0], v[1], v[2])),
        _ => match Unit::try_new(Vector3::new(v[0], v[1], v[2]), 0.0) {
            Some(axis) => Rotation3::from_axis_angle(&axis, v[3] * PI / 180.0).to_homogeneous(),
            None => Matrix4::identity(),
        },
    })
}
