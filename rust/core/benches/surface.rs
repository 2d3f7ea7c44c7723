//! Closest points and all-hit rays on a mesh of 5,120 triangles, in batches of 10,000.

use std::hint::black_box;

use contactsense::spatial::Pose;
use contactsense::surface::{Geometry, Part, Surface};
use criterion::{criterion_group, criterion_main, Criterion, Throughput};
use nalgebra::Vector3;

const BATCH: usize = 10_000;
const RADIUS: f64 = 0.15;

/// A sphere of 2 n m - 2 n triangles.
fn sphere(n: u32, m: u32) -> Surface {
    let mut vertices = vec![[0.0, 0.0, -RADIUS], [0.0, 0.0, RADIUS]];
    let mut triangles = Vec::new();
    let at = |i: u32, j: u32| 2 + i % n * (m - 1) + (j - 1);
    for i in 0..n {
        let (sin, cos) = (std::f64::consts::TAU * f64::from(i) / f64::from(n)).sin_cos();
        for j in 1..m {
            let (t, u) = (std::f64::consts::PI * (f64::from(j) / f64::from(m) - 0.5)).sin_cos();
            vertices.push([RADIUS * u * cos, RADIUS * u * sin, RADIUS * t]);
            if j + 1 < m {
                let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
                triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
        triangles.extend([[0, at(i + 1, 1), at(i, 1)], [1, at(i, m - 1), at(i + 1, m - 1)]]);
    }
    surface(Geometry::Mesh { vertices, triangles })
}

/// An icosphere of 5,120 triangles.
fn icosphere() -> Surface {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut corners: Vec<[Vector3<f64>; 3]> = Vec::new();
    // The faces of an icosahedron: all triples of vertices at mutual distance 2.
    let signs = [-1.0, 1.0];
    let points: Vec<Vector3<f64>> = (0..3)
        .flat_map(|k| signs.into_iter().flat_map(move |s| signs.into_iter().map(move |t| (k, s, t * g))))
        .map(|(k, s, t)| {
            let mut v = Vector3::zeros();
            v[k] = s;
            v[(k + 1) % 3] = t;
            v
        })
        .collect();
    let near = |a: usize, b: usize| ((points[a] - points[b]).norm() - 2.0).abs() < 1e-9;
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b) && near(b, c) && near(c, a) {
                    corners.push([a, b, c].map(|i| points[i].normalize()));
                }
            }
        }
    }
    for _ in 0..4 {
        corners = corners
            .iter()
            .flat_map(|[a, b, c]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(|v| v.normalize());
                [[*a, ab, ca], [ab, *b, bc], [ca, bc, *c], [ab, bc, ca]]
            })
            .collect();
    }
    let triangles = (0..corners.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let vertices = corners.iter().flatten().map(|v| (v * RADIUS).into()).collect();
    surface(Geometry::Mesh { vertices, triangles })
}

fn surface(geometry: Geometry) -> Surface {
    let part = Part { geometry, pose: Pose::identity() };
    Surface::new(vec![part]).expect("a good mesh").0
}

fn closest_points(c: &mut Criterion) {
    for (name, surface) in [("icosphere", icosphere()), ("sphere", sphere(64, 41))] {
        assert!(surface.watertight());
        let queries: Vec<_> = surface.sample(BATCH, 1).iter().map(|s| s.point + s.normal * 0.003).collect();
        let mut group = c.benchmark_group(format!("{name}, {} triangles", surface.triangles().len()));
        group.throughput(Throughput::Elements(BATCH as u64));
        group.bench_function("closest point, 3 mm off", |b| {
            b.iter(|| queries.iter().map(|p| black_box(surface.closest_point(p)).distance).sum::<f64>())
        });
        let hints: Vec<Option<u32>> = queries.iter().map(|p| surface.closest_point(p).triangle).collect();
        group.bench_function("closest point, 3 mm off, warm start", |b| {
            b.iter(|| {
                let pairs = queries.iter().zip(&hints);
                pairs.map(|(p, &t)| black_box(surface.closest_point_from(p, t)).distance).sum::<f64>()
            })
        });
        group.finish();
    }
}

fn all_hits(c: &mut Criterion) {
    let surface = icosphere();
    let targets = surface.sample(BATCH, 2);
    let other = surface.sample(BATCH, 3);
    let lines: Vec<_> =
        targets.iter().zip(&other).map(|(a, b)| (a.point, (b.point - a.point).normalize())).collect();
    let mut hits = Vec::with_capacity(64);
    let mut group = c.benchmark_group(format!("icosphere, {} triangles", surface.triangles().len()));
    group.throughput(Throughput::Elements(BATCH as u64));
    for (name, t_min, back) in [("line", f64::NEG_INFINITY, 0.0), ("ray from outside", 0.0, 1.0)] {
        group.bench_function(format!("all hits, {name}"), |b| {
            b.iter(|| {
                let mut count = 0;
                for (origin, direction) in &lines {
                    hits.clear();
                    surface.cast_line_into(&(origin - direction * back), direction, t_min, &mut hits);
                    count += black_box(&hits).len();
                }
                count
            })
        });
    }
    group.finish();
}

criterion_group!(benches, closest_points, all_hits);
criterion_main!(benches);
