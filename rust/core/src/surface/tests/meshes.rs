//! Meshes made here: nothing is read from files.

use std::collections::HashMap;

use nalgebra::Vector3;

use crate::spatial::Pose;
use crate::surface::{Geometry, Part, Surface};

pub type Soup = (Vec<[f64; 3]>, Vec<[u32; 3]>);

/// An icosphere with 20 * 4^level triangles.
pub fn icosphere(level: usize, radius: f64) -> Soup {
    let g = (1.0 + 5f64.sqrt()) / 2.0;
    let mut vertices: Vec<Vector3<f64>> = [
        [-1.0, g, 0.0],
        [1.0, g, 0.0],
        [-1.0, -g, 0.0],
        [1.0, -g, 0.0],
        [0.0, -1.0, g],
        [0.0, 1.0, g],
        [0.0, -1.0, -g],
        [0.0, 1.0, -g],
        [g, 0.0, -1.0],
        [g, 0.0, 1.0],
        [-g, 0.0, -1.0],
        [-g, 0.0, 1.0],
    ]
    .iter()
    .map(|&v| Vector3::from(v).normalize())
    .collect();
    let mut triangles: Vec<[u32; 3]> = vec![
        [0, 11, 5],
        [0, 5, 1],
        [0, 1, 7],
        [0, 7, 10],
        [0, 10, 11],
        [1, 5, 9],
        [5, 11, 4],
        [11, 10, 2],
        [10, 7, 6],
        [7, 1, 8],
        [3, 9, 4],
        [3, 4, 2],
        [3, 2, 6],
        [3, 6, 8],
        [3, 8, 9],
        [4, 9, 5],
        [2, 4, 11],
        [6, 2, 10],
        [8, 6, 7],
        [9, 8, 1],
    ];
    for _ in 0..level {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                vertices.push((vertices[a as usize] + vertices[b as usize]).normalize());
                vertices.len() as u32 - 1
            })
        };
        triangles = triangles
            .iter()
            .flat_map(|&[a, b, c]| {
                let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            })
            .collect();
    }
    (vertices.iter().map(|v| (v * radius).into()).collect(), triangles)
}

/// A torus around z.
pub fn torus(n: u32, m: u32, large: f64, small: f64) -> Soup {
    let turn = |i: u32, n: u32| (2.0 * std::f64::consts::PI * f64::from(i) / f64::from(n)).sin_cos();
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..n {
        for j in 0..m {
            let ((s, c), (t, u)) = (turn(i, n), turn(j, m));
            vertices.push([(large + small * u) * c, (large + small * u) * s, small * t]);
            let at = |i: u32, j: u32| i % n * m + j % m;
            let (a, b, c, d) = (at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    (vertices, triangles)
}

/// A box between two corners.
pub fn block(low: [f64; 3], high: [f64; 3]) -> Soup {
    let vertices =
        (0..8).map(|i| [0, 1, 2].map(|k| if i >> k & 1 == 1 { high[k] } else { low[k] })).collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    (vertices, quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// The boundary of a set of unit cells, scaled: closed, not convex, with many coplanar faces.
pub fn cells(filled: &[[i64; 3]], size: f64) -> Soup {
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for &cell in filled {
        for axis in 0..3 {
            for side in [0i64, 1] {
                let mut next = cell;
                next[axis] += 2 * side - 1;
                if filled.contains(&next) {
                    continue;
                }
                let corner = |j: i64, k: i64| {
                    let mut at = cell;
                    at[axis] += side;
                    at[(axis + 1) % 3] += j;
                    at[(axis + 2) % 3] += k;
                    at.map(|x| x as f64 * size)
                };
                let first = vertices.len() as u32;
                vertices.extend([corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]);
                let quad = if side == 1 { [0, 1, 2, 3] } else { [0, 3, 2, 1] }.map(|i| first + i);
                triangles.extend([[quad[0], quad[1], quad[2]], [quad[0], quad[2], quad[3]]]);
            }
        }
    }
    (vertices, triangles)
}

/// Meshes side by side in one.
pub fn join(meshes: &[Soup]) -> Soup {
    let mut all: Soup = Default::default();
    for (vertices, triangles) in meshes {
        let first = all.0.len() as u32;
        all.0.extend(vertices);
        all.1.extend(triangles.iter().map(|t| t.map(|v| v + first)));
    }
    all
}

/// The same, inside out.
pub fn inverted((vertices, triangles): &Soup) -> Soup {
    (vertices.clone(), triangles.iter().map(|&[a, b, c]| [a, c, b]).collect())
}

pub fn part((vertices, triangles): &Soup) -> Part {
    let geometry = Geometry::Mesh { vertices: vertices.clone(), triangles: triangles.clone() };
    Part { geometry, pose: Pose::identity() }
}

/// The surface of one mesh, and the remarks about it.
pub fn surface(mesh: &Soup) -> (Surface, Vec<String>) {
    Surface::new(vec![part(mesh)]).unwrap()
}

/// A small generator for tests.
pub struct Random(pub u64);

impl Random {
    /// In [-1, 1).
    pub fn number(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let x = self.0 ^ (self.0 >> 33);
        (x.wrapping_mul(0xff51_afd7_ed55_8ccd) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    pub fn vector(&mut self) -> Vector3<f64> {
        Vector3::new(self.number(), self.number(), self.number())
    }

    pub fn unit(&mut self) -> Vector3<f64> {
        loop {
            let v = self.vector();
            if v.norm() < 1.0 && v.norm() > 0.1 {
                return v.normalize();
            }
        }
    }

    pub fn below(&mut self, n: usize) -> usize {
        ((self.number() * 0.5 + 0.5) * n as f64) as usize % n
    }

    pub fn pose(&mut self) -> Pose {
        let rotation = nalgebra::Rotation3::new(self.unit() * (3.0 * self.number()));
        Pose { rotation: *rotation.matrix(), translation: self.vector() }
    }
}
