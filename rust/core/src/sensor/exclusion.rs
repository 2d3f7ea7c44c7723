//! Wanted contacts at sensors: what they do to the joints and to other sensors (Vorndamme 2017, eq. 20).

use nalgebra::{Vector3, Vector6};

use super::sensor_tree::SensorTree;
use crate::robot::jacobian::for_each_column;
use crate::robot::{Kinematics, Robot, WORLD};
use crate::spatial::vector::moved;

/// Writes `J(S)^T F_ext,S`, `(nv,)`, for a wrench at the sensor's origin, world axes.
///
/// Joints behind the sensor and on other branches get zero.
pub(crate) fn sensor_torque(
    robot: &Robot,
    kinematics: &Kinematics,
    tree: &SensorTree,
    sensor: usize,
    wrench: &Vector6<f64>,
    torque: &mut [f64],
) {
    torque.fill(0.0);
    let about_origin = moved(wrench, &tree.position(kinematics, sensor));
    for_each_column(robot, kinematics, tree.body(sensor), &Vector3::zeros(), |k, column| {
        torque[k] = column.dot(&about_origin);
    });
}

/// Takes wanted contacts out of the external wrenches of sensors nearer to the base: zero at a wanted sensor, none where a wanted
/// one is not trusted. `outermost` is called with each sensor whose wrench is that of all wanted contacts behind it.
pub(crate) fn exclude_wanted(
    kinematics: &Kinematics,
    tree: &SensorTree,
    wanted: &[bool],
    is_trusted: impl Fn(usize) -> bool,
    external: &[Option<Vector6<f64>>],
    unwanted: &mut [Option<Vector6<f64>>],
    mut outermost: impl FnMut(usize, &Vector6<f64>),
) {
    unwanted.copy_from_slice(external);
    for sensor in (0..tree.len()).filter(|sensor| wanted[*sensor]) {
        let is_outermost = tree.parent(sensor).is_none_or(|parent| !wanted[parent]);
        let wrench = external[sensor].filter(|_| is_outermost);
        if let Some(wrench) = &wrench {
            outermost(sensor, wrench);
        }
        for other in (0..tree.len()).filter(|other| *other != sensor && tree.is_behind(sensor, *other)) {
            if !is_trusted(sensor) {
                unwanted[other] = None;
            } else if is_outermost {
                let arm = tree.position(kinematics, sensor) - tree.position(kinematics, other);
                let wrench = wrench.map(|wrench| moved(&wrench, &arm));
                unwanted[other] = unwanted[other].zip(wrench).map(|(sum, wrench)| sum - wrench);
            }
        }
    }
    for (sensor, unwanted) in unwanted.iter_mut().enumerate() {
        if wanted[sensor] && unwanted.is_some() {
            *unwanted = Some(Vector6::zeros());
        }
    }
}

/// Velocity variables that a wanted contact may load that no sensor measures: on the chain of a wanted sensor that is not trusted,
/// and behind a wanted sensor.
pub(crate) fn leave_out_blind(
    robot: &Robot,
    tree: &SensorTree,
    wanted: &[bool],
    is_trusted: impl Fn(usize) -> bool,
    blind: &mut [bool],
) {
    blind.fill(false);
    for body in WORLD + 1..robot.body_count() {
        if tree.at_joint(body).is_some_and(|sensor| wanted[sensor]) {
            blind[robot.velocity_range(body)].fill(true);
        }
    }
    for sensor in (0..tree.len()).filter(|sensor| wanted[*sensor] && !is_trusted(*sensor)) {
        for &body in robot.chain(tree.body(sensor)) {
            blind[robot.velocity_range(body)].fill(true);
        }
    }
}
