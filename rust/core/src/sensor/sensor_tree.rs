//! Where sensors sit, and which links, joints and other sensors lie behind which of them.

use nalgebra::{Matrix3, Vector3, Vector6};

use super::force_torque_sensor::ForceTorqueSensor;
use crate::error::{Error, Result};
use crate::robot::ancestry::Ancestry;
use crate::robot::{Kinematics, Robot, LARGEST, WORLD};
use crate::spatial::vector::{split, stack};
use crate::spatial::Pose;

/// What a contact's source is called that no sensor saw.
pub const JOINT_TORQUES: &str = "joint torques";

/// The sensors of one robot, in the order given, and the tree they form.
#[derive(Debug, Clone)]
pub(crate) struct SensorTree {
    sensors: Vec<ForceTorqueSensor>,
    names: Vec<String>,
    mounts: Vec<Mount>,
    distal_first: Vec<usize>,
    /// Of every link, all sensors in use or not.
    nearest: Vec<Option<usize>>,
    active: Vec<bool>,
    parent: Vec<Option<usize>>,
    ancestry: Ancestry,
    /// By body: the first of its links that its joint moves, if it has links.
    joint_link: Vec<Option<usize>>,
    /// By body: the nearest sensor, in use or not, that its joint lies behind.
    before_joint: Vec<Option<usize>>,
    /// By body: the nearest sensor, in use or not, that all that its joint moves loads.
    at_joint: Vec<Option<usize>>,
}

/// Where a sensor is fixed.
#[derive(Debug, Clone, Copy)]
struct Mount {
    link: usize,
    body: usize,
    /// Sensor frame in the body's frame.
    placement: Pose,
    /// The next sensor towards the base, in use or not.
    parent: Option<usize>,
}

impl SensorTree {
    /// Checks the sensors of a robot; none is an empty tree.
    ///
    /// # Errors
    /// [`Error::Input`] for a link that does not exist or that nothing movable carries, two sensors of one name or on
    /// one link, a pose that is not rigid, and an offset that is not finite.
    pub fn new(robot: &Robot, sensors: &[ForceTorqueSensor]) -> Result<Self> {
        let mut at_link = vec![None; robot.links().len()];
        let mut mounts = Vec::with_capacity(sensors.len());
        for (index, sensor) in sensors.iter().enumerate() {
            let mount = mount(robot, sensor)?;
            if sensor.name == JOINT_TORQUES {
                return Err(Error::input("sensors", format!("'{JOINT_TORQUES}' is no name for a sensor")));
            }
            if sensors[..index].iter().any(|other| other.name == sensor.name) {
                return Err(Error::input("sensors", format!("two are named '{}'", sensor.name)));
            }
            if let Some(other) = at_link[mount.link].replace(index) {
                let other: &ForceTorqueSensor = &sensors[other];
                return Err(Error::input(
                    "sensors",
                    format!(
                        "'{}' and '{}' both sit at link '{}'; a link has one joint to its parent",
                        other.name, sensor.name, sensor.link
                    ),
                ));
            }
            mounts.push(mount);
        }
        let upwards = |start: Option<usize>| std::iter::successors(start, |&link| robot.links()[link].parent);
        let nearest_from = |start: Option<usize>| upwards(start).find_map(|link| at_link[link]);
        for mount in &mut mounts {
            mount.parent = nearest_from(robot.links()[mount.link].parent);
        }
        let depth = |sensor: usize| upwards(Some(mounts[sensor].link)).count();
        let mut distal_first: Vec<usize> = (0..sensors.len()).collect();
        distal_first.sort_by_key(|&sensor| std::cmp::Reverse(depth(sensor)));
        let nearest: Vec<_> = (0..robot.links().len()).map(|link| nearest_from(Some(link))).collect();
        let links = robot.links();
        let mut joint_link = vec![None; robot.body_count()];
        for (index, link) in links.iter().enumerate() {
            if link.parent.is_none_or(|parent| links[parent].body != link.body) {
                joint_link[link.body].get_or_insert(index);
            }
        }
        let (mut before_joint, mut at_joint) = (joint_link.clone(), joint_link.clone());
        // Parents come first; a body without links is as the one that carries it.
        for (body, link) in joint_link.iter().enumerate() {
            let carrier = Some(robot.parent_body(body)).filter(|_| body != WORLD);
            let behind = |known: &[Option<usize>]| carrier.and_then(|carrier| known[carrier]);
            let parent = link.and_then(|link| links[link].parent);
            before_joint[body] = parent.map_or_else(|| behind(&before_joint), |parent| nearest[parent]);
            at_joint[body] = link.map_or_else(|| behind(&at_joint), |link| nearest[link]);
        }
        let chain =
            |sensor| std::iter::successors(Some(sensor), |sensor: &usize| mounts[*sensor].parent).collect();
        let chains: Vec<Vec<usize>> = (0..sensors.len()).map(chain).collect();
        Ok(Self {
            ancestry: Ancestry::new(&chains),
            joint_link,
            before_joint,
            at_joint,
            sensors: sensors.to_vec(),
            names: sensors.iter().map(|sensor| sensor.name.clone()).collect(),
            active: vec![true; sensors.len()],
            parent: mounts.iter().map(|mount| mount.parent).collect(),
            mounts,
            distal_first,
            nearest,
        })
    }

    /// Number of sensors, in use or not.
    pub fn len(&self) -> usize {
        self.sensors.len()
    }

    /// Whether there are no sensors.
    pub fn is_empty(&self) -> bool {
        self.sensors.is_empty()
    }

    /// The sensors' names.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// A sensor's index by its name.
    pub fn find(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|known| known == name)
    }

    /// The link that a sensor sits at: it and all behind it load the sensor.
    pub fn link(&self, sensor: usize) -> usize {
        self.mounts[sensor].link
    }

    /// The body of a sensor's link.
    pub fn body(&self, sensor: usize) -> usize {
        self.mounts[sensor].body
    }

    /// A sensor's origin in the frame of its link's body (m).
    pub(crate) fn origin(&self, sensor: usize) -> Vector3<f64> {
        self.mounts[sensor].placement.translation
    }

    /// The next sensor in use towards the base: the one that this sensor's loads pass on to.
    pub fn parent(&self, sensor: usize) -> Option<usize> {
        self.parent[sensor]
    }

    /// The next sensor towards the base, in use or not.
    pub(crate) fn fixed_parent(&self, sensor: usize) -> Option<usize> {
        self.mounts[sensor].parent
    }

    /// The nearest sensor in use at or above a link: the one that the link loads directly.
    pub fn of_link(&self, link: usize) -> Option<usize> {
        self.in_use(self.nearest[link])
    }

    /// The nearest sensor at or above a link, in use or not.
    pub(crate) fn fixed_of_link(&self, link: usize) -> Option<usize> {
        self.nearest[link]
    }

    /// The first of a body's links that its joint moves; none for a body without links.
    pub(crate) fn joint_link(&self, body: usize) -> Option<usize> {
        self.joint_link[body]
    }

    /// The nearest sensor in use that the joint which moves a body lies behind.
    pub(crate) fn before_joint(&self, body: usize) -> Option<usize> {
        self.in_use(self.before_joint[body])
    }

    /// The nearest sensor, in use or not, that all that a body's joint moves loads: at that joint's own link or before.
    pub(crate) fn at_joint(&self, body: usize) -> Option<usize> {
        self.at_joint[body]
    }

    /// Whether a sensor lies behind another or is that one, in use or not.
    pub(crate) fn is_behind(&self, sensor: usize, other: usize) -> bool {
        self.ancestry.leads_to(other, sensor)
    }

    /// The nearest sensor in use, from one towards the base.
    fn in_use(&self, sensor: Option<usize>) -> Option<usize> {
        sensor.and_then(|sensor| if self.active[sensor] { Some(sensor) } else { self.parent[sensor] })
    }

    /// Which sensors' contacts are meant, by their names: what is behind such a sensor is meant, too.
    ///
    /// # Errors
    /// [`Error::Input`] for a name that no sensor has.
    pub(crate) fn wanted(&self, names: &[String]) -> Result<Vec<bool>> {
        let mut named = vec![false; self.len()];
        for name in names {
            let Some(sensor) = self.find(name) else {
                return Err(Error::input(
                    "wanted_contacts",
                    format!("there is no sensor '{name}'; the sensors are {}", self.names.join(", ")),
                ));
            };
            named[sensor] = true;
        }
        let wanted = |sensor| (0..self.len()).any(|other| named[other] && self.is_behind(sensor, other));
        Ok((0..self.len()).map(wanted).collect())
    }

    /// The sensors, each after all behind it.
    pub fn distal_first(&self) -> &[usize] {
        &self.distal_first
    }

    /// Whether a sensor is in use.
    pub fn is_active(&self, sensor: usize) -> bool {
        self.active[sensor]
    }

    /// Leaves out the sensors that are false in `active`, one entry a sensor; what they measure then passes on to the
    /// next sensor towards the base. Allocates nothing.
    pub fn set_active(&mut self, active: &[bool]) {
        if self.active == active {
            return;
        }
        self.active.copy_from_slice(active);
        let Self { mounts, active, parent, .. } = self;
        let in_use = |mut sensor: Option<usize>| {
            while let Some(index) = sensor.filter(|index| !active[*index]) {
                sensor = mounts[index].parent;
            }
            sensor
        };
        parent.iter_mut().zip(mounts.iter()).for_each(|(parent, mount)| *parent = in_use(mount.parent));
    }

    /// A sensor's origin, from `kinematics.origin`, world axes (m).
    #[inline]
    pub fn position(&self, kinematics: &Kinematics, sensor: usize) -> Vector3<f64> {
        let Mount { body, placement, .. } = &self.mounts[sensor];
        let state = &kinematics.bodies[*body];
        state.position + state.rotation * placement.translation
    }

    /// Rotation from the sensor frame to world axes.
    #[inline]
    pub fn rotation(&self, kinematics: &Kinematics, sensor: usize) -> Matrix3<f64> {
        let Mount { body, placement, .. } = &self.mounts[sensor];
        kinematics.bodies[*body].rotation * placement.rotation
    }

    /// The force and moment that the distal side exerts by a reading, about the sensor's origin, world axes.
    #[inline]
    pub(crate) fn exerted(
        &self,
        kinematics: &Kinematics,
        sensor: usize,
        reading: &[f64; 6],
    ) -> [Vector3<f64>; 2] {
        let turn = self.rotation(kinematics, sensor);
        let (force, moment) = split(&self.sensors[sensor].exerted(reading));
        [turn * force, turn * moment]
    }

    /// What a wrench in world axes adds to a sensor's reading, in its axes and convention.
    #[inline]
    pub(crate) fn reading(
        &self,
        kinematics: &Kinematics,
        sensor: usize,
        wrench: &Vector6<f64>,
    ) -> Vector6<f64> {
        let turn = self.rotation(kinematics, sensor);
        let (force, moment) = split(wrench);
        stack(&turn.tr_mul(&force), &turn.tr_mul(&moment)) * self.sensors[sensor].convention.sign()
    }

    /// The sensors, in the order given, with their present offsets.
    pub(crate) fn sensors(&self) -> &[ForceTorqueSensor] {
        &self.sensors
    }

    /// Another offset of a sensor, which must be finite.
    pub(crate) fn set_offset(&mut self, sensor: usize, offset: [f64; 6]) {
        self.sensors[sensor].offset = offset;
    }
}

fn mount(robot: &Robot, sensor: &ForceTorqueSensor) -> Result<Mount> {
    let name = &sensor.name;
    let Some(index) = robot.links().iter().position(|link| link.name == sensor.link) else {
        let names: Vec<&str> = robot.links().iter().map(|link| link.name.as_str()).collect();
        return Err(Error::input(
            "sensors",
            format!(
                "'{name}' sits at the link '{}', which the robot does not have; its links are {}",
                sensor.link,
                names.join(", ")
            ),
        ));
    };
    let link = &robot.links()[index];
    if link.parent.is_none() || link.body == WORLD {
        let reason = if link.body == WORLD { "is fixed to the world" } else { "is the root" };
        return Err(Error::input(
            "sensors",
            format!(
                "'{name}' sits at the link '{}', which {reason}; a sensor joins a link that can move to its \
             parent",
                sensor.link
            ),
        ));
    }
    let rigid = sensor.pose.check_rigid();
    rigid.map_err(|why| Error::input("sensors", format!("the pose of '{name}' {why}")))?;
    if !sensor.offset.iter().all(|x| x.abs() < LARGEST) {
        return Err(Error::input("sensors", format!("the offset of '{name}' must be finite [N, Nm]")));
    }
    Ok(Mount { link: index, body: link.body, placement: link.placement.compose(&sensor.pose), parent: None })
}

#[cfg(test)]
mod tests;
