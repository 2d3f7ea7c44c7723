//! Golden data, made by `python -m tools.golden` with Pinocchio and trimesh.

use std::path::PathBuf;
use std::sync::Arc;

use contactsense::load::UrdfOptions;
use contactsense::robot::Robot;
use serde::de::DeserializeOwned;
use serde::Deserialize;

#[derive(Debug, Deserialize)]
pub struct Contacts {
    /// Standard deviation of the noisy torques [Nm].
    pub noise: f64,
    pub contacts: Vec<Push>,
}

#[derive(Debug, Deserialize)]
pub struct Push {
    pub link: String,
    pub q: Vec<f64>,
    /// World frame [m].
    pub point: [f64; 3],
    /// Outward, world frame.
    pub normal: [f64; 3],
    /// World frame [N].
    pub force: [f64; 3],
    pub torque: Vec<f64>,
    pub noisy_torque: Vec<f64>,
    /// Whether the joints before the link determine the wrench.
    pub determined: bool,
    /// How often the line of action enters this link, and all others.
    pub entries: [usize; 2],
}

#[derive(Debug, Deserialize)]
pub struct Dynamics {
    pub states: Vec<State>,
}

#[derive(Debug, Deserialize)]
pub struct State {
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub a: Vec<f64>,
    pub mass_matrix: Vec<Vec<f64>>,
    pub bias: Vec<f64>,
    pub inverse_dynamics: Vec<f64>,
    pub link: String,
    pub point: [f64; 3],
    pub jacobian: Vec<Vec<f64>>,
}

#[derive(Debug, Deserialize)]
pub struct Motion {
    pub dt: f64,
    pub gain: f64,
    /// External torque from the 20th tick on [Nm].
    pub push: Vec<f64>,
    pub ticks: Vec<Tick>,
}

#[derive(Debug, Deserialize)]
pub struct Tick {
    pub q: Vec<f64>,
    pub v: Vec<f64>,
    pub tau: Vec<f64>,
    /// The external torque after a first-order filter.
    pub filtered: Vec<f64>,
}

#[derive(Debug, Deserialize)]
pub struct Runs {
    pub runs: Vec<Run>,
}

/// An arm leans on a springy ball and moves a little.
#[derive(Debug, Deserialize)]
pub struct Run {
    pub link: String,
    /// Of the ball [N/m].
    pub stiffness: f64,
    /// At the end, world frame [m].
    pub point: [f64; 3],
    /// At the end, world frame [N].
    pub force: [f64; 3],
    pub q: Vec<Vec<f64>>,
    pub torque: Vec<Vec<f64>>,
}

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/data")
}

/// `NAME.json`.
pub fn read<T: DeserializeOwned>(name: &str) -> T {
    let text = std::fs::read_to_string(folder().join(format!("{name}.json"))).expect("golden data is there");
    serde_json::from_str(&text).expect("golden data has this shape")
}

/// The robot of the same URDF as the golden data's.
pub fn robot(name: &str) -> Arc<Robot> {
    let packaged = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../python/contactsense/descriptions");
    let folder = if name == "meshed_arm" { folder() } else { packaged };
    let options = UrdfOptions { floating_base: name == "atlas", ..UrdfOptions::default() };
    Arc::new(Robot::from_urdf(folder.join(format!("{name}.urdf")), &options).expect("a valid URDF"))
}
