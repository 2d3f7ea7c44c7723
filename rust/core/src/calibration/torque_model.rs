//! From measured torques to those that move the links: scale, bias and friction of each joint, and delays.

use super::alignment::Alignment;
use super::friction::Reversal;
use super::hysteresis::Stops;
use super::Calibration;

/// Corrects measured torques and velocities.
#[derive(Debug, Clone)]
pub(crate) struct TorqueModel {
    joints: Vec<Joint>,
    alignment: Alignment,
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
        let alignment = Alignment::new(calibration.velocity_delay, calibration.torque_delay, scale.len());
        TorqueModel { joints: (0..scale.len()).map(joint).collect(), alignment }
    }

    /// Forgets the signals of before.
    pub fn reset(&mut self) {
        for joint in &mut self.joints {
            joint.share = 0.0;
            joint.stops.reset();
        }
        self.alignment.reset();
    }

    /// How late the corrected signals are against the measured positions (s).
    pub fn delay(&self) -> f64 {
        self.alignment.delay()
    }

    /// Corrects `v` and `tau` in place, both `(nv,)`, after a step of `dt` (s; zero at the first).
    #[inline]
    pub fn correct(&mut self, dt: f64, v: &mut [f64], tau: &mut [f64]) {
        self.alignment.advance(dt, v, tau);
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
    use crate::calibration::Friction;

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
