use std::collections::HashMap;

use nalgebra::{Rotation3, Vector3};

use super::{area, collada as document, CONCAVE_AREA, INSTANCE};
use crate::load::mesh_file::{collada, obj, polygon};
use crate::math::random::Stream;

/// Triangles of a polygon, checked: each of its edges in one triangle, all others in two that face the same way.
fn triangles(corners: &[Vector3<f64>]) -> Vec<[usize; 3]> {
    let mut found = Vec::new();
    polygon::triangulate(corners, &mut |triangle| {
        found.push(triangle);
        Ok(())
    })
    .unwrap();
    assert_eq!(found.len(), corners.len() - 2);
    let mut edges: HashMap<(usize, usize), i32> = HashMap::new();
    for [a, b, c] in &found {
        for (from, to) in [(a, b), (b, c), (c, a)] {
            *edges.entry((*from, *to)).or_default() += 1;
            *edges.entry((*to, *from)).or_default() -= 1;
        }
    }
    for i in 0..corners.len() {
        *edges.entry((i, (i + 1) % corners.len())).or_default() -= 1;
        *edges.entry(((i + 1) % corners.len(), i)).or_default() += 1;
    }
    assert!(edges.values().all(|count| *count == 0), "{found:?}");
    found
}

/// Area of the polygon, and the sum of the areas of its triangles: larger where they overlap or lie outside.
fn areas(corners: &[Vector3<f64>]) -> [f64; 2] {
    let twice = |[a, b, c]: [usize; 3]| (corners[b] - corners[a]).cross(&(corners[c] - corners[a]));
    let whole: Vector3<f64> = (2..corners.len()).map(|i| twice([0, i - 1, i])).sum();
    [whole.norm(), triangles(corners).into_iter().map(|t| twice(t).norm()).sum()]
}

fn fills(corners: &[Vector3<f64>]) {
    let turned = Rotation3::from_euler_angles(0.7, -1.1, 2.0);
    for rotation in
        [Rotation3::identity(), turned, turned * turned, Rotation3::from_euler_angles(3.0, 0.0, 0.0)]
    {
        let mut placed: Vec<_> =
            corners.iter().map(|p| rotation * p + Vector3::new(30.0, -20.0, 10.0)).collect();
        for _ in 0..2 {
            let [whole, sum] = areas(&placed);
            assert!((whole - sum).abs() < 1e-9 * whole, "{whole} {sum}: {corners:?}");
            placed.reverse();
        }
    }
}

fn flat(points: &[[f64; 2]]) -> Vec<Vector3<f64>> {
    points.iter().map(|p| Vector3::new(p[0], p[1], 0.0)).collect()
}

#[test]
fn a_convex_polygon_is_a_fan() {
    let corners = flat(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.5], [0.0, 1.0]]);
    assert_eq!(triangles(&corners), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
}

#[test]
fn concave_polygons_are_filled_from_any_first_corner() {
    let mut arrow = vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.2], [0.0, 2.0]];
    // With corners on straight edges, which neighbours may use.
    let mut step =
        vec![[0., 0.], [1., 0.], [2., 0.], [2., 1.], [1.5, 1.], [1., 1.], [1., 1.5], [1., 2.], [0., 2.]];
    // A square hole in a square, reached by an edge that is used twice.
    let mut frame = vec![
        [0., 0.],
        [3., 0.],
        [3., 3.],
        [0., 3.],
        [0., 0.],
        [1., 1.],
        [1., 2.],
        [2., 2.],
        [2., 1.],
        [1., 1.],
    ];
    for polygon in [&mut arrow, &mut step, &mut frame] {
        for _ in 0..polygon.len() {
            polygon.rotate_left(1);
            fills(&flat(polygon));
        }
    }
}

#[test]
fn random_polygons_are_filled() {
    let random = Stream::new(3);
    for case in 0..300 {
        let n = 4 + (random.uniform(case) * 40.0) as usize;
        let polygon: Vec<[f64; 2]> = (0..n)
            .map(|i| {
                let radius = 0.05 + random.uniform(1_000 + case * 100 + i as u64);
                let angle = std::f64::consts::TAU * i as f64 / n as f64;
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        fills(&flat(&polygon));
    }
    // A spiral: two arms of 30 corners, one around the other.
    let arm = |shift: f64| {
        (0..30).map(move |i| {
            let angle = 0.4 * f64::from(i);
            [(1.0 + shift + angle) * angle.cos(), (1.0 + shift + angle) * angle.sin()]
        })
    };
    let spiral: Vec<[f64; 2]> = arm(0.0).chain(arm(0.5).collect::<Vec<_>>().into_iter().rev()).collect();
    fills(&flat(&spiral));
}

#[test]
fn a_polygon_that_meets_itself_keeps_its_edges() {
    let bow = flat(&[[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]);
    let nothing = flat(&[[0.0, 0.0]; 7]);
    let line = flat(&[[0.0, 0.0], [1.0, 1.0], [3.0, 3.0], [2.0, 2.0], [-1.0, -1.0]]);
    for corners in [bow, nothing, line] {
        triangles(&corners);
    }
    let random = Stream::new(4);
    for case in 0..300 {
        let n = 5 + case as usize % 20;
        let number = |i: usize, k: usize| (5.0 * random.uniform(case * 1_000 + (2 * i + k) as u64)).floor();
        triangles(&flat(&(0..n).map(|i| [number(i, 0), number(i, 1)]).collect::<Vec<_>>()));
    }
}

#[test]
fn concave_faces_of_files_have_their_own_area() {
    let face = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 1 0.2 0\nv 0 2 0\nf 1 2 3 4 5\n";
    let soup = obj::parse(face).unwrap();
    assert!((area(&soup) - CONCAVE_AREA).abs() < 1e-12);
    let input = r##"<input semantic="VERTEX" source="#v" offset="0"/>"##;
    for primitive in [
        format!("<polylist>{input}<vcount>5</vcount><p>0 1 2 3 4</p></polylist>"),
        format!("<polygons>{input}<p>0 1 2 3 4</p></polygons>"),
    ] {
        let soup = collada::parse(&document(&primitive, "", INSTANCE)).unwrap();
        assert!((area(&soup) - CONCAVE_AREA).abs() < 1e-12, "{primitive}");
    }
}

#[test]
fn lines_of_obj_are_read_as_written() {
    let text = "# a comment \\\nv 0 0 0 1 0 0\r\nv 4 0 0 2\nv 0 2 0 # corner\np 1\nl 1 2 3\nf 1/1/1 \\\n 2//3 -1\nf 3 2 4\rv 1 1 1\n";
    let soup = obj::parse(text).unwrap();
    assert_eq!(soup.triangles, [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(soup.vertices[1], Vector3::new(2.0, 0.0, 0.0));
}
