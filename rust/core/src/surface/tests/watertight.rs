//! Lines through generic points, vertices and edges of closed meshes come out as often as they go in.

use nalgebra::Vector3;

use super::meshes::{block, cells, icosphere, join, part, surface, torus, Random, Soup};
use crate::surface::{RayHit, Surface};

const LINES: usize = 1500;

fn closed_meshes() -> Vec<(&'static str, Soup)> {
    let stairs: Vec<[i64; 3]> =
        (0..6).flat_map(|x| (0..6).flat_map(move |y| (0..=(x + y) % 4).map(move |z| [x, y, z]))).collect();
    let tunnel: Vec<[i64; 3]> = (0..27)
        .map(|i| [i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1])
        .filter(|c| c.iter().filter(|&&x| x == 0).count() < 2)
        .collect();
    vec![
        ("icosphere", icosphere(4, 0.15)),
        ("torus", torus(60, 40, 0.2, 0.05)),
        ("stairs", cells(&stairs, 0.04)),
        ("tunnel", cells(&tunnel, 0.1)),
        ("block", block([-0.1, -0.2, -0.3], [0.1, 0.2, 0.3])),
        (
            "two blocks",
            join(&[block([-0.3, -0.1, -0.1], [-0.1, 0.1, 0.1]), block([0.0, -0.1, -0.1], [0.2, 0.1, 0.1])]),
        ),
    ]
}

/// A direction: random, along an axis, or in the plane of two axes.
fn direction(random: &mut Random, i: usize) -> Vector3<f64> {
    match i % 4 {
        0 | 1 => random.unit(),
        2 => Vector3::ith_axis(i / 4 % 3).into_inner(),
        _ => {
            let mut d = random.unit();
            d[i / 4 % 3] = 0.0;
            d.normalize()
        }
    }
}

fn check(name: &str, surface: &Surface, through: &Vector3<f64>, d: &Vector3<f64>, hits: &mut Vec<RayHit>) {
    let (center, radius) = surface.bounding_sphere();
    let outside = through - d * ((through - center).dot(d) + 2.0 * radius);
    for (origin, t_min) in [(*through, f64::NEG_INFINITY), (outside, 0.0), (outside, f64::NEG_INFINITY)] {
        hits.clear();
        assert!(surface.cast_line_into(&origin, d, t_min, hits));
        assert_eq!(hits.len() % 2, 0, "{name}: {} hits through {through:?} along {d:?}", hits.len());
        for (i, hit) in hits.iter().enumerate() {
            assert_eq!(hit.entering, i % 2 == 0, "{name}: order through {through:?} along {d:?}: {hits:?}");
            assert!(i == 0 || hits[i - 1].distance <= hit.distance);
        }
    }
}

fn run(points: impl Fn(&Surface, &mut Random) -> Vector3<f64>) {
    let mut hits = Vec::with_capacity(4096);
    for (name, mesh) in closed_meshes() {
        let (surface, remarks) = surface(&mesh);
        assert!(surface.watertight(), "{name}: {remarks:?}");
        let mut random = Random(7);
        let mut some = 0;
        for i in 0..LINES {
            let through = points(&surface, &mut random);
            let d = direction(&mut random, i);
            check(name, &surface, &through, &d, &mut hits);
            some += usize::from(!hits.is_empty());
        }
        assert!(some > LINES / 4, "{name}: only {some} lines hit");
    }
}

fn corner(surface: &Surface, triangle: usize, k: usize) -> Vector3<f64> {
    surface.vertices()[surface.triangles()[triangle][k % 3] as usize].into()
}

#[test]
fn generic_lines() {
    run(|surface, random| {
        surface.bounding_sphere().0 + random.vector() * (0.5 * surface.bounding_sphere().1)
    });
}

#[test]
fn lines_through_vertices() {
    run(|surface, random| corner(surface, random.below(surface.triangles().len()), 0));
}

#[test]
fn lines_through_edge_midpoints() {
    run(|surface, random| {
        let (t, k) = (random.below(surface.triangles().len()), random.below(3));
        (corner(surface, t, k) + corner(surface, t, k + 1)) * 0.5
    });
}

#[test]
fn lines_along_edges() {
    let mut hits = Vec::with_capacity(4096);
    for (name, mesh) in closed_meshes() {
        let (surface, _) = surface(&mesh);
        let mut random = Random(3);
        for _ in 0..LINES {
            let (t, k) = (random.below(surface.triangles().len()), random.below(3));
            let (a, b) = (corner(&surface, t, k), corner(&surface, t, k + 1));
            check(name, &surface, &(a + (b - a) * random.number()), &(b - a).normalize(), &mut hits);
        }
    }
}

#[test]
fn lines_in_planes_of_faces() {
    let mut hits = Vec::with_capacity(4096);
    let mut random = Random(5);
    for (name, mesh) in closed_meshes() {
        // Turned, so that the plane is met only to rounding.
        let mut turned = part(&mesh);
        turned.pose = random.pose();
        let (surface, _) = Surface::new(vec![turned]).unwrap();
        for _ in 0..LINES {
            let t = random.below(surface.triangles().len());
            let [a, b, c] = [0, 1, 2].map(|k| corner(&surface, t, k));
            let (u, v) = (random.number(), random.number());
            let d = ((b - a) * random.number() + (c - a) * random.number()).normalize();
            check(name, &surface, &(a + (b - a) * u + (c - a) * v), &d, &mut hits);
        }
    }
}
