//! Which crossings of a line lie inside another closed part.

use crate::surface::answers::RayHit;
use crate::surface::part::Solid;

/// Faces nearer to each other than this share of the surface's size touch.
const TIE: f64 = 1e-9;

/// Marks the hits inside another closed part, by counting the crossings of each part along the line.
///
/// Faces of two parts that touch are inside their union; of faces that coincide the part with the
/// smaller index keeps its hit going in, and the one with the larger its hit coming out. Takes time with the square
/// of the number of hits, which is a handful.
pub(crate) fn hide_inside(solids: &[Solid], hits: &mut [RayHit], size: f64) {
    for i in 0..hits.len() {
        hits[i].hidden = depth(solids, hits, &hits[i], size) > 0;
    }
}

/// In how many other closed parts `hit` lies, as far as the `hits` still to come along the line tell: of each part as
/// many more come out than go in, which is never a negative number.
pub(crate) fn depth(solids: &[Solid], hits: &[RayHit], hit: &RayHit, size: f64) -> i64 {
    let tie = TIE * size;
    let others = hits.iter().filter(|other| other.part != hit.part && comes_after(other, hit, tie));
    let closed = others.filter(|other| solids[other.part as usize].closed());
    closed.map(|other| if other.entering { -1 } else { 1 }).sum()
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
