//! Closest point on a mesh: depth first, nearest box first, with the best distance so far as the bound.

use nalgebra::Vector3;

use super::triangle::closest_feature;
use crate::surface::answers::ClosestPoint;
use crate::surface::mesh::bvh4::{Child, Node, STACK};
use crate::surface::mesh::Mesh;

/// Share by which single-precision rounding can overstate a squared distance, with room to spare.
const SHRINK: f32 = 1.0 - 4e-6;

impl Mesh {
    /// Replaces `best` if this mesh is nearer. `hint` is a triangle to begin with.
    pub fn closest_point(
        &self,
        p: &Vector3<f64>,
        hint: Option<usize>,
        first: usize,
        best: &mut ClosestPoint,
    ) {
        let mut nearest = best.distance * best.distance;
        let mut found = None;
        if let Some(id) = hint {
            let (point, feature) = closest_feature(p, &self.corners_of(id));
            let squared = (point - p).norm_squared();
            if squared < nearest {
                nearest = squared;
                found = Some((point, id, feature));
            }
        }
        let local = p - self.tree.center;
        let query = [local.x as f32, local.y as f32, local.z as f32];
        let mut bound = to_bound(nearest);
        let mut stack = [0u64; STACK];
        let mut height = 1; // the root, at distance 0
        while height > 0 {
            height -= 1;
            let entry = stack[height];
            if f32::from_bits((entry >> 32) as u32) > bound {
                continue;
            }
            let child = Child(entry as u32);
            if let Some(run) = child.triangles() {
                for slot in run {
                    let (point, feature) = closest_feature(p, &self.corners[slot]);
                    let squared = (point - p).norm_squared();
                    if squared < nearest {
                        nearest = squared;
                        bound = to_bound(nearest);
                        found = Some((point, self.order[slot] as usize, feature));
                    }
                }
            } else {
                let keys = ordered_children(&self.tree.nodes[child.0 as usize], &query);
                for key in keys {
                    // Farthest first, so that the nearest is on top.
                    if f32::from_bits((key >> 32) as u32) <= bound {
                        stack[height] = key;
                        height += 1;
                    }
                }
            }
        }
        if let Some((point, id, feature)) = found {
            *best = ClosestPoint {
                point,
                normal: self.normals[id],
                distance: nearest.sqrt(),
                inside: self.is_inner_side(&(p - point), id, feature),
                triangle: Some((first + id) as u32),
            };
        }
    }
}

/// A squared distance in single precision, not less than given.
#[inline]
fn to_bound(squared: f64) -> f32 {
    squared as f32 * (1.0 + 1e-6) + f32::MIN_POSITIVE
}

/// Lower bounds of the squared distances (upper half) and children (lower half), farthest first.
///
/// Bits of non-negative floats are ordered as the floats are.
#[inline]
fn ordered_children(node: &Node, query: &[f32; 3]) -> [u64; 4] {
    let mut squared = [0f32; 4];
    for (k, &x) in query.iter().enumerate() {
        for (lane, squared) in squared.iter_mut().enumerate() {
            let below = node.low[k][lane] - x;
            let above = x - node.high[k][lane];
            let gap = if below > above { below } else { above };
            let gap = if gap > 0.0 { gap } else { 0.0 };
            *squared += gap * gap;
        }
    }
    let mut keys = [0u64; 4];
    for lane in 0..4 {
        keys[lane] = u64::from((squared[lane] * SHRINK).to_bits()) << 32 | u64::from(node.child[lane].0);
    }
    for (i, j) in [(0, 1), (2, 3), (0, 2), (1, 3), (1, 2)] {
        let (a, b) = (keys[i], keys[j]);
        keys[i] = a.max(b);
        keys[j] = a.min(b);
    }
    keys
}
