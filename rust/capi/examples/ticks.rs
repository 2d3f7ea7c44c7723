//! Times the ticks of a monitor on the rows of a file (q, v and tau, of doubles): `ticks URDF ROWS CALIBRATION REPEATS`.
//! Prints the fastest of all repeats for each tick, in nanoseconds; a C program does the same through the C interface.

use std::sync::Arc;
use std::time::Instant;

use contactsense::calibration::Calibration;
use contactsense::load::UrdfOptions;
use contactsense::monitor::{ContactMonitor, MonitorOptions};
use contactsense::robot::Robot;
use contactsense::Sample;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<String> = std::env::args().collect();
    let [_, urdf, rows, calibration, repeats] = &arguments[..] else { return Err("wrong arguments".into()) };
    let robot = Arc::new(Robot::from_urdf(urdf, &UrdfOptions::default())?);
    let mut options = MonitorOptions::new(1e-3);
    options.isolation.torque_threshold = None;
    options.calibration = Some(Calibration::load(calibration)?);
    let mut monitor = ContactMonitor::new(robot.clone(), &options)?;
    let bytes = std::fs::read(rows)?;
    let numbers: Vec<f64> =
        bytes.chunks_exact(8).map(|chunk| f64::from_ne_bytes(chunk.try_into().unwrap_or_default())).collect();
    let nv = robot.nv();
    let ticks: Vec<&[f64]> = numbers.chunks_exact(3 * nv).collect();
    let mut fastest = vec![u128::MAX; ticks.len()];
    for _ in 0..repeats.parse()? {
        monitor.reset();
        for (row, fastest) in ticks.iter().zip(&mut fastest) {
            let start = Instant::now();
            monitor.update(&Sample::new(&row[..nv], &row[nv..2 * nv], &row[2 * nv..]))?;
            *fastest = start.elapsed().as_nanos().min(*fastest);
        }
    }
    fastest.iter().for_each(|time| println!("{time}"));
    Ok(())
}
