//! A line that crosses a surface more often than its hits have room.

use super::rays::{alternate, drop_hidden, Ray};
use super::union;
use crate::surface::answers::RayHit;
use crate::surface::part::Solid;

/// Appends the nearest crossings, as many as fit, those inside other closed parts dropped; `size` is the surface's.
///
/// Takes time with the number of crossings and, where there are several parts, with the square of the capacity.
pub(crate) fn nearest(solids: &[Solid], ray: &Ray, size: f64, hits: &mut Vec<RayHit>) {
    let start = hits.len();
    keep_nearest(solids, ray, hits);
    hits[start..].sort_unstable_by(|a, b| a.part.cmp(&b.part).then(a.distance.total_cmp(&b.distance)));
    // What lies beyond is not there to be counted. It all comes after the hits that are, so that it puts each of them
    // into the same number of parts.
    let beyond = |part: usize, hits: &[RayHit]| {
        let kept = hits.iter().filter(|hit| hit.part as usize == part);
        ray.depth(&solids[part]) - kept.map(|hit| if hit.entering { -1 } else { 1 }).sum::<i64>()
    };
    let closed = (0..solids.len()).filter(|&part| solids[part].closed());
    let beyond_all: i64 = closed.map(|part| beyond(part, &hits[start..])).sum();
    let mut first = start;
    while let Some(part) = hits.get(first).map(|hit| hit.part) {
        let end = first + hits[first..].partition_point(|hit| hit.part == part);
        let solid = &solids[part as usize];
        if let Solid::Mesh { mesh, .. } = solid {
            alternate(&mut hits[first..end], mesh, ray.depth(solid) > 0);
        }
        let own = if solid.closed() { beyond(part as usize, &hits[start..]) } else { 0 };
        // A single part hides nothing.
        for i in (first..end).filter(|_| solids.len() > 1) {
            let depth = union::depth(solids, &hits[start..], &hits[i], size) + beyond_all - own;
            hits[i].hidden = depth > 0;
        }
        first = end;
    }
    drop_hidden(start, hits);
}

/// Appends the nearest crossings of all parts, in no order.
fn keep_nearest(solids: &[Solid], ray: &Ray, hits: &mut Vec<RayHit>) {
    let start = hits.len();
    for (part, solid) in solids.iter().enumerate() {
        ray.cross(solid, part as u32, &mut |hit| {
            if hits.len() < hits.capacity() {
                hits.push(hit);
                if hits.len() == hits.capacity() {
                    // Farthest first, which is a heap too.
                    hits[start..].sort_unstable_by(|a, b| b.distance.total_cmp(&a.distance));
                }
            } else if hits.get(start).is_some_and(|farthest| hit.distance < farthest.distance) {
                replace_farthest(&mut hits[start..], hit);
            }
            true
        });
    }
}

/// Puts a hit in place of the first of a heap, which is the farthest.
fn replace_farthest(heap: &mut [RayHit], hit: RayHit) {
    heap[0] = hit;
    let mut at = 0;
    loop {
        let farther = |a: usize, b: usize| {
            if b < heap.len() && heap[b].distance > heap[a].distance {
                b
            } else {
                a
            }
        };
        let farthest = farther(farther(at, 2 * at + 1), 2 * at + 2);
        if farthest == at {
            return;
        }
        heap.swap(at, farthest);
        at = farthest;
    }
}
