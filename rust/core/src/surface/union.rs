//! Which crossings of a line lie inside another closed part.

use super::part::Solid;
use super::RayHit;

/// Marks the hits inside another closed part, by counting the crossings of each part along the line.
///
/// Faces of two parts that touch within `tie` are inside their union; of faces that coincide the part with the
/// smaller index keeps its hit going in, and the one with the larger its hit coming out. Takes time with the square
/// of the number of hits, which is a handful.
pub(super) fn hide_inside(solids: &[Solid], hits: &mut [RayHit], tie: f64) {
    for i in 0..hits.len() {
        let hit = hits[i];
        let mut others = hits.iter().filter(|other| other.part != hit.part);
        // Crossings of another part still to come, seen from this hit: more out than in means that it is inside.
        // One part at a time, as its count is positive or zero, never negative, where it is closed.
        let mut depth = 0i64;
        others.by_ref().filter(|other| comes_after(other, &hit, tie)).for_each(|other| {
            if solids[other.part as usize].closed() {
                depth += if other.entering { -1 } else { 1 };
            }
        });
        hits[i].hidden = depth > 0;
    }
}

/// Whether `other` comes after `hit` along the line, where within `tie` going in comes before coming out.
fn comes_after(other: &RayHit, hit: &RayHit, tie: f64) -> bool {
    let apart = other.distance - hit.distance;
    if apart.abs() > tie {
        return apart > 0.0;
    }
    match (other.entering, hit.entering) {
        (false, true) => true,
        (true, false) => false,
        _ => other.part > hit.part,
    }
}
