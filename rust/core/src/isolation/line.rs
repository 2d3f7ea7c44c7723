//! Intersecting the line of action with the links' surfaces (Vorndamme 2017, step 4).

use nalgebra::Vector3;

use super::result::Candidate;
use crate::robot::{Kinematics, Link, LinkIndex, Robot};
use crate::surface::RayHit;

/// Hits of one link that are kept: the nearest.
const HITS_PER_LINK: usize = 128;

/// Workspace for casting a line.
#[derive(Debug, Clone)]
pub(super) struct LineCast {
    hits: Vec<RayHit>,
    /// Whether a line since the last [`LineCast::take_overflow`] had more hits than were kept.
    overflow: bool,
}

impl LineCast {
    pub fn new() -> Self {
        Self { hits: Vec::with_capacity(HITS_PER_LINK), overflow: false }
    }

    /// Whether hits were lost since this was asked last.
    pub fn take_overflow(&mut self) -> bool {
        std::mem::take(&mut self.overflow)
    }

    /// Appends all hits of the whole line with a link, up to the capacity of `candidates`.
    pub fn cast(
        &mut self,
        robot: &Robot,
        kinematics: &Kinematics,
        link: LinkIndex,
        start: &Vector3<f64>,
        direction: &Vector3<f64>,
        candidates: &mut Vec<Candidate>,
    ) {
        let Link { surface, body, placement, .. } = &robot[link];
        let Some(surface) = surface else { return };
        let body = &kinematics.bodies[*body];
        let rotation = body.rotation * placement.rotation;
        let translation = body.position + body.rotation * placement.translation;
        let origin = rotation.tr_mul(&(start - translation));
        let along = rotation.tr_mul(direction);

        let (centre, radius) = surface.bounding_sphere();
        if (centre - origin).cross(&along).norm_squared() > radius * radius * (1.0 + 1e-9) {
            return;
        }
        // From before the surface, so that distances stay of its size.
        let before = (centre - origin).dot(&along) - 1.1 * radius;
        let from = origin + along * before;
        self.hits.clear();
        self.overflow |= !surface.cast_line_into(&from, &along, f64::NEG_INFINITY, &mut self.hits);
        for hit in &self.hits {
            if candidates.len() == candidates.capacity() {
                self.overflow = true;
                return;
            }
            candidates.push(Candidate {
                link,
                point: rotation * hit.point + translation + kinematics.origin,
                normal: rotation * hit.normal,
                pushing: hit.normal.dot(&along) < 0.0,
                distance: before + hit.distance,
            });
        }
    }
}

/// Nothing that pushes fits into a gap between two links that is narrower than this (m).
const GAP: f64 = 3e-3;

/// Whether an entry into a link lies inside another link that the same line crosses, or right behind it: no contact can
/// be there.
pub(super) fn is_covered(hits: &[Candidate], entry: &Candidate) -> bool {
    let enters =
        |hit: &&Candidate| hit.link != entry.link && hit.pushing && hit.distance < entry.distance + GAP;
    hits.iter().filter(enters).any(|enter| {
        let leaves = hits.iter().filter(|hit| hit.link == enter.link && !hit.pushing);
        let behind = leaves.map(|hit| hit.distance).filter(|distance| *distance > enter.distance);
        behind.fold(f64::INFINITY, f64::min) + GAP > entry.distance
    })
}

/// Distance of the farthest place that a line enters and that is not covered from the first, zero if there is none (m).
pub(super) fn farthest_entry(hits: &[Candidate], first: &Candidate) -> f64 {
    let open = hits.iter().filter(|hit| hit.pushing && *hit != first && !is_covered(hits, hit));
    open.map(|hit| (hit.point - first.point).norm()).fold(0.0, f64::max)
}

/// Orders hits: those where the force enters first, each kind along the force.
pub(super) fn best_first(candidates: &mut [Candidate]) {
    candidates.sort_unstable_by(|a, b| {
        b.pushing.cmp(&a.pushing).then(a.distance.total_cmp(&b.distance)).then(a.link.cmp(&b.link))
    });
}
