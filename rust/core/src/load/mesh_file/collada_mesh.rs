//! One `<geometry>` of a COLLADA document.

use std::collections::HashMap;
use std::ops::Range;

use nalgebra::Vector3;
use roxmltree::{Node, NodeId};

use super::collada_reader::{child, Reader, Result};
use super::soup::Soup;

/// Most numbers per corner: a vertex, a normal, and a few of texture and colour.
const LARGEST_STRIDE: usize = 1 << 10;

/// The triangles of a geometry; none where it is a spline.
pub(super) fn mesh<'a, 'i>(reader: &mut Reader<'a, 'i>, geometry: Node<'a, 'i>) -> Result<Soup> {
    let mut soup = Soup::default();
    let Some(mesh) = child(geometry, "mesh") else { return Ok(soup) };
    let mut placed = HashMap::new();
    for primitive in mesh.children().filter(Node::is_element) {
        let kind = primitive.tag_name().name();
        if !["triangles", "polylist", "polygons", "tristrips", "trifans"].contains(&kind) {
            continue;
        }
        let Inputs { vertices, offset, stride } = Inputs::new(primitive)?;
        let corners =
            Corners { vertices: vertices_of(reader, vertices, &mut soup, &mut placed)?, offset, stride };
        let counts: Vec<usize> = match child(primitive, "vcount") {
            Some(vcount) => reader.numbers(vcount)?,
            None if kind == "polylist" => return Err("<polylist> has no vcount".into()),
            None => Vec::new(),
        };
        let mut counts = counts.into_iter();
        for p in primitive.children().filter(|n| n.tag_name().name() == "p") {
            let corners = corners.read(&reader.numbers::<u32>(p)?)?;
            add(kind, &corners, &mut counts, &mut soup)?;
        }
    }
    Ok(soup)
}

/// What the numbers of a primitive's `<p>` are.
struct Inputs<'a, 'i> {
    vertices: Node<'a, 'i>,
    offset: usize,
    stride: usize,
}

impl<'a, 'i> Inputs<'a, 'i> {
    fn new(primitive: Node<'a, 'i>) -> Result<Self> {
        let mut vertices = None;
        let mut stride = 1;
        for input in primitive.children().filter(|n| n.tag_name().name() == "input") {
            let text = input.attribute("offset").unwrap_or("0");
            let offset: usize = match text.trim().parse() {
                Ok(offset) if offset < LARGEST_STRIDE => offset,
                _ => return Err(format!("offset '{text}' in <input> is no number below {LARGEST_STRIDE}")),
            };
            stride = stride.max(offset + 1);
            if vertices.is_none() && input.attribute("semantic") == Some("VERTEX") {
                vertices = Some((input, offset));
            }
        }
        let (vertices, offset) =
            vertices.ok_or_else(|| format!("<{}> has no vertices", primitive.tag_name().name()))?;
        Ok(Inputs { vertices, offset, stride })
    }
}

/// Which of a primitive's numbers name vertices of the soup.
struct Corners {
    vertices: Range<u32>,
    offset: usize,
    stride: usize,
}

impl Corners {
    fn read(&self, numbers: &[u32]) -> Result<Vec<u32>> {
        numbers
            .chunks_exact(self.stride)
            .map(|corner| {
                let index = corner.get(self.offset).and_then(|&v| self.vertices.start.checked_add(v));
                index
                    .filter(|index| self.vertices.contains(index))
                    .ok_or_else(|| "has a triangle with an index out of range".to_owned())
            })
            .collect()
    }
}

/// Adds what an `<input>` names, unless it is there; returns where in the soup it is.
fn vertices_of<'a, 'i>(
    reader: &mut Reader<'a, 'i>,
    input: Node<'a, 'i>,
    soup: &mut Soup,
    placed: &mut HashMap<NodeId, Range<u32>>,
) -> Result<Range<u32>> {
    let vertices = reader.referenced(input)?;
    if let Some(range) = placed.get(&vertices.id()) {
        return Ok(range.clone());
    }
    let first = soup.vertices.len() as u32;
    for position in positions(reader, vertices)? {
        soup.add_vertex(position)?;
    }
    let range = first..soup.vertices.len() as u32;
    placed.insert(vertices.id(), range.clone());
    Ok(range)
}

fn positions<'a, 'i>(reader: &mut Reader<'a, 'i>, vertices: Node<'a, 'i>) -> Result<Vec<Vector3<f64>>> {
    let input = vertices.children().find(|n| n.attribute("semantic") == Some("POSITION"));
    let source = reader.referenced(input.ok_or("<vertices> has no positions")?)?;
    let accessor = child(source, "technique_common").and_then(|common| child(common, "accessor"));
    let accessor = accessor.ok_or("<source> has no accessor")?;
    let values: Vec<f64> = reader.numbers(reader.referenced(accessor)?)?;
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
    let found = values.get(offset..).unwrap_or_default().chunks(stride).filter_map(|c| c.first_chunk::<3>());
    let positions: Vec<_> = found.take(count).map(|&c| Vector3::from(c)).collect();
    if positions.len() < count {
        return Err(format!("has {} positions where {count} are announced", positions.len()));
    }
    Ok(positions)
}

/// Adds the triangles of one `<p>`; `counts` are the corners of the polygons still to come.
fn add(kind: &str, corners: &[u32], counts: &mut impl Iterator<Item = usize>, soup: &mut Soup) -> Result<()> {
    match kind {
        "triangles" => corners.as_chunks::<3>().0.iter().try_for_each(|&t| soup.add_triangle(t)),
        "polylist" => {
            let mut rest = corners;
            for count in counts {
                let (polygon, others) = rest.split_at_checked(count).ok_or("<polylist> is cut short")?;
                soup.add_polygon(polygon)?;
                rest = others;
            }
            Ok(())
        }
        "tristrips" => corners.windows(3).enumerate().try_for_each(|(i, w)| {
            soup.add_triangle(if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] })
        }),
        "trifans" => corners.windows(2).skip(1).try_for_each(|w| soup.add_triangle([corners[0], w[0], w[1]])),
        _ => soup.add_polygon(corners),
    }
}
