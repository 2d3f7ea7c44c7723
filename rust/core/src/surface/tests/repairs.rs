//! Meshes as found in the wild.

use nalgebra::Vector3;
use proptest::prelude::*;

use super::meshes::{block, icosphere, inverted, join, part, surface, torus, Random, Soup};
use crate::spatial::Pose;
use crate::surface::{Geometry, Part, Surface};
use crate::Error;

fn volume(surface: &Surface) -> f64 {
    let corner = |v: u32| Vector3::from(surface.vertices()[v as usize]);
    surface.triangles().iter().map(|t| t.map(corner)).map(|[a, b, c]| a.dot(&b.cross(&c)) / 6.0).sum()
}

fn said(remarks: &[String], what: &str) -> bool {
    remarks.iter().any(|remark| remark.contains(what))
}

#[test]
fn good_meshes_are_left_alone() {
    for mesh in [icosphere(2, 0.1), torus(20, 10, 0.2, 0.05), block([0.0; 3], [1.0; 3])] {
        let (surface, remarks) = surface(&mesh);
        assert!(remarks.is_empty() && surface.watertight(), "{remarks:?}");
        assert_eq!((surface.vertices(), surface.triangles()), (&mesh.0[..], &mesh.1[..]));
    }
}

#[test]
fn inward_normals_are_turned() {
    for mesh in [icosphere(2, 0.1), torus(20, 10, 0.2, 0.05), block([2.0; 3], [3.0; 3])] {
        let (good, _) = surface(&mesh);
        let (turned, remarks) = surface(&inverted(&mesh));
        assert!(said(&remarks, "1 component had inward normals"), "{remarks:?}");
        assert!((volume(&turned) - volume(&good)).abs() < 1e-12 && volume(&turned) > 0.0);
    }
}

#[test]
fn any_winding_is_made_consistent() {
    let mut random = Random(11);
    let good = icosphere(3, 0.1);
    let mut mixed = good.clone();
    let mut turned = 0;
    for t in mixed.1.iter_mut().filter(|_| random.number() > 0.4) {
        t.swap(0, 1);
        turned += 1;
    }
    let (repaired, remarks) = surface(&mixed);
    assert!(said(&remarks, &format!("{turned} triangles turned")), "{turned} {remarks:?}");
    assert!(repaired.watertight());
    assert!((volume(&repaired) - volume(&surface(&good).0)).abs() < 1e-15);
}

#[test]
fn a_soup_is_stitched() {
    let (vertices, triangles) = icosphere(2, 0.1);
    let mut random = Random(4);
    let soup: Vec<[f64; 3]> = triangles
        .iter()
        .flatten()
        .map(|&v| (Vector3::from(vertices[v as usize]) + random.vector() * 1e-12).into())
        .collect();
    let faces = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let (repaired, remarks) = surface(&(soup, faces));
    assert!(repaired.watertight());
    assert_eq!(repaired.vertices().len(), vertices.len());
    let merged = 3 * triangles.len() - vertices.len();
    assert!(said(&remarks, &format!("{merged} duplicate vertices merged")), "{remarks:?}");
}

#[test]
fn cavities_stay_and_turn_with_their_shell() {
    let hollow = join(&[icosphere(3, 0.2), inverted(&icosphere(2, 0.1))]);
    let (surface_a, remarks) = surface(&hollow);
    assert!(remarks.is_empty(), "{remarks:?}");
    let (surface_b, remarks) = surface(&inverted(&hollow));
    assert!(said(&remarks, "2 components had inward normals"), "{remarks:?}");
    for surface in [surface_a, surface_b] {
        let mut hits = Vec::with_capacity(8);
        surface.cast_line_into(&Vector3::new(-1.0, 0.01, 0.02), &Vector3::x(), 0.0, &mut hits);
        let entering: Vec<bool> = hits.iter().map(|hit| hit.entering).collect();
        assert_eq!(entering, [true, false, true, false]);
    }
    let beside = join(&[icosphere(3, 0.2), inverted(&block([1.0; 3], [2.0; 3]))]);
    let (both, remarks) = surface(&beside);
    assert!(said(&remarks, "1 component had"), "{remarks:?}");
    assert!(volume(&both) > 1.0);
}

#[test]
fn duplicates_and_double_sides() {
    let sphere = icosphere(2, 0.1);
    let mut doubled = sphere.clone();
    doubled.1.extend(sphere.1.iter().take(50));
    let (one, remarks) = surface(&doubled);
    assert!(said(&remarks, "50 duplicate triangles") && one.watertight(), "{remarks:?}");
    let (one, remarks) = surface(&join(&[sphere.clone(), inverted(&sphere)]));
    assert!(said(&remarks, "320 duplicate triangles") && one.watertight(), "{remarks:?}");
    assert!(volume(&one) > 0.0);
    // Two blocks that share a face have a wall inside.
    let walled = join(&[block([0.0; 3], [1.0; 3]), block([1.0, 0.0, 0.0], [2.0, 1.0, 1.0])]);
    let (one, remarks) = surface(&walled);
    assert!(one.watertight(), "{remarks:?}");
    assert_eq!(one.triangles().len(), 20);
    assert!((volume(&one) - 2.0).abs() < 1e-12);
}

#[test]
fn slivers_go_and_leave_no_hole() {
    // A block one of whose edges has a vertex in the middle, used on one side only: a sliver fills the gap.
    let (mut vertices, mut triangles) = block([0.0; 3], [1.0; 3]);
    vertices.push([0.5, 0.0, 0.0]);
    let at = triangles.iter().position(|t| t.contains(&0) && t.contains(&1)).unwrap();
    let t = triangles.remove(at);
    let k = (0..3).find(|&k| t[k] != 0 && t[k] != 1).unwrap();
    let (apex, a, b) = (t[k], t[(k + 1) % 3], t[(k + 2) % 3]);
    triangles.extend([[apex, a, 8], [apex, 8, b], [a, b, 8]]);
    let (repaired, remarks) = surface(&(vertices, triangles));
    assert!(said(&remarks, "1 degenerate triangle removed"), "{remarks:?}");
    assert!(repaired.watertight());
    assert_eq!(repaired.triangles().len(), 14);
    assert!((repaired.area() - 6.0).abs() < 1e-12);
}

#[test]
fn open_meshes_are_reported() {
    let (vertices, mut triangles) = icosphere(2, 0.1);
    triangles.truncate(250);
    let (open, remarks) = surface(&(vertices.clone(), triangles.clone()));
    assert!(!open.watertight() && said(&remarks, "open"), "{remarks:?}");
    let (turned, remarks) = surface(&inverted(&(vertices, triangles)));
    assert!(said(&remarks, "inward") && said(&remarks, "open"), "{remarks:?}");
    assert!(turned.triangles().iter().zip(open.triangles()).all(|(a, b)| a[0] == b[0] && a[1] == b[1]));
}

#[test]
fn a_moebius_strip_is_one_sided() {
    let n = 12;
    let mut vertices = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..n {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(n);
        for side in [-0.1, 0.1] {
            let r = 1.0 + side * (angle / 2.0).cos();
            vertices.push([r * angle.cos(), r * angle.sin(), side * (angle / 2.0).sin()]);
        }
        let (a, b) = (2 * i as u32, 2 * i as u32 + 1);
        let (c, d) = if i + 1 < n { (a + 2, b + 2) } else { (1, 0) };
        triangles.extend([[a, c, b], [b, c, d]]);
    }
    let (strip, remarks) = surface(&(vertices, triangles));
    assert!(said(&remarks, "one-sided") && !strip.watertight(), "{remarks:?}");
}

#[test]
fn unusable_meshes_are_refused() {
    let triangle = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bad: Vec<(Soup, &str)> = vec![
        ((vec![], vec![]), "at least one triangle"),
        ((triangle.clone(), vec![]), "at least one triangle"),
        ((triangle.clone(), vec![[0, 1, 3]]), "only 3 vertices"),
        ((vec![[f64::NAN, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]]), "finite"),
        ((triangle.clone(), vec![[0, 1, 1]]), "nothing is left"),
        ((vec![[1.0; 3]; 3], vec![[0, 1, 2]]), "nothing is left"),
        ((vec![[0.0; 3], [1.0; 3], [2.0; 3]], vec![[0, 1, 2]]), "nothing is left"),
    ];
    for (mesh, why) in bad {
        match Surface::new(vec![part(&mesh)]) {
            Err(Error::Geometry { problem: message, .. }) => assert!(message.contains(why), "{message}"),
            other => panic!("{why}: {other:?}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..Default::default() })]

    /// Whatever comes in, there is a surface or an error, and queries work.
    #[test]
    fn garbage_never_panics(
        grid in prop::collection::vec(prop::array::uniform3(-2i8..3), 1..25),
        faces in prop::collection::vec(prop::array::uniform3(0u32..26), 1..60),
        noise in 0..3usize,
    ) {
        let scale = [1.0, 1e-8, 1e8][noise];
        let vertices: Vec<[f64; 3]> = grid.iter().map(|v| v.map(|x| f64::from(x) * scale)).collect();
        let triangles: Vec<[u32; 3]> = faces;
        let geometry = Geometry::Mesh { vertices, triangles };
        if let Ok((surface, _)) = Surface::new(vec![Part { geometry, pose: Pose::identity() }]) {
            let mut hits = Vec::with_capacity(512);
            let mut random = Random(9);
            for i in 0..20 {
                let p = random.vector() * scale;
                prop_assert!(surface.closest_point(&p).distance.is_finite());
                hits.clear();
                let d = if i % 2 == 0 { random.unit() } else { Vector3::x() };
                prop_assert!(surface.cast_line_into(&p, &d, f64::NEG_INFINITY, &mut hits));
                prop_assert!(!surface.watertight() || hits.len() % 2 == 0);
                prop_assert!(hits.iter().all(|hit| hit.distance.is_finite()));
            }
            prop_assert_eq!(surface.sample(5, 0).len(), 5);
        }
    }
}
