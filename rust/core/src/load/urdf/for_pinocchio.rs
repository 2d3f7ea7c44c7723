//! A checked URDF for another reader of URDF.

use std::path::Path;

use super::checked::{self, Checked};
use super::options::UrdfOptions;
use super::xml::Element;
use super::{shapes, tree};
use crate::error::Result;
use crate::surface::Geometry;

/// A URDF's text for another reader of URDF, such as Pinocchio, that gives it the same robot.
///
/// ```
/// use contactsense::load::{CheckedUrdf, UrdfOptions};
///
/// let checked = CheckedUrdf::read("no_such_file.urdf", &UrdfOptions::default());
/// assert!(checked.unwrap_err().to_string().contains("no_such_file.urdf"));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct CheckedUrdf {
    /// Links, named "link:" and their name, and joints. In place of shapes that not every reader knows the same way
    /// (meshes and capsules) there are spheres of 1 m.
    pub xml: String,
    /// What these are: the link's name, the place of the shape among the link's, and the shape.
    pub shapes: Vec<(String, usize, Geometry)>,
    /// What was odd, and what was done about it.
    pub warnings: Vec<String>,
}

impl CheckedUrdf {
    /// Keeps a link apart from a joint of the same name, which Pinocchio cannot lock.
    pub const LINK_PREFIX: &'static str = "link:";

    /// Reads and checks a file, and reads its meshes; locked joints, gravity and armature are left to the reader.
    ///
    /// # Errors
    /// As [`from_urdf`](super::from_urdf).
    pub fn read(path: impl AsRef<Path>, options: &UrdfOptions) -> Result<Self> {
        let path = path.as_ref();
        Self::read_file(path, options).map_err(|error| error.in_file(path))
    }

    fn read_file(path: &Path, options: &UrdfOptions) -> Result<Self> {
        let Checked { name, mut elements, robot, warnings } = checked::read(path, options)?;
        tree::visits(&robot, options.floating_base)?;
        let mut shapes = vec![];
        for link in &robot.links {
            for (place, part) in shapes::parts(link)?.into_iter().enumerate() {
                if matches!(part.geometry, Geometry::Mesh { .. } | Geometry::Capsule { .. }) {
                    shapes.push((link.name.clone(), place, part.geometry));
                }
            }
        }
        elements.iter_mut().for_each(for_another_reader);
        Ok(Self { xml: Element::robot(&name, elements).text(), shapes, warnings })
    }
}

fn for_another_reader(element: &mut Element) {
    let is_name =
        |tag: &str, name: &str| matches!((tag, name), ("link", "name") | ("parent" | "child", "link"));
    for (name, value) in &mut element.attributes {
        if is_name(&element.tag, name) {
            *value = format!("{}{value}", CheckedUrdf::LINK_PREFIX);
        }
    }
    if ["mesh", "capsule"].contains(&element.tag.as_str()) {
        element.tag = "sphere".into();
        element.attributes = vec![("radius".into(), "1".into())];
    }
    element.children.iter_mut().for_each(for_another_reader);
}
