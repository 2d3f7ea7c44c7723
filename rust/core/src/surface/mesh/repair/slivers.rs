//! Removal of triangles without area, without opening the mesh.

use std::collections::HashMap;

use nalgebra::Vector3;

/// Rounds of edge flips; each can make new slivers.
const ROUNDS: usize = 8;

/// Removes triangles with a height of at most `tolerance`, and returns how many were removed.
///
/// Of a triangle with three distinct vertices in a line, the one in the middle is inserted into the neighbour across
/// the longest edge, so that a closed mesh stays closed.
pub(crate) fn remove(vertices: &[Vector3<f64>], triangles: &mut Vec<[u32; 3]>, tolerance: f64) -> usize {
    let before = triangles.len();
    triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
    let mut removed = before - triangles.len();
    for _ in 0..ROUNDS {
        let flat: Vec<(usize, usize)> = (0..triangles.len())
            .filter_map(|i| flat(vertices, triangles[i], tolerance).map(|corner| (i, corner)))
            .collect();
        if flat.is_empty() {
            return removed;
        }
        removed += flat.len();
        flip(triangles, &flat);
    }
    let before = triangles.len();
    triangles.retain(|&t| flat(vertices, t, tolerance).is_none());
    removed + before - triangles.len()
}

/// The corner opposite to the longest edge, if the triangle is flat.
fn flat(vertices: &[Vector3<f64>], t: [u32; 3], tolerance: f64) -> Option<usize> {
    let [a, b, c] = t.map(|v| vertices[v as usize]);
    let lengths = [(c - b).norm(), (a - c).norm(), (b - a).norm()];
    let longest = (0..3).max_by(|&i, &j| lengths[i].total_cmp(&lengths[j]))?;
    let sound = (b - a).cross(&(c - a)).norm() > tolerance * lengths[longest];
    (!sound).then_some(longest)
}

/// Takes the flat triangles out and splits their neighbours.
fn flip(triangles: &mut Vec<[u32; 3]>, flat: &[(usize, usize)]) {
    let mut at_edge: HashMap<[u32; 2], Vec<usize>> = HashMap::new();
    for (i, t) in triangles.iter().enumerate() {
        for k in 0..3 {
            let (a, b) = (t[k], t[(k + 1) % 3]);
            at_edge.entry([a.min(b), a.max(b)]).or_default().push(i);
        }
    }
    let mut touched = vec![false; triangles.len()];
    let mut gone = vec![false; triangles.len()];
    let mut added = Vec::new();
    for &(i, corner) in flat {
        if touched[i] {
            continue; // next round
        }
        let t = triangles[i];
        let (middle, from, to) = (t[corner], t[(corner + 1) % 3], t[(corner + 2) % 3]);
        let neighbour = at_edge[&[from.min(to), from.max(to)]].iter().copied().find(|&j| j != i);
        if let Some(j) = neighbour {
            if touched[j] {
                continue;
            }
            touched[j] = true;
            gone[j] = true;
            let other = triangles[j];
            if !other.contains(&middle) {
                // The edge runs from other[k] to other[k + 1]; the middle goes in between.
                let k = (0..3).find(|&k| other[k] != from && other[k] != to).map_or(0, |k| (k + 1) % 3);
                let (a, b, c) = (other[k], other[(k + 1) % 3], other[(k + 2) % 3]);
                added.extend([[a, middle, c], [middle, b, c]]);
            }
        }
        touched[i] = true;
        gone[i] = true;
    }
    let mut i = 0;
    triangles.retain(|_| {
        i += 1;
        !gone[i - 1]
    });
    triangles.extend(added);
}
