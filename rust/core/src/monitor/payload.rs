//! A payload that the robot picks up or puts down while the monitor runs.

use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::contact_monitor::ContactMonitor;
use crate::detection::Load;
use crate::error::Result;
use crate::robot::{LinkIndex, Robot};

impl ContactMonitor {
    /// From the next tick on the robot carries a payload at a link: mass (kg), centre of mass in the link's frame (m). It takes
    /// the place of one that was set before; what the description or a calibration has stays.
    ///
    /// External torque, bias and contacts go on. The step to the next sample, within which the load may change, tells
    /// nothing of the external torque. Where all joints are tested at once, the payload's weight counts as unknown for half a
    /// second: it may be borne later than it is announced. A weight that is borne before it is set, or, with a threshold a
    /// joint, not at the same tick, is an external torque.
    ///
    /// Not for the control loop: it allocates.
    ///
    /// # Errors
    /// [`crate::Error::Input`] for a mass or centre that is none; nothing is then changed.
    ///
    /// ```
    /// use std::sync::Arc;
    ///
    /// use contactsense::monitor::{ContactMonitor, MonitorOptions};
    /// use contactsense::robot::Robot;
    ///
    /// let robot = Arc::new(Robot::example_arm());
    /// let mut monitor = ContactMonitor::new(robot.clone(), &MonitorOptions::new(1e-3))?;
    /// monitor.set_payload(robot.link("link_7")?, 1.5, [0.0, 0.0, 0.1])?;
    /// assert!((monitor.robot().mass() - robot.mass() - 1.5).abs() < 1e-12);
    /// monitor.clear_payload();
    /// assert_eq!(monitor.robot().mass(), robot.mass());
    /// # Ok::<(), contactsense::Error>(())
    /// ```
    pub fn set_payload(&mut self, link: LinkIndex, mass: f64, com: [f64; 3]) -> Result<()> {
        let loaded = self.unloaded.with_payload(link, mass, com.into(), Matrix3::zeros())?;
        let moment = self.unloaded[link].placement.transform_point(&Vector3::from(com)) * mass;
        self.change_robot(Arc::new(loaded), Some(Load { body: self.unloaded[link].body, mass, moment }));
        Ok(())
    }

    /// From the next tick on the robot carries no payload, as [`ContactMonitor::set_payload`].
    ///
    /// Not for the control loop: it frees memory.
    pub fn clear_payload(&mut self) {
        if self.payload.is_some() {
            self.change_robot(Arc::clone(&self.unloaded), None);
        }
    }

    fn change_robot(&mut self, robot: Arc<Robot>, payload: Option<Load>) {
        self.observer.set_robot(&robot);
        if let Some(sensing) = &mut self.sensing {
            sensing.set_robot(&robot);
        }
        if let Some(test) = &mut self.test {
            test.set_robot(&robot, [self.payload, payload]);
        }
        self.recent.reset();
        self.robot = robot;
        self.payload = payload;
    }
}
