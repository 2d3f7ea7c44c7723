//! A robot, from a URDF file or made up, and where a push on it is found from the joint torques alone.
//!
//! `cargo run --release --example touch -- [URDF [PACKAGE_DIR ...]]`

use std::sync::Arc;

use contactsense::isolation::{ContactIsolator, IsolatorOptions};
use contactsense::load::UrdfOptions;
use contactsense::robot::Robot;
use contactsense::{Error, Result};
use nalgebra::DVector;

const FORCE: f64 = 20.0; // [N]

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let path = arguments.next();
    let package_dirs = arguments.map(Into::into).collect();
    let options = UrdfOptions { package_dirs, ..UrdfOptions::default() };
    let robot =
        Arc::new(path.map_or_else(|| Ok(Robot::example_arm()), |path| Robot::from_urdf(path, &options))?);
    println!("{}: {} joints", robot.name(), robot.joint_names().len());
    for warning in robot.warnings() {
        println!("  {warning}");
    }

    // Every joint a little bent; a push against the last link but one, along the inward normal.
    let mut q = robot.neutral();
    for joint in q.iter_mut().filter(|joint| **joint == 0.0) {
        *joint = 0.4;
    }
    let no_surface = || Error::input("robot", "has no surface that can be in contact");
    let &link = robot.touchable_links().iter().nth_back(1).ok_or_else(no_surface)?;
    let surface = robot[link].surface.as_ref().ok_or_else(no_surface)?;
    let pose = robot.link_pose(&q, link)?;
    let touched = surface.sample(1, 7).into_iter().next().ok_or_else(no_surface)?;
    let point = pose.transform_point(&touched.point);
    let force = -FORCE * (pose.rotation * touched.normal);
    let jacobian = robot.jacobian(&q, link, Some([point.x, point.y, point.z]))?;
    let tau_ext: DVector<f64> = jacobian.rows(0, 3).transpose() * force;

    let mut isolator = ContactIsolator::new(robot.clone(), &IsolatorOptions::default())?;
    let isolation = isolator.isolate(&q, tau_ext.as_slice())?;
    println!("pushed: {} at {:.4?} m", robot[link].name, point.as_slice());
    for contact in &isolation.contacts {
        let name = &robot[contact.link].name;
        match (contact.place, contact.force()) {
            (Some(place), Some(force)) if contact.located => {
                println!("found:  {name} at {:.4?} m, {:.2} N", place.point.as_slice(), force.norm());
            }
            _ => println!("found:  {name}; the link is known, the point is not"),
        }
    }
    Ok(())
}
