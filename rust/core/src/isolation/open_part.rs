//! The part of a pair's wrenches that the torques leave open, closed by what is known of contacts: an external force
//! has no moment, so each wrench is a force on a line.

use nalgebra::{Matrix2, Vector2, Vector6};

use super::conics::{common_zeros, Conic};
use super::pair::{Open, PairEstimate};

/// Solutions at most.
const MOST: usize = 5;
/// Steps of Gauss and Newton.
const STEPS: usize = 12;
const STANDSTILL: f64 = 1e-13;

/// Every way to close a deficit of two at most.
pub(super) fn close(pair: &PairEstimate) -> ([Open; MOST], usize) {
    let mut closed = ([[0.0; 6]; MOST], 0);
    match pair.deficit {
        0 => closed.1 = 1,
        1 => close_one(pair, &mut closed),
        2 => {
            let [first, second] = conics(pair);
            let (zeros, count) = common_zeros(&first, &second);
            for zero in &zeros[..count] {
                push(&mut closed, &[zero.x, zero.y]);
            }
        }
        _ => {}
    }
    closed
}

fn push(closed: &mut ([Open; MOST], usize), shares: &[f64]) {
    if closed.1 < MOST {
        closed.0[closed.1][..shares.len()].copy_from_slice(shares);
        closed.1 += 1;
    }
}

/// `force . moment` of a wrench, and the bilinear form behind it.
fn moment_form(a: &Vector6<f64>, b: &Vector6<f64>) -> f64 {
    a.fixed_rows::<3>(0).dot(&b.fixed_rows::<3>(3))
}

/// `force . moment` of both wrenches over the first two open directions.
fn conics(pair: &PairEstimate) -> [Conic; 2] {
    let [first, second] = pair.scaled(&[0.0; 6]);
    [(first, -1.0), (second, 1.0)].map(|(wrench, sign)| {
        let (a, b) = (pair.basis.column(0) * sign, pair.basis.column(1) * sign);
        let cross = |x: &Vector6<f64>, y: &Vector6<f64>| moment_form(x, y) + moment_form(y, x);
        let (xx, xy, yy) = (moment_form(&a, &a), 0.5 * cross(&a, &b), moment_form(&b, &b));
        Conic {
            quadratic: Matrix2::new(xx, xy, xy, yy),
            linear: Vector2::new(cross(&wrench, &a), cross(&wrench, &b)),
            constant: moment_form(&wrench, &wrench),
        }
    })
}

/// One open direction and two conditions: least squares from the zeros of either.
fn close_one(pair: &PairEstimate, closed: &mut ([Open; MOST], usize)) {
    // Coefficients of both conditions in rising order.
    let conditions = conics(pair).map(|conic| [conic.constant, conic.linear.x, conic.quadratic[(0, 0)]]);
    for [c, b, a] in conditions {
        let root = b * b - 4.0 * a * c;
        // The extremum where rounding has lifted the zero off the axis.
        let q = -0.5 * (b + root.max(0.0).sqrt().copysign(b));
        for start in [q / a, if root > 0.0 { c / q } else { f64::NAN }] {
            let Some(share) = least_squares(&conditions, start) else { continue };
            let near = |other: &Open| (other[0] - share).abs() <= 1e-6 * (1.0 + share.abs());
            if !closed.0[..closed.1].iter().any(near) {
                push(closed, &[share]);
            }
        }
    }
}

fn least_squares(conditions: &[[f64; 3]; 2], mut share: f64) -> Option<f64> {
    for _ in 0..STEPS {
        let (mut slope, mut residual) = (0.0, 0.0);
        for [c, b, a] in conditions {
            let gradient = b + 2.0 * a * share;
            slope += gradient * gradient;
            residual += gradient * (c + share * (b + share * a));
        }
        let step = residual / slope;
        share -= step;
        if !share.is_finite() {
            return None;
        }
        if step.abs() <= STANDSTILL * (1.0 + share.abs()) {
            break;
        }
    }
    Some(share)
}

/// The nearest way, by Newton's steps of least norm, to close a deficit of more than two from near `open`.
pub(super) fn close_near(pair: &PairEstimate, mut open: Open) -> Option<Open> {
    for _ in 0..STEPS {
        let [first, second] = pair.scaled(&open);
        let values = Vector2::new(moment_form(&first, &first), moment_form(&second, &second));
        let size = first.norm_squared() + second.norm_squared();
        if values.amax() <= STANDSTILL * size {
            return Some(open);
        }
        let mut gradients = [[0.0; 6]; 2];
        for (i, column) in pair.basis.column_iter().enumerate().take(pair.deficit) {
            let column = column.into_owned();
            gradients[0][i] = -moment_form(&first, &column) - moment_form(&column, &first);
            gradients[1][i] = moment_form(&second, &column) + moment_form(&column, &second);
        }
        let dot = |a: &Open, b: &Open| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        let (xx, xy, yy) = (
            dot(&gradients[0], &gradients[0]),
            dot(&gradients[0], &gradients[1]),
            dot(&gradients[1], &gradients[1]),
        );
        let shares = Matrix2::new(xx, xy, xy, yy).try_inverse()? * values;
        for (i, open) in open.iter_mut().enumerate() {
            *open -= gradients[0][i] * shares.x + gradients[1][i] * shares.y;
        }
    }
    None
}
