//! Torques that say nothing of the model: missing, or of something else.

use super::evidence::Evidence;
use super::finding::{FaultCode, Finding};
use super::fit::Fit;
use super::motion::Motion;
use super::prior::Reference;
use super::report::spoils;
use crate::robot::Robot;

/// Torques have nothing to do with a model that leaves more than this share of their mean square, ...
const NOTHING_IN_COMMON: f64 = 0.5;
/// ... and so many times the torque that spoils the detection of contacts.
const GROSS: f64 = 5.0;

/// Torques that never change although the model says that they must.
pub(super) fn missing_torques(robot: &Robot, motion: &Motion) -> Option<Finding> {
    /// Change of torque that no sensor misses (Nm; N), root mean square.
    const FELT: f64 = 0.5;
    if !motion.consecutive || motion.stands_still() || !motion.torque_is_constant() {
        return None;
    }
    let evidence = Evidence::new(robot, motion);
    let changes = |joint: usize| {
        let unexplained = evidence.unexplained(joint);
        let n = unexplained.len().max(1) as f64;
        let mean = unexplained.iter().sum::<f64>() / n;
        (unexplained.iter().map(|torque| (torque - mean).powi(2)).sum::<f64>() / n).sqrt() > FELT
    };
    (0..motion.nv).any(changes).then(|| {
        let value =
            if motion.tau.iter().all(|tau| *tau == 0.0) { "are zero all the time" } else { "never change" };
        unjudged(&format!(
            "the torques {value} although the robot moves: they are missing, and nothing was judged by them"
        ))
    })
}

/// Torques that the model does not explain even where everything found is taken into account.
pub(super) fn unexplained_torques(
    evidence: &Evidence,
    reference: &Reference,
    left: Option<&Fit>,
) -> Option<Finding> {
    let text = "the torques have nothing to do with the model, even with all that was found: other findings of the torques \
                are in doubt; see whether they are those of this robot, in Nm and at these times";
    // Without accelerations much of the torque of a moving robot is not explained.
    if !evidence.moving {
        return None;
    }
    // Numbers so large that nothing can be computed from them.
    let Some(left) = left else { return (evidence.rows > 1.0).then(|| unjudged(text)) };
    let relative = |torque: f64, joint: usize| (torque / reference.effort[joint]).powi(2);
    let measured = |joint: usize| evidence.square(joint, evidence.parts.torque(joint)).sqrt();
    let all = |size: &dyn Fn(usize) -> f64| (0..evidence.nv).map(|k| relative(size(k), k)).sum::<f64>();
    let missed = all(&|joint| left.sigma[joint]);
    let worst = (0..evidence.nv).map(|k| spoils(reference, k, left.sigma[k])).fold(0.0, f64::max);
    let explained = missed <= NOTHING_IN_COMMON * all(&measured) || worst <= GROSS;
    (!explained).then(|| unjudged(text))
}

fn unjudged(text: &str) -> Finding {
    Finding::new(FaultCode::NotJudged, text.into()).major_if(true)
}
