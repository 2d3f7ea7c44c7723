//! Errors say what is wrong where, as fields, and keep what the system or a parser said.

use std::error::Error as _;
use std::path::{Path, PathBuf};

use contactsense::load::{load_mesh, UrdfOptions};
use contactsense::robot::{BodyIndex, Robot, RobotDescription};
use contactsense::surface::Geometry;
use contactsense::Error;

/// A folder that goes away with it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("contactsense-errors-{}-{name}", std::process::id()));
        std::fs::create_dir_all(&path).expect("a temporary folder");
        Folder(path)
    }

    fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.0.join(name);
        std::fs::write(&path, text).expect("a temporary file");
        path
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// Element, path and message of a model or geometry error.
fn parts(error: &Error) -> (Option<&str>, Option<&Path>, &str) {
    match error {
        Error::Model { element, path, problem, .. } | Error::Geometry { element, path, problem, .. } => {
            (element.as_deref(), path.as_deref(), problem)
        }
        other => panic!("{other:?}"),
    }
}

type Edit = fn(&mut RobotDescription);

fn load(path: &Path) -> Error {
    Robot::from_urdf(path, &UrdfOptions::default()).expect_err("it cannot be used")
}

#[test]
fn a_missing_file_keeps_the_error_of_the_system() {
    let folder = Folder::new("missing");
    let (urdf, mesh) = (folder.0.join("none.urdf"), folder.0.join("none.stl"));
    for (error, path) in
        [(load(&urdf), urdf), (load_mesh(&mesh, [1.0; 3]).expect_err("it is not there"), mesh.clone())]
    {
        assert_eq!(parts(&error).1, Some(path.as_path()));
        let source = error.source().and_then(|source| source.downcast_ref::<std::io::Error>());
        assert_eq!(source.map(std::io::Error::kind), Some(std::io::ErrorKind::NotFound), "{error:?}");
    }
}

#[test]
fn a_broken_file_keeps_the_error_of_the_parser() {
    let folder = Folder::new("broken");
    let urdf = folder.write("cut.urdf", "<robot name='cut'><link");
    let dae = folder.write("cut.dae", "<COLLADA><asset");
    for error in [load(&urdf), load_mesh(&dae, [1.0; 3]).expect_err("it is cut")] {
        let said = error.source().expect("the parser's error").to_string();
        assert!(error.to_string().contains(&said), "{error} {said}");
    }
}

#[test]
fn links_and_joints_are_named() {
    let folder = Folder::new("elements");
    let link = |name: &str, shape: &str| {
        format!(
            "<link name='{name}'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1'/></inertial>\
             {shape}</link>"
        )
    };
    let robot = |link_b: &str, joint: &str| {
        format!(
            "<robot name='two'>{}{link_b}<joint name='j' type='{joint}'><parent link='a'/><child link='b'/>\
             </joint></robot>",
            link("a", "")
        )
    };
    let ball = "<collision><geometry><sphere radius='-1'/></geometry></collision>";
    let mesh = "<collision><geometry><mesh filename='cut.stl'/></geometry></collision>";
    let missing = mesh.replace("cut", "none");
    folder.write("cut.stl", "solid\n");
    let cases = [
        (robot(&link("b", ""), "planar"), "joint 'j'", "two.urdf"),
        (robot(&link("b", "").replace("value='1'", "value='x'"), "continuous"), "link 'b'", "two.urdf"),
        (robot(&link("b", "").replace("value='1'", "value='-1'"), "continuous"), "link 'b'", "two.urdf"),
        (robot(&link("b", "").replace("izz='1'", "izz='-9'"), "continuous"), "joint 'j'", "two.urdf"),
        (robot(&link("b", ball), "continuous"), "link 'b'", "two.urdf"),
        (robot(&link("b", mesh), "continuous"), "link 'b'", "cut.stl"),
        (robot(&link("b", &missing), "continuous"), "link 'b'", "two.urdf"),
    ];
    for (text, element, file) in cases {
        let error = load(&folder.write("two.urdf", &text));
        let (found, path, problem) = parts(&error);
        assert_eq!(found, Some(element), "{error:?}");
        assert!(problem.contains(element), "{problem}");
        assert_eq!(path.and_then(Path::file_name), Some(file.as_ref()), "{error:?}");
    }
}

#[test]
fn descriptions_made_by_hand_name_the_element() {
    let refuse = |change: Edit| {
        let mut description = RobotDescription::example_arm();
        change(&mut description);
        Robot::new(description).expect_err("it cannot be used")
    };
    let cases: [(Edit, Option<&str>); 5] = [
        (|robot| robot.joints[1].axis.fill(0.0), Some("joint 'joint_2'")),
        (|robot| robot.links[1].body = BodyIndex::new(99), Some("link 'link_2'")),
        (|robot| robot.links[1].mass = f64::NAN, Some("link 'link_2'")),
        (
            |robot| robot.links[1].geometry[0].geometry = Geometry::Sphere { radius: 0.0 },
            Some("link 'link_2'"),
        ),
        (|robot| robot.gravity.fill(f64::NAN), None),
    ];
    for (edit, element) in cases {
        let error = refuse(edit);
        assert_eq!(parts(&error).0, element, "{error:?}");
        assert!(error.source().is_none() && parts(&error).1.is_none());
    }
}
