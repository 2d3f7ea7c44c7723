//! A URDF file, checked: what is used of it, and nothing that a reader would refuse, drop or misread in silence.
//!
//! On its own `urdf-rs` reads 70 of 73 published files; the others have a texture without a file name. It also
//! refuses prefixes of extension tags for which no namespace is declared, descends one call an element, skips words
//! that are no numbers, takes a missing `<limit>` for zeros, and names no element in its messages. Pinocchio drops
//! shapes and joints that it does not know, and reads mesh files from anywhere. So both are given only what is used.

use std::path::Path;

use super::element::{check, keep_first};
use super::joints;
use super::meshes::MeshFinder;
use super::options::UrdfOptions;
use super::shapes::{choose_shapes, is_shape, ROLES};
use super::text;
use super::xml::Element;
use crate::error::{Error, Result};
use crate::load::problem::Problem;

/// Elements and what is read in them; nothing else of the file is.
const READ: [(&str, &[&str]); 7] = [
    ("robot", &["link", "joint"]),
    ("link", &["inertial", "collision", "visual"]),
    ("inertial", &["origin", "mass", "inertia"]),
    ("collision", &["origin", "geometry"]),
    ("visual", &["origin", "geometry"]),
    ("geometry", &[]),
    ("joint", &["parent", "child", "origin", "axis", "limit", "mimic", "dynamics"]),
];
/// Links, whose chosen shapes are all `<collision>`, and joints.
pub(super) struct Checked {
    pub name: String,
    pub elements: Vec<Element>,
    pub robot: urdf_rs::Robot,
    pub warnings: Vec<String>,
}

/// Reads and checks a file.
pub(super) fn read(path: &Path, options: &UrdfOptions) -> Result<Checked> {
    let is_read = |parent: &str, tag: &str| {
        READ.iter().any(|(name, read)| *name == parent && (read.contains(&tag) || parent == "geometry"))
    };
    let Element { tag, attributes, children: mut elements } = Element::parse(&text::read(path)?, is_read)?;
    if tag != "robot" {
        return Err(Error::model(format!("it is not a URDF: its root element is <{tag}>, not <robot>")));
    }
    if !elements.iter().any(|element| element.tag == "link") {
        return Err(Error::model("it has no links (a xacro file must be expanded first)"));
    }
    let mut warnings = vec![];
    for element in &mut elements {
        let owner = element.owner();
        if element.name().is_empty() {
            return Err(Error::model(format!("a <{}> has no name", element.tag)));
        }
        joints::complete(element);
        // Shapes are checked after all links and joints.
        for child in element.children.iter_mut().filter(|child| !is_shape(child)) {
            check(child, &owner, Error::model).map_err(|error| error.of(&owner))?;
        }
        keep_first(element);
        joints::check(element, &owner).map_err(|error| error.of(&owner))?;
    }
    let mut meshes = MeshFinder::new(path, &options.package_dirs);
    choose_shapes(&mut elements, options, &mut meshes, &mut warnings)?;
    let robot = parse(&elements).map_err(|whole| blame(&elements).unwrap_or(whole))?;
    check_names(&elements, &robot)?;
    warnings.extend(joints::oddities(&elements));
    let name = attributes.into_iter().find(|(name, _)| name == "name").map(|(_, value)| value);
    let stem = || path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let name = name.filter(|name| !name.is_empty()).unwrap_or_else(stem);
    Ok(Checked { name, elements, robot, warnings })
}

fn parse(elements: &[Element]) -> Result<urdf_rs::Robot> {
    urdf_rs::read_from_string(&Element::robot("", elements.to_vec()).text())
        .map_err(Problem::from_error)
        .map_err(|said| Error::model(said.to_string()).because(said.cause))
}

/// The error of the first element that `urdf-rs` does not read, of its shapes where it reads the rest.
fn blame(elements: &[Element]) -> Option<Error> {
    for element in elements {
        let Err(error) = parse(std::slice::from_ref(element)) else { continue };
        let owner = element.owner();
        let text = format!("{owner} cannot be read: {error}");
        let mut bare = element.clone();
        bare.children.retain(|child| !ROLES.contains(&child.tag.as_str()));
        let is_shape = element.tag == "link" && parse(&[bare]).is_ok();
        return Some(if is_shape { Error::geometry(text) } else { Error::model(text) }.of(&owner));
    }
    None
}

/// Names that a second pass through XML changes cannot be kept.
fn check_names(elements: &[Element], robot: &urdf_rs::Robot) -> Result<()> {
    let of = |tag: &'static str| elements.iter().filter(move |element| element.tag == tag).map(Element::name);
    let links = robot.links.iter().map(|link| link.name.as_str());
    let joints = robot.joints.iter().map(|joint| joint.name.as_str());
    for (written, read) in of("link").chain(of("joint")).zip(links.chain(joints)) {
        if written != read {
            return Err(Error::model(format!("{written:?} cannot be a name; leave control characters out")));
        }
    }
    Ok(())
}
