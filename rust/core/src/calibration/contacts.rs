//! Contacts left in a log that should have none.

use nalgebra::DVector;

/// Residuals are compared with the median magnitude, which a few contacts do not move; 1.4826 of it is a standard
/// deviation of Gaussian errors.
const MEDIAN_TO_DEVIATION: f64 = 1.4826;
/// So many standard deviations on two joints are a contact; errors of models do not go that far together.
const LEVEL: f64 = 6.0;
/// On one joint alone friction does so where the motion turns round.
const LEVEL_ALONE: f64 = 12.0;
/// More than this share of the rows is no exception but the rule: then none is left out.
const MOST: f64 = 0.3;

/// Which rows have no contact, `margin` rows around one included.
pub(super) fn without_contact(residuals: &[DVector<f64>], margin: usize) -> Vec<bool> {
    let joints = residuals.first().map_or(0, DVector::len);
    let deviations: Vec<f64> = (0..joints)
        .map(|j| {
            let mut magnitudes: Vec<f64> = residuals.iter().map(|r| r[j].abs()).collect();
            magnitudes.sort_by(f64::total_cmp);
            MEDIAN_TO_DEVIATION * magnitudes[magnitudes.len() / 2]
        })
        .collect();
    let touched: Vec<bool> = residuals
        .iter()
        .map(|residual| {
            let levels =
                deviations.iter().zip(residual.iter()).map(|(d, r)| r.abs() / d.max(f64::MIN_POSITIVE));
            let far = levels.clone().filter(|level| *level > LEVEL).count();
            far >= 2 || levels.fold(0.0, f64::max) > LEVEL_ALONE
        })
        .collect();
    let used: Vec<bool> = (0..touched.len())
        .map(|row| {
            let around = row.saturating_sub(margin)..(row + margin + 1).min(touched.len());
            !touched[around].contains(&true)
        })
        .collect();
    let left_out = used.iter().filter(|used| !**used).count();
    if left_out as f64 > MOST * used.len() as f64 {
        vec![true; used.len()]
    } else {
        used
    }
}

/// The stretches of rows that are left out, as first and last row.
pub(super) fn stretches(used: &[bool]) -> Vec<[usize; 2]> {
    let mut stretches: Vec<[usize; 2]> = vec![];
    for (row, _) in used.iter().enumerate().filter(|(_, used)| !**used) {
        match stretches.last_mut() {
            Some(last) if last[1] + 1 == row => last[1] = row,
            _ => stretches.push([row, row]),
        }
    }
    stretches
}

#[cfg(test)]
mod tests {
    use super::*;

    fn residuals() -> Vec<DVector<f64>> {
        (0..200).map(|k| DVector::from_fn(3, |j, _| 0.1 * ((k * (j + 3)) as f64).sin())).collect()
    }

    #[test]
    fn quiet_rows_are_all_kept() {
        assert!(without_contact(&residuals(), 3).iter().all(|used| *used));
    }

    #[test]
    fn a_contact_is_left_out_with_its_surroundings() {
        let mut rows = residuals();
        for row in &mut rows[50..60] {
            row[0] += 5.0;
            row[1] -= 2.0;
        }
        let used = without_contact(&rows, 3);
        assert_eq!(stretches(&used), [[47, 62]]);
    }

    #[test]
    fn what_happens_most_of_the_time_is_no_contact() {
        let mut rows = residuals();
        for row in &mut rows[50..130] {
            row[0] += 5.0;
            row[1] -= 2.0;
        }
        assert!(without_contact(&rows, 3).iter().all(|used| *used));
    }
}
