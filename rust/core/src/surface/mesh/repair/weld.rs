//! Merging of vertices that are the same point.

use std::collections::hash_map::{Entry, HashMap};

use nalgebra::Vector3;

/// Merges vertices nearer than `tolerance`; returns those kept and, for each old vertex, its new index.
pub(crate) fn weld(vertices: &[Vector3<f64>], tolerance: f64) -> (Vec<Vector3<f64>>, Vec<u32>) {
    let mut kept: Vec<Vector3<f64>> = Vec::with_capacity(vertices.len());
    let mut exact: HashMap<[u64; 3], u32> = HashMap::with_capacity(vertices.len());
    let mut cells: HashMap<[i64; 3], Vec<u32>> = HashMap::new();
    let cells_from = vertices.iter().fold(Vector3::repeat(f64::INFINITY), |low, v| low.inf(v));
    let key = |v: &Vector3<f64>| key(&(v - cells_from), CELL * tolerance);
    let index = vertices
        .iter()
        .map(|v| {
            // Adding zero makes one zero of the two.
            let entry = match exact.entry([0, 1, 2].map(|k| (v[k] + 0.0).to_bits())) {
                Entry::Occupied(entry) => return *entry.get(),
                Entry::Vacant(entry) => entry,
            };
            let near = (tolerance > 0.0).then(|| find(&cells, &kept, v, tolerance, key)).flatten();
            *entry.insert(near.unwrap_or_else(|| {
                let new = kept.len() as u32;
                kept.push(*v);
                if tolerance > 0.0 {
                    cells.entry(key(v)).or_default().push(new);
                }
                new
            }))
        })
        .collect();
    (kept, index)
}

/// Edge of the cells in which near vertices are looked for [tolerances].
const CELL: f64 = 16.0;

/// The cell of a place that is not negative: a mesh far from the origin must not be all in one.
fn key(v: &Vector3<f64>, cell: f64) -> [i64; 3] {
    [0, 1, 2].map(|k| (v[k] / cell).floor() as i64)
}

fn find(
    cells: &HashMap<[i64; 3], Vec<u32>>,
    kept: &[Vector3<f64>],
    v: &Vector3<f64>,
    tolerance: f64,
    key: impl Fn(&Vector3<f64>) -> [i64; 3],
) -> Option<u32> {
    let low = key(&v.add_scalar(-tolerance));
    let high = key(&v.add_scalar(tolerance));
    for x in low[0]..=high[0] {
        for y in low[1]..=high[1] {
            for z in low[2]..=high[2] {
                let near = cells.get(&[x, y, z]).into_iter().flatten();
                if let Some(&i) = near.into_iter().find(|&&i| (kept[i as usize] - v).norm() <= tolerance) {
                    return Some(i);
                }
            }
        }
    }
    None
}
