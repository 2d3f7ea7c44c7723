//! What the motion of a log could not tell, and which motion would.

use super::unknowns::{ARMATURE, BIAS, COULOMB, VISCOUS};

/// A number is told by the log if that leaves less than this share of its uncertainty of before.
const TOLD: f64 = 0.5;
/// A joint's torque is understood if so much of its mean square, about its mean, is explained on blocks that were not fitted.
const UNDERSTOOD: f64 = 0.5;
/// Names in one note.
const SHOWN: usize = 8;

/// What is known of one joint.
pub(super) struct JointFacts<'a> {
    pub name: &'a str,
    /// Uncertainty of each term after the log as a share of that before.
    pub uncertain: [f64; 4],
    /// Share of the torque's variance that is left on blocks that were not fitted.
    pub left: f64,
    /// Largest speed (rad/s; m/s).
    pub speed: f64,
}

/// One sentence or two each.
pub(super) fn notes(joints: &[JointFacts<'_>], contacts: &[[f64; 2]], change: f64) -> Vec<String> {
    let named = |is: &dyn Fn(&JointFacts<'_>) -> bool| -> Vec<&str> {
        joints.iter().filter(|joint| is(joint)).map(|joint| joint.name).collect()
    };
    let untold = |term: usize| named(&move |joint| joint.uncertain[term] > TOLD);
    let mut notes = vec![];
    let mut add = |names: Vec<&str>, text: &dyn Fn(&str) -> String| {
        if !names.is_empty() {
            notes.push(text(&list(&names)));
        }
    };
    add(named(&|joint| joint.left > 1.0 - UNDERSTOOD), &|names| {
        format!(
            "The measured torque of {names} hardly follows the model: most of what it shows is not explained by inertia, \
             weight or friction, so it says little about contacts. Check sign, unit and order of these torques."
        )
    });
    add(named(&|joint| joint.speed < STILL), &|names| {
        format!("{names} did not move: nothing of friction or rotor inertia is known. {}", motion(names))
    });
    let moving = |names: Vec<&'_ str>| -> Vec<String> {
        let moves = |name: &&str| joints.iter().any(|joint| joint.name == *name && joint.speed >= STILL);
        names.into_iter().filter(moves).map(str::to_owned).collect()
    };
    let terms = [
        (BIAS, "The bias", "weights", "Poses all over the range of these joints would show it."),
        (COULOMB, "Coulomb friction", "viscous friction", "Slow and fast motion both ways would show it."),
        (VISCOUS, "Viscous friction", "Coulomb friction", "Slow and fast motion both ways would show it."),
        (
            ARMATURE,
            "The rotor inertia",
            "the inertia of the links",
            "Fast changes of speed in several poses would show it.",
        ),
    ];
    for (term, what, other, remedy) in terms {
        let names = moving(untold(term));
        add(names.iter().map(String::as_str).collect(), &|names| {
            format!("{what} of {names} cannot be told from {other}. {remedy} {}", motion(names))
        });
    }
    for [from, to] in contacts {
        notes.push(format!("From {from:.2} to {to:.2} s of the log something touched the robot: left out."));
    }
    if change >= LOOSE {
        notes.push(
            "Inertias were let free, since the description does not fit: a wrong tool, payload or robot is likely.".into(),
        );
    }
    notes
}

/// A joint that is slower stands (rad/s; m/s).
const STILL: f64 = 0.02;
/// A share by which bodies differ from a description that says little.
const LOOSE: f64 = 1.0;

fn motion(names: &str) -> String {
    format!("See exciting_motion(robot, 30, joints=[...]) for {names}.")
}

fn list(names: &[&str]) -> String {
    let shown = names[..names.len().min(SHOWN)].iter().map(|name| format!("'{name}'")).collect::<Vec<_>>();
    let more = names.len() - shown.len();
    if more > 0 {
        format!("{} and {more} more", shown.join(", "))
    } else {
        shown.join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: JointFacts<'static> =
        JointFacts { name: "good", uncertain: [0.01; 4], left: 0.01, speed: 1.0 };

    #[test]
    fn nothing_is_said_where_all_is_told() {
        assert!(notes(&[GOOD], &[], 0.1).is_empty());
    }

    #[test]
    fn joints_are_named_with_what_they_lack() {
        let still = JointFacts { name: "still", uncertain: [0.01, 0.9, 0.9, 0.9], speed: 0.0, ..GOOD };
        let slow = JointFacts { name: "slow", uncertain: [0.01, 0.01, 0.01, 0.9], ..GOOD };
        let blind = JointFacts { name: "blind", left: 0.9, ..GOOD };
        let notes = notes(&[GOOD, still, slow, blind], &[[1.0, 1.5]], 0.1);
        assert_eq!(notes.len(), 4, "{notes:?}");
        assert!(notes[0].contains("'blind'") && !notes[0].contains("'good'"));
        assert!(notes[1].contains("'still'") && notes[1].contains("exciting_motion"));
        assert!(notes[2].starts_with("The rotor inertia of 'slow'"));
        assert!(notes[3].contains("1.00 to 1.50 s"));
    }
}
