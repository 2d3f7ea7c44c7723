//! The crossings of a line with one part, and their order.

use std::cmp::Ordering;

use nalgebra::Vector3;

use super::line::Line;
use crate::surface::answers::RayHit;
use crate::surface::mesh::bvh4::{Child, Node, STACK};
use crate::surface::mesh::Mesh;
use crate::surface::part::Solid;

/// Distances nearer than this share of the mesh's radius can be in either order.
const TIE: f64 = 1e-12;

/// Drops the hits from `start` on that are hidden, and sorts the others.
pub(super) fn drop_hidden(start: usize, hits: &mut Vec<RayHit>) {
    let mut kept = start;
    for i in start..hits.len() {
        if !hits[i].hidden {
            hits[kept] = hits[i];
            kept += 1;
        }
    }
    hits.truncate(kept);
    sort(&mut hits[start..]);
}

/// Sorts by distance without allocating; equal distances keep their order in short lists, the usual case.
pub(super) fn sort(hits: &mut [RayHit]) {
    if hits.len() > 64 {
        hits.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance));
        return;
    }
    for i in 1..hits.len() {
        let mut j = i;
        while j > 0 && hits[j - 1].distance.total_cmp(&hits[j].distance) == Ordering::Greater {
            hits.swap(j - 1, j);
            j -= 1;
        }
    }
}

/// Puts hits of a mesh at the same distance, to rounding, in an order in which the line goes in and out in turn.
pub(super) fn alternate(hits: &mut [RayHit], mesh: &Mesh, starts_inside: bool) {
    if !mesh.closed || hits.len() < 2 {
        return;
    }
    let tie = TIE * (mesh.tree.radius + mesh.tree.center.norm());
    let mut inside = starts_inside;
    for i in 0..hits.len() {
        if hits[i].entering == inside {
            let limit = hits[i].distance + tie;
            let other = hits[i + 1..].iter().take_while(|hit| hit.distance <= limit);
            if let Some(ahead) = other.map(|hit| hit.entering).position(|entering| entering != inside) {
                let j = i + 1 + ahead;
                let (a, b) = (hits[i], hits[j]);
                hits[i] = RayHit { distance: a.distance, point: a.point, ..b };
                hits[j] = RayHit { distance: b.distance, point: b.point, ..a };
            }
        }
        inside = hits[i].entering;
    }
}

/// A line from `t_min` on.
pub(crate) struct Ray<'a> {
    pub origin: &'a Vector3<f64>,
    pub direction: &'a Vector3<f64>,
    pub t_min: f64,
}

impl Ray<'_> {
    /// Calls `visit` for every crossing with a part, in no order, until it returns `false`.
    #[inline]
    pub fn cross(&self, solid: &Solid, part: u32, visit: &mut impl FnMut(RayHit) -> bool) {
        let Ray { origin, direction, t_min } = *self;
        match solid {
            Solid::Mesh { mesh, first } => {
                mesh.cross(origin, direction, t_min, &mut |distance, id, entering| {
                    visit(RayHit {
                        distance,
                        point: origin + direction * distance,
                        normal: mesh.normals[id],
                        triangle: Some((first + id) as u32),
                        part,
                        entering,
                        hidden: false,
                    })
                });
            }
            Solid::Exact(placed) => placed.cross(origin, direction, t_min, part, visit),
        }
    }

    /// By how much more often the line comes out of a part than it goes in: whether it starts inside, if that is closed.
    pub fn depth(&self, solid: &Solid) -> i64 {
        let mut depth = 0;
        self.cross(solid, 0, &mut |hit| {
            depth += if hit.entering { -1 } else { 1 };
            true
        });
        depth
    }
}

impl Mesh {
    /// Calls `visit(distance, triangle, entering)` for every crossing from `t_min` on, in no order, until it returns
    /// `false`.
    pub fn cross(
        &self,
        origin: &Vector3<f64>,
        direction: &Vector3<f64>,
        t_min: f64,
        visit: &mut impl FnMut(f64, usize, bool) -> bool,
    ) {
        match direction.iamax() {
            0 => self.cross_along::<0>(origin, direction, t_min, visit),
            1 => self.cross_along::<1>(origin, direction, t_min, visit),
            _ => self.cross_along::<2>(origin, direction, t_min, visit),
        }
    }

    /// As `cross`; `K` is the axis along which the direction is longest.
    fn cross_along<const K: usize>(
        &self,
        origin: &Vector3<f64>,
        direction: &Vector3<f64>,
        t_min: f64,
        visit: &mut impl FnMut(f64, usize, bool) -> bool,
    ) {
        // From the point of the line nearest to the centre, so that a far origin costs no precision.
        let tree = &self.tree;
        let to_center = tree.center - origin;
        let shift = to_center.dot(direction) / direction.norm_squared();
        let offset = direction * shift - to_center;
        if offset.norm_squared() > tree.radius * tree.radius * (1.0 + 1e-9) {
            return;
        }
        let line = Line::<K>::new(&(tree.center + offset), direction);
        let from = t_min - shift;
        let slabs = Slabs::new(&offset, direction, from - 1e-5 * tree.radius);
        let mut stack = [0u32; STACK];
        let mut height = 1; // the root
        while height > 0 {
            height -= 1;
            let child = Child(stack[height]);
            if let Some(run) = child.triangles() {
                for slot in run {
                    if let Some((distance, entering)) = line.cross(&self.corners[slot]) {
                        if distance >= from && !visit(distance + shift, self.order[slot] as usize, entering) {
                            return;
                        }
                    }
                }
            } else {
                let node = &tree.nodes[child.0 as usize];
                let mut meets = slabs.meet(node);
                while meets != 0 {
                    stack[height] = node.child[meets.trailing_zeros() as usize].0;
                    height += 1;
                    meets &= meets - 1;
                }
            }
        }
    }
}

/// A line in single precision for boxes; zero components of its direction are made tiny.
struct Slabs {
    origin: [f32; 3],
    inverse: [f32; 3],
    from: f32,
}

impl Slabs {
    fn new(origin: &Vector3<f64>, direction: &Vector3<f64>, from: f64) -> Self {
        Slabs {
            origin: [0, 1, 2].map(|k| origin[k] as f32),
            inverse: [0, 1, 2].map(|k| {
                let d = direction[k];
                (1.0 / if d.abs() > 1e-25 { d } else { 1e-25f64.copysign(d) }) as f32
            }),
            from: from as f32,
        }
    }

    /// Which of the four boxes the line meets, as bits.
    #[inline]
    fn meet(&self, node: &Node) -> u32 {
        let mut near = [self.from; 4];
        let mut far = [f32::INFINITY; 4];
        for k in 0..3 {
            let (origin, inverse) = (self.origin[k], self.inverse[k]);
            let (first, last) = if inverse > 0.0 { (&node.low, &node.high) } else { (&node.high, &node.low) };
            near = larger(near, first[k].map(|x| (x - origin) * inverse));
            far = smaller(far, last[k].map(|x| (x - origin) * inverse));
        }
        (0..4).fold(0, |bits, lane| bits | u32::from(near[lane] <= far[lane]) << lane)
    }
}

#[inline]
fn smaller(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|i| if a[i] < b[i] { a[i] } else { b[i] })
}

#[inline]
fn larger(a: [f32; 4], b: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|i| if a[i] > b[i] { a[i] } else { b[i] })
}
