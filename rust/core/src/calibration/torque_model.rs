//! From measured torques to those that move the links: scale, bias and friction of each joint, and delays.

use super::hysteresis::Stops;
use super::lead::Lead;
use super::Calibration;

/// Friction of the joints, by velocity variable.
///
/// ```
/// use contactsense::calibration::{Friction, Reversal};
///
/// let reversal = vec![Reversal::Velocity(0.01)];
/// let friction = Friction { coulomb: vec![0.5], viscous: vec![0.1], reversal };
/// assert_eq!(friction.reversal[0].width(), 0.01);
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(deny_unknown_fields))]
pub struct Friction {
    /// Torque against the motion, whatever its speed (Nm; N for sliding joints).
    pub coulomb: Vec<f64>,
    /// Torque in proportion to the velocity (Nm s/rad; N s/m).
    pub viscous: Vec<f64>,
    /// How Coulomb friction turns round.
    pub reversal: Vec<Reversal>,
}

/// How Coulomb friction goes from one direction to the other.
///
/// ```
/// use contactsense::calibration::Reversal;
///
/// assert_eq!(Reversal::Displacement(0.003).width(), 0.003);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(rename_all = "snake_case"))]
pub enum Reversal {
    /// With the velocity, as `tanh(v / v_s)` of this `v_s` (rad/s; m/s): none at rest.
    Velocity(f64),
    /// With the displacement since the motion last turned round, whole after twice this length (rad; m): a joint at rest
    /// keeps its friction (Dahl 1968, piecewise linear).
    Displacement(f64),
}

/// The ways of turning round among which a log chooses, the usual one first: from abrupt to smooth.
pub(crate) const REVERSALS: [Reversal; 8] = [
    Reversal::Velocity(0.03),
    Reversal::Velocity(0.003),
    Reversal::Velocity(0.01),
    Reversal::Velocity(0.1),
    Reversal::Displacement(0.003),
    Reversal::Displacement(0.01),
    Reversal::Displacement(0.03),
    Reversal::Displacement(0.1),
];

impl Reversal {
    /// The velocity (rad/s; m/s) or length (rad; m).
    pub fn width(self) -> f64 {
        match self {
            Reversal::Velocity(width) | Reversal::Displacement(width) => width,
        }
    }

    /// The share of Coulomb friction at velocity `v` after a step of `dt` (s), from -1 to 1; `last` is that of before.
    #[inline]
    pub(crate) fn share(self, last: f64, v: f64, dt: f64) -> f64 {
        match self {
            Reversal::Velocity(slow) => sliding(v / slow),
            Reversal::Displacement(length) => (last + v * dt / length).clamp(-1.0, 1.0),
        }
    }
}

/// Beyond this argument the quotient below exceeds one.
const SATURATED: f64 = 4.97;

/// The hyperbolic tangent to 2e-4 (its continued fraction to the seventh order): friction is not known better, and no
/// library call is needed every tick.
#[inline]
pub(crate) fn sliding(x: f64) -> f64 {
    let x = x.clamp(-SATURATED, SATURATED);
    let y = x * x;
    x * (135_135.0 + y * (17_325.0 + y * (378.0 + y)))
        / (135_135.0 + y * (62_370.0 + y * (3_150.0 + y * 28.0)))
}

/// Corrects measured torques and velocities.
#[derive(Debug, Clone)]
pub(crate) struct TorqueModel {
    joints: Vec<Joint>,
    velocity_lead: Lead,
    torque_lead: Lead,
}

#[derive(Debug, Clone, Copy)]
struct Joint {
    scale: f64,
    bias: f64,
    coulomb: f64,
    viscous: f64,
    reversal: Reversal,
    /// Of Coulomb friction, at the last step.
    share: f64,
    /// Of the torque's change.
    hysteresis: f64,
    stops: Stops,
}

impl TorqueModel {
    /// Of one calibration.
    pub fn new(calibration: &Calibration) -> Self {
        let Calibration { torque_scale: scale, torque_bias: bias, friction, .. } = calibration;
        let joint = |j: usize| Joint {
            scale: scale[j],
            bias: bias[j],
            coulomb: friction.coulomb[j],
            viscous: friction.viscous[j],
            reversal: friction.reversal[j],
            share: 0.0,
            hysteresis: calibration.hysteresis[j],
            stops: Stops::new(calibration.hysteresis_width[j]),
        };
        let delays = [calibration.velocity_delay, calibration.torque_delay];
        let [velocity_lead, torque_lead] = delays.map(|delay| Lead::new(delay, scale.len()));
        TorqueModel { joints: (0..scale.len()).map(joint).collect(), velocity_lead, torque_lead }
    }

    /// Forgets the signals of before.
    pub fn reset(&mut self) {
        for joint in &mut self.joints {
            joint.share = 0.0;
            joint.stops.reset();
        }
        self.velocity_lead.reset();
        self.torque_lead.reset();
    }

    /// The next step is one over a gap: rates of signals are not known from before it. Friction and what gears keep back are,
    /// about: they depend on motion and load, not on time.
    pub fn bridge_gap(&mut self) {
        self.velocity_lead.reset();
        self.torque_lead.reset();
    }

    /// Corrects `v` and `tau` in place, both `(nv,)`, after a step of `dt` (s; zero at the first).
    #[inline]
    pub fn correct(&mut self, dt: f64, v: &mut [f64], tau: &mut [f64]) {
        self.velocity_lead.advance(dt, v);
        self.torque_lead.advance(dt, tau);
        for ((joint, v), tau) in self.joints.iter_mut().zip(v).zip(tau) {
            joint.share = joint.reversal.share(joint.share, *v, dt);
            let friction = joint.coulomb * joint.share + joint.viscous * *v;
            let measured = joint.scale * *tau;
            let kept_back = joint.hysteresis * joint.stops.advance(measured);
            *tau = measured + kept_back - joint.bias - friction;
        }
    }
}

impl TorqueModel {
    /// Corrects external torques `(nv,)` of a vendor in place, which contain neither friction nor delays of ours.
    #[inline]
    pub fn correct_external(&self, tau_ext: &mut [f64]) {
        for (joint, tau) in self.joints.iter().zip(tau_ext) {
            *tau = joint.scale * *tau - joint.bias;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_quotient_is_the_hyperbolic_tangent() {
        for k in -2000..=2000 {
            let x = f64::from(k) * 0.01;
            assert!((sliding(x) - x.tanh()).abs() < 2e-4, "{x}");
            assert!(sliding(x).abs() <= 1.0);
        }
    }

    fn model(friction: [f64; 2], reversal: Reversal, scale: f64, bias: f64) -> TorqueModel {
        let robot = crate::robot::Robot::example_arm();
        let [coulomb, viscous] = friction.map(|x| vec![x; 7]);
        let friction = Friction { coulomb, viscous, reversal: vec![reversal; 7] };
        let (torque_scale, torque_bias) = (vec![scale; 7], vec![bias; 7]);
        let described = Calibration::of_description(&robot);
        TorqueModel::new(&Calibration { torque_scale, torque_bias, friction, ..described })
    }

    #[test]
    fn a_torque_is_scaled_first() {
        let mut tau = [-3.0; 7];
        model([0.5, 0.1], Reversal::Velocity(0.01), -1.0, 0.2).correct(1e-3, &mut [1.0; 7], &mut tau);
        assert!((tau[0] - (3.0 - 0.2 - 0.5 - 0.1)).abs() < 2e-4);
    }

    #[test]
    fn friction_that_turns_with_displacement_stays_at_rest() {
        let mut model = model([2.0, 0.0], Reversal::Displacement(0.01), 1.0, 0.0);
        let mut friction_at = |v: f64| {
            let mut tau = [0.0; 7];
            model.correct(1e-3, &mut [v; 7], &mut tau);
            -tau[0]
        };
        (0..20).for_each(|_| _ = friction_at(1.0));
        assert_eq!(friction_at(0.0), 2.0);
        // Half the way back.
        assert!((0..10).map(|_| friction_at(-1.0)).last().unwrap().abs() < 1e-12);
        // Over a gap it is kept.
        assert!((friction_at(1.0) - 0.2).abs() < 1e-12);
        model.bridge_gap();
        let mut tau = [0.0; 7];
        model.correct(1.0, &mut [0.0; 7], &mut tau);
        assert!((tau[0] + 0.2).abs() < 1e-12);
        model.reset();
        let mut tau = [0.0; 7];
        model.correct(1e-3, &mut [0.0; 7], &mut tau);
        assert_eq!(tau[0], 0.0);
    }

    #[test]
    fn what_hysteresis_keeps_back_is_added() {
        let robot = crate::robot::Robot::example_arm();
        let (hysteresis, hysteresis_width) = (vec![0.05; 7], vec![1.0; 7]);
        let described = Calibration::of_description(&robot);
        let mut model = TorqueModel::new(&Calibration { hysteresis, hysteresis_width, ..described });
        let mut corrected = |tau: f64| {
            let mut tau = [tau; 7];
            model.correct(1e-3, &mut [0.0; 7], &mut tau);
            tau[3]
        };
        assert_eq!(corrected(10.0), 10.0);
        assert!((corrected(30.0) - (30.0 + 0.05 * 13.0)).abs() < 1e-12);
    }
}
