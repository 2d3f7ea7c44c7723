//! The best force at friction's limit.
//!
//! In units in which the cone is `|(t1, t2)| <= s`, stationarity with the multiplier `m >= 0` of `|t|^2 <= s^2` reads
//!
//! ```text
//! (a_i + m) t_i = b_i - c_i s,    D s = N,    D = n - m - sum c_i^2 / (a_i + m),    N = h - sum c_i b_i / (a_i + m)
//! ```
//!
//! with gains `n` and `a`, couplings `c`, products `h` and `b`. `D` is concave, and positive at zero: it changes its sign
//! once, and above that multiplier it falls. The misfit is convex, so that one multiplier only gives `|t| = s > 0`. On
//! which side of a trial it is, two equations tell:
//!
//! * Of the tangents, `|t| = s` with `s = N / D`, where `D > 0`. Forces on the other nappe (`N < 0`) or outside the cone
//!   need a larger multiplier.
//! * Of the normal, `D s = N` with the positive `s` for which `|t| = s`, where `D` falls: that `s` is unique and falls
//!   with the multiplier, and `D s - N` is the slope of the misfit there, which rises with `s`.

use super::misfit::Misfit;

/// Most trials of a multiplier, and most turns of the direction. Even near degenerate cones, few need ten of the one and
/// three of the other.
const MOST_TRIALS: usize = 60;
const MOST_TURNS: usize = 6;
/// Share that a multiplier is known to when the direction takes over, which converges quadratically.
const CLOSE: f64 = 1e-5;
/// A turn after which another one, about as large as its square, is of no account (rad).
const LAST_TURN: f64 = 1e-6;
/// Cosine of a turn that only refines a direction, and what another one explains at least, beside a direction's.
const NEAR: f64 = 1.0 - 1e-6;
const GAIN: f64 = 1.0 + 1e-10;
/// Share of what a direction explains that turning it may cost by rounding.
const SAME: f64 = 0.999;
/// Slope of `D` above which the equation of the tangents is the better one where both hold: without tangential products,
/// that of the normal has its root where it ends.
const GENTLE: f64 = -0.5;
/// Growth of a trial where nothing else is known.
const GROWTH: f64 = 8.0;

/// A multiplier on trial.
#[derive(Debug, Clone, Copy)]
struct Trial {
    /// Of the force across the normal; its length does not matter.
    direction: Option<[f64; 2]>,
    is_too_small: bool,
    /// Newton's, to where the equation holds.
    step: Option<f64>,
}

impl Misfit {
    /// Direction across the normal of the best force at friction's limit, nearly.
    pub(super) fn limit(&self) -> [f64; 2] {
        let (mut low, mut high) = (0.0, f64::INFINITY);
        let mut multiplier = 0.0;
        let mut direction = self.products;
        for _ in 0..MOST_TRIALS {
            let trial = self.trial(multiplier);
            direction = trial.direction.unwrap_or(direction);
            *(if trial.is_too_small { &mut low } else { &mut high }) = multiplier;
            // Newton's step may lead to a root on the other nappe.
            let step = trial.step.filter(|step| trial.is_too_small == (*step > 0.0));
            let is_close = step.is_some_and(|step| step.abs() <= CLOSE * multiplier);
            if is_close || high - low <= CLOSE * low {
                break;
            }
            let next = step.map(|step| multiplier + step).filter(|next| low < *next && *next < high);
            multiplier = next.unwrap_or_else(|| between(low, high, self.normal));
        }
        unit(direction)
    }

    fn trial(&self, multiplier: f64) -> Trial {
        let Misfit { normal, across: a, coupling: c, product: h, products: b } = *self;
        let e = [(a[0] + multiplier).recip(), (a[1] + multiplier).recip()];
        let ce = [c[0] * e[0], c[1] * e[1]];
        let be = [b[0] * e[0], b[1] * e[1]];
        let d = normal - multiplier - dot(c, ce);
        let n = h - dot(c, be);
        // Derivatives of D and N.
        let (dd, dn) = (dot(ce, ce) - 1.0, dot(be, ce));
        if dd < 0.0 && !(d > 0.0 && n > 0.0 && dd > GENTLE) {
            // |be - ce s| = s, a quadratic equation in s, solved without cancellation.
            let square = dot(be, be);
            let root = (dn * dn - dd * square).sqrt();
            let s = if dn >= 0.0 { square / (dn + root) } else { (dn - root) / dd };
            let t = [be[0] - ce[0] * s, be[1] - ce[1] * s];
            let ds = -(t[0] * t[0] * e[0] + t[1] * t[1] * e[1]) / root;
            // N / s - D, which is linear in the multiplier where the coupling is small.
            let excess = n / s - d;
            let slope = dn / s - n * ds / (s * s) - dd;
            return Trial { direction: Some(t), is_too_small: excess < 0.0, step: Some(-excess / slope) };
        }
        if n <= 0.0 {
            return Trial { direction: None, is_too_small: true, step: None };
        }
        // D t, and N / |D t| - 1, which is nearly linear near a pole of t.
        let t = [be[0] * d - ce[0] * n, be[1] * d - ce[1] * n];
        let dt = [be[0] * dd - ce[0] * dn - t[0] * e[0], be[1] * dd - ce[1] * dn - t[1] * e[1]];
        let square = dot(t, t);
        let ratio = n / square.sqrt();
        let slope = ratio * (dn / n - dot(t, dt) / square);
        Trial { direction: Some(t), is_too_small: ratio < 1.0, step: Some((1.0 - ratio) / slope) }
    }

    /// Turns a direction to where the best force along `(1, x, y)` explains most: Newton's steps of the angle.
    pub(super) fn turned(&self, [mut x, mut y]: [f64; 2]) -> [f64; 2] {
        let Misfit { normal, across: a, coupling: c, product: h, products: b } = *self;
        let from = [x, y];
        for _ in 0..MOST_TURNS {
            let torque = [normal + c[0] * x + c[1] * y, c[0] + a[0] * x, c[1] + a[1] * y];
            let product = h + b[0] * x + b[1] * y;
            let gain = torque[0] + torque[1] * x + torque[2] * y;
            // Derivatives by the angle: of the product, and half that of the gain.
            let dp = b[1] * x - b[0] * y;
            let dg = torque[2] * x - torque[1] * y;
            let ddg = torque[0] - gain + a[0] * y * y + a[1] * x * x;
            // What is explained, product^2 / gain, is most where its slope is zero.
            let slope = dp * gain - product * dg;
            let curvature = (h - product) * gain + dp * dg - product * ddg;
            if curvature.is_nan() || curvature >= 0.0 {
                break;
            }
            let step = -slope / curvature;
            let length = (1.0 + step * step).sqrt();
            [x, y] = [(x - step * y) / length, (y + step * x) / length];
            if step.abs() < LAST_TURN {
                break;
            }
        }
        // Where torques hardly show some force, a step may lead to one that explains nothing.
        if self.explained([x, y]) > SAME * self.explained(from) {
            [x, y]
        } else {
            from
        }
    }

    /// The same, unless it turns far and gains nothing: of directions that explain the same, the one given is kept.
    pub(super) fn improved(&self, direction: [f64; 2]) -> [f64; 2] {
        let turned = self.turned(direction);
        let is_near = dot(turned, direction) > NEAR;
        let is_better = || self.explained(turned) > GAIN * self.explained(direction);
        if is_near || is_better() {
            turned
        } else {
            direction
        }
    }

    /// Twice what the best force along `(1, x, y)` takes off the misfit.
    fn explained(&self, direction: [f64; 2]) -> f64 {
        let (gain, product) = self.along(direction);
        product * product.abs() / gain
    }
}

/// A multiplier between two, or beyond the first one.
fn between(low: f64, high: f64, unit: f64) -> f64 {
    if high.is_infinite() {
        GROWTH * f64::max(low, unit)
    } else if low == 0.0 {
        high / (GROWTH * GROWTH)
    } else {
        (low * high).sqrt()
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// Of length one.
fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y);
    if length > 0.0 {
        [x / length, y / length]
    } else {
        [1.0, 0.0]
    }
}
