//! The common zeros of two quadratic polynomials in two unknowns: by their resultant, a quartic.

use nalgebra::{Matrix2, Vector2};

/// `a z.z` of a symmetric matrix, plus a linear and a constant term.
#[derive(Debug, Clone, Copy)]
pub(super) struct Conic {
    pub quadratic: Matrix2<f64>,
    pub linear: Vector2<f64>,
    pub constant: f64,
}

/// Turns the unknowns, so that solutions one above the other (as on the axes of symmetric cases) come apart.
const TURN: f64 = 0.7;
/// Newton's steps that polish a solution, and the relative step at which it stands still.
const POLISH: usize = 12;
const STANDSTILL: f64 = 1e-10;
/// Solutions nearer than this, relatively, are one.
const SAME: f64 = 1e-6;
/// Bisections per root: each halves the interval.
const BISECTIONS: usize = 80;

impl Conic {
    pub fn value(&self, z: &Vector2<f64>) -> f64 {
        (z.transpose() * self.quadratic * z)[0] + self.linear.dot(z) + self.constant
    }

    fn gradient(&self, z: &Vector2<f64>) -> Vector2<f64> {
        self.quadratic * z * 2.0 + self.linear
    }

    /// Coefficients of x^2, x (in powers of y), 1 (in powers of y), in the turned unknowns and of size one.
    fn in_x(&self, turn: &Matrix2<f64>) -> (f64, [f64; 2], [f64; 3]) {
        let quadratic = turn.transpose() * self.quadratic * turn;
        let linear = turn.transpose() * self.linear;
        let size = quadratic.amax().max(linear.amax()).max(self.constant.abs()).max(f64::MIN_POSITIVE);
        let s = 1.0 / size;
        (
            s * quadratic[(0, 0)],
            [s * linear.x, s * 2.0 * quadratic[(0, 1)]],
            [s * self.constant, s * linear.y, s * quadratic[(1, 1)]],
        )
    }
}

/// Up to four common zeros, and how many there are.
pub(super) fn common_zeros(first: &Conic, second: &Conic) -> ([Vector2<f64>; 4], usize) {
    let (sin, cos) = TURN.sin_cos();
    let turn = Matrix2::new(cos, -sin, sin, cos);
    let (a1, b1, c1) = first.in_x(&turn);
    let (a2, b2, c2) = second.in_x(&turn);
    // a1 second - a2 first = q(y) x + p(y), and the resultant is p^2 - q (b1 c2 - b2 c1).
    let p = [a1 * c2[0] - a2 * c1[0], a1 * c2[1] - a2 * c1[1], a1 * c2[2] - a2 * c1[2]];
    let q = [a1 * b2[0] - a2 * b1[0], a1 * b2[1] - a2 * b1[1]];
    let mut s = [0.0; 4];
    for (i, (x, y)) in b1.iter().zip(&b2).enumerate() {
        for (j, (u, w)) in c2.iter().zip(&c1).enumerate() {
            s[i + j] += x * u - y * w;
        }
    }
    let mut resultant = [0.0; 5];
    for i in 0..3 {
        for j in 0..3 {
            resultant[i + j] += p[i] * p[j];
        }
    }
    for i in 0..2 {
        for j in 0..4 {
            resultant[i + j] -= q[i] * s[j];
        }
    }
    let (roots, count) = real_roots(&resultant);
    let mut zeros = [Vector2::zeros(); 4];
    let mut found = 0;
    for &y in &roots[..count] {
        let divisor = q[0] + q[1] * y;
        let x = -(p[0] + y * (p[1] + y * p[2])) / divisor;
        let start = turn * Vector2::new(x, y);
        let Some(zero) = polish(first, second, start) else { continue };
        let near = |other: &Vector2<f64>| (other - zero).norm() <= SAME * (1.0 + zero.norm());
        if found < zeros.len() && !zeros[..found].iter().any(near) {
            zeros[found] = zero;
            found += 1;
        }
    }
    (zeros, found)
}

fn polish(first: &Conic, second: &Conic, mut z: Vector2<f64>) -> Option<Vector2<f64>> {
    for _ in 0..POLISH {
        let (g1, g2) = (first.gradient(&z), second.gradient(&z));
        let inverse = Matrix2::new(g1.x, g1.y, g2.x, g2.y).try_inverse()?;
        let step = inverse * Vector2::new(first.value(&z), second.value(&z));
        z -= step;
        if step.norm() <= STANDSTILL * (1.0 + z.norm()) {
            return Some(z);
        }
    }
    None
}

/// Real roots of a polynomial of degree four at most (coefficients in rising order), between the extrema of its
/// derivatives; a double root that rounding has lifted off the axis is given at its extremum.
fn real_roots(coefficients: &[f64; 5]) -> ([f64; 8], usize) {
    let size = coefficients.iter().fold(0.0_f64, |size, c| size.max(c.abs()));
    let mut roots = ([0.0; 8], 0);
    if !(size > 0.0 && size.is_finite()) {
        return roots;
    }
    // Cauchy's bound, kept finite where the leading coefficient vanishes.
    let lead = coefficients[4].abs().max(1e-9 * size);
    let bound = 1.0 + size / lead;
    for degree in 1..=4 {
        let mut derivative = *coefficients;
        let mut top = 4;
        for _ in degree..4 {
            for i in 0..top {
                derivative[i] = derivative[i + 1] * (i + 1) as f64;
            }
            derivative[top] = 0.0;
            top -= 1;
        }
        roots = roots_between(&derivative, bound, &roots.0[..roots.1], degree == 4);
    }
    roots
}

fn roots_between(
    polynomial: &[f64; 5],
    bound: f64,
    extrema: &[f64],
    keep_touching: bool,
) -> ([f64; 8], usize) {
    let value = |x: f64| polynomial.iter().rev().fold(0.0, |sum, c| sum * x + c);
    let scale = |x: f64| polynomial.iter().rev().fold(0.0, |sum, c| sum * x.abs() + c.abs());
    let (mut roots, mut count) = ([0.0; 8], 0);
    let mut left = -bound;
    for right in extrema.iter().copied().chain([bound]) {
        let (mut low, mut high) = (left, right);
        if value(low) * value(high) < 0.0 {
            let rising = value(high) > 0.0;
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                if (value(middle) > 0.0) == rising {
                    high = middle;
                } else {
                    low = middle;
                }
                if high - low <= f64::EPSILON * middle.abs() {
                    break;
                }
            }
            roots[count] = 0.5 * (low + high);
            count += 1;
        }
        if keep_touching && right < bound && value(right).abs() <= 1e-9 * scale(right) {
            roots[count] = right;
            count += 1;
        }
        left = right;
        if count >= 7 {
            break;
        }
    }
    (roots, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn conic(c: [f64; 6]) -> Conic {
        Conic {
            quadratic: Matrix2::new(c[0], 0.5 * c[1], 0.5 * c[1], c[2]),
            linear: Vector2::new(c[3], c[4]),
            constant: c[5],
        }
    }

    /// A conic through a point.
    fn through(mut c: [f64; 6], z: &Vector2<f64>) -> Conic {
        c[5] -= conic(c).value(z);
        conic(c)
    }

    #[test]
    fn circle_and_hyperbola() {
        let circle = conic([1.0, 0.0, 1.0, 0.0, 0.0, -2.5]);
        let (zeros, count) = common_zeros(&circle, &conic([0.0, 1.0, 0.0, 0.0, 0.0, -1.0]));
        assert_eq!(count, 4);
        for zero in zeros {
            assert!((zero.norm_squared() - 2.5).abs() < 1e-12 && (zero.x * zero.y - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn none_where_they_do_not_meet() {
        let circle = conic([1.0, 0.0, 1.0, 0.0, 0.0, -1.0]);
        assert_eq!(common_zeros(&circle, &conic([1.0, 0.0, 1.0, 0.0, 0.0, -4.0])).1, 0);
        assert_eq!(common_zeros(&circle, &conic([0.0; 6])).1, 0);
    }

    proptest! {
        #[test]
        fn a_known_zero_is_found(
            first in prop::array::uniform6(-1.0..1.0),
            second in prop::array::uniform6(-1.0..1.0),
            x in -3.0..3.0, y in -3.0..3.0,
        ) {
            let z = Vector2::new(x, y);
            let (first, second) = (through(first, &z), through(second, &z));
            let (g1, g2) = (first.gradient(&z), second.gradient(&z));
            prop_assume!((g1.x * g2.y - g1.y * g2.x).abs() > 1e-3);
            let (zeros, count) = common_zeros(&first, &second);
            let nearest = zeros[..count].iter().map(|zero| (zero - z).norm()).fold(f64::INFINITY, f64::min);
            prop_assert!(nearest < 1e-8, "{nearest}");
        }
    }
}
