//! Damaged files of every kind the core reads: an answer or a typed error, soon.

use std::fs;
use std::panic::{catch_unwind, AssertUnwindSafe};
use std::path::Path;
use std::time::{Duration, Instant};

use contactsense::calibration::Calibration;
use contactsense::load::{load_mesh, UrdfOptions};
use contactsense::robot::Robot;
use contactsense::spatial::Pose;
use contactsense::surface::{Geometry, Part, Surface};
use contactsense::{Error, Result};

use crate::mutation::damage;
use crate::originals::{ascii_stl, binary_stl, whole_urdf, COLLADA, OBJ, URDF};
use crate::random::Random;

/// No file may take longer: all are small.
const LONGEST: Duration = Duration::from_secs(10);

type Read = fn(&Path) -> Result<()>;

fn mesh(path: &Path) -> Result<()> {
    let (vertices, triangles) = load_mesh(path, [1.0, 1.0, -1.0])?;
    assert!(triangles.iter().flatten().all(|&v| (v as usize) < vertices.len()));
    let geometry = Geometry::Mesh { vertices, triangles };
    let (surface, _) = Surface::new(vec![Part { geometry, pose: Pose::identity() }])?;
    assert!(surface.sample(3, 0).len() <= 3);
    Ok(())
}

fn urdf(path: &Path) -> Result<()> {
    let robot = Robot::from_urdf(path, &UrdfOptions::default())?;
    assert!(robot.mass_matrix(&robot.neutral())?.iter().all(|entry| entry.is_finite()));
    Ok(())
}

fn calibration(path: &Path) -> Result<()> {
    let robot = Robot::example_arm();
    let calibration = Calibration::load(path)?;
    calibration.check(&robot)?;
    calibration.corrected(&robot).map(drop)
}

fn kinds() -> Result<Vec<(&'static str, Vec<u8>, Read)>> {
    let written = Calibration::of_description(&Robot::example_arm()).to_yaml("a log", "")?;
    Ok(vec![
        ("robot.urdf", URDF.into(), urdf),
        ("whole.urdf", whole_urdf().into(), urdf),
        ("block.obj", OBJ.into(), mesh),
        ("block.dae", COLLADA.into(), mesh),
        ("text.stl", ascii_stl().into(), mesh),
        ("binary.stl", binary_stl(), mesh),
        ("arm.yaml", written.into(), calibration),
    ])
}

/// Damages `count` files; whether none made a panic or took too long.
pub fn run(count: u64, seed: u64) -> Result<bool> {
    let folder = std::env::temp_dir().join(format!("contactsense-harden-{}", std::process::id()));
    let failed = |error: std::io::Error| Error::input("folder", error.to_string());
    fs::create_dir_all(&folder).map_err(failed)?;
    let kinds = kinds()?;
    let (mut held, mut each) = (true, count / kinds.len() as u64);
    let mut first = count % kinds.len() as u64;
    for (name, original, read) in &kinds {
        let (path, mut taken, mut panics) = (folder.join(name), [0_u64; 2], 0_u64);
        let mut slowest = (Duration::ZERO, 0);
        each += first; // the rest goes to the first kind
        for case in 0..each {
            let mut random = Random::of_case(seed, case);
            let mut bytes = original.clone();
            damage(&mut random, &mut bytes);
            fs::write(&path, &bytes).map_err(failed)?;
            let start = Instant::now();
            let outcome = catch_unwind(AssertUnwindSafe(|| read(&path)));
            slowest = slowest.max((start.elapsed(), case));
            match outcome {
                Ok(result) => taken[usize::from(result.is_err())] += 1,
                Err(_) => {
                    panics += 1;
                    println!("panic: {name}, seed {seed}, case {case}");
                }
            }
        }
        let [read, refused] = taken;
        println!(
            "{name:>10}: {each} files, {read} read, {refused} refused, {panics} panics; slowest {:.1} ms (case {})",
            slowest.0.as_secs_f64() * 1e3,
            slowest.1
        );
        held &= panics == 0 && slowest.0 < LONGEST;
        each -= first;
        first = 0;
    }
    fs::remove_dir_all(&folder).map_err(failed)?;
    Ok(held)
}
