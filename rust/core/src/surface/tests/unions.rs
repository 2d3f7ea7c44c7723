//! Several parts: what lies inside another is not hit and not sampled.

use nalgebra::Vector3;

use super::meshes::{block, icosphere, part, Random};
use crate::spatial::Pose;
use crate::surface::{Geometry, Part, RayHit, Surface};

fn exact(geometry: Geometry, at: [f64; 3]) -> Part {
    Part { geometry, pose: Pose { translation: at.into(), ..Pose::identity() } }
}

fn cast(surface: &Surface, origin: [f64; 3], d: [f64; 3]) -> Vec<RayHit> {
    let mut hits = Vec::with_capacity(64);
    assert!(surface.cast_line_into(&origin.into(), &d.into(), f64::NEG_INFINITY, &mut hits));
    hits
}

fn distances(hits: &[RayHit]) -> Vec<f64> {
    hits.iter().map(|hit| (hit.distance * 1e9).round() / 1e9).collect()
}

fn cube(at: [f64; 3]) -> Part {
    exact(Geometry::Box { half_extents: [0.5; 3] }, at)
}

#[test]
fn overlapping_and_touching_boxes() {
    let x = [1.0, 0.0, 0.0];
    let (overlap, _) = Surface::new(vec![cube([0.0; 3]), cube([0.6, 0.0, 0.0])]).unwrap();
    assert_eq!(distances(&cast(&overlap, [0.0; 3], x)), [-0.5, 1.1]);
    let (touching, _) = Surface::new(vec![cube([0.0; 3]), cube([1.0, 0.0, 0.0])]).unwrap();
    assert_eq!(distances(&cast(&touching, [0.0; 3], x)), [-0.5, 1.5]);
    let (apart, _) = Surface::new(vec![cube([0.0; 3]), cube([1.1, 0.0, 0.0])]).unwrap();
    assert_eq!(distances(&cast(&apart, [0.0; 3], x)), [-0.5, 0.5, 0.6, 1.6]);
    let (same, _) =
        Surface::new(vec![cube([0.0; 3]), cube([0.0; 3]), part(&block([-0.5; 3], [0.5; 3]))]).unwrap();
    let hits = cast(&same, [0.0, 0.1, 0.2], x);
    assert_eq!(distances(&hits), [-0.5, 0.5]);
    assert!(hits[0].entering && !hits[1].entering);
    let nested = vec![cube([0.0; 3]), exact(Geometry::Sphere { radius: 0.2 }, [0.0; 3])];
    let (nested, _) = Surface::new(nested).unwrap();
    assert_eq!(distances(&cast(&nested, [0.0; 3], x)), [-0.5, 0.5]);
}

#[test]
fn a_ray_from_inside_another_part() {
    let (surface, _) = Surface::new(vec![cube([0.0; 3]), cube([0.6, 0.0, 0.0])]).unwrap();
    let mut hits = Vec::with_capacity(8);
    surface.cast_line_into(&Vector3::new(0.3, 0.0, 0.0), &Vector3::x(), 0.0, &mut hits);
    assert_eq!(distances(&hits), [0.8]);
    hits.clear();
    surface.cast_line_into(&Vector3::new(0.3, 0.0, 0.0), &-Vector3::x(), 0.0, &mut hits);
    assert_eq!(distances(&hits), [0.8]);
}

#[test]
fn open_parts_hide_nothing() {
    let (vertices, mut triangles) = block([-1.0; 3], [1.0; 3]);
    triangles.truncate(10);
    let (surface, _) = Surface::new(vec![cube([0.0; 3]), part(&(vertices, triangles))]).unwrap();
    assert!(!surface.watertight());
    let hits = cast(&surface, [0.0, 0.1, 0.2], [1.0, 0.0, 0.0]);
    assert_eq!(distances(&hits), [-1.0, -0.5, 0.5, 1.0]);
    assert!(surface.sample(500, 1).iter().any(|s| s.triangle.is_none()));
}

/// A link of all kinds of parts, turned and overlapping.
fn jumble(random: &mut Random) -> Vec<Part> {
    let geometries = [
        Geometry::Box { half_extents: [0.3, 0.5, 0.2] },
        Geometry::Cylinder { radius: 0.2, half_length: 0.7 },
        Geometry::Capsule { radius: 0.25, half_length: 0.4 },
        Geometry::Sphere { radius: 0.4 },
        part(&icosphere(3, 0.4)).geometry,
        part(&block([-0.3; 3], [0.4; 3])).geometry,
    ];
    geometries
        .into_iter()
        .map(|geometry| {
            let mut pose = random.pose();
            pose.translation *= 0.5;
            Part { geometry, pose }
        })
        .collect()
}

#[test]
fn hits_are_where_the_line_changes_between_inside_and_outside() {
    let mut random = Random(21);
    for _ in 0..20 {
        let parts = jumble(&mut random);
        let each: Vec<Surface> = parts.iter().map(|p| Surface::new(vec![p.clone()]).unwrap().0).collect();
        let (all, _) = Surface::new(parts).unwrap();
        for _ in 0..50 {
            let (o, d) = (random.vector() * 0.5, random.unit());
            let hits = cast(&all, o.into(), d.into());
            assert_eq!(hits.len() % 2, 0);
            assert!(hits.iter().enumerate().all(|(i, hit)| hit.entering == (i % 2 == 0)), "{hits:?}");
            // Depth from the parts alone.
            let mut events: Vec<(f64, i32)> = each
                .iter()
                .flat_map(|s| cast(s, o.into(), d.into()))
                .map(|hit| (hit.distance, if hit.entering { 1 } else { -1 }))
                .collect();
            events.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut depth = 0;
            let mut expected = Vec::new();
            for (distance, step) in events {
                if depth + step == 0 || depth == 0 {
                    expected.push(distance);
                }
                depth += step;
            }
            assert_eq!(depth, 0);
            assert_eq!(hits.iter().map(|hit| hit.distance).collect::<Vec<_>>(), expected);
        }
    }
}

#[test]
fn samples_are_exposed() {
    let mut random = Random(33);
    for seed in 0..5 {
        let parts = jumble(&mut random);
        let each: Vec<Surface> = parts.iter().map(|p| Surface::new(vec![p.clone()]).unwrap().0).collect();
        let (all, _) = Surface::new(parts).unwrap();
        let samples = all.sample(400, seed);
        assert_eq!(samples.len(), 400);
        for s in samples {
            // Odd counts along a line mean inside.
            let outside = s.point + s.normal * 1e-7;
            for surface in &each {
                let mut hits = Vec::with_capacity(64);
                surface.cast_line_into(&outside, &Vector3::new(0.6, 0.48, 0.64), 0.0, &mut hits);
                assert_eq!(hits.len() % 2, 0, "{s:?}");
            }
        }
    }
}

#[test]
fn touching_faces_are_not_sampled_and_coinciding_ones_once() {
    let (touching, _) = Surface::new(vec![cube([0.0; 3]), cube([1.0, 0.0, 0.0])]).unwrap();
    assert!(touching.sample(5000, 3).iter().all(|s| (s.point.x - 0.5).abs() > 1e-9 || s.normal.x == 0.0));
    let (same, _) = Surface::new(vec![cube([0.0; 3]), part(&block([-0.5; 3], [0.5; 3]))]).unwrap();
    assert!(same.sample(2000, 3).iter().all(|s| s.triangle.is_none()));
}
