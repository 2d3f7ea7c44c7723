//! Where a line crosses a triangle, watertight.
//!
//! Vertices are sheared so that the line becomes the third axis (Woop, Benthin and Wald, "Watertight ray/triangle
//! intersection", 2013). A triangle is crossed if its outline winds around the origin of the remaining plane. The
//! winding is counted as in the crossing number of polygons: an edge counts if it passes from `y < 0` to `y >= 0` at
//! `x > 0`, and minus one the other way round. Whether it does is decided from its two vertices alone, and exactly
//! opposite for the opposite direction, so over a mesh that uses each edge in both directions the counts cancel
//! whatever the rounding: as many crossings in as out, for lines through edges, vertices or in planes of faces too.
//! The sign of the orientation is that of the exact value for the sheared vertices, so the counts are those of a real
//! surface, displaced by rounding, and in and out alternate along the line wherever it does not meet itself.

use nalgebra::Vector3;

/// A line sheared onto axis `K`.
pub(crate) struct Line<const K: usize> {
    origin: Vector3<f64>,
    shear: [f64; 2],
    inverse: f64,
}

impl<const K: usize> Line<K> {
    pub fn new(origin: &Vector3<f64>, direction: &Vector3<f64>) -> Self {
        let inverse = 1.0 / direction[K];
        let shear = [direction[(K + 1) % 3] / direction[K], direction[(K + 2) % 3] / direction[K]];
        Line { origin: *origin, shear, inverse }
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
    pub fn cross(&self, [a, b, c]: &[Vector3<f64>; 3]) -> Option<(f64, bool)> {
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
        let z = if sum > 0.0 { z_ab + (z_ca - z_ab) * (x_ab / sum) } else { z_ab };
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
    (p, ((a_high * b_high - p) + a_high * b_low + a_low * b_high) + a_low * b_low)
}

/// Veltkamp's split into numbers of 26 bits.
fn halves(a: f64) -> (f64, f64) {
    let scaled = a * 134_217_729.0;
    let high = scaled - (scaled - a);
    (high, a - high)
}
