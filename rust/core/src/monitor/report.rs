//! What the monitor reports.

use nalgebra::Vector6;

use crate::isolation::Isolation;
use crate::robot::LinkIndex;
use crate::sensor::SensorIndex;

/// What the monitor says of one tick.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::monitor::{ContactMonitor, MonitorOptions};
/// use contactsense::robot::Robot;
/// use contactsense::Sample;
///
/// let mut monitor = ContactMonitor::new(Arc::new(Robot::example_arm()), &MonitorOptions::new(1e-3))?;
/// let upright = [0.0; 7];
/// for tick in 0..3 {
///     let report = monitor.update(&Sample::new(&upright, &upright, &upright))?;
///     assert!(!report.collision && report.isolation.contacts.is_empty());
///     assert_eq!(report.time, 1e-3 * f64::from(tick));
/// }
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct ContactReport {
    /// Since the first accepted call (s).
    pub time: f64,
    /// Whether there is a contact.
    pub collision: bool,
    /// Whether it began with this tick.
    pub onset: bool,
    /// How unlikely the torques are without contact: a Gaussian number would be so many standard deviations off as rarely.
    /// The largest over all gains of the observers; none where each joint has a threshold of its own.
    pub significance: Option<f64>,
    /// Whether a torque that stood still became the bias in this tick, which ended the contact: what hysteresis may have
    /// left, what outlasted [`MonitorOptions::bias_settle_time`](super::MonitorOptions::bias_settle_time), or no torque at
    /// all where the bias before was wrong.
    pub remainder_learned: bool,
    /// Region that detection alone gives.
    pub links: Vec<LinkIndex>,
    /// Bias-free external torque of all contacts `(nv,)`.
    pub external_torque: Vec<f64>,
    /// The same without wanted contacts (Vorndamme 2017, eq. 20) and stops of joints, zero where joints are left out `(nv,)`.
    /// Of contacts wanted at points, what the torque of forces there cannot explain, by least squares.
    pub collision_torque: Vec<f64>,
    /// External wrench that each sensor sees, world axes, at its origin; none where one is left out (N, Nm).
    pub wrenches: Vec<Option<Vector6<f64>>>,
    /// The sensors without a reading.
    pub sensors_left_out: Vec<SensorIndex>,
    /// Indices of the joints whose torques a wanted contact loads unmeasured: behind its sensor, and on the way there
    /// from the base while the sensor gives no reading, and until the observer has forgotten that gap.
    pub joints_left_out: Vec<usize>,
    /// Indices of the joints at a limit of their position whose stop pushes them inward: that torque is no contact.
    pub limited_joints: Vec<usize>,
    /// The contacts.
    pub isolation: Isolation,
}
