//! All crossings of a line with a surface.

use nalgebra::Vector3;

use super::rays::{alternate, drop_hidden, sort, Ray};
use super::{crowded, union};
use crate::surface::answers::RayHit;
use crate::surface::part::Solid;

/// Crossings of a line with all parts, those inside other closed parts dropped; `false` if some did not fit, and only
/// the nearest are there.
pub(crate) fn cast(
    solids: &[Solid],
    (center, radius): (&Vector3<f64>, f64),
    origin: &Vector3<f64>,
    direction: &Vector3<f64>,
    t_min: f64,
    hits: &mut Vec<RayHit>,
) -> bool {
    let finite = origin.iter().chain(direction.iter()).all(|x| x.is_finite());
    if !finite || direction.norm_squared() == 0.0 || t_min.is_nan() {
        return true;
    }
    let start = hits.len();
    let ray = Ray { origin, direction, t_min };
    for (part, solid) in solids.iter().enumerate() {
        let own = hits.len();
        let mut fitted = true;
        ray.cross(solid, part as u32, &mut |hit| {
            fitted = hits.len() < hits.capacity();
            if fitted {
                hits.push(hit);
            }
            fitted
        });
        if !fitted {
            hits.truncate(start);
            crowded::nearest(solids, &ray, radius + center.norm(), hits);
            return false;
        }
        if let Solid::Mesh { mesh, .. } = solid {
            let out = hits[own..].iter().filter(|hit| !hit.entering).count();
            let starts_inside = 2 * out > hits.len() - own;
            sort(&mut hits[own..]);
            alternate(&mut hits[own..], mesh, starts_inside);
        }
    }
    if solids.len() > 1 && hits.len() > start + 1 {
        union::hide_inside(solids, &mut hits[start..], radius + center.norm());
        drop_hidden(start, hits);
    }
    true
}
