//! Wavefront OBJ: its vertices and faces. Texture, normals, groups, materials, points and lines have no part in a surface.

use std::borrow::Cow;

use nalgebra::Vector3;

use super::soup::{Soup, MOST_TRIANGLES};

type Result<T> = std::result::Result<T, String>;

/// Most corners of all faces.
const MOST_CORNERS: usize = 3 * MOST_TRIANGLES;

pub(super) fn parse(text: &str) -> Result<Soup> {
    let mut soup = Soup::default();
    // A face may come before its vertices.
    let mut corners: Vec<u32> = Vec::new();
    let mut ends: Vec<usize> = Vec::new();
    for line in lines(text) {
        let mut words = line.split('#').next().unwrap_or_default().split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                let vertex = vertex(words).ok_or_else(|| format!("'{}' is no vertex", shown(&line)))?;
                soup.add_vertex(vertex)?;
            }
            Some("f") => {
                for word in words {
                    let index = index(word, soup.vertices.len());
                    corners.push(index.ok_or_else(|| format!("'{}' is no face", shown(&line)))?);
                    if corners.len() > MOST_CORNERS {
                        return Err(format!("has faces of more than {MOST_CORNERS} corners; simplify it"));
                    }
                }
                ends.push(corners.len());
            }
            _ => {}
        }
    }
    let mut start = 0;
    for end in ends {
        soup.add_polygon(corners.get(start..end).unwrap_or_default())?;
        start = end;
    }
    Ok(soup)
}

/// Lines; a vertex or face that ends in a backslash goes on in the next.
fn lines(text: &str) -> impl Iterator<Item = Cow<'_, str>> {
    let mut lines = text.split(['\n', '\r']);
    std::iter::from_fn(move || {
        let first = lines.next()?;
        let Some(part) = continued(first).filter(|_| first.trim_start().starts_with(['v', 'f'])) else {
            return Some(first.into());
        };
        let mut joined = part.to_owned();
        for line in lines.by_ref().filter(|line| !line.is_empty()) {
            let part = continued(line);
            joined.push(' ');
            joined.push_str(part.unwrap_or(line));
            if part.is_none() {
                break;
            }
        }
        Some(joined.into())
    })
}

fn continued(line: &str) -> Option<&str> {
    line.trim_end().strip_suffix('\\')
}

fn shown(line: &str) -> String {
    line.chars().take(60).collect()
}

/// `x y z`, then nothing, a weight that divides them, or a colour.
fn vertex<'a>(mut words: impl Iterator<Item = &'a str>) -> Option<Vector3<f64>> {
    let mut number = || words.next()?.parse::<f64>().ok();
    let position = Vector3::new(number()?, number()?, number()?);
    match (words.next(), words.next()) {
        (Some(weight), None) => Some(position / weight.parse::<f64>().ok()?),
        _ => Some(position),
    }
}

/// The vertex of `vertex/texture/normal`, counted from one, or backwards from the last vertex so far.
fn index(word: &str, vertices: usize) -> Option<u32> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let index = if number < 0 { (vertices as i64).checked_add(number)? } else { number.checked_sub(1)? };
    u32::try_from(index).ok()
}
