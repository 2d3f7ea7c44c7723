//! Contacts that force/torque sensors see (Vorndamme 2017, IV-B and eq. 27).

use nalgebra::{Vector3, Vector6};

use super::found::{Entry, Found, Scene};
use super::isolator::{ContactIsolator, CONTRADICTION, LEFT_OVER};
use super::line::best_first;
use super::result::Contact;
use super::rows::{Root, SENSOR_SHARE};
use super::wrench::WrenchEstimate;
use crate::detection::is_over;
use crate::observer::WrenchObserver;
use crate::robot::jacobian::jacobian_column;
use crate::robot::Kinematics;
use crate::sensor::{sensor_torque, SensorIndex};
use crate::spatial::vector::{moved, split, stack};
use crate::torque::{largest, LEVEL};

/// Moment along the force that rounding leaves [tolerances].
const EXACT: f64 = 1e-6;

impl ContactIsolator {
    /// Which sensors are in use, and what each joint feels of contacts in its own region: its torque less what the
    /// sensors behind it see (eq. 20). `lagged` are the sensors' torques as an observer knows them.
    pub(super) fn divide(
        &mut self,
        kinematics: &Kinematics,
        torque: &[f64],
        wrenches: &[Option<Vector6<f64>>],
        lagged: Option<&WrenchObserver>,
    ) {
        self.residual.copy_from_slice(torque);
        self.measured.fill(0.0);
        let Self {
            robot,
            regions,
            residual,
            measured,
            limit,
            noise,
            growing,
            active,
            sensed,
            wrench_threshold,
            ..
        } = self;
        let power = if wrenches.is_empty() { 1 } else { 2 };
        let largest = largest(torque);
        for (k, limit) in limit.iter_mut().enumerate() {
            let growing = if *growing { noise.growing(k, LEVEL, torque[k], largest) } else { 0.0 };
            *limit = growing.hypot(LEVEL * noise.at_rest()[k]).powi(power);
        }
        active.clear();
        active.extend(wrenches.iter().map(Option::is_some));
        regions.set_active(robot, active);
        for (sensor, wrench) in wrenches.iter().enumerate() {
            let Some(wrench) = wrench else { continue };
            let explained = match lagged {
                Some(lagged) => lagged.lagged_torque(sensor),
                None => {
                    sensor_torque(robot, kinematics, &regions.tree, sensor, wrench, sensed);
                    &*sensed
                }
            };
            let region =
                regions.tree.parent(sensor).map_or(&regions.base, |carrier| &regions.behind[carrier]);
            let position = regions.tree.position(kinematics, sensor);
            for joint in region.chain(robot, regions.tree.body(sensor)) {
                for (column, k) in robot.velocity_range(joint).enumerate() {
                    residual[k] -= explained[k];
                    // Components err one by one, also where their sum is small.
                    let axis = jacobian_column(robot, kinematics, joint, column, &position);
                    measured[k] += axis.component_mul(wrench).norm_squared();
                    limit[k] += axis.component_mul(&wrench_threshold[sensor]).norm_squared();
                }
            }
        }
        if !wrenches.is_empty() {
            limit.iter_mut().for_each(|limit| *limit = limit.sqrt());
        }
        for (measured, torque) in measured.iter_mut().zip(torque).filter(|(measured, _)| **measured > 0.0) {
            *measured = (*measured + torque * torque).sqrt();
        }
    }

    /// The contacts that load a sensor directly, not by way of the next sensor behind it.
    pub(super) fn isolate_behind_sensor(
        &mut self,
        kinematics: &Kinematics,
        sensor: usize,
        wrenches: &[Option<Vector6<f64>>],
    ) {
        let regions = &self.regions;
        let Some(wrench) = wrenches[sensor].filter(|_| !regions.wanted[sensor]) else { return };
        if regions.behind[sensor].unknown {
            return;
        }
        let (root, spread) = self.left_over(kinematics, sensor, wrench, wrenches);
        let over =
            |share: f64| (0..6).any(|i| is_over(root.value[i], root.threshold[i].max(share * spread[i])));
        if !over(0.0) {
            return;
        }
        let certain = over(LEFT_OVER);
        std::mem::swap(&mut self.region, &mut self.regions.behind[sensor]);
        let first = self.isolation.contacts.len();
        self.locate(kinematics, &root, certain);
        self.isolation.contacts[first..]
            .iter_mut()
            .for_each(|contact| contact.source = Some(SensorIndex::new(sensor)));
        std::mem::swap(&mut self.region, &mut self.regions.behind[sensor]);
    }

    /// A sensor's wrench `value` less those of the next sensors behind it (eq. 27), and how large the parts are.
    fn left_over(
        &self,
        kinematics: &Kinematics,
        sensor: usize,
        mut value: Vector6<f64>,
        wrenches: &[Option<Vector6<f64>>],
    ) -> (Root, Vector6<f64>) {
        let tree = &self.regions.tree;
        let position = tree.position(kinematics, sensor);
        let mut squares = value.component_mul(&value);
        let own = &self.wrench_threshold[sensor];
        let mut limits = own.component_mul(own);
        for (other, wrench) in wrenches.iter().enumerate() {
            let Some(wrench) = wrench.filter(|_| tree.parent(other) == Some(sensor)) else { continue };
            let arm = tree.position(kinematics, other) - position;
            value -= moved(&wrench, &arm);
            squares += moved_squares(&wrench, &arm);
            limits += moved_squares(&self.wrench_threshold[other], &arm);
        }
        let (spread, limits) = (squares.map(f64::sqrt), limits.map(f64::sqrt));
        let axes = std::array::from_fn(|i| {
            let axis = Vector3::ith(i % 3, 1.0);
            if i < 3 {
                stack(&axis, &Vector3::zeros())
            } else {
                stack(&position.cross(&axis), &axis)
            }
        });
        let tolerance = std::array::from_fn(|i| limits[i].hypot(SENSOR_SHARE * spread[i]));
        (Root { axes, value: value.into(), tolerance, threshold: limits.into() }, spread)
    }

    /// One force that explains the wrench, or several that explain it and the joints' torques; `certain`: the wrench
    /// is more than an error of the sensors.
    fn locate(&mut self, kinematics: &Kinematics, root: &Root, certain: bool) {
        let wrench = root.estimate();
        let moment = wrench.moment_along().abs();
        if moment > EXACT && !certain {
            return;
        }
        self.find_tips(LEFT_OVER);
        let tip = match self.tips.tips() {
            [tip] => Some(*tip),
            _ => None,
        };
        if moment > EXACT {
            let one_does = moment <= CONTRADICTION;
            if self.solve_several(kinematics, root, one_does) {
                return self.report_several(kinematics);
            }
        }
        if moment <= CONTRADICTION {
            if let Some(hit) = self.hit_in_region(kinematics, tip, &wrench) {
                // What contradicts the thresholds is not located.
                let narrow = root.narrow().estimate().moment_along().abs();
                let determined = moment <= EXACT || narrow <= CONTRADICTION;
                self.report_found(kinematics, &Found::new(wrench, hit), determined);
                return;
            }
        }
        // The wrench is known, the point is not.
        let body = tip.filter(|tip| self.region.links_of(&self.robot, *tip).next().is_some());
        let named = (1..self.robot.body_count()).filter(|other| body.is_none_or(|body| *other == body));
        let link = named.flat_map(|body| self.region.links_of(&self.robot, body)).next();
        if link.is_some() && self.isolation.contacts.len() == self.max_contacts {
            self.isolation.truncated = true;
        } else if let Some(link) = link {
            let mut contact = Contact::unlocated(link);
            let end = self.isolation.candidates.len();
            contact.candidates = end..end;
            self.isolation.contacts.push(contact);
            self.isolation.link_candidates.push(link);
            self.report_wrench(kinematics, &wrench);
        }
    }

    /// The first place along the force where it enters a link of the region: one that the joints allow, or any.
    /// Leaves all hits of these links at the end of the candidates.
    fn hit_in_region(
        &mut self,
        kinematics: &Kinematics,
        tip: Option<usize>,
        wrench: &WrenchEstimate,
    ) -> Option<Entry> {
        let (start, direction) = wrench.line_of_action()?;
        let scene = Scene { robot: &self.robot, kinematics, region: &self.region };
        let end = self.isolation.candidates.len();
        for allowed in [true, false] {
            match tip.filter(|_| allowed) {
                Some(tip) => self.bodies.grow(scene, tip, wrench, &self.residual, &self.limit),
                None => self.bodies.set_all(true),
            }
            self.isolation.candidates.truncate(end);
            for link in self.bodies.links(&self.robot, &self.region) {
                let hits = &mut self.isolation.candidates;
                self.line.cast(&self.robot, kinematics, link, &start, &direction, hits);
            }
            best_first(&mut self.isolation.candidates[end..]);
            let best = Entry::of(&self.isolation.candidates[end..]);
            if best.is_some() {
                return best;
            }
        }
        self.isolation.candidates.truncate(end);
        None
    }
}

/// Squares of what adds up to the components of a wrench that is moved by `arm`.
fn moved_squares(wrench: &Vector6<f64>, arm: &Vector3<f64>) -> Vector6<f64> {
    let (forces, moments) = split(&wrench.component_mul(wrench));
    let arms = arm.component_mul(arm);
    let turned = Vector3::new(
        arms.y * forces.z + arms.z * forces.y,
        arms.z * forces.x + arms.x * forces.z,
        arms.x * forces.y + arms.y * forces.x,
    );
    stack(&forces, &(moments + turned))
}
