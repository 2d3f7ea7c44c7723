//! A bounding volume tree over triangles: four boxes a node, single precision, rounded outward.
//!
//! Boxes only cull; they are enlarged by more than any rounding in the queries, so no triangle is ever lost. The
//! coordinates are relative to the mesh's centre.

use nalgebra::Vector3;

/// Most entries a depth-first search ever holds: three a level, and the depth is checked when the tree is built.
pub(super) const STACK: usize = 96;
const MAX_DEPTH: usize = 31;
const SURFACE_AREA_DEPTH: usize = 17;
const MAX_LEAF: usize = 2;
const BINS: usize = 12;
/// Enlargement of boxes relative to the mesh's radius: well above single-precision rounding.
const MARGIN: f64 = 2e-6;

/// Where unused boxes are, as points: finite, so that no arithmetic on them is undefined.
const NOWHERE: f32 = 1e30;

/// Four boxes side by side.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub low: [[f32; 4]; 3],
    pub high: [[f32; 4]; 3],
    pub child: [Child; 4],
}

/// A node's index, or a run of triangles: bit 31 set, count in bits 28..31, first in the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Child(pub u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    /// Most triangles that a run's first index can address.
    pub const MAX_TRIANGLES: usize = 1 << 28;

    fn leaf(first: usize, count: usize) -> Self {
        Child(Self::LEAF | (count as u32) << 28 | first as u32)
    }

    /// The run of triangles, if it is one.
    #[inline]
    pub fn triangles(self) -> Option<std::ops::Range<usize>> {
        (self.0 & Self::LEAF != 0).then(|| {
            let first = (self.0 & ((1 << 28) - 1)) as usize;
            first..first + (self.0 >> 28 & 7) as usize
        })
    }
}

#[derive(Debug, Clone)]
pub(super) struct Tree {
    /// The root is first.
    pub nodes: Vec<Node>,
    pub center: Vector3<f64>,
    /// Of a sphere around the triangles.
    pub radius: f64,
}

#[derive(Clone, Copy)]
struct Bounds {
    low: [f64; 3],
    high: [f64; 3],
}

impl Bounds {
    const EMPTY: Bounds = Bounds { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    fn add(&mut self, other: &Bounds) {
        for k in 0..3 {
            self.low[k] = self.low[k].min(other.low[k]);
            self.high[k] = self.high[k].max(other.high[k]);
        }
    }

    fn half_area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|k| (self.high[k] - self.low[k]).max(0.0));
        x * y + y * z + z * x
    }
}

struct Item {
    bounds: Bounds,
    middle: [f64; 3],
    id: u32,
}

impl Tree {
    /// The tree, and the triangles' order in its leaves. There must be at least one triangle.
    pub fn new(corners: &[[Vector3<f64>; 3]]) -> (Tree, Vec<u32>) {
        let all = corners.iter().flatten();
        let low = all.clone().fold(Vector3::repeat(f64::INFINITY), |a, v| a.inf(v));
        let high = all.clone().fold(Vector3::repeat(f64::NEG_INFINITY), |a, v| a.sup(v));
        let center = (low + high) * 0.5;
        let radius = all.map(|v| (v - center).norm()).fold(0.0, f64::max);
        let mut items: Vec<Item> = corners
            .iter()
            .enumerate()
            .map(|(id, [a, b, c])| {
                let bounds = Bounds {
                    low: (a.inf(b).inf(c) - center).into(),
                    high: (a.sup(b).sup(c) - center).into(),
                };
                let middle = [0, 1, 2].map(|k| 0.5 * (bounds.low[k] + bounds.high[k]));
                Item { bounds, middle, id: id as u32 }
            })
            .collect();
        let mut tree = Tree { nodes: Vec::new(), center, radius };
        let margin = MARGIN * radius;
        tree.grow(&mut items, 0, 0, margin);
        (tree, items.iter().map(|item| item.id).collect())
    }

    /// Adds the node over `items`, which start at `first` in leaf order, and all below it.
    fn grow(&mut self, items: &mut [Item], first: usize, depth: usize, margin: f64) -> u32 {
        assert!(depth < MAX_DEPTH, "median splits bound the depth");
        let index = self.nodes.len();
        self.nodes.push(Node {
            low: [[NOWHERE; 4]; 3],
            high: [[NOWHERE; 4]; 3],
            child: [Child::leaf(0, 0); 4],
        });
        let by_area = depth < SURFACE_AREA_DEPTH;
        let middle = split(items, by_area);
        let (left, right) = items.split_at_mut(middle);
        let mut start = first;
        let mut lane = 0;
        for half in [left, right] {
            let at = split(half, by_area);
            let (a, b) = half.split_at_mut(at);
            for quarter in [a, b] {
                if quarter.is_empty() {
                    continue;
                }
                let mut bounds = Bounds::EMPTY;
                quarter.iter().for_each(|item| bounds.add(&item.bounds));
                let child = if quarter.len() <= MAX_LEAF {
                    Child::leaf(start, quarter.len())
                } else {
                    Child(self.grow(quarter, start, depth + 1, margin))
                };
                let node = &mut self.nodes[index];
                for k in 0..3 {
                    node.low[k][lane] = (bounds.low[k] - margin) as f32;
                    node.high[k][lane] = (bounds.high[k] + margin) as f32;
                }
                node.child[lane] = child;
                lane += 1;
                start += quarter.len();
            }
        }
        index as u32
    }
}

/// Orders the items in two groups and returns where the second starts (0 or the length: no split needed).
fn split(items: &mut [Item], by_area: bool) -> usize {
    if items.len() <= MAX_LEAF {
        return items.len();
    }
    let mut low = [f64::INFINITY; 3];
    let mut high = [f64::NEG_INFINITY; 3];
    for item in items.iter() {
        for k in 0..3 {
            low[k] = low[k].min(item.middle[k]);
            high[k] = high[k].max(item.middle[k]);
        }
    }
    let axis = (0..3).max_by(|&a, &b| (high[a] - low[a]).total_cmp(&(high[b] - low[b]))).unwrap_or(0);
    if by_area {
        if let Some(at) = split_by_area(items, low, high) {
            return at;
        }
    }
    let half = items.len() / 2;
    items.select_nth_unstable_by(half, |a, b| a.middle[axis].total_cmp(&b.middle[axis]));
    half
}

/// The surface area heuristic over bins of the centres, on the best of the three axes.
fn split_by_area(items: &mut [Item], low: [f64; 3], high: [f64; 3]) -> Option<usize> {
    let mut best: Option<(f64, usize, usize)> = None;
    for axis in 0..3 {
        let extent = high[axis] - low[axis];
        if extent <= 0.0 {
            continue;
        }
        let mut bins = [(Bounds::EMPTY, 0usize); BINS];
        for item in items.iter() {
            let bin = &mut bins[bin_of(item, axis, low[axis], extent)];
            bin.0.add(&item.bounds);
            bin.1 += 1;
        }
        let mut behind = [0.0; BINS];
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for k in (1..BINS).rev() {
            bounds.add(&bins[k].0);
            count += bins[k].1;
            behind[k] = bounds.half_area() * count as f64;
        }
        let (mut bounds, mut count) = (Bounds::EMPTY, 0);
        for k in 1..BINS {
            bounds.add(&bins[k - 1].0);
            count += bins[k - 1].1;
            let cost = bounds.half_area() * count as f64 + behind[k];
            if count > 0 && count < items.len() && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, k));
            }
        }
    }
    let (_, axis, bin) = best?;
    let extent = high[axis] - low[axis];
    let mut at = 0;
    for i in 0..items.len() {
        if bin_of(&items[i], axis, low[axis], extent) < bin {
            items.swap(i, at);
            at += 1;
        }
    }
    Some(at)
}

fn bin_of(item: &Item, axis: usize, low: f64, extent: f64) -> usize {
    (((item.middle[axis] - low) / extent * BINS as f64) as usize).min(BINS - 1)
}
