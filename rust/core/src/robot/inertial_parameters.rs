//! The inertia of a body as ten numbers in which its dynamics are linear.

use nalgebra::{Matrix3, Vector3};

pub(crate) use super::dynamics::MOMENTS;
use super::dynamics::PARAMETERS;
use super::robot::{Body, Robot};

/// Mass (kg), first moments (kg m) and the moments of inertia `xx, xy, yy, xz, yz, zz` about the body's origin (kg m^2), in
/// the body's axes.
pub(crate) type Parameters = [f64; PARAMETERS];

/// The parameters of a body.
pub(crate) fn of_body(body: &Body) -> Parameters {
    of_inertia(body.mass, &body.com, &body.inertia)
}

/// The parameters of a mass, its centre and the inertia about it.
pub(crate) fn of_inertia(mass: f64, com: &Vector3<f64>, inertia: &Matrix3<f64>) -> Parameters {
    let about_origin = inertia + spread(com) * mass;
    let moment = com * mass;
    let mut parameters = [mass, moment.x, moment.y, moment.z, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    for (value, &(row, column)) in parameters[4..].iter_mut().zip(&MOMENTS) {
        *value = about_origin[(row, column)];
    }
    parameters
}

/// The mass, its centre and the inertia about it; without mass the centre is the origin.
pub(crate) fn to_inertia(parameters: &Parameters) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let mass = parameters[0];
    let moment = Vector3::new(parameters[1], parameters[2], parameters[3]);
    let inertia = moment_matrix(&parameters[4..]);
    if mass == 0.0 {
        return (0.0, Vector3::zeros(), inertia);
    }
    let com = moment / mass;
    (mass, com, inertia - spread(&com) * mass)
}

/// The matrix of the moments `xx, xy, yy, xz, yz, zz`.
pub(crate) fn moment_matrix(moments: &[f64]) -> Matrix3<f64> {
    let mut matrix = Matrix3::zeros();
    for (value, &(row, column)) in moments.iter().zip(&MOMENTS) {
        matrix[(row, column)] = *value;
        matrix[(column, row)] = *value;
    }
    matrix
}

/// The inertia of a unit mass at a place, about the origin.
fn spread(place: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::from_diagonal_element(place.norm_squared()) - place * place.transpose()
}

impl Robot {
    /// The inertial parameters of all bodies, in their order, the world's left out.
    pub(crate) fn inertial_parameters(&self) -> Vec<Parameters> {
        self.bodies[1..].iter().map(of_body).collect()
    }

    /// The robot with other inertias of its bodies and other rotor inertias (one a joint); its links stay as they are.
    pub(crate) fn with_inertial_parameters(&self, parameters: &[Parameters], armature: &[f64]) -> Robot {
        let mut corrected = self.clone();
        for (body, (parameters, armature)) in
            corrected.bodies[1..].iter_mut().zip(parameters.iter().zip(armature))
        {
            (body.mass, body.com, body.inertia) = to_inertia(parameters);
            body.armature = *armature;
        }
        corrected
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_comes_back_from_its_parameters() {
        for body in &Robot::example_arm().bodies[1..] {
            let (mass, com, inertia) = to_inertia(&of_body(body));
            assert!((mass - body.mass).abs() < 1e-12);
            assert!((com - body.com).norm() < 1e-12);
            assert!((inertia - body.inertia).norm() < 1e-12);
        }
    }
}
