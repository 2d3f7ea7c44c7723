//! All crossings of a line with a mesh, watertight.
//!
//! Vertices are sheared so that the line becomes the third axis (Woop, Benthin and Wald, "Watertight ray/triangle
//! intersection", 2013). A triangle is crossed if its outline winds around the origin of the remaining plane. The
//! winding is counted as in the crossing number of polygons: an edge counts if it passes from `y < 0` to `y >= 0` at
//! `x > 0`, and minus one the other way round. Whether it does is decided from its two vertices alone, and exactly
//! opposite for the opposite direction, so over a mesh that uses each edge in both directions the counts cancel
//! whatever the rounding: as many crossings in as out, for lines through edges, vertices or in planes of faces too.
//! The sign of the orientation is that of the exact value for the sheared vertices, so the counts are those of a real
//! surface, displaced by rounding, and in and out alternate along the line wherever it does not meet itself.

use std::cmp::Ordering;

use nalgebra::Vector3;

use super::mesh::Mesh;
use super::part::Solid;
use super::tree::{Child, Node, STACK};
use super::{union, RayHit};

/// Distances nearer than this share of the mesh's radius can be in either order.
const TIE: f64 = 1e-12;

/// Crossings of a line with all parts, those inside other closed parts dropped; `false` if some did not fit.
pub(super) fn cast(
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
    let mut fitted = true;
    for (part, solid) in solids.iter().enumerate() {
        let own = hits.len();
        let part = part as u32;
        fitted &= match solid {
            Solid::Mesh { mesh, first } => mesh.cast(origin, direction, t_min, *first, part, hits),
            Solid::Exact(placed) => placed.cast(origin, direction, t_min, part, hits),
        };
        if let Solid::Mesh { mesh, .. } = solid {
            sort(&mut hits[own..]);
            alternate(
                &mut hits[own..],
                TIE * (mesh.tree.radius + mesh.tree.center.norm()),
                mesh.closed,
            );
        }
    }
    if solids.len() > 1 && hits.len() > start + 1 {
        union::hide_inside(solids, &mut hits[start..], 1e-9 * (radius + center.norm()));
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
    fitted
}

/// Sorts by distance without allocating; equal distances keep their order in short lists, the usual case.
fn sort(hits: &mut [RayHit]) {
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

/// Puts hits at the same distance, to rounding, in an order in which the line goes in and out in turn.
fn alternate(hits: &mut [RayHit], tie: f64, closed: bool) {
    if !closed || hits.len() < 2 {
        return;
    }
    // Of a closed mesh as many come out as go in, so what comes out too often ahead was gone into before.
    let out = hits.iter().filter(|hit| !hit.entering).count();
    let mut inside = 2 * out > hits.len();
    for i in 0..hits.len() {
        if hits[i].entering == inside {
            let limit = hits[i].distance + tie;
            let other = hits[i + 1..].iter().take_while(|hit| hit.distance <= limit);
            if let Some(ahead) = other
                .map(|hit| hit.entering)
                .position(|entering| entering != inside)
            {
                let j = i + 1 + ahead;
                let (a, b) = (hits[i], hits[j]);
                hits[i] = RayHit {
                    distance: a.distance,
                    point: a.point,
                    ..b
                };
                hits[j] = RayHit {
                    distance: b.distance,
                    point: b.point,
                    ..a
                };
            }
        }
        inside = hits[i].entering;
    }
}

impl Mesh {
    fn cast(
        &self,
        origin: &Vector3<f64>,
        direction: &Vector3<f64>,
        t_min: f64,
        first: usize,
        part: u32,
        hits: &mut Vec<RayHit>,
    ) -> bool {
        let mut fitted = true;
        self.cross(origin, direction, t_min, &mut |distance, id, entering| {
            fitted = hits.len() < hits.capacity();
            if fitted {
                hits.push(RayHit {
                    distance,
                    point: origin + direction * distance,
                    normal: self.normals[id],
                    triangle: (first + id) as i64,
                    part,
                    entering,
                    hidden: false,
                });
            }
            fitted
        });
        fitted
    }

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
                let meets = slabs.meet(node);
                for (meets, child) in meets.into_iter().zip(node.child) {
                    if meets {
                        stack[height] = child.0;
                        height += 1;
                    }
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

    /// Which of the four boxes the line meets.
    #[inline]
    fn meet(&self, node: &Node) -> [bool; 4] {
        let mut near = [self.from; 4];
        let mut far = [f32::INFINITY; 4];
        for k in 0..3 {
            let (front, back) = if self.inverse[k] > 0.0 {
                (&node.low[k], &node.high[k])
            } else {
                (&node.high[k], &node.low[k])
            };
            for lane in 0..4 {
                let a = (front[lane] - self.origin[k]) * self.inverse[k];
                let b = (back[lane] - self.origin[k]) * self.inverse[k];
                near[lane] = if a > near[lane] { a } else { near[lane] };
                far[lane] = if b < far[lane] { b } else { far[lane] };
            }
        }
        let mut meets = [false; 4];
        for lane in 0..4 {
            meets[lane] = near[lane] <= far[lane];
        }
        meets
    }
}

/// A line sheared onto axis `K`.
struct Line<const K: usize> {
    origin: Vector3<f64>,
    shear: [f64; 2],
    inverse: f64,
}

impl<const K: usize> Line<K> {
    fn new(origin: &Vector3<f64>, direction: &Vector3<f64>) -> Self {
        let inverse = 1.0 / direction[K];
        let shear = [
            direction[(K + 1) % 3] / direction[K],
            direction[(K + 2) % 3] / direction[K],
        ];
        Line {
            origin: *origin,
            shear,
            inverse,
        }
    }

    /// Across the line (x, y), and along it (z). The same for a vertex in whatever triangle.
    #[inline]
    fn shear(&self, v: &Vector3<f64>) -> [f64; 3] {
        let z = v[K] - self.origin[K];
        [
            v[(K + 1) % 3] - self.origin[(K + 1) % 3] - self.shear[0] * z,
            v[(K + 2) % 3] - self.origin[(K + 2) % 3] - self.shear[1] * z,
            z,
        ]
    }

    /// Where the line crosses the triangle, and whether it goes in there.
    #[inline]
    fn cross(&self, [a, b, c]: &[Vector3<f64>; 3]) -> Option<(f64, bool)> {
        let (a, b, c) = (self.shear(a), self.shear(b), self.shear(c));
        let (up_a, up_b, up_c) = (a[1] >= 0.0, b[1] >= 0.0, c[1] >= 0.0);
        if up_a == up_b && up_b == up_c {
            return None;
        }
        if a[0] < 0.0 && b[0] < 0.0 && c[0] < 0.0 {
            return None;
        }
        // Turn so that `a` is alone on its side of y = 0.
        let (a, b, c) = if up_b == up_c {
            (a, b, c)
        } else if up_c == up_a {
            (b, c, a)
        } else {
            (c, a, b)
        };
        let ab = orient(&a, &b);
        let ca = orient(&c, &a);
        let ab_rise = b[1] - a[1];
        let ca_rise = a[1] - c[1];
        let ab_counts = (ab > 0.0) == (ab_rise > 0.0) && ab != 0.0;
        let ca_counts = (ca > 0.0) == (ca_rise > 0.0) && ca != 0.0;
        if ab_counts == ca_counts {
            return None;
        }
        let counter_clockwise = ab_counts == (ab_rise > 0.0);
        // Interpolate between the two points of the outline at y = 0, which lie on either side of x = 0: no
        // cancellation, and never beyond the triangle.
        let x_ab = (ab / ab_rise).abs();
        let x_ca = (ca / ca_rise).abs();
        let z_ab = a[2] - (b[2] - a[2]) * (a[1] / ab_rise);
        let z_ca = a[2] + (c[2] - a[2]) * (a[1] / ca_rise);
        let sum = x_ab + x_ca;
        let z = if sum > 0.0 {
            z_ab + (z_ca - z_ab) * (x_ab / sum)
        } else {
            z_ab
        };
        Some((z * self.inverse, counter_clockwise == (self.inverse < 0.0)))
    }
}

/// `x_a y_b - x_b y_a` to relative rounding, its sign exact; exactly opposite for swapped points.
#[inline]
fn orient(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    let p = a[0] * b[1];
    let q = b[0] * a[1];
    let difference = p - q;
    if difference.abs() > 1e-3 * (p.abs() + q.abs()) {
        return difference;
    }
    exact_difference(a[0], b[1], b[0], a[1])
}

/// `a b - c d` by error-free transformations (Dekker 1971, Knuth 1969).
#[cold]
fn exact_difference(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (p, p_rest) = product(a, b);
    let (q, q_rest) = product(c, d);
    let (high, low) = two_sum(p, -q);
    let (rest, last) = two_sum(p_rest, -q_rest);
    let (sum, tail) = two_sum(high, rest);
    sum + (tail + (low + last))
}

fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let from_b = sum - a;
    (sum, (a - (sum - from_b)) + (b - from_b))
}

fn product(a: f64, b: f64) -> (f64, f64) {
    let p = a * b;
    let (a_high, a_low) = halves(a);
    let (b_high, b_low) = halves(b);
    (
        p,
        ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low,
    )
}

/// Veltkamp's split into numbers of 26 bits.
fn halves(a: f64) -> (f64, f64) {
    let scaled = a * 134_217_729.0;
    let high = scaled - (scaled - a);
    (high, a - high)
}
