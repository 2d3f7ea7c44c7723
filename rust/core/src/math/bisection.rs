//! The place where a condition ceases to hold.

/// Rounds of bisection; each halves the interval, and so many leave only rounding.
const ROUNDS: usize = 60;

/// Where in an interval a condition ceases to hold that holds below and not above; an end of the interval where it holds
/// throughout or nowhere.
pub(crate) fn last_where(interval: [f64; 2], holds: impl Fn(f64) -> bool) -> f64 {
    last_where_after(ROUNDS, interval, holds)
}

/// The same after so many rounds, each of which halves the error.
pub(crate) fn last_where_after(rounds: usize, interval: [f64; 2], holds: impl Fn(f64) -> bool) -> f64 {
    let [mut low, mut high] = interval;
    for _ in 0..rounds {
        let middle = 0.5 * (low + high);
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::{last_where, last_where_after};

    #[test]
    fn roots_and_ends_are_found() {
        assert!((last_where([0.0, 2.0], |x| x * x < 2.0) - 2.0_f64.sqrt()).abs() < 1e-15);
        assert_eq!(last_where_after(2, [0.0, 4.0], |x| x < 1.7), 1.5);
        assert!((last_where([1.0, 4.0], |_| true) - 4.0).abs() < 1e-15);
        assert!((last_where([1.0, 4.0], |_| false) - 1.0).abs() < 1e-15);
    }
}
