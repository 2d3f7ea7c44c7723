//! Conventions on small robots, refusals by name, and no panic on corrupted text.

use std::path::PathBuf;

use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

use super::{from_urdf, UrdfGeometry, UrdfOptions};
use crate::robot::{BodyIndex, JointKind, Robot, RobotDescription};
use crate::surface::Geometry;
use crate::{Error, Result};

const INERTIAL: &str = r#"<inertial><origin xyz="0 0 0.1"/><mass value="2"/>
    <inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001"/></inertial>"#;
const LIMIT: &str = r#"<limit lower="-1" upper="2" effort="30" velocity="3"/>"#;

fn link(name: &str, inside: &str) -> String {
    format!(r#"<link name="{name}">{INERTIAL}{inside}</link>"#)
}

fn joint(name: &str, kind: &str, parent: &str, child: &str, inside: &str) -> String {
    format!(
        r#"<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
        <origin xyz="0 0 0.3" rpy="0.1 0.2 0.3"/>{inside}</joint>"#
    )
}

fn robot(parts: &[String]) -> String {
    format!(r#"<robot name="arm">{}</robot>"#, parts.concat())
}

/// Two branches, named against the order of the file, with a fixed tool.
fn arm() -> String {
    let capsule = r#"<collision><origin xyz="0 0 0.1"/><geometry><capsule radius="0.02" length="0.1"/></geometry>
        </collision><visual><geometry><box size="1 2 3"/></geometry></visual>"#;
    robot(&[
        link("base", ""),
        link("right", ""),
        link("left", ""),
        link("tool", capsule),
        link("slide", ""),
        joint("z_right", "revolute", "base", "right", &format!(r#"<axis xyz="0 2 0"/>{LIMIT}"#)),
        joint("a_left", "continuous", "base", "left", r#"<axis xyz="0 0.6 0.8"/>"#),
        joint("flange", "fixed", "left", "tool", ""),
        joint("rail", "prismatic", "tool", "slide", LIMIT),
    ])
}

/// A file that goes away with it.
struct Urdf(PathBuf);

impl Urdf {
    fn new(text: &[u8]) -> Self {
        use std::sync::atomic::{AtomicU32, Ordering};
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let folder = std::env::temp_dir().join(format!("contactsense-urdf-{}-{number}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a temporary folder");
        std::fs::write(folder.join("arm.urdf"), text).expect("a temporary file");
        Self(folder)
    }

    fn read(&self, options: &UrdfOptions) -> Result<RobotDescription> {
        from_urdf(self.0.join("arm.urdf"), options)
    }
}

impl Drop for Urdf {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

fn read(text: &str, options: &UrdfOptions) -> Result<RobotDescription> {
    Urdf::new(text.as_bytes()).read(options)
}

fn names(description: &RobotDescription) -> Vec<&str> {
    description.joints.iter().map(|joint| joint.name.as_str()).collect()
}

#[test]
fn children_go_depth_first_by_joint_name() {
    let arm = read(&arm(), &UrdfOptions::default()).unwrap();
    assert_eq!(names(&arm), ["a_left", "rail", "z_right"]);
    assert_eq!(arm.joints.iter().map(|joint| joint.parent.get()).collect::<Vec<_>>(), [0, 1, 0]);
    let kinds: Vec<JointKind> = arm.joints.iter().map(|joint| joint.kind).collect();
    assert_eq!(kinds, [JointKind::Continuous, JointKind::Prismatic, JointKind::Revolute]);
    let links: Vec<(&str, usize)> =
        arm.links.iter().map(|link| (link.name.as_str(), link.body.get())).collect();
    assert_eq!(links, [("base", 0), ("left", 1), ("tool", 1), ("slide", 2), ("right", 3)]);
    assert_eq!(arm.joints[2].axis, Vector3::y());
    assert!(arm
        .warnings
        .iter()
        .any(|text| text.contains("not of unit length") && text.contains("'z_right'")));
}

#[test]
fn what_is_fixed_to_a_joint_is_one_body() {
    let arm = read(&arm(), &UrdfOptions::default()).unwrap();
    let body = &arm.joints[0];
    assert_eq!(body.mass, 4.0);
    let tool = &arm.links[2].placement;
    let here = Vector3::new(0.0, 0.0, 0.1);
    let there = tool.transform_point(&here);
    assert!((body.com - 0.5 * (here + there)).norm() < 1e-15);
    // The parallel axis theorem for two equal masses.
    let own = Matrix3::new(0.02, 0.001, 0.0, 0.001, 0.03, 0.0, 0.0, 0.0, 0.04);
    let apart = there - here;
    let spread = Matrix3::identity() * apart.norm_squared() - apart * apart.transpose();
    let whole = own + tool.rotation * own * tool.rotation.transpose() + spread;
    assert!((body.inertia - whole).norm() < 1e-15);
}

#[test]
fn a_floating_base_carries_the_root_link() {
    let options = UrdfOptions { floating_base: true, ..UrdfOptions::default() };
    let free = read(&arm(), &options).unwrap();
    assert_eq!(names(&free)[0], "root_joint");
    assert_eq!((free.joints[0].kind, free.joints[0].mass), (JointKind::FreeFlyer, 2.0));
    assert!(free.links.iter().all(|link| link.body != BodyIndex::WORLD));
    let taken = arm().replace("rail", "root_joint");
    assert!(read(&taken, &UrdfOptions::default()).is_ok());
    assert!(
        matches!(read(&taken, &options), Err(Error::Model { problem: text, .. }) if text.contains("'root_joint'"))
    );
}

#[test]
fn a_limit_of_zero_is_no_missing_limit() {
    let effort = |limit: &str| {
        let turning = joint("wheel", "continuous", "base", "rim", limit);
        let wheel =
            read(&robot(&[link("base", ""), link("rim", ""), turning]), &UrdfOptions::default()).unwrap();
        assert_eq!((wheel.joints[0].lower, wheel.joints[0].upper), (None, None));
        wheel.joints[0].effort
    };
    assert_eq!(effort(""), None);
    assert_eq!(effort(r#"<limit velocity="2"/>"#), None);
    assert_eq!(effort(r#"<limit lower="0" upper="0" effort="0" velocity="0"/>"#), Some(0.0));
}

#[test]
fn locked_joints_merge() {
    let locked = vec![("rail".into(), 0.5), ("a_left".into(), 0.0), ("z_right".into(), 9.0)];
    let options = UrdfOptions { locked_joints: locked, floating_base: true, ..UrdfOptions::default() };
    let one = read(&arm(), &options).unwrap();
    assert_eq!(names(&one), ["root_joint"]);
    assert_eq!(one.joints[0].mass, 10.0);
    assert!(one.warnings.iter().any(|text| text.ends_with("outside their limits: 'z_right'")));
    let slide = one.links[2].placement.inverse_transform_point(&one.links[3].placement.translation);
    let (pitch, yaw) = (0.2_f64, 0.3_f64);
    let rail = Vector3::new(yaw.cos() * pitch.cos(), yaw.sin() * pitch.cos(), -pitch.sin());
    assert!((slide - Vector3::new(0.0, 0.0, 0.3) - 0.5 * rail).norm() < 1e-15, "{slide}");

    for (name, position, message) in
        [("flange", 0.0, "valid names: 'z_right', 'a_left', 'rail'"), ("rail", f64::NAN, "'rail'")]
    {
        let options = UrdfOptions { locked_joints: vec![(name.into(), position)], ..UrdfOptions::default() };
        let refused = read(&arm(), &options);
        assert!(
            matches!(&refused, Err(error @ Error::Input { .. }) if error.to_string().contains(message)),
            "{refused:?}"
        );
    }
}

#[test]
fn shapes_of_either_role() {
    let collision = read(&arm(), &UrdfOptions::default()).unwrap();
    let part = &collision.links[2].geometry[0];
    assert_eq!(part.geometry, Geometry::Capsule { radius: 0.02, half_length: 0.05 });
    assert_eq!(part.pose.translation, Vector3::new(0.0, 0.0, 0.1));
    let options = UrdfOptions { geometry: UrdfGeometry::Visual, ..UrdfOptions::default() };
    let visual = read(&arm(), &options).unwrap();
    assert_eq!(visual.links[2].geometry[0].geometry, Geometry::Box { half_extents: [0.5, 1.0, 1.5] });
}

#[test]
fn mesh_files_come_from_allowed_folders_only() {
    const STL: &str =
        "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n\
                       endfacet\nendsolid s\n";
    let outside = Urdf::new(b"");
    std::fs::write(outside.0.join("part.stl"), STL).unwrap();
    let folder = outside.0.display();
    for name in
        [format!("{folder}/part.stl"), format!("file://{folder}/part.stl"), "package://pkg/part.stl".into()]
    {
        let mesh = format!(r#"<collision><geometry><mesh filename="{name}"/></geometry></collision>"#);
        let urdf = Urdf::new(robot(&[link("a", &mesh)]).as_bytes());
        let refused = urdf.read(&UrdfOptions::default());
        let place = if name.starts_with("package") { "was not found" } else { "lies outside" };
        assert!(
            matches!(&refused, Err(Error::Geometry { problem: text, .. }) if text.contains(place)),
            "{refused:?}"
        );
        std::fs::create_dir_all(outside.0.join("pkg")).unwrap();
        std::fs::write(outside.0.join("pkg/part.stl"), STL).unwrap();
        let options = UrdfOptions { package_dirs: vec![outside.0.clone()], ..UrdfOptions::default() };
        let found = urdf.read(&options).unwrap();
        assert!(
            matches!(&found.links[0].geometry[0].geometry, Geometry::Mesh { triangles, .. } if triangles.len() == 1)
        );
        std::fs::remove_dir_all(outside.0.join("pkg")).unwrap();
    }
}

#[cfg(unix)]
#[test]
fn links_out_of_the_folder_are_followed_and_refused() {
    let outside = Urdf::new(b"");
    std::fs::write(outside.0.join("part.stl"), "solid").unwrap();
    let mesh = r#"<collision><geometry><mesh filename="part.stl"/></geometry></collision>"#;
    let urdf = Urdf::new(robot(&[link("a", mesh)]).as_bytes());
    std::os::unix::fs::symlink(outside.0.join("part.stl"), urdf.0.join("part.stl")).unwrap();
    let refused = urdf.read(&UrdfOptions::default());
    assert!(
        matches!(&refused, Err(Error::Geometry { problem: text, .. }) if text.contains("lies outside")),
        "{refused:?}"
    );
}

#[test]
fn refusals_name_the_element() {
    let two = |text: &str| robot(&[link("a", ""), link("b", ""), text.to_owned()]);
    let cases = [
        ("<robot".to_owned(), "not XML"),
        ("<model/>".to_owned(), "<model>"),
        (two(""), "'a', 'b'"),
        (two(&joint("j", "planar", "a", "b", "")), "joint 'j' has the type 'planar'"),
        (two(&joint("j", "revolute", "a", "b", "")), "joint 'j' is revolute and needs <limit>"),
        (two(&joint("j", "continuous", "a", "b", r#"<axis xyz="0 x 1 0"/>"#)), "joint 'j': 'xyz' of <axis>"),
        (two(&joint("j", "continuous", "a", "b", r#"<axis xyz="0 nan 0"/>"#)), "joint 'j': 'xyz' of <axis>"),
        (two(&joint("j", "fixed", "a", "ghost", "")), "'ghost'"),
        (
            two(&joint("j", "fixed", "a", "b", "")).replace(r#"value="2""#, r#"value="inf""#),
            "link 'a': 'value'",
        ),
        (two(&joint("j", "continuous", "a", "b", "")).replace("0.04", "-4"), "negative principal moment"),
    ];
    for (text, message) in cases {
        let refused = read(&text, &UrdfOptions::default()).and_then(Robot::new);
        assert!(
            matches!(&refused, Err(Error::Model { problem: said, .. }) if said.contains(message)),
            "{refused:?}"
        );
    }
}

#[test]
fn deep_and_growing_text_is_refused() {
    // What stands between the elements does not hide how deep they go; what is not used of them is left out.
    for step in ["<x>", "<x y='/>'>", "<x><!-- </x> -->", "<x><?p </x>?>", "<x><![CDATA[</x>]]>", "<x><y/>"] {
        let deep = format!("<robot name='a'><link name='a'>{}", step.repeat(100_000));
        let refused = read(&deep, &UrdfOptions::default());
        assert!(
            matches!(&refused, Err(Error::Model { problem: text, .. }) if text.contains("not XML")),
            "{step}: {refused:?}"
        );
        let whole = format!("{deep}{}</link></robot>", "</x>".repeat(100_000));
        assert!(read(&whole, &UrdfOptions::default()).is_ok(), "{step}");
    }
    let wide = format!("<robot name='a'><link name='a'/>{}</robot>", "<x><y z='>'/></x>".repeat(10_000));
    assert!(read(&wide, &UrdfOptions::default()).is_ok());
    let growing =
        r#"<!DOCTYPE r [<!ENTITY a "x"><!ENTITY b "&a;&a;">]><robot name='&b;'><link name='a'/></robot>"#;
    let refused = read(growing, &UrdfOptions::default());
    assert!(
        matches!(&refused, Err(Error::Model { problem: text, .. }) if text.contains("document type")),
        "{refused:?}"
    );
}

#[test]
fn text_in_other_encodings_is_read() {
    let text = arm().replace("tool", "werkzeugträger");
    let utf16: Vec<u8> = format!("\u{feff}{text}").encode_utf16().flat_map(u16::to_le_bytes).collect();
    let declared = format!(r#"<?xml version="1.0" encoding="ISO-8859-1"?>{text}"#);
    let latin1: Vec<u8> = declared.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    for bytes in [text.clone().into_bytes(), format!("\u{feff}{text}").into_bytes(), utf16, latin1] {
        let arm = Urdf::new(&bytes).read(&UrdfOptions::default()).unwrap();
        assert_eq!(arm.links[2].name, "werkzeugträger");
    }
    let foreign = format!(r#"<?xml version="1.0" encoding="klingon"?>{text}"#);
    assert!(
        matches!(read(&foreign, &UrdfOptions::default()), Err(Error::Model { problem: said, .. }) if said.contains("klingon"))
    );
}

/// Loads to the end, or refuses.
fn load_or_refuse(text: &[u8], floating_base: bool) {
    let options = UrdfOptions { floating_base, ..UrdfOptions::default() };
    match Urdf::new(text).read(&options).and_then(Robot::new) {
        Ok(robot) => assert!(robot.mass_matrix(&robot.neutral()).is_ok()),
        Err(error) => assert!(!error.to_string().is_empty()),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn corrupt_bytes_do_not_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        floating in any::<bool>(),
    ) {
        let mut text = arm().into_bytes();
        for (place, byte) in changes {
            let place = place.index(text.len());
            text[place] = byte;
        }
        load_or_refuse(&text, floating);
    }

    #[test]
    fn cut_text_does_not_panic(start in any::<prop::sample::Index>(), length in 1..400_usize) {
        let text = arm();
        let start = start.index(text.len());
        let end = text.len().min(start + length);
        load_or_refuse(&[&text.as_bytes()[..start], &text.as_bytes()[end..]].concat(), false);
    }

    #[test]
    fn any_number_anywhere_does_not_panic(
        place in any::<prop::sample::Index>(),
        number in prop_oneof![any::<f64>().prop_map(|x| format!("{x:?}")), "[-+.0-9eE]{0,12}"],
    ) {
        let text = arm();
        // Every odd piece lies between quotes.
        let mut pieces: Vec<&str> = text.split('"').collect();
        let numeric: Vec<usize> =
            (1..pieces.len()).step_by(2).filter(|k| pieces[*k].starts_with(|c: char| "-.0123456789".contains(c))).collect();
        pieces[numeric[place.index(numeric.len())]] = &number;
        load_or_refuse(pieces.join("\"").as_bytes(), true);
    }

    #[test]
    fn any_name_is_kept_or_refused(name in "\\PC{1,8}|[&<>\"' \t\n]{1,4}") {
        let mut written = String::new();
        for c in name.chars() {
            written += &format!("&#{};", u32::from(c));
        }
        match read(&robot(&[link(&written, "")]), &UrdfOptions::default()) {
            Ok(robot) => prop_assert_eq!(&robot.links[0].name, &name),
            Err(error) => prop_assert!(matches!(error, Error::Model { .. }), "{error}"),
        }
    }
}
