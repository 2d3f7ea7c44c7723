//! Meshes whose surface takes hours to make where the work grows with the square of their size.

use std::f64::consts::TAU;

use nalgebra::Vector3;

use super::meshes::{block, inverted, join, surface, Soup};

const MANY: u32 = 300_000;

/// Points on a circle of radius 1, at height 0; then the origin, and the tip above.
fn circle_and_tip(count: u32) -> Vec<[f64; 3]> {
    let on_circle = |i| (TAU * f64::from(i) / f64::from(count)).sin_cos();
    let circle = (0..count).map(on_circle).map(|(sin, cos)| [cos, sin, 0.0]);
    circle.chain([[0.0; 3], [0.0, 0.0, 1.0]]).collect()
}

#[test]
fn many_triangles_round_one_vertex() {
    let (middle, tip) = (MANY, MANY + 1);
    let triangles = (0..MANY).flat_map(|i| {
        let next = (i + 1) % MANY;
        [[i, next, tip], [next, i, middle]]
    });
    let (cone, remarks) = surface(&(circle_and_tip(MANY), triangles.collect()));
    assert!(cone.watertight() && remarks.is_empty(), "{remarks:?}");
    assert!((cone.area() - TAU / 2.0 * (1.0 + 2f64.sqrt())).abs() < 1e-6);
    // From the tip, where all of them meet, the search goes through the tree.
    let above = Vector3::new(0.0, 0.0, 2.0);
    let near = cone.closest_point_near(&above, Some(0));
    assert_eq!(near.point, Vector3::z());
    let beside = Vector3::new(1.0, 0.0, 0.6);
    let [near, nearest] = [cone.closest_point_near(&beside, near.triangle), cone.closest_point(&beside)];
    assert!((near.point - nearest.point).norm() < 1e-12);
}

#[test]
fn many_triangles_round_one_edge() {
    let (middle, tip) = (MANY, MANY + 1);
    let pages: Vec<[u32; 3]> = (0..MANY).map(|i| [i, middle, tip]).collect();
    let (book, _) = surface(&(circle_and_tip(MANY), pages));
    assert!(!book.watertight());
    assert_eq!(book.triangles().len(), MANY as usize);
}

#[test]
fn many_components() {
    let cube = |i: i32, size: f64| {
        let low = [f64::from(i % 50), f64::from(i / 50 % 50), f64::from(i / 2500)];
        block(low, low.map(|x| x + size))
    };
    let cubes = |count: i32| join(&(0..count).map(|i| cube(i, 0.5)).collect::<Vec<_>>());
    // All as they should be; one of them is inside out.
    let (right, remarks) = surface(&cubes(40_000));
    assert!(remarks.is_empty());
    let (turned, remarks) = surface(&join(&[cubes(39_999), inverted(&cube(39_999, 0.5))]));
    assert!((right.area() - turned.area()).abs() < 1e-6 * right.area());
    assert!(remarks[0].contains("1 component had inward normals"), "{remarks:?}");
    assert!(remarks[1].contains("components not compared with all others"), "{remarks:?}");
    // Few enough to be compared: one hull around all, turned, so that they turn with it.
    let shells: Soup = join(&[cubes(2_000), inverted(&block([-1.0; 3], [60.0; 3]))]);
    assert_eq!(surface(&shells).1, ["2001 components had inward normals: turned outward"]);
}

#[test]
fn vertices_far_from_the_origin() {
    // As near to each other as numbers of this size can be.
    let place = |i: u32| 1e14 + f64::from(i) / 64.0;
    let side = 60;
    let vertices: Vec<[f64; 3]> =
        (0..side * side * side).map(|i| [i % side, i / side % side, i / side / side].map(place)).collect();
    let triangles = (0..vertices.len() as u32 - side).map(|i| [i, i + 1, i + side]).collect();
    assert!(surface(&(vertices, triangles)).0.area() > 0.0);
}
