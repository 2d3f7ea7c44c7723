//! Generalised momentum and its known rate, each by one O(n) pass.
//!
//! In world axes about one origin the composite momentum of a subtree is a plain sum. With `S_i` the joint's
//! motion axis, `h_i` the momentum and `V_i` the velocity of the subtree's first body,
//! `p_i = S_i . h_i` and `(C^T v)_i = (V_i x S_i) . h_i`: no matrix is formed.

use nalgebra::Vector3;

use crate::robot::description::JointKind;
use crate::robot::kinematics::Kinematics;
use crate::robot::Robot;

/// Momentum, mass and first moment of mass of a subtree, about the reference origin.
#[derive(Debug, Clone, Copy)]
struct Composite {
    linear: Vector3<f64>,
    angular: Vector3<f64>,
    mass: f64,
    moment: Vector3<f64>,
}

/// Workspace of the momentum pass.
///
/// ```
/// use contactsense::robot::{Kinematics, MomentumPass, Robot};
///
/// let robot = Robot::example_arm();
/// let (q, v) = (vec![0.4; 7], vec![0.2; 7]);
/// let mut kinematics = Kinematics::new(&robot);
/// kinematics.set_configuration(&robot, &q);
/// kinematics.set_velocity(&robot, &v);
/// let (mut momentum, mut rate) = (vec![0.0; 7], vec![0.0; 7]);
/// MomentumPass::new(&robot).evaluate(&robot, &kinematics, &v, &mut momentum, &mut rate);
/// let expected = robot.mass_matrix(&q)? * nalgebra::DVector::from_vec(v);
/// assert!((momentum[0] - expected[0]).abs() < 1e-12);
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct MomentumPass {
    composite: Vec<Composite>,
}

impl MomentumPass {
    /// Space for a robot's bodies.
    pub fn new(robot: &Robot) -> Self {
        let zero = Vector3::zeros();
        let empty = Composite { linear: zero, angular: zero, mass: 0.0, moment: zero };
        Self { composite: vec![empty; robot.body_count()] }
    }

    /// Writes `M v` and `C^T v - g` (Vorndamme 2017, eq. 5 with the sign turned), both `(nv,)`.
    ///
    /// `kinematics` holds the configuration and `v`.
    #[inline]
    pub fn evaluate(
        &mut self,
        robot: &Robot,
        kinematics: &Kinematics,
        v: &[f64],
        momentum: &mut [f64],
        rate: &mut [f64],
    ) {
        for ((body, state), composite) in
            robot.bodies.iter().zip(&kinematics.bodies).zip(&mut self.composite).skip(1)
        {
            let com = state.position + state.rotation * body.com;
            let linear = state.velocity_at(&com) * body.mass;
            let spin = state.rotation * (body.inertia * state.rotation.tr_mul(&state.angular));
            *composite = Composite {
                linear,
                angular: com.cross(&linear) + spin,
                mass: body.mass,
                moment: com * body.mass,
            };
        }
        let gravity = robot.gravity;
        for index in (1..robot.bodies.len()).rev() {
            let body = &robot.bodies[index];
            let state = &kinematics.bodies[index];
            let Composite { linear: f, angular: n, mass, moment } = self.composite[index];
            let k = body.idx_v;
            match body.kind {
                JointKind::Revolute | JointKind::Continuous => {
                    let axis = state.axis();
                    let at = &state.position;
                    let n = n - at.cross(&f);
                    let weight = (moment - at * mass).cross(&gravity);
                    momentum[k] = axis.dot(&n);
                    rate[k] = axis.dot(&(f.cross(&state.velocity_at(at)) + n.cross(&state.angular) + weight));
                }
                JointKind::Prismatic => {
                    let axis = state.axis();
                    momentum[k] = axis.dot(&f);
                    rate[k] = axis.dot(&(f.cross(&state.angular) + gravity * mass));
                }
                JointKind::FreeFlyer => {
                    let to_base = |x: Vector3<f64>| state.rotation.tr_mul(&x);
                    let (w, u) = (&state.angular, &state.linear);
                    let parts = [
                        (to_base(f), to_base(f.cross(w) + gravity * mass)),
                        (to_base(n), to_base(f.cross(u) + n.cross(w) + moment.cross(&gravity))),
                    ];
                    for (row, (p, r)) in parts.iter().enumerate() {
                        momentum[k + 3 * row..k + 3 * row + 3].copy_from_slice(p.as_slice());
                        rate[k + 3 * row..k + 3 * row + 3].copy_from_slice(r.as_slice());
                    }
                }
            }
            if body.armature != 0.0 {
                for j in k..k + body.kind.nv() {
                    momentum[j] += body.armature * v[j];
                }
            }
            let parent = &mut self.composite[body.parent];
            parent.linear += f;
            parent.angular += n;
            parent.mass += mass;
            parent.moment += moment;
        }
    }
}
