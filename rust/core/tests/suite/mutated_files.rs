//! Files with random damage: an error or a robot, never a panic, and never for ever.

use std::fs;
use std::path::{Path, PathBuf};

use contactsense::load::{load_mesh, UrdfOptions};
use contactsense::robot::Robot;
use contactsense::spatial::Pose;
use contactsense::surface::{Geometry, Part, Surface};
use contactsense::Error;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestRng, TestRunner};

/// Damaged files of each kind; more are tried where `MUTATED_FILES` says so.
const CASES: u32 = 1500;

/// What parsers and arithmetic stumble over.
const WORDS: [&str; 24] = [
    "0",
    "-1",
    "1",
    "1e308",
    "-1e-320",
    "nan",
    "inf",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "9223372036854775807",
    "-9223372036854775808",
    "1000000",
    "\n",
    " ",
    "\\\n",
    "\"",
    "<",
    "/>",
    "&#0;",
    "\0",
    "#n0",
    "offset=\"99\"",
    "é",
];

/// One change: where (as shares of the length), how long, and what.
#[derive(Debug, Clone)]
enum Change {
    Byte(f64, u8),
    Remove(f64, usize),
    Repeat(f64, usize, usize),
    Insert(f64, usize),
    /// Puts a word in place of the number or name that is there.
    Replace(f64, usize),
    Move(f64, f64, usize),
    Cut(f64),
}

fn change() -> impl Strategy<Value = Change> {
    let at = 0.0..1.0f64;
    let length = 1..80usize;
    prop_oneof![
        1 => (at.clone(), any::<u8>()).prop_map(|(at, byte)| Change::Byte(at, byte)),
        1 => (at.clone(), length.clone()).prop_map(|(at, length)| Change::Remove(at, length)),
        1 => (at.clone(), length.clone(), 2..60usize).prop_map(|(at, length, n)| Change::Repeat(at, length, n)),
        1 => (at.clone(), 0..WORDS.len()).prop_map(|(at, word)| Change::Insert(at, word)),
        4 => (at.clone(), 0..WORDS.len()).prop_map(|(at, word)| Change::Replace(at, word)),
        1 => (at.clone(), at.clone(), length).prop_map(|(from, to, length)| Change::Move(from, to, length)),
        1 => at.prop_map(Change::Cut),
    ]
}

fn apply(bytes: &mut Vec<u8>, change: &Change) {
    let place = |share: f64| (share * bytes.len() as f64) as usize;
    match *change {
        Change::Byte(at, byte) => {
            let at = place(at);
            bytes.splice(at..(at + 1).min(bytes.len()), [byte]);
        }
        Change::Remove(at, length) => {
            let at = place(at);
            bytes.drain(at..(at + length).min(bytes.len()));
        }
        Change::Repeat(at, length, times) => {
            let at = place(at);
            let part = bytes[at..(at + length).min(bytes.len())].repeat(times);
            bytes.splice(at..at, part);
        }
        Change::Insert(at, word) => {
            let at = place(at);
            bytes.splice(at..at, WORDS[word].bytes());
        }
        Change::Replace(at, word) => {
            let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || b".-_#".contains(byte);
            let at = place(at);
            let start = at + bytes[at..].iter().position(is_word).unwrap_or(0);
            let length = bytes[start..].iter().position(|byte| !is_word(byte)).unwrap_or(0);
            bytes.splice(start..start + length, WORDS[word].bytes());
        }
        Change::Move(from, to, length) => {
            let (from, to) = (place(from), place(to));
            let part = bytes[from..(from + length).min(bytes.len())].to_vec();
            bytes.splice(to..to, part);
        }
        Change::Cut(at) => bytes.truncate(place(at)),
    }
}

/// Gives `run` the file `name` again and again, damaged anew each time.
fn damage(name: &str, original: &[u8], run: impl Fn(&Path)) {
    let cases = std::env::var("MUTATED_FILES").ok().and_then(|n| n.parse().ok()).unwrap_or(CASES);
    let config = Config { cases, failure_persistence: None, ..Config::default() };
    let algorithm = config.rng_algorithm;
    let mut runner = TestRunner::new_with_rng(config, TestRng::deterministic_rng(algorithm));
    let folder = std::env::temp_dir().join(format!("contactsense-mutated-{}-{name}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let path: PathBuf = folder.join(name);
    let result = runner.run(&prop::collection::vec(change(), 1..6), |changes| {
        let mut bytes = original.to_vec();
        changes.iter().for_each(|change| apply(&mut bytes, change));
        fs::write(&path, &bytes).unwrap();
        run(&path);
        Ok(())
    });
    fs::remove_dir_all(&folder).unwrap();
    result.unwrap();
}

fn mesh(path: &Path) {
    let surface = load_mesh(path, [1.0, 1.0, -1.0]).and_then(|(vertices, triangles)| {
        assert!(triangles.iter().flatten().all(|&v| (v as usize) < vertices.len()));
        Surface::new(vec![Part { geometry: Geometry::Mesh { vertices, triangles }, pose: Pose::identity() }])
    });
    match surface {
        Ok((surface, _)) => assert!(surface.sample(3, 0).len() <= 3),
        Err(error) => assert!(matches!(error, Error::Geometry { .. }), "{error}"),
    }
}

const OBJ: &str = "# a block\nmtllib none.mtl\no block\nv 0 0 0\nv 0 0 1\nv 0 1 0\nv 0 1 1\nv 1 0 0\nv 1 0 1\nv 1 1 0\n\
    v 1 1 1\nvn 0 0 1\nvt 0 0\nusemtl m\nf 1/1/1 5//1 7 3\nf 2 4 8 6\nf 1 2 6 5\nf -6 -2 -1 -5\ng h\nf 1 3 4 2\n\
    f 5 6 8 \\\n 7\nl 1 2 3\n";

const COLLADA: &str = r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.5"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="24">0 0 0 0 0 1 0 1 0 0 1 1 1 0 0 1 0 1 1 1 0 1 1 1</float_array>
<technique_common><accessor source="#a" count="8" stride="3" offset="0"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<polylist count="4"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#s" offset="1"/>
<vcount>4 4 3 3</vcount><p>0 0 4 0 6 0 2 0 1 0 3 0 7 0 5 0 0 1 1 1 5 1 0 1 5 1 4 1</p></polylist>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>2 6 7 2 7 3</p></triangles>
<polygons><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 3 1</p></polygons>
<tristrips><input semantic="VERTEX" source="#v" offset="0"/><p>4 5 6 7</p></tristrips>
<trifans><input semantic="VERTEX" source="#v" offset="0"/><p>4 5 7 6</p></trifans>
</mesh></geometry></library_geometries>
<library_nodes><node id="n0"><translate>1 2 3</translate><rotate>0 0 1 90</rotate><instance_node url="#n1"/>
<instance_node url="#n1"/></node><node id="n1"><scale>1 1 -1</scale><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="scene"><node><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>
<instance_node url="#n0"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>"##;

fn ascii_stl() -> String {
    let facet = |[a, b, c]: [&str; 3]| {
        format!(" facet normal 0 0 1\n  outer loop\n   vertex {a}\n   vertex {b}\n   vertex {c}\n  endloop\n endfacet\n")
    };
    let [o, x, y, z] = ["0 0 0", "1 0 0", "0 1e0 0", "0 0 1.5"];
    let facets: String = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]].map(facet).concat();
    format!("solid a\n{facets}endsolid a\n")
}

fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(4u32.to_le_bytes());
    let [o, x, y, z] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5f32]];
    for triangle in [[o, y, x], [o, x, z], [o, z, y], [x, y, z]] {
        bytes.extend([0; 12]);
        bytes.extend(triangle.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn damaged_obj() {
    damage("block.obj", OBJ.as_bytes(), mesh);
}

#[test]
fn damaged_collada() {
    damage("block.dae", COLLADA.as_bytes(), mesh);
}

#[test]
fn damaged_ascii_stl() {
    damage("text.stl", ascii_stl().as_bytes(), mesh);
}

#[test]
fn damaged_binary_stl() {
    damage("binary.stl", &binary_stl(), mesh);
}

#[test]
fn damaged_urdf() {
    let urdf = r#"<?xml version="1.0"?><robot name="r"><link name="a"><collision><geometry><box size="1 1 1"/></geometry>
        </collision></link><link name="b"><inertial><origin xyz="0 0 1" rpy="0 1 0"/><mass value="2"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial><collision><origin xyz="0 0 1"/><geometry>
        <cylinder radius="0.1" length="1"/></geometry></collision></link><link name="c"><inertial><mass value="1"/>
        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial><collision><geometry>
        <mesh filename="none.stl" scale="1 1 1"/></geometry></collision></link>
        <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><origin xyz="0 0 1"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
        <joint name="k" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="j"/></joint></robot>"#;
    let whole = urdf.replace(r#"<mesh filename="none.stl" scale="1 1 1"/>"#, r#"<sphere radius="0.2"/>"#);
    for text in [urdf, &whole] {
        damage("robot.urdf", text.as_bytes(), |path| {
            if let Ok(robot) = Robot::from_urdf(path, &UrdfOptions::default()) {
                assert!(robot.mass_matrix(&robot.neutral()).is_ok());
            }
        });
    }
}
