//! Lines with more crossings than room for hits.

use nalgebra::Vector3;

use super::meshes::{block, torus, Random, Soup};
use crate::spatial::Pose;
use crate::surface::{Geometry, Part, RayHit, Surface};

/// Many plates, one after the other, as one mesh.
fn plates(count: usize, from: f64, side: f64) -> Soup {
    let mut soup: Soup = Default::default();
    for i in 0..count {
        let low = from + 0.02 * i as f64;
        let (vertices, triangles) = block([low, -side, -side], [low + 0.01, side, side]);
        let first = soup.0.len() as u32;
        soup.0.extend(vertices);
        soup.1.extend(triangles.iter().map(|t| t.map(|v| v + first)));
    }
    soup
}

/// Plates that overlap with others, a ring, a ball and a box.
fn crowd() -> Surface {
    let mesh = |(vertices, triangles)| Geometry::Mesh { vertices, triangles };
    let shapes = [
        mesh(plates(15, -0.2, 0.3)),
        mesh(plates(9, -0.1037, 0.27)),
        mesh(torus(20, 12, 0.2, 0.05)),
        Geometry::Sphere { radius: 0.07 },
        Geometry::Box { half_extents: [0.131, 0.02, 0.3] },
    ];
    Surface::new(shapes.map(|geometry| Part { geometry, pose: Pose::identity() }).into()).unwrap().0
}

#[test]
fn the_nearest_hits_are_kept() {
    let surface = crowd();
    let mut random = Random(11);
    let (mut all, mut hidden_ends) = (Vec::with_capacity(1000), 0);
    for i in 0..300 {
        let d = if i % 3 == 0 { random.unit() } else { (Vector3::x() + 0.2 * random.unit()).normalize() };
        let origin = random.vector() * 0.1 - d * [0.0, 1.0][i % 2];
        let t_min = [f64::NEG_INFINITY, 0.0][i % 5 % 2];
        all.clear();
        assert!(surface.cast_line_into(&origin, &d, t_min, &mut all));
        let mut found = 0;
        for capacity in 0..80 {
            let mut hits: Vec<RayHit> = Vec::with_capacity(capacity);
            let fits = surface.cast_line_into(&origin, &d, t_min, &mut hits);
            assert_eq!(hits.capacity(), capacity);
            assert_eq!(hits, all[..hits.len()], "capacity {capacity}");
            assert!(!fits || hits.len() == all.len());
            // More room never loses a hit, and each slot more gains at most one.
            assert!(hits.len() >= found && hits.len() <= found + 1);
            hidden_ends += usize::from(!fits && hits.len() == found);
            found = hits.len();
        }
    }
    assert!(hidden_ends > 100); // of crossings inside other parts
}

#[test]
fn hits_that_are_there_already_stay() {
    let surface = crowd();
    let mut hits = Vec::with_capacity(7);
    let cast = |hits: &mut Vec<RayHit>, capacity| {
        let mut own = Vec::with_capacity(capacity);
        let fits = surface.cast_line_into(&Vector3::new(-1.0, 0.001, 0.25), &Vector3::x(), 0.0, &mut own);
        hits.extend(own);
        fits
    };
    assert!(!cast(&mut hits, 3));
    let first = hits.clone();
    assert!(!surface.cast_line_into(&Vector3::new(-1.0, 0.001, 0.25), &Vector3::x(), 0.0, &mut hits));
    assert_eq!((&hits[..3], hits.len()), (&first[..], 7));
    assert_eq!(hits[3..6], first);
}
