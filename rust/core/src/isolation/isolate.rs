//! From an external torque to contacts: first those that no sensor sees, then those behind each sensor.

use nalgebra::Vector6;

use super::isolator::ContactIsolator;
use super::result::Isolation;
use crate::detection::is_over;
use crate::error::{Error, Result};
use crate::observer::WrenchObserver;
use crate::robot::{Kinematics, LinkIndex};
use crate::sensor::SensorTree;

impl ContactIsolator {
    /// Contacts that explain the external torque `(nv,)` at the configuration `q`.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    pub fn isolate(&mut self, q: &[f64], tau_ext: &[f64]) -> Result<&Isolation> {
        if !self.active.is_empty() {
            return Err(Error::input("wrenches", "missing; there are sensors"));
        }
        self.isolate_sensed(q, tau_ext, &[])
    }

    /// The same with the external wrench that each sensor sees, as [`crate::sensor::LoadCompensator`] gives it: (force,
    /// moment) at the sensor's origin, world axes (N, Nm). A sensor without a wrench is left out.
    ///
    /// # Errors
    /// [`Error::Input`] names the argument.
    pub fn isolate_sensed(
        &mut self,
        q: &[f64],
        tau_ext: &[f64],
        wrenches: &[Option<Vector6<f64>>],
    ) -> Result<&Isolation> {
        self.robot.check_configuration(q)?;
        self.robot.check_tangent("tau_ext", tau_ext)?;
        check_wrenches(&self.regions.tree, wrenches)?;
        let mut kinematics = std::mem::replace(&mut self.kinematics, Kinematics::empty());
        kinematics.set_configuration(&self.robot, q);
        // Closed forms tell several contacts apart where a base floats; elsewhere the posterior has its own noise.
        self.growing = self.stated && self.robot.floating_base();
        self.isolate_at(&kinematics, tau_ext, wrenches, None);
        self.growing = false;
        if !self.isolation.contacts.is_empty() {
            let Self { evidence, surface, wrench_posterior, regions, isolation, robot, noise, .. } = self;
            evidence.set(robot, &kinematics, &regions.tree, (tau_ext, noise.at_rest()), wrenches);
            let now = evidence.at(&kinematics);
            if let Some(surface) = surface {
                surface.judge(&now, isolation);
                isolation.name_sources(&regions.tree);
            }
            isolation.determine_wrench(&now, wrench_posterior);
        }
        self.kinematics = kinematics;
        Ok(&self.isolation)
    }

    /// The same with poses that are known already, and with the sensors' torques as an observer knows them.
    pub(crate) fn isolate_at(
        &mut self,
        kinematics: &Kinematics,
        tau_ext: &[f64],
        wrenches: &[Option<Vector6<f64>>],
        lagged: Option<&WrenchObserver>,
    ) -> &Isolation {
        self.isolation.clear();
        self.several.work.reset();
        self.divide(kinematics, tau_ext, wrenches, lagged);
        let masked = self.left_out.contains(&true);
        if masked {
            self.regions.leave_out(&self.robot, &self.left_out);
            for (residual, _) in
                self.residual.iter_mut().zip(&self.left_out).filter(|(_, left_out)| **left_out)
            {
                *residual = 0.0;
            }
        }
        self.unexplained.copy_from_slice(&self.residual);
        // Joints that feel nothing at all do not contradict the sensors: an observer is slower than they are.
        let felt = (0..tau_ext.len()).any(|k| !self.left_out[k] && is_over(tau_ext[k], self.threshold[k]));
        if felt && !self.regions.base.unknown {
            std::mem::swap(&mut self.region, &mut self.regions.base);
            self.isolate_from_torques(kinematics);
            std::mem::swap(&mut self.region, &mut self.regions.base);
        }
        for index in 0..wrenches.len() {
            let sensor = self.regions.tree.distal_first()[index];
            self.isolate_behind_sensor(kinematics, sensor, wrenches);
        }
        if !wrenches.is_empty() {
            let Self { robot, isolation, .. } = self;
            let depth = |link: LinkIndex| robot.chain(robot[link].body).len();
            isolation
                .contacts
                .sort_unstable_by_key(|contact| (std::cmp::Reverse(depth(contact.link)), contact.link));
        }
        let overflow = [self.line.take_overflow(), self.several.caster.take_overflow()];
        self.isolation.truncated |= overflow.contains(&true) || self.several.work.was_refused();
        if masked {
            self.regions.restore(&self.robot);
        }
        self.isolation.residual = self.unexplained.iter().map(|x| x * x).sum::<f64>().sqrt();
        &self.isolation
    }
}

/// One for each sensor, finite or none.
fn check_wrenches(tree: &SensorTree, wrenches: &[Option<Vector6<f64>>]) -> Result<()> {
    if wrenches.len() != tree.len() {
        return Err(Error::input(
            "wrenches",
            format!("expected one for each of the {} sensors, got {}", tree.len(), wrenches.len()),
        ));
    }
    for (name, wrench) in tree.names().iter().zip(wrenches) {
        let Some(wrench) = wrench else { continue };
        if let Some(value) = wrench.iter().find(|x| x.is_nan() || x.abs() > crate::robot::LARGEST) {
            return Err(Error::input(
                "wrenches",
                format!("that of '{name}' has {value}; give finite numbers [N, Nm], or none (NaN in NumPy) to leave it out"),
            ));
        }
    }
    Ok(())
}
