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

#[test]
fn what_another_part_covers_is_hidden() {
    let at =
        |x: f64| Pose { rotation: nalgebra::Matrix3::identity(), translation: Vector3::new(x, 0.0, 0.0) };
    let cube = Geometry::Box { half_extents: [0.1; 3] };
    // Two that overlap by half, as a primitive and as a mesh, and one alone.
    let (vertices, triangles) = block([-0.1, -0.1, -0.1], [0.1, 0.1, 0.1]);
    let mesh = Geometry::Mesh { vertices, triangles };
    let parts = vec![Part { geometry: cube.clone(), pose: at(0.0) }, Part { geometry: mesh, pose: at(0.1) }];
    let both = Surface::new(parts).unwrap().0;
    assert!(both.hides(&Vector3::new(0.1, 0.0, 0.01), None), "on the box, inside the mesh");
    let near = both.closest_point(&Vector3::new(0.25, 0.01, 0.02));
    assert!(!both.hides(&near.point, near.triangle));
    let inside = Vector3::new(0.0, 0.01, 0.02);
    let triangle = (0..both.triangles().len())
        .find(|&id| both.triangles()[id].iter().all(|&v| both.vertices()[v as usize][0].abs() < 1e-9))
        .expect("the mesh has a face at x = 0");
    assert!(both.hides(&inside, Some(triangle as u32)), "on the mesh, inside the box");
    for sample in both.sample(200, 3) {
        assert!(!both.hides(&sample.point, sample.triangle));
    }
    let alone = Surface::new(vec![Part { geometry: cube, pose: at(0.0) }]).unwrap().0;
    assert!(!alone.hides(&Vector3::new(0.0, 0.0, 0.0), None));
}
