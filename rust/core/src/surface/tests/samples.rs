//! Samples: uniform by area, on the surface, the same for the same seed.

use nalgebra::Vector3;

use super::meshes::{block, icosphere, surface};
use crate::spatial::Pose;
use crate::surface::{Geometry, Part, Surface};

fn kinds() -> Vec<Surface> {
    let mut surfaces: Vec<Surface> = [
        Geometry::Box { half_extents: [0.1, 0.2, 0.4] },
        Geometry::Cylinder { radius: 0.1, half_length: 0.2 },
        Geometry::Sphere { radius: 0.3 },
        Geometry::Capsule { radius: 0.1, half_length: 0.2 },
    ]
    .map(|geometry| Surface::new(vec![Part { geometry, pose: Pose::identity() }]).unwrap().0)
    .into();
    surfaces.push(surface(&icosphere(3, 0.2)).0);
    surfaces.push(surface(&block([-0.1, -0.2, -0.4], [0.1, 0.2, 0.4])).0);
    surfaces
}

#[test]
fn same_seed_same_points() {
    for surface in kinds() {
        let points = surface.sample(50, 42);
        assert_eq!(points, surface.sample(50, 42));
        assert_eq!(points, surface.sample(80, 42)[..50]);
        assert_ne!(points, surface.sample(50, 43));
        assert!(surface.sample(0, 1).is_empty());
    }
}

#[test]
fn on_the_surface_with_its_normal() {
    for surface in kinds() {
        for s in surface.sample(1000, 5) {
            let nearest = surface.closest_point(&(s.point + s.normal * 1e-3));
            assert!((nearest.point - s.point).norm() < 1e-12, "{s:?} {nearest:?}");
            assert!((nearest.distance - 1e-3).abs() < 1e-12);
            assert!((s.normal.norm() - 1.0).abs() < 1e-14);
        }
    }
}

/// The share of samples in the cells of a fixed partition is that of the area, from the tessellation.
#[test]
fn uniform_by_area() {
    const N: usize = 40_000;
    let cell = |p: &Vector3<f64>| {
        let octant = usize::from(p.x > 0.0) + 2 * usize::from(p.y > 0.0) + 4 * usize::from(p.z > 0.0);
        8 * ((p.z.abs() * 10.0) as usize).min(3) + octant
    };
    for surface in kinds() {
        let mut expected = [0.0; 32];
        for t in surface.triangles() {
            let [a, b, c] = t.map(|v| Vector3::from(surface.vertices()[v as usize]));
            let share = (b - a).cross(&(c - a)).norm() / 2.0 / surface.area() / 1024.0;
            for i in 0..32 {
                for j in 0..32 {
                    let (mut u, mut v) = ((f64::from(i) + 0.5) / 32.0, (f64::from(j) + 0.5) / 32.0);
                    if u + v > 1.0 {
                        (u, v) = (1.0 - u, 1.0 - v);
                    }
                    expected[cell(&(a + (b - a) * u + (c - a) * v))] += share;
                }
            }
        }
        let mut found = [0.0; 32];
        for s in surface.sample(N, 8) {
            found[cell(&s.point)] += 1.0 / N as f64;
        }
        for (found, expected) in found.iter().zip(expected) {
            let deviation = (expected * (1.0 - expected) / N as f64).sqrt();
            assert!((found - expected).abs() < 4.5 * deviation + 0.004, "{found} {expected}");
        }
    }
}
