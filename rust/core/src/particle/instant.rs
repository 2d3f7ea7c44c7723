//! One instant as the particles see it: the links' poses before and now, what forces do to the joints there, and the
//! torque that was measured.

use nalgebra::{Vector3, Vector6};

use crate::robot::{Kinematics, Robot};
use crate::spatial::Pose;
use crate::torque::{Frames, NormalEquations, Target, TorqueNoise};

/// Where a link was, and how large it is.
#[derive(Debug, Clone)]
struct Extent {
    /// At the step before.
    before: Pose,
    /// Sphere around the surface, link frame [m].
    center: Vector3<f64>,
    radius: f64,
}

/// The poses and torques of one instant.
#[derive(Debug, Clone)]
pub(crate) struct Instant {
    kinematics: Kinematics,
    pub noise: TorqueNoise,
    pub frames: Frames,
    pub target: Target,
    /// By link of the robot: normal equations with what other contacts may do integrated out, and the squared norm of the torques that
    /// these do not explain. Without others as in frames and target.
    pub equations: Vec<NormalEquations>,
    pub squared: f64,
    /// The measured torque, one a velocity variable [Nm, N], the same without what other contacts do, its stated standard deviation,
    /// and the one it is weighed with.
    pub measured: Vec<f64>,
    pub torque: Vec<f64>,
    pub stated: Vec<f64>,
    pub deviation: Vec<f64>,
    /// By velocity variable: whether its torque is a force.
    pub is_force: Vec<bool>,
    /// One a link of the robot.
    extents: Vec<Extent>,
}

impl Instant {
    /// Of a robot of which these links can be in contact.
    pub fn new(robot: &Robot, noise: TorqueNoise, wanted: Vec<usize>) -> Self {
        let frames = Frames::new(robot, wanted);
        let extents = robot.links().iter().map(|link| {
            let sphere = link.surface.as_ref().map(|surface| surface.bounding_sphere());
            let (center, radius) = sphere.unwrap_or((Vector3::zeros(), 0.0));
            Extent { before: Pose::identity(), center, radius }
        });
        Instant {
            kinematics: Kinematics::new(robot),
            noise,
            is_force: robot.forces(),
            target: Target::new(&frames),
            equations: frames
                .links
                .iter()
                .map(|frame| NormalEquations { gram: *frame.gram(), product: Vector6::zeros() })
                .collect(),
            squared: 0.0,
            measured: vec![0.0; robot.nv()],
            torque: vec![0.0; robot.nv()],
            stated: vec![1.0; robot.nv()],
            deviation: vec![1.0; robot.nv()],
            extents: extents.collect(),
            frames,
        }
    }

    /// Takes on a checked configuration and torque, weighed by the noise or as it is.
    pub fn update(&mut self, robot: &Robot, q: &[f64], torque: &[f64], weighed: bool) {
        self.stand();
        self.measured.copy_from_slice(torque);
        self.torque.copy_from_slice(torque);
        self.noise.set_deviations(torque, &mut self.stated);
        if weighed {
            self.deviation.copy_from_slice(&self.stated);
        } else {
            self.deviation.fill(1.0);
        }
        self.kinematics.set_configuration(robot, q);
        self.frames.update(robot, &self.kinematics, &self.deviation);
        self.target.set(&self.frames, &self.torque, &self.deviation);
        for &link in &self.frames.wanted {
            self.equations[link] = self.frames.links[link].normal_equations(self.target.on(link));
        }
        self.squared = self.target.squared;
    }

    /// Where a link is.
    pub fn pose(&self, link: usize) -> &Pose {
        &self.frames.links[link].pose
    }

    /// Where a link was at the step before.
    pub fn before(&self, link: usize) -> &Pose {
        &self.extents[link].before
    }

    /// Forgets the step before: no link has moved.
    pub fn stand(&mut self) {
        for &link in &self.frames.wanted {
            self.extents[link].before = self.frames.links[link].pose;
        }
    }

    /// How far a point of a link moved at most since the step before [m].
    pub fn displacement_of(&self, link: usize) -> f64 {
        self.apart(link, self.pose(link), self.before(link))
    }

    /// How far a point of the robot moved at most since the step before [m].
    pub fn displacement(&self) -> f64 {
        self.frames.wanted.iter().map(|&link| self.displacement_of(link)).fold(0.0, f64::max)
    }

    /// How far a point of a link moves at most from one pose to another [m].
    pub fn apart(&self, link: usize, here: &Pose, pose: &Pose) -> f64 {
        let Extent { center, radius, .. } = &self.extents[link];
        let centre = here.transform_point(center) - pose.transform_point(center);
        // Chord of the rotation at the rim: |R - R'| by Frobenius is sqrt(2) times that of a unit arm.
        let turned = (here.rotation - pose.rotation).norm() / std::f64::consts::SQRT_2;
        centre.norm() + turned * radius
    }
}
