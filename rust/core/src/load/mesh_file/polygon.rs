//! Triangles of a polygon, concave ones too.
//!
//! Every corner is kept, those on a straight edge too, so that a mesh closes as its polygons do. (The `earcut` crate
//! drops such corners, which opens the mesh where a neighbour ends there.)

use std::collections::VecDeque;

use nalgebra::Vector3;

type Result<T> = std::result::Result<T, String>;
type Point = [f64; 2];

/// Most corners of a polygon that a fan does not fill: cutting ears takes time with their square.
const MOST_CORNERS: usize = 2048;

/// Calls `emit` with the corners of each triangle, of which there are two fewer than corners.
///
/// The polygon is projected along its normal (Newell's). Where a fan from its first corner fills it, as in every convex
/// polygon, the triangles are that fan; otherwise ears are cut (Meisters 1975). A polygon that meets itself, which has no
/// right answer, gets triangles that keep its edges.
pub(super) fn triangulate(
    corners: &[Vector3<f64>],
    emit: &mut impl FnMut([usize; 3]) -> Result<()>,
) -> Result<()> {
    let points = project(corners);
    let mut fan = (2..points.len()).map(|i| [0, i - 1, i]);
    if fan.clone().all(|[a, b, c]| turn(&points[a], &points[b], &points[c]) >= 0.0) {
        return fan.try_for_each(emit);
    }
    if points.len() > MOST_CORNERS {
        return Err(format!(
            "has a concave face of {} corners; at most {MOST_CORNERS} are supported",
            points.len()
        ));
    }
    Outline::new(&points).cut(emit)
}

/// The corners along two of the three axes, so that they run counter-clockwise.
fn project(corners: &[Vector3<f64>]) -> Vec<Point> {
    let Some(first) = corners.first() else { return Vec::new() };
    // From one of the corners, so that a polygon far away loses no precision.
    let at = |v: &Vector3<f64>| v - first;
    let normal: Vector3<f64> = corners.windows(2).map(|pair| at(&pair[0]).cross(&at(&pair[1]))).sum();
    let axis = normal.iamax();
    let (mut u, mut v) = ((axis + 1) % 3, (axis + 2) % 3);
    if normal[axis] < 0.0 {
        (u, v) = (v, u);
    }
    corners.iter().map(at).map(|p| [p[u], p[v]]).collect()
}

/// Twice the area of a triangle, positive if counter-clockwise.
fn turn(a: &Point, b: &Point, c: &Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// What is left of a polygon.
struct Outline<'a> {
    points: &'a [Point],
    previous: Vec<usize>,
    next: Vec<usize>,
    left: usize,
    /// Corners at which it does not turn left: only such a corner can lie in an ear.
    reflex: Vec<bool>,
}

impl<'a> Outline<'a> {
    fn new(points: &'a [Point]) -> Self {
        let n = points.len();
        let mut outline = Outline {
            points,
            previous: (0..n).map(|i| (i + n - 1) % n).collect(),
            next: (0..n).map(|i| (i + 1) % n).collect(),
            left: n,
            reflex: vec![false; n],
        };
        (0..n).for_each(|i| outline.reflex[i] = outline.turn_at(i) <= 0.0);
        outline
    }

    fn turn_at(&self, i: usize) -> f64 {
        turn(&self.points[self.previous[i]], &self.points[i], &self.points[self.next[i]])
    }

    /// Whether the triangle at corner `i` lies in the polygon.
    fn is_ear(&self, i: usize) -> bool {
        if self.reflex[i] {
            return false;
        }
        let triangle = [self.previous[i], i, self.next[i]];
        let [a, b, c] = triangle.map(|corner| &self.points[corner]);
        let mut other = self.next[triangle[2]];
        while other != triangle[0] {
            let p = &self.points[other];
            // A corner at the same place as one of the triangle's is where two edges of the polygon meet.
            let inside = self.reflex[other]
                && turn(a, b, p) >= 0.0
                && turn(b, c, p) >= 0.0
                && turn(c, a, p) >= 0.0
                && ![a, b, c].contains(&p);
            if inside {
                return false;
            }
            other = self.next[other];
        }
        true
    }

    fn cut(mut self, emit: &mut impl FnMut([usize; 3]) -> Result<()>) -> Result<()> {
        let mut ears: VecDeque<usize> = (0..self.points.len()).filter(|&i| self.is_ear(i)).collect();
        let mut gone = vec![false; self.points.len()];
        let mut start = 0;
        while let Some(i) = ears.pop_front().filter(|_| self.left > 3) {
            // What was one may be cut, or be one no more.
            if gone[i] || !self.is_ear(i) {
                continue;
            }
            let (before, after) = (self.previous[i], self.next[i]);
            emit([before, i, after])?;
            gone[i] = true;
            self.left -= 1;
            self.next[before] = after;
            self.previous[after] = before;
            for corner in [before, after] {
                self.reflex[corner] = self.turn_at(corner) <= 0.0;
                if self.is_ear(corner) {
                    ears.push_back(corner);
                }
            }
            start = after;
        }
        // The last triangle, or what has no ear: flat, or it meets itself.
        let mut at = self.next[start];
        for _ in 2..self.left {
            emit([start, at, self.next[at]])?;
            at = self.next[at];
        }
        Ok(())
    }
}
