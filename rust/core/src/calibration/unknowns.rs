//! What a calibration solves for, and how far each is expected from the description.

use nalgebra::{DVector, Matrix3, Vector3};

use super::pseudo_inertia::{Change, PseudoInertia, CHANGES};
use crate::robot::inertial_parameters::{moment_matrix, Parameters, MOMENTS};
use crate::robot::{LinkIndex, Robot};
use crate::spatial::Pose;

/// Terms of each joint, in the order of their columns.
pub(super) const TERMS: usize = 5;
pub(super) const BIAS: usize = 0;
pub(super) const COULOMB: usize = 1;
pub(super) const VISCOUS: usize = 2;
pub(super) const ARMATURE: usize = 3;
pub(super) const HYSTERESIS: usize = 4;

/// Numbers of a payload: its inertial parameters in the link's frame, all free, so that the misfit has one minimum.
pub(super) const PAYLOAD: usize = PARAMETERS;
/// Inertial parameters of a body.
pub(super) const PARAMETERS: usize = 10;
/// A torque may be late by so much: one standard deviation (s).
const TORQUE_DELAY: f64 = 0.01;

/// A payload may weigh this share of the robot and be this far from the link's origin (m): one standard deviation each, wide
/// enough for any tool.
const PAYLOAD_SHARE: f64 = 0.2;
const PAYLOAD_REACH: f64 = 0.3;
/// A lighter payload (share of the robot's mass) has no centre.
const NO_PAYLOAD: f64 = 1e-6;

/// The unknowns `z`: changes of the bodies that have mass, terms of the joints, and a payload.
#[derive(Debug, Clone)]
pub(super) struct Unknowns {
    /// By body, the world left out.
    pub bodies: Vec<Option<PseudoInertia>>,
    pub described: Vec<Parameters>,
    payload: Option<Held>,
    joints: usize,
    /// One standard deviation of each term before the log is seen, by joint.
    pub term_units: Vec<[f64; TERMS]>,
    /// No term is smaller.
    pub term_floors: Vec<[f64; TERMS]>,
    robot_mass: f64,
}

/// Where a payload is held: the body (the world left out) and the link's pose in it.
#[derive(Debug, Clone, Copy)]
struct Held {
    body: usize,
    placement: Pose,
}

/// The payload that a vector of unknowns stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct HeldPayload {
    pub mass: f64,
    pub com: Vector3<f64>,
    pub moment: f64,
}

/// One column of the derivative of the correction by the unknowns: consecutive entries from `first` on.
pub(super) struct Column {
    pub first: usize,
    pub values: Vec<f64>,
}

impl Unknowns {
    pub fn new(robot: &Robot, payload_link: Option<LinkIndex>, term_units: Vec<[f64; TERMS]>) -> Self {
        let described = robot.inertial_parameters();
        let payload = payload_link.map(|link| &robot[link]).filter(|link| link.body > 0);
        let floors = robot.bodies[1..].iter().map(|body| [f64::NEG_INFINITY, 0.0, 0.0, -body.armature, 0.0]);
        Unknowns {
            bodies: described.iter().map(PseudoInertia::nearest).collect(),
            payload: payload.map(|link| Held { body: link.body - 1, placement: link.placement }),
            joints: robot.nv(),
            term_units,
            term_floors: floors.collect(),
            robot_mass: robot.mass(),
            described,
        }
    }

    /// Number of unknowns.
    pub fn len(&self) -> usize {
        self.torque_delay() + 1 + if self.payload.is_some() { PAYLOAD } else { 0 }
    }

    /// Number of columns of the regression: ten a body, [`TERMS`] a joint, and the delay of the torque.
    pub fn columns(&self) -> usize {
        self.delay_column() + 1
    }

    /// Where the delay of the torque is among the columns.
    pub fn delay_column(&self) -> usize {
        PARAMETERS * self.bodies.len() + TERMS * self.joints
    }

    /// Where it is among the unknowns.
    pub fn torque_delay(&self) -> usize {
        self.term(self.joints, 0)
    }

    /// Where a term of a joint is among the columns of the regression.
    pub fn term_column(&self, joint: usize, term: usize) -> usize {
        PARAMETERS * self.bodies.len() + TERMS * joint + term
    }

    /// Where a term of a joint is among the unknowns.
    pub fn term(&self, joint: usize, term: usize) -> usize {
        CHANGES * self.bodies.len() + TERMS * joint + term
    }

    /// Where the payload's mass is among the unknowns.
    pub fn payload(&self) -> Option<usize> {
        self.payload.map(|_| self.torque_delay() + 1)
    }

    /// One standard deviation of each before the log is seen, for a `change` of the bodies (a share).
    pub fn units(&self, change: f64) -> DVector<f64> {
        let bodies = self.bodies.iter().flat_map(|body| body.map_or([1.0; CHANGES], |body| body.units()));
        let mut units: Vec<f64> = bodies.map(|unit| unit * change).collect();
        units.extend(self.term_units.iter().flatten());
        units.push(TORQUE_DELAY);
        if self.payload.is_some() {
            let mass = PAYLOAD_SHARE * self.robot_mass;
            let (moment, spread) = (mass * PAYLOAD_REACH, mass * PAYLOAD_REACH * PAYLOAD_REACH);
            units.extend([mass, moment, moment, moment]);
            units.extend([spread; 6]);
        }
        DVector::from_vec(units)
    }

    /// No unknown is smaller.
    pub fn floors(&self) -> Vec<f64> {
        let mut floors = vec![f64::NEG_INFINITY; CHANGES * self.bodies.len()];
        floors.extend(self.term_floors.iter().flatten());
        floors.push(0.0);
        if self.payload.is_some() {
            floors.push(0.0);
            floors.extend([f64::NEG_INFINITY; PAYLOAD - 1]);
        }
        floors
    }

    /// What the unknowns add to the description, by column of the regression.
    pub fn correction(&self, z: &DVector<f64>) -> DVector<f64> {
        let mut correction = DVector::zeros(self.columns());
        for (index, parameters) in self.parameters(z).iter().enumerate() {
            for (k, (now, before)) in parameters.iter().zip(&self.described[index]).enumerate() {
                correction[PARAMETERS * index + k] = now - before;
            }
        }
        let first = PARAMETERS * self.bodies.len();
        let terms = z.rows(self.term(0, 0), TERMS * self.joints + 1);
        correction.rows_mut(first, TERMS * self.joints + 1).copy_from(&terms);
        correction
    }

    /// The inertial parameters of all bodies, the payload with them.
    fn parameters(&self, z: &DVector<f64>) -> Vec<Parameters> {
        let mut all = self.without_payload(z);
        if let Some((held, numbers)) = self.held(z) {
            let added = held.parameters(&numbers);
            all[held.body].iter_mut().zip(&added).for_each(|(sum, part)| *sum += part);
        }
        all
    }

    /// The inertial parameters of all bodies without the payload.
    pub fn without_payload(&self, z: &DVector<f64>) -> Vec<Parameters> {
        let changed = |(index, body): (usize, &Option<PseudoInertia>)| match body {
            Some(body) => body.changed(&self.change(z, index)),
            None => self.described[index],
        };
        self.bodies.iter().enumerate().map(changed).collect()
    }

    /// The payload that the unknowns stand for.
    pub fn held_payload(&self, z: &DVector<f64>) -> Option<HeldPayload> {
        self.held(z).map(|(_, numbers)| HeldPayload::of(&numbers, self.robot_mass))
    }

    /// The derivative of [`correction`](Self::correction), by unknown.
    pub fn derivative(&self, z: &DVector<f64>) -> Vec<Column> {
        let mut columns = Vec::with_capacity(self.len());
        for (index, body) in self.bodies.iter().enumerate() {
            let first = PARAMETERS * index;
            match body {
                Some(body) => {
                    let derivative = body.derivative(&self.change(z, index));
                    columns.extend(
                        derivative
                            .column_iter()
                            .map(|c| Column { first, values: c.iter().copied().collect() }),
                    );
                }
                None => columns.extend((0..CHANGES).map(|_| Column { first, values: vec![] })),
            }
        }
        let first_term = PARAMETERS * self.bodies.len();
        columns
            .extend((0..=TERMS * self.joints).map(|k| Column { first: first_term + k, values: vec![1.0] }));
        if let Some((held, _)) = self.held(z) {
            for k in 0..PAYLOAD {
                let mut unit = [0.0; PAYLOAD];
                unit[k] = 1.0;
                columns
                    .push(Column { first: PARAMETERS * held.body, values: held.parameters(&unit).to_vec() });
            }
        }
        columns
    }

    fn change(&self, z: &DVector<f64>, body: usize) -> Change {
        std::array::from_fn(|k| z[CHANGES * body + k])
    }

    fn held(&self, z: &DVector<f64>) -> Option<(Held, [f64; PAYLOAD])> {
        let first = self.payload()?;
        self.payload.map(|held| (held, std::array::from_fn(|k| z[first + k])))
    }
}

impl Held {
    /// The payload's inertial parameters in the axes of the body.
    fn parameters(&self, numbers: &Parameters) -> Parameters {
        let Pose { rotation, translation: p } = &self.placement;
        let mass = numbers[0];
        let moment = rotation * Vector3::new(numbers[1], numbers[2], numbers[3]);
        let inertia = rotation * moment_matrix(&numbers[4..]) * rotation.transpose();
        let parallel = |a: &Vector3<f64>, b: &Vector3<f64>| {
            Matrix3::from_diagonal_element(2.0 * a.dot(b)) - a * b.transpose() - b * a.transpose()
        };
        let moved = inertia + parallel(p, &moment) + parallel(p, p) * (0.5 * mass);
        let moment = moment + p * mass;
        let mut parameters = [mass, moment.x, moment.y, moment.z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
        for (value, &(row, column)) in parameters[4..].iter_mut().zip(&MOMENTS) {
            *value = moved[(row, column)];
        }
        parameters
    }
}

impl HeldPayload {
    fn of(numbers: &Parameters, robot_mass: f64) -> Self {
        let mass = numbers[0];
        if mass <= NO_PAYLOAD * robot_mass {
            return HeldPayload { mass: 0.0, com: Vector3::zeros(), moment: 0.0 };
        }
        let com = Vector3::new(numbers[1], numbers[2], numbers[3]) / mass;
        // The mean moment about the centre: half of the trace is the second moment of mass.
        let moment = (moment_matrix(&numbers[4..]).trace() - 2.0 * mass * com.norm_squared()) / 3.0;
        HeldPayload { mass, com, moment: moment.max(0.0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::inertial_parameters::of_inertia;

    #[test]
    fn a_payload_has_the_same_inertia_in_the_axes_of_the_body() {
        let rotation = nalgebra::Rotation3::from_euler_angles(0.3, -0.8, 1.1).into_inner();
        let placement = Pose { rotation, translation: Vector3::new(0.1, 0.2, -0.3) };
        let (mass, com) = (1.5, Vector3::new(0.02, -0.03, 0.08));
        let inertia = Matrix3::new(0.02, 0.001, 0.0, 0.001, 0.03, 0.002, 0.0, 0.002, 0.04);
        let found = Held { body: 0, placement }.parameters(&of_inertia(mass, &com, &inertia));
        let turned = rotation * inertia * rotation.transpose();
        for (found, wanted) in found.iter().zip(of_inertia(mass, &placement.transform_point(&com), &turned)) {
            assert!((found - wanted).abs() < 1e-12);
        }
        let held = HeldPayload::of(&of_inertia(mass, &com, &inertia), 20.0);
        assert!((held.com - com).norm() < 1e-12 && (held.moment - 0.03).abs() < 1e-12);
    }
}
