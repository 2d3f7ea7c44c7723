//! Mesh queries against a loop over all triangles.

use nalgebra::Vector3;

use super::meshes::{block, icosphere, join, surface, torus, Random, Soup};
use crate::surface::query::triangle;
use crate::surface::Surface;

fn meshes() -> Vec<Soup> {
    vec![
        icosphere(3, 0.15),
        torus(40, 25, 0.2, 0.05),
        block([-0.1, 0.2, 0.3], [0.4, 0.5, 0.35]),
        join(&[icosphere(2, 0.05), block([0.2, 0.2, 0.2], [0.3, 0.3, 0.3])]),
        (vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]),
    ]
}

fn corners(surface: &Surface, t: usize) -> [Vector3<f64>; 3] {
    surface.triangles()[t].map(|v| surface.vertices()[v as usize].into())
}

/// Nearest point of a triangle by another way: the plane's foot if inside, else the nearest of the edges' points.
fn nearest_on(p: &Vector3<f64>, [a, b, c]: [Vector3<f64>; 3]) -> f64 {
    let n = (b - a).cross(&(c - a));
    let foot = p - n * (n.dot(&(p - a)) / n.norm_squared());
    let inside = [(a, b), (b, c), (c, a)].iter().all(|(u, v)| n.dot(&(v - u).cross(&(foot - u))) >= 0.0);
    if inside {
        return (foot - p).norm();
    }
    [(a, b), (b, c), (c, a)]
        .iter()
        .map(|(u, v)| {
            let s = ((p - u).dot(&(v - u)) / (v - u).norm_squared()).clamp(0.0, 1.0);
            (u + (v - u) * s - p).norm()
        })
        .fold(f64::INFINITY, f64::min)
}

#[test]
fn closest_points() {
    let mut random = Random(1);
    for mesh in meshes() {
        let (surface, _) = surface(&mesh);
        let (center, radius) = surface.bounding_sphere();
        for i in 0..if cfg!(debug_assertions) { 60 } else { 400 } {
            let scale = [0.5, 1.1, 5.0, 1e4][i % 4] * radius;
            let mut p = center + random.vector() * scale;
            if i % 3 == 0 {
                let [a, b, c] = corners(&surface, random.below(surface.triangles().len()));
                p = [a, (a + b) * 0.5, (a + b + c) / 3.0][i / 3 % 3] + random.unit() * 0.003;
            }
            let expected = (0..surface.triangles().len())
                .map(|t| nearest_on(&p, corners(&surface, t)))
                .fold(f64::INFINITY, f64::min);
            let got = surface.closest_point(&p);
            assert!((got.distance - expected).abs() <= 1e-12 * (expected + radius), "{got:?} {expected}");
            assert!(((got.point - p).norm() - got.distance).abs() <= 1e-12 * (expected + radius));
            let [a, b, c] = corners(&surface, got.triangle.expect("a mesh") as usize);
            assert!(nearest_on(&got.point, [a, b, c]) < 1e-12 * radius);
            assert!((got.normal - (b - a).cross(&(c - a)).normalize()).norm() < 1e-12);
            let hint = (random.below(surface.triangles().len() + 2) as u32).checked_sub(1);
            let warm = surface.closest_point_from(&p, hint);
            assert_eq!(warm.distance, got.distance);
        }
    }
}

#[test]
fn descent_on_a_convex_surface_ends_at_the_nearest_point_of_all() {
    let mut random = Random(4);
    for mesh in [icosphere(3, 0.15), icosphere(1, 0.15), block([-0.1, 0.2, 0.3], [0.4, 0.5, 0.35])] {
        let (surface, _) = surface(&mesh);
        for (k, sample) in surface.sample(900, 3).into_iter().enumerate() {
            let height = [0.001, 0.05, 0.6][k % 3];
            let p = sample.point + sample.normal * height + random.vector() * (0.01 * (k % 4) as f64);
            let (near, nearest) =
                (surface.closest_point_near(&p, sample.triangle), surface.closest_point(&p));
            if (p - nearest.point).dot(&nearest.normal) > 0.0 {
                assert!((near.distance - nearest.distance).abs() < 1e-12, "{near:?} {nearest:?}");
                assert!((near.point - nearest.point).norm() < 1e-6);
            }
        }
        let p = random.vector();
        for no_triangle in [None, Some(1 << 30)] {
            assert_eq!(surface.closest_point_near(&p, no_triangle), surface.closest_point(&p));
        }
    }
}

#[test]
fn a_triangle_in_all_its_regions() {
    let mut random = Random(2);
    for _ in 0..2000 {
        let t = [random.vector(), random.vector(), random.vector()];
        let p = random.vector() * 2.0;
        let (got, _) = triangle::closest_feature(&p, &t);
        assert!(((got - p).norm() - nearest_on(&p, t)).abs() < 1e-9);
    }
}

#[test]
fn all_hits() {
    let mut random = Random(3);
    let mut hits = Vec::with_capacity(256);
    for mesh in meshes() {
        let (surface, _) = surface(&mesh);
        let (center, radius) = surface.bounding_sphere();
        let mut total = 0;
        for i in 0..600 {
            let d = random.unit();
            let target = center + random.vector() * radius * 0.7;
            let origin = target - d * (radius * [0.0, 2.0, 1e5][i % 3]);
            let t_min = if i % 2 == 0 { f64::NEG_INFINITY } else { 0.0 };
            hits.clear();
            assert!(surface.cast_line_into(&origin, &d, t_min, &mut hits));
            let mut expected: Vec<(f64, usize)> = (0..surface.triangles().len())
                .filter_map(|t| {
                    let [a, b, c] = corners(&surface, t);
                    let (e, f) = (b - a, c - a);
                    let h = d.cross(&f);
                    let s = (origin - a) / e.dot(&h);
                    let u = s.dot(&h);
                    let q = s.cross(&e);
                    let v = d.dot(&q);
                    let distance = f.dot(&q);
                    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance >= t_min).then_some((distance, t))
                })
                .collect();
            expected.sort_by(|a, b| a.0.total_cmp(&b.0));
            if i % 3 == 2 && expected.len() != hits.len() {
                continue; // so far off that the reference loses a hit
            }
            assert_eq!(hits.len(), expected.len());
            total += hits.len();
            for (hit, (distance, t)) in hits.iter().zip(expected) {
                let tolerance = 1e-10 * radius + 1e-10 * distance.abs();
                assert!((hit.distance - distance).abs() < tolerance, "{hit:?} {distance}");
                assert!(hits.len() > 2 || hit.triangle == Some(t as u32));
                assert!((hit.point - (origin + d * hit.distance)).norm() < tolerance);
                assert_eq!(hit.entering, hit.normal.dot(&d) < 0.0);
            }
        }
        assert!(total > 100);
    }
}

#[test]
fn a_full_buffer_is_reported_and_not_grown() {
    let (surface, _) = surface(&torus(40, 25, 0.2, 0.05));
    let (origin, d) = (Vector3::new(-1.0, 0.001, 0.002), Vector3::x());
    for capacity in [0, 1, 3, 4] {
        let mut hits = Vec::with_capacity(capacity);
        let fits = surface.cast_line_into(&origin, &d, 0.0, &mut hits);
        assert_eq!((fits, hits.len(), hits.capacity()), (capacity >= 4, capacity, capacity));
    }
}

#[test]
fn queries_that_are_not_finite() {
    let (surface, _) = surface(&icosphere(2, 0.1));
    let mut hits = Vec::with_capacity(8);
    for bad in [f64::NAN, f64::INFINITY] {
        let p = Vector3::new(bad, 0.0, 0.0);
        assert!(surface.closest_point(&p).distance.is_nan());
        assert!(surface.cast_line_into(&p, &Vector3::x(), 0.0, &mut hits));
        assert!(surface.cast_line_into(&Vector3::zeros(), &p, 0.0, &mut hits));
    }
    assert!(surface.cast_line_into(&Vector3::zeros(), &Vector3::zeros(), 0.0, &mut hits));
    assert!(hits.is_empty());
}
