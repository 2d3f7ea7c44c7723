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

use originals::{ascii_stl, binary_stl, whole_urdf, COLLADA, OBJ, URDF, WORDS};

#[path = "../../examples/harden/originals.rs"]
mod originals;

/// Damaged files of each kind; more are tried where `MUTATED_FILES` says so.
const CASES: u32 = 1500;

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
    for text in [URDF, &whole_urdf()] {
        damage("robot.urdf", text.as_bytes(), |path| {
            if let Ok(robot) = Robot::from_urdf(path, &UrdfOptions::default()) {
                assert!(robot.mass_matrix(&robot.neutral()).is_ok());
            }
        });
    }
}
