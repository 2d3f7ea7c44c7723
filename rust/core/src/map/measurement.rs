//! One measured torque at one pose, and what it says of contacts at points of the surface.

use crate::robot::{Kinematics, Robot};
use crate::torque::{ForcePrior, Frames, PlaceBlock, PushLikelihood, Target, TorqueNoise};

/// A torque at a pose.
#[derive(Debug, Clone)]
pub(super) struct Measurement {
    kinematics: Kinematics,
    pub torque: Vec<f64>,
    /// Its stated standard deviation, and the one it is weighed with (Nm, N).
    pub stated: Vec<f64>,
    deviation: Vec<f64>,
    /// By velocity variable: whether its torque is a force.
    is_force: Vec<bool>,
    pub frames: Frames,
    target: Target,
}

impl Measurement {
    pub fn new(robot: &Robot, wanted: Vec<usize>) -> Self {
        let frames = Frames::new(robot, wanted);
        Measurement {
            kinematics: Kinematics::new(robot),
            torque: vec![0.0; robot.nv()],
            stated: vec![1.0; robot.nv()],
            deviation: vec![1.0; robot.nv()],
            is_force: robot.forces(),
            target: Target::new(&frames),
            frames,
        }
    }

    /// Takes on a checked configuration and torque.
    pub fn set(&mut self, robot: &Robot, q: &[f64], torque: &[f64], noise: &TorqueNoise) {
        self.kinematics.set_configuration(robot, q);
        self.torque.copy_from_slice(torque);
        noise.set_deviations(torque, &mut self.stated);
        self.blur(robot, 0.0);
    }

    /// Weighs the torques of joints that turn with another standard deviation beside the stated one (Nm).
    pub fn blur(&mut self, robot: &Robot, more: f64) {
        for ((deviation, stated), is_force) in self.deviation.iter_mut().zip(&self.stated).zip(&self.is_force) {
            *deviation = if *is_force { *stated } else { stated.hypot(more) };
        }
        self.frames.update(robot, &self.kinematics, &self.deviation);
        self.target.set(&self.frames, &self.torque, &self.deviation);
    }

    /// Logarithm of the likelihood without contact, but for a constant.
    pub fn without_contact(&self) -> f64 {
        -0.5 * self.target.squared - self.deviation.iter().map(|deviation| deviation.ln()).sum::<f64>()
    }

    /// What it says of contacts at a block of points on a link, relative to no contact.
    #[inline]
    pub fn likelihood(&self, prior: &ForcePrior, link: usize, block: &PlaceBlock) -> PushLikelihood {
        prior.likelihood(&self.frames.links[link], self.target.on(link), block)
    }
}
