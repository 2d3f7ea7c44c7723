//! The chi-square distribution, as far as tests of a misfit need it.

/// Quantile of the standard normal distribution that belongs to [`upper_limit`]: 99 %.
const NORMAL_QUANTILE: f64 = 2.326;

/// The value that a chi-square of `checks` degrees of freedom stays below in 99 % of cases, by the cube-root
/// approximation of Wilson and Hilferty (1931), within 2 % for one degree and better for more.
pub(crate) fn upper_limit(checks: usize) -> f64 {
    let checks = checks.max(1) as f64;
    let variance = 2.0 / (9.0 * checks);
    checks * (1.0 - variance + NORMAL_QUANTILE * variance.sqrt()).powi(3)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_those_of_tables() {
        for (checks, table) in [(1, 6.635), (2, 9.210), (3, 11.345), (10, 23.209), (31, 52.191)] {
            let limit = upper_limit(checks);
            assert!((limit / table - 1.0).abs() < 0.02, "{checks}: {limit} instead of {table}");
        }
    }
}
