//! Dynamics, Jacobians and the momentum observer.

use contactsense::observer::MomentumObserver;
use contactsense::Sample;

use super::data::{read, robot, Dynamics, Motion};

/// Relative to the greatest number of a kind.
const EXACT: f64 = 1e-10;

fn close<'a>(ours: impl IntoIterator<Item = &'a f64>, theirs: impl IntoIterator<Item = &'a f64>, what: &str) {
    let pairs: Vec<_> = ours.into_iter().zip(theirs).collect();
    let greatest = pairs.iter().map(|(_, theirs)| theirs.abs()).fold(1.0, f64::max);
    let error = pairs.iter().map(|(ours, theirs)| (*ours - *theirs).abs()).fold(0.0, f64::max);
    assert!(!pairs.is_empty() && error < EXACT * greatest, "{what}: {error:e}");
}

#[test]
fn dynamics_are_pinocchios() {
    for name in ["iiwa14", "atlas"] {
        let robot = robot(name);
        for state in read::<Dynamics>(&format!("dynamics_{name}")).states {
            let (q, v, a) = (&state.q, &state.v, &state.a);
            let mass = robot.mass_matrix(q).expect("valid input");
            // Symmetric: rows or columns are the same.
            close(&mass, state.mass_matrix.iter().flatten(), "mass matrix");
            let still = vec![0.0; robot.nv()];
            close(&robot.inverse_dynamics(q, v, &still).expect("valid input"), &state.bias, "bias");
            let tau = robot.inverse_dynamics(q, v, a).expect("valid input");
            close(&tau, &state.inverse_dynamics, "inverse dynamics");
            let link = robot.link(&state.link).expect("a link of the robot");
            let jacobian = robot.jacobian(q, link, Some(state.point)).expect("valid input");
            assert_eq!(jacobian.shape(), (6, robot.nv()));
            close(&jacobian.transpose(), state.jacobian.iter().flatten(), "Jacobian");
        }
    }
}

/// The external torque of the observer is the true one after a first-order filter.
#[test]
fn the_observer_follows_an_external_torque() {
    /// Of the greatest external torque: what ticks of 2 ms leave of the integrals [1].
    const SHARE: f64 = 0.01;
    let motion: Motion = read("observer_iiwa14");
    let mut observer =
        MomentumObserver::new(robot("iiwa14"), motion.dt, &[motion.gain]).expect("valid options");
    let greatest = motion.push.iter().fold(0.0_f64, |greatest, push| greatest.max(push.abs()));
    for (k, tick) in motion.ticks.iter().enumerate() {
        let torque = observer.update(&Sample::new(&tick.q, &tick.v, &tick.tau)).expect("valid input");
        for (ours, theirs) in torque.iter().zip(&tick.filtered) {
            assert!((ours - theirs).abs() < SHARE * greatest, "tick {k}: {torque:?}, {:?}", tick.filtered);
        }
    }
    let last = &motion.ticks.last().expect("ticks").filtered;
    assert!(last.iter().zip(&motion.push).all(|(last, push)| (last - push).abs() < 0.01 * greatest));
}
