//! The search tree keeps every triangle, in its boxes and within the depth that searches have room for.

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};

use super::meshes::icosphere;
use crate::surface::mesh::bvh::Branch;
use crate::surface::mesh::bvh4::{collapse, Child, Node, Tree, MAX_DEPTH, STACK};

type Triangle = [Vector3<f64>; 3];

/// Checks that each slot is in one leaf and in all boxes above it; returns how many levels there are.
fn check_nodes(nodes: &[Node], slots: &[Aabb]) -> usize {
    let mut seen = vec![0; slots.len()];
    let mut levels = 0;
    let mut stack = vec![(Child(0), 0, Vec::new())];
    while let Some((child, level, boxes)) = stack.pop() {
        levels = levels.max(level);
        let Some(run) = child.triangles() else {
            let node = &nodes[child.0 as usize];
            for lane in 0..4 {
                let mut boxes: Vec<[[f32; 3]; 2]> = boxes.clone();
                boxes.push([node.low.map(|x| x[lane]), node.high.map(|x| x[lane])]);
                stack.push((node.child[lane], level + 1, boxes));
            }
            assert!(stack.len() <= STACK, "{} entries", stack.len());
            continue;
        };
        for slot in run {
            seen[slot] += 1;
            for [low, high] in &boxes {
                for k in 0..3 {
                    assert!(f64::from(low[k]) <= slots[slot].mins[k], "slot {slot} sticks out below");
                    assert!(f64::from(high[k]) >= slots[slot].maxs[k], "slot {slot} sticks out above");
                }
            }
        }
    }
    assert!(seen.iter().all(|&count| count == 1), "a slot is in no leaf or in several");
    assert!(levels <= MAX_DEPTH, "{levels} levels");
    levels
}

fn check(triangles: &[Triangle]) -> usize {
    let (tree, order) = Tree::new(triangles);
    let mut sorted = order.clone();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..triangles.len() as u32), "the order is no permutation");
    let point = |v: Vector3<f64>| <[f64; 3]>::from(v - tree.center).into();
    let slots: Vec<Aabb> = order
        .iter()
        .map(|&id| {
            let [a, b, c] = triangles[id as usize];
            Aabb::new(point(a.inf(&b).inf(&c)), point(a.sup(&b).sup(&c)))
        })
        .collect();
    check_nodes(&tree.nodes, &slots)
}

/// A triangle of this size at a place.
fn triangle(at: Vector3<f64>, size: f64) -> Triangle {
    [at, at + Vector3::new(size, 0.0, 0.0), at + Vector3::new(0.0, size, 0.5 * size)]
}

#[test]
fn few_triangles() {
    for n in 1..40 {
        let row: Vec<_> = (0..n).map(|i| triangle(Vector3::new(f64::from(i), 0.0, 0.0), 0.4)).collect();
        let levels = check(&row);
        assert!(n > 4 || levels == 1, "{n} triangles: {levels} levels");
    }
}

#[test]
fn coincident_triangles() {
    for n in [2, 5, 5_000] {
        check(&vec![triangle(Vector3::new(1.0, 2.0, 3.0), 0.1); n]);
    }
    // All at one place but a few.
    let mut most = vec![triangle(Vector3::zeros(), 1e-3); 5_000];
    most.extend((0..50).map(|i| triangle(Vector3::new(1.5f64.powi(i), 0.0, 0.0), 1e-3)));
    check(&most);
}

#[test]
fn growing_triangles() {
    // On both sides, so that the small ones are at the centre, where numbers are finest; down to the finest.
    for growth in [8.0 / 7.0, 1.3, 2.0, 7.0, 100.0] {
        let count = (1e300f64.ln() / f64::ln(growth)) as i32;
        let sizes: Vec<f64> = (0..count).map(|i| f64::powi(growth, -i)).collect();
        let nested: Vec<_> = sizes.iter().map(|&s| triangle(Vector3::repeat(-0.3 * s), s)).collect();
        let row = |sign: f64| sizes.iter().map(move |&s| triangle(Vector3::new(sign * s, 0.0, 0.0), 0.1 * s));
        check(&nested);
        check(&row(1.0).chain(row(-1.0)).collect::<Vec<_>>());
        for scale in [1e-30, 1e14] {
            check(&nested.iter().map(|t| t.map(|v| v * scale)).collect::<Vec<_>>());
        }
    }
}

#[test]
fn triangles_on_a_line_and_in_a_plane() {
    let line: Vec<_> = (0..3_000).map(|i| [Vector3::new(f64::from(i * i), 0.0, 0.0); 3]).collect();
    check(&line);
    let sheet = (0..40_000).map(|i| triangle(Vector3::new(f64::from(i % 200), f64::from(i / 200), 0.0), 1.0));
    check(&sheet.map(|t| t.map(|v| Vector3::new(v.x, v.y, 0.0))).collect::<Vec<_>>());
}

#[test]
fn large_meshes() {
    let (vertices, triangles) = icosphere(6, 0.2);
    let soup: Vec<_> = triangles.iter().map(|t| t.map(|v| vertices[v as usize].into())).collect();
    assert_eq!(soup.len(), 81_920);
    let twice: Vec<_> = soup.iter().copied().chain(soup.iter().map(|t| t.map(|v| v * 0.5))).collect();
    assert!(check(&twice) <= 15, "a well-formed mesh needs few levels");
}

/// A binary tree that parts off one leaf at a time is deeper than any search has room for.
#[test]
fn chains_are_halved() {
    let n = 20_000;
    let boxes: Vec<Aabb> =
        (0..n).map(|i| Aabb::new([i as f64, 0.0, 0.0].into(), [i as f64 + 1.0, 1.0, 1.0].into())).collect();
    let order: Vec<u32> = (0..n as u32).collect();
    let mut rest = vec![boxes[n - 1]; n];
    for i in (0..n - 1).rev() {
        rest[i] = rest[i + 1].merged(&boxes[i]);
    }
    let mut branches = vec![Branch { bounds: rest[0], child: 1, count: n }];
    for i in 0..n - 1 {
        let child = if i + 2 < n { branches.len() + 2 } else { 0 };
        branches.push(Branch { bounds: boxes[i], child: 0, count: 1 });
        branches.push(Branch { bounds: rest[i + 1], child, count: n - 1 - i });
    }
    let levels = check_nodes(&collapse(&branches, &order, &boxes), &boxes);
    assert!(levels > 18, "the chain was followed as far as it could be: {levels}");
}
