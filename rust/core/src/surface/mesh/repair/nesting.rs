//! Which closed components of a mesh lie inside others.

use nalgebra::Vector3;

/// Steps of the search for components inside others, of about 10 ns: more than 10,000 components need.
const MOST_STEPS: usize = 200_000_000;

/// The outermost shell around each, if there is one, and of how many that remained open.
pub(crate) fn outermost(
    vertices: &[Vector3<f64>],
    triangles: &[[u32; 3]],
    shells: &[Shell],
) -> (Vec<Option<usize>>, usize) {
    let mut outermost = vec![None; shells.len()];
    if shells.iter().all(|shell| shell.volume >= 0.0) {
        return (outermost, 0); // nothing can be inside out
    }
    let mut largest_first: Vec<usize> = (0..shells.len()).collect();
    largest_first.sort_by(|&a, &b| shells[b].volume.abs().total_cmp(&shells[a].volume.abs()));
    let mut steps = 0;
    for (rank, &i) in largest_first.iter().enumerate() {
        for &j in &largest_first[..rank] {
            steps += 1;
            if !shells[j].could_hold(&shells[i]) {
                continue;
            }
            steps += shells[j].members.len();
            if steps > MOST_STEPS {
                return (outermost, shells.len() - rank);
            }
            if shells[j].winds_around(vertices, triangles, &shells[i]) {
                outermost[i] = Some(j);
                break;
            }
        }
        if steps > MOST_STEPS {
            return (outermost, shells.len() - rank - 1);
        }
    }
    (outermost, 0)
}

/// A closed component.
pub(crate) struct Shell<'a> {
    pub members: &'a [u32],
    pub volume: f64,
    low: Vector3<f64>,
    high: Vector3<f64>,
}

impl<'a> Shell<'a> {
    pub fn new(vertices: &[Vector3<f64>], triangles: &[[u32; 3]], members: &'a [u32], volume: f64) -> Self {
        let points = members.iter().flat_map(|&i| triangles[i as usize]).map(|v| vertices[v as usize]);
        let low = points.clone().fold(Vector3::repeat(f64::INFINITY), |a, v| a.inf(&v));
        let high = points.fold(Vector3::repeat(f64::NEG_INFINITY), |a, v| a.sup(&v));
        Shell { members, volume, low, high }
    }

    /// Whether `other` is smaller and its box inside this one's.
    fn could_hold(&self, other: &Shell) -> bool {
        let boxed = (0..3).all(|k| self.low[k] <= other.low[k] && other.high[k] <= self.high[k]);
        boxed && self.volume.abs() > other.volume.abs()
    }

    /// Whether a point of `other` lies inside.
    fn winds_around(&self, vertices: &[Vector3<f64>], triangles: &[[u32; 3]], other: &Shell) -> bool {
        let [a, b, c] = triangles[other.members[0] as usize].map(|v| vertices[v as usize]);
        let p = (a + b + c) / 3.0;
        // The winding number about p, from the solid angles of the triangles (Van Oosterom and Strackee 1983).
        let angle: f64 = self
            .members
            .iter()
            .map(|&i| {
                let [a, b, c] = triangles[i as usize].map(|v| vertices[v as usize] - p);
                let (x, y, z) = (a.norm(), b.norm(), c.norm());
                let below = x * y * z + a.dot(&b) * z + b.dot(&c) * x + c.dot(&a) * y;
                2.0 * a.dot(&b.cross(&c)).atan2(below)
            })
            .sum();
        angle.abs() > 2.0 * std::f64::consts::PI
    }
}
