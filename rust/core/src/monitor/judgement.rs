//! Whether a tick's torque is a contact: slow errors are subtracted, and all joints are tested at once or one by one.

use super::contact_monitor::ContactMonitor;
use super::report::ContactReport;
use super::sensing::Sensing;
use crate::observer::Step;

impl ContactMonitor {
    /// Tests all joints at once, and subtracts the bias that the test follows; `new` and `felt` as in
    /// [`ContactMonitor::remove_bias`].
    pub(super) fn test_all_joints(&mut self, step: Step, new: bool, felt: bool) {
        let Self { test, observer, sensing, detector, release, report, clock, free, .. } = self;
        let Some(test) = test else { return };
        let ContactReport { collision_torque, external_torque, remainder_learned, significance, .. } = report;
        let length = step.length(clock.dt());
        *remainder_learned = false;
        leave_out(sensing, collision_torque, Some(test.slow().bias()));
        test.advance(
            observer.kinematics(),
            observer.velocity(),
            observer.known_rate(),
            observer.unexplained(),
            step,
        );
        test.evaluate(collision_torque, detector.collision(), free.if_any());
        let touched = detector.collision() || felt || test.suspicious();
        if touched && !new {
            release.interrupt();
        } else if touched {
            let over = release.update(test.prompt(), test.slow().bias(), length);
            if over && !felt && test.slow().allows(release.remainder(), |k| release.could_keep(k)) {
                test.slow_mut().set(release.remainder());
                release.reset();
                detector.reset();
                test.evaluate(collision_torque, false, free.if_any());
                *remainder_learned = true;
            }
        } else {
            release.reset();
        }
        test.follow(length, touched || !new);
        detector.update(test.joints(), length);
        *significance = Some(test.significance());
        for torque in [collision_torque, external_torque] {
            torque.iter_mut().zip(test.slow().bias()).for_each(|(torque, bias)| *torque -= bias);
        }
        if free.any() {
            test.leave(&mut report.collision_torque, free);
        }
    }

    /// Subtracts the bias, which follows the collision torque while nothing touches, over a step of `length` (s). `new`
    /// is false where the step brought no new torque: the first, and one over a gap; `felt`: a sensor is over its threshold.
    /// False during the bias's first estimate.
    pub(super) fn remove_bias(&mut self, length: f64, new: bool, felt: bool) -> bool {
        let Self { bias, fixed_bias, sensing, detector, release, report, free, scale, .. } = self;
        let ContactReport { collision_torque, external_torque, remainder_learned, .. } = report;
        *remainder_learned = false;
        let Some(bias) = bias else {
            for torque in
                [&mut *collision_torque, external_torque].into_iter().filter(|_| fixed_bias.is_some())
            {
                let bias = fixed_bias.iter().flatten();
                torque.iter_mut().zip(bias).for_each(|(torque, bias)| *torque -= bias);
            }
            leave_out(sensing, collision_torque, None);
            if free.any() {
                free.leave(0, scale, collision_torque);
            }
            return true;
        };
        // A joint that is left out has no torque to follow.
        leave_out(sensing, collision_torque, Some(bias.bias()));
        if free.any() {
            collision_torque.iter_mut().zip(bias.bias()).for_each(|(torque, bias)| *torque -= bias);
            free.leave(0, scale, collision_torque);
            collision_torque.iter_mut().zip(bias.bias()).for_each(|(torque, bias)| *torque += bias);
        }
        let ready = bias.ready();
        let without_bias = collision_torque.iter().zip(bias.bias()).map(|(torque, bias)| torque - bias);
        let touched = ready && (detector.collision() || felt || detector.any_over(without_bias));
        if touched && !new {
            release.interrupt();
        } else if touched {
            let over = release.update(collision_torque, bias.bias(), length);
            // A sensor that feels a contact knows better than a torque that stands still.
            if over && !felt && bias.allows(release.remainder()) {
                bias.set(release.remainder());
                release.reset();
                detector.reset();
                *remainder_learned = true;
            }
        } else {
            release.reset();
            if new {
                bias.follow(collision_torque, length);
            }
        }
        for torque in [collision_torque, external_torque] {
            torque.iter_mut().zip(bias.bias()).for_each(|(torque, bias)| *torque -= bias);
        }
        ready
    }
}

/// Puts `value`, or zero, for the torques of joints that are left out.
fn leave_out(sensing: &Option<Sensing>, torque: &mut [f64], value: Option<&[f64]>) {
    let Some(sensing) = sensing else { return };
    for (k, torque) in torque.iter_mut().enumerate().filter(|(k, _)| sensing.blind()[*k]) {
        *torque = value.map_or(0.0, |value| value[k]);
    }
}
