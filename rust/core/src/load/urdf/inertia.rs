//! Which inertias a link and a body can have.

use nalgebra::{Matrix3, SymmetricEigen};

use super::build::tensor;
use super::names::name_list;
use super::tree::Tree;
use crate::error::{Error, Result};
use crate::robot::description::RobotDescription;
use crate::robot::BodyIndex;

/// A principal moment is clearly negative when below both: published models have rounding errors below the first,
/// and inertias moved to the wrong point (up to a fifth of the largest moment) below the second (kg m^2).
const NEGATIVE_MOMENT: f64 = 1e-6;
const NEGATIVE_SHARE: f64 = 0.5;
/// Published moments carry two or three digits.
const TRIANGLE_SLACK: f64 = 1e-2;
/// As good as zero (kg m^2).
pub(super) const NO_MOMENT: f64 = 1e-12;
const MOST_STEPS: usize = 1000;

/// A warning of inertias with negative principal moments, or with such that break the triangle inequality
/// I1 + I2 >= I3: no distribution of positive mass has them. [`Error::Model`] for a negative mass.
pub(super) fn check_links(tree: &Tree) -> Result<Option<String>> {
    let mut odd = vec![];
    for link in tree.robot.links.iter().filter(|link| !tree.without_inertial.contains(&link.name)) {
        let mass = link.inertial.mass.value;
        if mass < 0.0 {
            let owner = format!("link '{}'", link.name);
            return Err(Error::model(format!("{owner}: mass must not be negative, not {mass} kg")).of(&owner));
        }
        let [smallest, middle, largest] = principal_moments(tensor(&link.inertial))?;
        if smallest < -NO_MOMENT || largest > (1.0 + TRIANGLE_SLACK) * (smallest + middle) + NO_MOMENT {
            odd.push(&link.name);
        }
    }
    let text =
        || format!("Inertias that no rigid body has (used as given), of the links {}", name_list(&odd));
    Ok((!odd.is_empty()).then(text))
}

/// [`Error::Model`] where a principal moment of a moving body is clearly negative.
///
/// A link of the base may be odd without harm.
pub(super) fn check_bodies(description: &RobotDescription) -> Result<()> {
    for (index, joint) in description.joints.iter().enumerate() {
        let moments = principal_moments(joint.inertia)?;
        if moments[0] < -f64::max(NEGATIVE_MOMENT, NEGATIVE_SHARE * moments[2]) {
            let links = description.links.iter().filter(|link| link.body == BodyIndex::new(index + 1));
            let links: Vec<&str> = links.map(|link| link.name.as_str()).collect();
            return Err(Error::model(format!(
                "joint '{}' (links {}): inertia has the negative principal moment {} kg m^2",
                joint.name,
                name_list(&links),
                moments[0]
            ))
            .of(&format!("joint '{}'", joint.name)));
        }
    }
    Ok(())
}

/// In rising order.
fn principal_moments(inertia: Matrix3<f64>) -> Result<[f64; 3]> {
    let found = SymmetricEigen::try_new(inertia, f64::EPSILON, MOST_STEPS);
    let mut moments: [f64; 3] = found
        .map(|found| found.eigenvalues.into())
        .ok_or_else(|| Error::model("an inertia has no principal moments; check its magnitude"))?;
    moments.sort_by(f64::total_cmp);
    Ok(moments)
}
