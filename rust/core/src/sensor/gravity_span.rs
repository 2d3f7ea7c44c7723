//! Whether the directions of gravity, seen by a sensor in several poses, tell its offset from the load behind it.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// A mass needs a change of gravity's direction, its centre changes about two axes; four poses leave something to check.
const LEAST_POSES: usize = 4;

/// Directions that differ by less (rad) count as one: a reading's noise tells them hardly apart.
const SAME: f64 = 0.05;

/// The spread that is needed across the main change of direction, root mean square (rad), and a good one.
const LEAST_SPREAD: f64 = 0.1;
const GOOD_SPREAD: f64 = 0.4;

/// What is missing: directions of gravity, along the sensor's axes. None where the unit vectors `directions` suffice.
pub(super) fn missing(directions: &[Vector3<f64>]) -> Option<Vec<&'static str>> {
    if spread(directions) >= LEAST_SPREAD && distinct(directions) >= LEAST_POSES {
        return None;
    }
    let mut known = directions.to_vec();
    let mut added = vec![];
    while spread(&known) < GOOD_SPREAD || distinct(&known) < LEAST_POSES {
        let left = || AXES.iter().filter(|(name, _)| !added.contains(name));
        let gain = |axis: &Vector3<f64>| {
            let with: Vec<_> = known.iter().chain([axis]).copied().collect();
            (distinct(&with), spread(&with))
        };
        let better = |a: &&(&str, Vector3<f64>), b: &&(&str, Vector3<f64>)| {
            let (a, b) = (gain(&a.1), gain(&b.1));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        };
        // Of equals the first.
        let Some((name, axis)) = left().rev().max_by(better) else { break };
        added.push(*name);
        known.push(*axis);
    }
    Some(added)
}

const AXES: [(&str, Vector3<f64>); 6] = [
    ("+x", Vector3::new(1.0, 0.0, 0.0)),
    ("-x", Vector3::new(-1.0, 0.0, 0.0)),
    ("+y", Vector3::new(0.0, 1.0, 0.0)),
    ("-y", Vector3::new(0.0, -1.0, 0.0)),
    ("+z", Vector3::new(0.0, 0.0, 1.0)),
    ("-z", Vector3::new(0.0, 0.0, -1.0)),
];

/// The root mean square change of direction across the main one: it determines the centre of mass along the main one.
fn spread(directions: &[Vector3<f64>]) -> f64 {
    let count = directions.len().max(1) as f64;
    let mean = directions.iter().sum::<Vector3<f64>>() / count;
    let scatter: Matrix3<f64> =
        directions.iter().map(|x| (x - mean) * (x - mean).transpose()).sum::<Matrix3<f64>>() / count;
    let moments = SymmetricEigen::new(scatter).eigenvalues;
    (moments.sum() - moments.max()).max(0.0).sqrt()
}

/// How many directions differ.
fn distinct(directions: &[Vector3<f64>]) -> usize {
    let mut found: Vec<&Vector3<f64>> = vec![];
    for direction in directions {
        if found.iter().all(|other| (direction - *other).norm() > SAME) {
            found.push(direction);
        }
    }
    found.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(names: &[&str]) -> Vec<Vector3<f64>> {
        let axis = |name: &&str| AXES.iter().find(|(known, _)| known == name).map(|(_, axis)| *axis);
        names.iter().map(|name| axis(name).expect("an axis")).collect()
    }

    #[test]
    fn directions_in_a_plane_suffice_and_along_a_line_do_not() {
        assert_eq!(missing(&of(&["+x", "-x", "+z", "-z"])), None);
        assert_eq!(missing(&of(&["+x", "+y", "+z", "-z"])), None);
        let named = missing(&of(&["+z", "-z", "+z", "-z"])).expect("a line");
        assert_eq!(named, ["+x", "-x"]);
    }

    #[test]
    fn poses_that_are_alike_count_once() {
        assert_eq!(missing(&of(&["+x", "+y", "+z", "+z", "+x"])).map(|named| named.len()), Some(1));
        assert_eq!(missing(&of(&["-z"; 7])).map(|named| named.len()), Some(3));
        assert_eq!(missing(&[]).map(|named| named.len()), Some(4));
    }

    #[test]
    fn a_small_tilt_is_too_little() {
        let tilted =
            (0..9).map(|k| Vector3::new(1.0, 0.06 * f64::from(k % 3), 0.06 * f64::from(k / 3)).normalize());
        assert!(missing(&tilted.collect::<Vec<_>>()).is_some());
    }
}
