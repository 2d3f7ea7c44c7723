//! STL, binary and ASCII.

use nalgebra::Vector3;

use super::soup::Soup;

type Result<T> = std::result::Result<T, String>;

const HEADER: usize = 80;
const COUNT: usize = 4;
/// A normal, three vertices of three floats, and two more bytes.
const TRIANGLE: usize = 50;
const NORMAL: usize = 12;
const FLOAT: usize = 4;

pub(super) fn parse(bytes: &[u8]) -> Result<Soup> {
    let announced: Option<&[u8; COUNT]> = bytes.get(HEADER..).and_then(|rest| rest.first_chunk());
    let triangles = announced.map(|count| u32::from_le_bytes(*count));
    let fits = |n: u32| (HEADER + COUNT) as u64 + TRIANGLE as u64 * u64::from(n) <= bytes.len() as u64;
    // Some binary files begin as text does. Characters of text read as a count are more than any file holds.
    match triangles {
        Some(n) if fits(n) => binary(bytes.get(HEADER + COUNT..).unwrap_or_default()),
        _ if bytes.trim_ascii_start().starts_with(b"solid") => text(&String::from_utf8_lossy(bytes)),
        Some(n) => Err(format!("is cut short ({} bytes for {n} triangles)", bytes.len())),
        None => Err("is cut short (no header)".into()),
    }
}

/// All whole records: some programs write a wrong count, or end the file with a line.
fn binary(bytes: &[u8]) -> Result<Soup> {
    let mut soup = Soup::default();
    let (records, rest) = bytes.as_chunks::<TRIANGLE>();
    if !rest.trim_ascii().is_empty() {
        return Err(format!("has {} bytes after its last triangle", rest.len()));
    }
    for record in records {
        let (floats, _) = record[NORMAL..].as_chunks::<FLOAT>();
        let (vertices, _) = floats.as_chunks::<3>();
        let corners = [0, 1, 2].map(|k| vertices[k].map(f32::from_le_bytes));
        add(&mut soup, &corners)?;
    }
    Ok(soup)
}

/// Only vertices and the ends of facets and solids matter, not names and normals.
fn text(text: &str) -> Result<Soup> {
    let mut soup = Soup::default();
    let mut corners = Vec::new();
    let mut ended = true;
    for line in text.split(['\n', '\r']) {
        let mut words = line.split_ascii_whitespace();
        let keyword = words.next().unwrap_or_default().to_ascii_lowercase();
        match keyword.as_str() {
            "vertex" => {
                if corners.len() == 3 {
                    return Err("has a facet of more than three vertices".into());
                }
                corners.push(vertex(words).ok_or_else(|| {
                    format!("'{}' is no vertex", line.chars().take(60).collect::<String>())
                })?);
            }
            "endfacet" => {
                let found = corners.len();
                let corners: [[f32; 3]; 3] = std::mem::take(&mut corners)
                    .try_into()
                    .map_err(|_| format!("has a facet of {found} vertices"))?;
                add(&mut soup, &corners)?;
            }
            "solid" => ended = false,
            "endsolid" => ended = true,
            _ => {}
        }
    }
    if !ended || !corners.is_empty() {
        return Err("is cut short (no 'endsolid')".into());
    }
    Ok(soup)
}

fn vertex<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<[f32; 3]> {
    let mut number = || words.next()?.parse().ok();
    let vertex = [number()?, number()?, number()?];
    words.next().is_none().then_some(vertex)
}

fn add(soup: &mut Soup, corners: &[[f32; 3]; 3]) -> Result<()> {
    let mut triangle = [0; 3];
    for (index, corner) in triangle.iter_mut().zip(corners) {
        *index = soup.add_vertex(Vector3::from(corner.map(f64::from)))?;
    }
    soup.add_triangle(triangle)
}
