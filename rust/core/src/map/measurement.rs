//! One measured torque at one pose, with the wrenches of sensors where there are any, and what they say of contacts at points
//! of the surface.

use nalgebra::Vector3;

use crate::robot::{Kinematics, Robot};
use crate::torque::{ForcePrior, Frames, PlaceBlock, PushLikelihood, SensorMount, Target, WRENCH};

/// A torque at a pose. Its rows are the velocity variables, then the components of the sensors' wrenches.
#[derive(Debug, Clone)]
pub(crate) struct Measurement {
    torque: Vec<f64>,
    /// Its stated standard deviation, and the one it is weighed with (Nm, N).
    stated: Vec<f64>,
    deviation: Vec<f64>,
    /// By row: whether it is a force.
    is_force: Vec<bool>,
    /// Without weights, and by the deviations.
    plain: Frames,
    frames: Frames,
    target: Target,
}

impl Measurement {
    pub fn new(robot: &Robot, wanted: Vec<usize>, sensors: &[SensorMount]) -> Self {
        let frames = Frames::with_sensors(robot, wanted, sensors);
        let mut is_force = robot.forces();
        is_force.extend((0..WRENCH * sensors.len()).map(|i| i % WRENCH < 3));
        let rows = is_force.len();
        Measurement {
            torque: vec![0.0; rows],
            stated: vec![1.0; rows],
            deviation: vec![1.0; rows],
            is_force,
            target: Target::new(&frames),
            plain: frames.clone(),
            frames,
        }
    }

    /// Takes on a pose, and the rows measured there with their standard deviations.
    pub fn set(&mut self, robot: &Robot, kinematics: &Kinematics, torque: &[f64], stated: &[f64]) {
        self.torque.copy_from_slice(torque);
        self.stated.copy_from_slice(stated);
        self.deviation.fill(1.0);
        self.plain.update(robot, kinematics, &self.deviation);
        let links = std::mem::take(&mut self.plain.wanted);
        self.blur(0.0, &links);
        self.plain.wanted = links;
    }

    /// The same where only contacts on one link are looked at.
    pub fn set_on(
        &mut self,
        link: usize,
        robot: &Robot,
        kinematics: &Kinematics,
        torque: &[f64],
        stated: &[f64],
    ) {
        for frames in [&mut self.plain, &mut self.frames] {
            frames.wanted.clear();
            frames.wanted.push(link);
        }
        self.set(robot, kinematics, torque, stated);
    }

    /// Weighs torques and moments with another standard deviation beside the stated one (Nm), as these links feel them.
    pub fn blur(&mut self, more: f64, links: &[usize]) {
        let Self { torque, stated, deviation, is_force, plain, frames, target } = self;
        for ((deviation, stated), is_force) in deviation.iter_mut().zip(&*stated).zip(&*is_force) {
            *deviation = if *is_force { *stated } else { stated.hypot(more) };
        }
        frames.weigh(plain, deviation, links);
        target.set_on(links, frames, torque, deviation);
    }

    /// The links as they are weighed.
    pub fn frames(&self) -> &Frames {
        &self.frames
    }

    /// Stated standard deviations (Nm, N).
    pub fn stated(&self) -> &[f64] {
        &self.stated
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.torque.len()
    }

    /// Squared norm of the rows that feel a link, in standard deviations.
    pub fn felt(&self, link: usize) -> f64 {
        self.target.on(link).squared
    }

    /// Logarithm of the likelihood without contact, but for a constant.
    pub fn without_contact(&self) -> f64 {
        -0.5 * self.target.squared - self.deviation.iter().map(|deviation| deviation.ln()).sum::<f64>()
    }

    /// The largest of the rows that do not feel a link, in standard deviations.
    pub fn largest_elsewhere(&self, link: usize) -> f64 {
        let own = self.frames.links[link].rows();
        let others = self.torque.iter().zip(&self.deviation).enumerate().filter(|(k, _)| !own.contains(k));
        others.map(|(_, (torque, deviation))| (torque / deviation).abs()).fold(0.0, f64::max)
    }

    /// Squared norm, over all rows, of the torque that a force at a point of a link leaves over, in standard deviations (point
    /// and force in the link's frame); `left` is memory for as many numbers.
    pub fn left_over(
        &self,
        link: usize,
        point: &Vector3<f64>,
        force: &Vector3<f64>,
        left: &mut [f64],
    ) -> f64 {
        let (own, rest) = self.frames.links[link].left_over(point, force, self.target.on(link), left);
        (self.target.squared - own + rest).max(0.0)
    }

    /// The torques as they are weighed.
    pub fn target(&self) -> &Target {
        &self.target
    }

    /// What it says of contacts at a block of points on a link, relative to no contact.
    #[inline]
    pub fn likelihood(&self, prior: &ForcePrior, link: usize, block: &PlaceBlock) -> PushLikelihood {
        prior.likelihood(&self.frames.links[link], self.target.on(link), block)
    }
}
