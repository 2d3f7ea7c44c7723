//! Which inertias a link and a body can have.

use nalgebra::{Matrix3, SymmetricEigen};

use super::list;
use crate::error::{Error, Result};
use crate::robot::description::{LinkDescription, RobotDescription};
use crate::robot::BodyIndex;

/// A principal moment is clearly negative when below both: published models have rounding errors below the first,
/// and inertias moved to the wrong point (up to a fifth of the largest moment) below the second (kg m^2; share).
const NEGATIVE_MOMENT: f64 = 1e-6;
const NEGATIVE_SHARE: f64 = 0.5;
/// Published moments carry two or three digits (share).
const TRIANGLE_SLACK: f64 = 1e-2;
/// As good as zero (kg m^2).
pub(super) const NO_MOMENT: f64 = 1e-12;
const MOST_STEPS: usize = 1000;

/// Warnings of inertias that no rigid body has, and of links that move with a joint but have no mass.
///
/// [`Error::Model`] where a principal moment of a moving body is clearly negative; a body is all that is fixed to one
/// joint, and a link of the base may be odd without harm.
pub(super) fn check(description: &RobotDescription) -> Result<Vec<String>> {
    let RobotDescription { joints, links, .. } = description;
    let mut odd_links: Vec<&LinkDescription> = vec![];
    for link in links {
        if is_odd(&principal_moments(&link.inertia)?) {
            odd_links.push(link);
        }
    }
    let mut odd_joints = vec![];
    for (index, joint) in joints.iter().enumerate() {
        let (body, moments) = (BodyIndex::new(index + 1), principal_moments(&joint.inertia)?);
        if moments[0] < -f64::max(NEGATIVE_MOMENT, NEGATIVE_SHARE * moments[2]) {
            let links = links.iter().filter(|link| link.body == body);
            let links: Vec<&str> = links.map(|link| link.name.as_str()).collect();
            let owner = format!("joint '{}'", joint.name);
            return Err(Error::model(format!(
                "{owner} (links {}): inertia has the negative principal moment {} kg m^2",
                list(&links),
                moments[0]
            ))
            .of(&owner));
        }
        // A body is odd through its links, unless none of them says so.
        if is_odd(&moments) && odd_links.iter().all(|link| link.body != body) {
            odd_joints.push(joint.name.as_str());
        }
    }
    let first_of_body = |link: &&LinkDescription| {
        let above = link.parent.and_then(|parent| links.get(parent.get()));
        link.body != BodyIndex::WORLD && above.is_some_and(|above| above.body != link.body)
    };
    let massless: Vec<&str> = links
        .iter()
        .filter(first_of_body)
        .filter(|link| link.mass == 0.0)
        .map(|link| link.name.as_str())
        .collect();
    let odd_links: Vec<&str> = odd_links.into_iter().map(|link| link.name.as_str()).collect();
    let warnings = [
        ("Inertias that no rigid body has (used as given), of the links", odd_links),
        ("Inertias that no rigid body has (used as given), of the bodies of the joints", odd_joints),
        ("These links move with a joint but have no mass (used as given):", massless),
    ];
    let named = warnings.into_iter().filter(|(_, names)| !names.is_empty());
    Ok(named.map(|(concern, names)| format!("{concern} {}", list(&names))).collect())
}

/// Negative principal moments, or such that break the triangle inequality I1 + I2 >= I3: no distribution of positive
/// mass has them.
fn is_odd([smallest, middle, largest]: &[f64; 3]) -> bool {
    *smallest < -NO_MOMENT || *largest > (1.0 + TRIANGLE_SLACK) * (smallest + middle) + NO_MOMENT
}

/// In rising order; bounded work whatever the numbers.
pub(crate) fn principal_moments(inertia: &Matrix3<f64>) -> Result<[f64; 3]> {
    let found = SymmetricEigen::try_new(*inertia, f64::EPSILON, MOST_STEPS);
    let mut moments: [f64; 3] = found
        .map(|found| found.eigenvalues.into())
        .ok_or_else(|| Error::model("an inertia has no principal moments; check its magnitude"))?;
    moments.sort_by(f64::total_cmp);
    Ok(moments)
}
