//! What is odd in a URDF though usable: one warning per concern.

use urdf_rs::{Joint, JointType};

use super::names::name_list;
use super::tree::Tree;

/// Warnings that name the joints and links concerned and say what is done about them.
pub(super) fn oddities(tree: &Tree) -> Vec<String> {
    let mut warnings = vec![];
    let mimics: Vec<String> = tree
        .moving()
        .filter_map(|joint| joint.mimic.as_ref().map(|mimic| format!("'{}' ('{}')", joint.name, mimic.joint)))
        .collect();
    if !mimics.is_empty() {
        let mimics = mimics.join(", ");
        warnings.push(format!("Joints that mimic another (kept as independent joints): {mimics}"));
    }
    let mut warn = |concern: &str, names: Vec<&str>| {
        if !names.is_empty() {
            warnings.push(format!("{concern}: {}", name_list(&names)));
        }
    };
    let named = |odd: fn(&Joint) -> bool| tree.moving().filter(|j| odd(j)).map(|j| j.name.as_str()).collect();
    warn("The axes of these joints are not of unit length (normalised)", named(not_of_unit_length));
    warn("The limits of these joints leave no range (kept as given)", named(without_range));
    // Frames behind fixed joints rarely have an inertia and need none.
    let (bare, described): (Vec<&str>, Vec<&str>) = tree
        .moving()
        .map(|joint| joint.child.link.as_str())
        .partition(|link| tree.without_inertial.contains(*link));
    warn("These links move with a joint but have no <inertial> (taken as massless)", bare);
    let links = &tree.robot.links;
    let massless =
        |name: &&str| links.iter().any(|link| link.name == **name && link.inertial.mass.value == 0.0);
    warn(
        "These links move with a joint but have zero mass (used as given)",
        described.into_iter().filter(massless).collect(),
    );
    warnings
}

fn not_of_unit_length(joint: &Joint) -> bool {
    let norm = joint.axis.xyz.iter().map(|x| x * x).sum::<f64>().sqrt();
    (norm - 1.0).abs() > 1e-3
}

fn without_range(joint: &Joint) -> bool {
    joint.joint_type != JointType::Continuous && joint.limit.lower >= joint.limit.upper
}
