//! A query is inside where its nearest point says so, also on edges and corners.

use super::meshes::{cells, join, surface, torus, Random, Soup};
use crate::surface::{Geometry, Part, Surface};

/// Tetrahedra, most with edges far sharper than a right angle, far apart.
fn sharp(random: &mut Random) -> Soup {
    let one = |k: usize, random: &mut Random| {
        let at = [3.0 * k as f64, 0.0, 0.0];
        let corner = |random: &mut Random| {
            let v = random.vector();
            [at[0] + v.x, at[1] + 0.2 * v.y, at[2] + 0.2 * v.z]
        };
        let vertices = (0..4).map(|_| corner(random)).collect();
        (vertices, vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]])
    };
    let all: Vec<Soup> = (0..20).map(|k| one(k, random)).collect();
    join(&all)
}

fn check(surface: &Surface, random: &mut Random, count: usize) {
    assert!(surface.watertight());
    let (center, radius) = surface.bounding_sphere();
    let mut insides = 0;
    for k in 0..count {
        let near = surface.closest_point(&(center + random.vector() * radius));
        // Near the surface, where there is most of both.
        let p = near.point + random.unit() * [0.003, 0.03][k % 2];
        let near = surface.closest_point(&p);
        if near.distance > 1e-9 * radius {
            assert_eq!(near.inside, surface.contains(&p), "{p:?} {near:?}");
            insides += usize::from(near.inside);
            let descent = surface.closest_point_near(&p, near.triangle);
            assert_eq!(descent.inside, near.inside, "{p:?} {descent:?}");
        }
    }
    assert!(insides > count / 100, "{insides} of {count}");
}

#[test]
fn the_side_of_a_query_is_that_of_a_ray() {
    let mut random = Random(5);
    let stairs = cells(&[[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1], [2, 1, 1]], 0.1);
    for mesh in [sharp(&mut random), stairs, torus(30, 20, 0.2, 0.05)] {
        let (surface, _) = surface(&mesh);
        check(&surface, &mut random, if cfg!(debug_assertions) { 500 } else { 4000 });
    }
}

#[test]
fn the_side_of_a_primitive_too() {
    let mut random = Random(6);
    for geometry in [
        Geometry::Box { half_extents: [0.1, 0.2, 0.3] },
        Geometry::Cylinder { radius: 0.1, half_length: 0.2 },
        Geometry::Capsule { radius: 0.1, half_length: 0.2 },
        Geometry::Sphere { radius: 0.1 },
    ] {
        let (surface, _) = Surface::new(vec![Part { geometry, pose: random.pose() }]).expect("valid sizes");
        check(&surface, &mut random, 1000);
    }
}
