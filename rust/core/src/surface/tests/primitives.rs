//! Exact primitives against their definitions, and against their tessellations.

use nalgebra::Vector3;
use proptest::prelude::*;

use super::meshes::{surface, Random};
use crate::spatial::Pose;
use crate::surface::{Geometry, Part, Surface};
use crate::Error;

const ROUNDING: f64 = 1e-14;

fn place(geometry: Geometry, pose: Pose) -> Surface {
    let (surface, remarks) = Surface::new(vec![Part { geometry, pose }]).unwrap();
    assert!(remarks.is_empty());
    surface
}

fn still(geometry: Geometry) -> Surface {
    place(geometry, Pose::identity())
}

fn all(size: [f64; 3]) -> [Geometry; 4] {
    [
        Geometry::Box { half_extents: size },
        Geometry::Cylinder { radius: size[0], half_length: size[1] },
        Geometry::Sphere { radius: size[0] },
        Geometry::Capsule { radius: size[0], half_length: size[1] },
    ]
}

/// Signed distance from the definition.
fn signed_distance(geometry: &Geometry, p: &Vector3<f64>) -> f64 {
    let beyond = |x: f64, y: f64| Vector3::new(x.max(0.0), y.max(0.0), 0.0).norm() + x.max(y).min(0.0);
    match *geometry {
        Geometry::Box { half_extents } => {
            let over = p.abs() - Vector3::from(half_extents);
            over.map(|x| x.max(0.0)).norm() + over.max().min(0.0)
        }
        Geometry::Cylinder { radius, half_length } => beyond(p.xy().norm() - radius, p.z.abs() - half_length),
        Geometry::Sphere { radius } => p.norm() - radius,
        Geometry::Capsule { radius, half_length } => {
            (p - Vector3::z() * p.z.clamp(-half_length, half_length)).norm() - radius
        }
        Geometry::Mesh { .. } => unreachable!(),
    }
}

fn check_closest(geometry: &Geometry, surface: &Surface, p: &Vector3<f64>) {
    let scale = p.norm() + surface.bounding_sphere().1;
    let got = surface.closest_point(p);
    let expected = signed_distance(geometry, p);
    assert!(
        (got.distance - expected.abs()).abs() <= ROUNDING * scale,
        "{geometry:?} {p:?} {got:?} {expected}"
    );
    assert!((got.distance - (got.point - p).norm()).abs() <= ROUNDING * scale, "{geometry:?} {p:?} {got:?}");
    assert!(signed_distance(geometry, &got.point).abs() <= ROUNDING * scale, "{geometry:?} {p:?} {got:?}");
    assert!((got.normal.norm() - 1.0).abs() <= ROUNDING);
    assert_eq!(got.triangle, None);
    // Along the normal it goes out, against it in.
    let step = 1e-4 * surface.bounding_sphere().1;
    assert!(signed_distance(geometry, &(got.point + got.normal * step)) > 0.5 * step);
    assert!(signed_distance(geometry, &(got.point - got.normal * step)) < 1e-12);
}

#[test]
fn closest_points_in_special_places() {
    for geometry in all([0.1, 0.2, 0.3]) {
        let surface = still(geometry.clone());
        let places = [-0.6, -0.3, -0.2, -0.1, -1e-300, 0.0, 0.05, 0.1, 0.2, 0.3, 1.0];
        for x in places {
            for y in places {
                for z in places {
                    check_closest(&geometry, &surface, &Vector3::new(x, y, z));
                }
            }
        }
    }
}

#[test]
fn areas() {
    use std::f64::consts::PI;
    let expected = [
        8.0 * (0.02 + 0.06 + 0.03),
        2.0 * PI * 0.1 * 0.4 + 2.0 * PI * 0.01,
        4.0 * PI * 0.01,
        2.0 * PI * 0.1 * 0.4 + 4.0 * PI * 0.01,
    ];
    for (geometry, area) in all([0.1, 0.2, 0.3]).into_iter().zip(expected) {
        let surface = still(geometry);
        assert!((surface.area() - area).abs() < 1e-15);
        assert!(surface.watertight());
    }
}

#[test]
fn rays_on_edges_come_in_pairs() {
    let mut hits = Vec::with_capacity(4);
    for geometry in all([0.1, 0.1, 0.1]) {
        let surface = still(geometry.clone());
        for axis in 0..3 {
            for (u, v) in [(0.1, 0.0), (0.1, 0.1), (0.0, 0.0), (-0.1, 0.1), (0.05, -0.1), (0.2, 0.0)] {
                let mut origin = Vector3::zeros();
                origin[(axis + 1) % 3] = u;
                origin[(axis + 2) % 3] = v;
                let d = Vector3::ith_axis(axis).into_inner();
                for origin in [origin, origin - d, origin + d * 1e6] {
                    hits.clear();
                    assert!(surface.cast_line_into(&origin, &d, f64::NEG_INFINITY, &mut hits));
                    assert_eq!(hits.len() % 2, 0);
                    let expected = u.abs() < 0.1 && v.abs() < 0.1;
                    assert!(!expected || hits.len() == 2, "{geometry:?} {origin:?} {d:?}");
                }
            }
        }
    }
}

#[test]
fn tangent_and_parallel_lines() {
    let capsule = still(Geometry::Capsule { radius: 0.1, half_length: 0.3 });
    let mut hits = Vec::with_capacity(4);
    capsule.cast_line_into(&Vector3::new(0.0, 0.0, -2.0), &Vector3::z(), 0.0, &mut hits);
    let distances: Vec<f64> = hits.iter().map(|hit| hit.distance).collect();
    assert!((distances[0] - 1.6).abs() < 1e-15 && (distances[1] - 2.4).abs() < 1e-15);
    assert_eq!((hits[0].normal, hits[1].normal), (-Vector3::z(), Vector3::z()));
    assert!(hits[0].entering && !hits[1].entering);
    hits.clear();
    capsule.cast_line_into(&Vector3::new(0.1 + 1e-9, 0.0, -2.0), &Vector3::z(), 0.0, &mut hits);
    assert!(hits.is_empty());
    let cylinder = still(Geometry::Cylinder { radius: 0.1, half_length: 0.3 });
    cylinder.cast_line_into(&Vector3::new(0.05, 0.0, 0.0), &-Vector3::z(), 0.0, &mut hits);
    assert_eq!(hits.len(), 1);
    assert!((hits[0].distance - 0.3).abs() < 1e-16 && !hits[0].entering);
}

#[test]
fn bad_sizes_and_poses() {
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for k in 0..3 {
            let mut size = [1.0; 3];
            size[k] = bad;
            for geometry in all(size) {
                let uses = match geometry {
                    Geometry::Box { .. } => 3,
                    Geometry::Sphere { .. } => 1,
                    _ => 2,
                };
                let made = Surface::new(vec![Part { geometry, pose: Pose::identity() }]);
                assert_eq!(matches!(made, Err(Error::Geometry { .. })), k < uses);
            }
        }
    }
    let mut pose = Pose::identity();
    pose.translation.x = f64::NAN;
    assert!(Surface::new(vec![Part { geometry: Geometry::Sphere { radius: 1.0 }, pose }]).is_err());
    let pose = Pose { rotation: nalgebra::Matrix3::identity() * 2.0, ..Pose::identity() };
    assert!(Surface::new(vec![Part { geometry: Geometry::Sphere { radius: 1.0 }, pose }]).is_err());
    assert!(Surface::new(vec![]).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    #[test]
    fn closest_points_anywhere(
        size in prop::array::uniform3(0.01..2.0f64),
        p in prop::array::uniform3(-3.0..3.0f64),
    ) {
        for geometry in all(size) {
            check_closest(&geometry, &still(geometry.clone()), &p.into());
        }
    }
}

proptest! {
    // Each case builds four meshes.
    #![proptest_config(ProptestConfig { cases: if cfg!(debug_assertions) { 10 } else { 300 }, failure_persistence: None, ..Default::default() })]

    #[test]
    fn as_its_tessellation(size in prop::array::uniform3(0.05..0.5f64), seed in any::<u64>()) {
        let mut random = Random(seed);
        for geometry in all(size) {
            let exact = place(geometry.clone(), random.pose());
            let (fine, remarks) = surface(&(exact.vertices().to_vec(), exact.triangles().to_vec()));
            prop_assert!(fine.watertight() && remarks.is_empty(), "{:?}", remarks);
            let (center, radius) = exact.bounding_sphere();
            prop_assert!(exact.vertices().iter().all(|&v| (Vector3::from(v) - center).norm() < radius * (1.0 + 1e-12)));
            // Twice the sagitta of 48 segments: a sphere bends both ways.
            let sagitta = 0.005 * radius;
            prop_assert!((fine.area() / exact.area() - 1.0).abs() < 0.01);
            let mut hits = (Vec::with_capacity(4), Vec::with_capacity(4));
            for _ in 0..20 {
                let p = center + random.vector() * 2.0 * radius;
                let (a, b) = (exact.closest_point(&p), fine.closest_point(&p));
                prop_assert!((a.distance - b.distance).abs() < sagitta, "{:?} {:?} {:?}", geometry, a, b);
                let d = random.unit();
                hits.0.clear();
                hits.1.clear();
                exact.cast_line_into(&p, &d, f64::NEG_INFINITY, &mut hits.0);
                fine.cast_line_into(&p, &d, f64::NEG_INFINITY, &mut hits.1);
                prop_assert!(hits.0.len() % 2 == 0);
                for hit in &hits.0 {
                    prop_assert!(exact.closest_point(&hit.point).distance < 1e-13 * (radius + p.norm()));
                    prop_assert_eq!(hit.entering, hit.normal.dot(&d) <= 0.0);
                }
                for hit in &hits.1 {
                    prop_assert!(exact.closest_point(&hit.point).distance < sagitta);
                }
                if hits.0.len() == 2 && hits.0[1].distance - hits.0[0].distance > 0.3 * radius {
                    prop_assert_eq!(hits.1.len(), 2);
                }
            }
        }
    }
}
