//! The chi-square distribution, as far as tests of a misfit need it.

use super::bisection::last_where;

/// Quantile of the standard normal distribution that belongs to [`upper_limit`]: 99 %.
const NORMAL_QUANTILE: f64 = 2.326;
/// Relative error at which a series ends.
const ENOUGH: f64 = 1e-12;
const MOST_TERMS: usize = 500;
/// No Gaussian error is so many squared standard deviations large.
pub(crate) const LARGEST: f64 = 1600.0;

/// The value that a chi-square of `checks` degrees of freedom stays below in 99 % of cases, by the cube-root
/// approximation of Wilson and Hilferty (1931), within 2 % for one degree and better for more.
pub(crate) fn upper_limit(checks: usize) -> f64 {
    let checks = checks.max(1) as f64;
    let variance = 2.0 / (9.0 * checks);
    checks * (1.0 - variance + NORMAL_QUANTILE * variance.sqrt()).powi(3)
}

/// So many standard deviations a Gaussian number exceeds as rarely as a chi-square of `degrees` degrees of freedom exceeds
/// `value`; none below its median. By the same approximation.
#[inline]
pub(crate) fn standard_deviations(degrees: usize, value: f64) -> f64 {
    let degrees = degrees.max(1) as f64;
    let variance = 2.0 / (9.0 * degrees);
    (((value / degrees).cbrt() - 1.0 + variance) / variance.sqrt()).max(0.0)
}

/// The probability that a chi-square of `degrees` degrees of freedom exceeds `value`: the regularised upper incomplete gamma
/// function `Q(degrees / 2, value / 2)` (Abramowitz and Stegun 6.5.29 and 6.5.31).
pub(crate) fn survival(degrees: usize, value: f64) -> f64 {
    let (a, x) = (0.5 * degrees.max(1) as f64, 0.5 * value.max(0.0));
    if x == 0.0 {
        return 1.0;
    }
    let factor = (a * x.ln() - x - ln_gamma_of_half(degrees.max(1))).exp();
    if x < a + 1.0 {
        let (mut term, mut sum) = (1.0 / a, 1.0 / a);
        for k in 1..MOST_TERMS {
            term *= x / (a + k as f64);
            sum += term;
            if term < ENOUGH * sum {
                break;
            }
        }
        return 1.0 - factor * sum;
    }
    // The continued fraction, by Lentz's method.
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (f64::MAX, 1.0 / b);
    let mut fraction = d;
    for k in 1..MOST_TERMS {
        let an = -(k as f64) * (k as f64 - a);
        b += 2.0;
        d = 1.0 / (an * d + b);
        c = b + an / c;
        fraction *= d * c;
        if (d * c - 1.0).abs() < ENOUGH {
            break;
        }
    }
    factor * fraction
}

/// The value that a chi-square of `degrees` degrees of freedom exceeds with a probability, up to [`LARGEST`].
pub(crate) fn quantile(degrees: usize, probability: f64) -> f64 {
    last_where([0.0, LARGEST], |value| survival(degrees, value) > probability)
}

/// The logarithm of `Gamma(n / 2)`.
fn ln_gamma_of_half(n: usize) -> f64 {
    let (mut a, start) =
        if n.is_multiple_of(2) { (1.0, 0.0) } else { (0.5, 0.5 * std::f64::consts::PI.ln()) };
    let mut sum = start;
    while a < 0.5 * n as f64 - 0.25 {
        sum += f64::ln(a);
        a += 1.0;
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_those_of_tables() {
        for (checks, table) in [(1, 6.635), (2, 9.210), (3, 11.345), (10, 23.209), (31, 52.191)] {
            let limit = upper_limit(checks);
            assert!((limit / table - 1.0).abs() < 0.02, "{checks}: {limit} instead of {table}");
            assert!((survival(checks, table) - 0.01).abs() < 2e-5, "{checks}");
            assert!((standard_deviations(checks, table) - 2.326).abs() < 0.03, "{checks}");
        }
    }

    #[test]
    fn tails_are_those_of_an_independent_program() {
        // scipy.stats.chi2.sf
        for (degrees, value, tail) in [
            (1, 30.0, 4.320_463_057_827_495_5e-8),
            (2, 30.0, 3.059_023_205_018_258e-7),
            (6, 45.0, 4.680_212_628_434_101e-8),
            (7, 5.0, 0.659_963_229_694_282_4),
            (7, 60.0, 1.509_555_302_298_915_4e-10),
            (32, 90.0, 2.032_156_085_687_423_8e-7),
        ] {
            assert!((survival(degrees, value) / tail - 1.0).abs() < 1e-8, "{degrees} {value}");
            assert!((quantile(degrees, tail) / value - 1.0).abs() < 1e-8, "{degrees} {value}");
        }
        assert_eq!(survival(3, 0.0), 1.0);
        assert!((quantile(3, 0.0) / LARGEST - 1.0).abs() < 0.1 && quantile(3, 1.0) < 1e-9);
    }
}
