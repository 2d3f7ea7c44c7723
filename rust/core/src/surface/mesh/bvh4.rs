//! A bounding volume tree over triangles: four boxes a node, single precision, rounded outward.
//!
//! parry's binary tree, collapsed. Boxes only cull; they are enlarged by more than any rounding in the queries, so no
//! triangle is ever lost. The coordinates are relative to the mesh's centre.

use std::ops::Range;

use nalgebra::Vector3;
use parry3d_f64::bounding_volume::{Aabb, BoundingVolume};

use super::bvh;
use super::bvh::Branch;

/// Most entries a depth-first search ever holds: three a level, and one.
pub(crate) const STACK: usize = 3 * MAX_DEPTH + 1;
pub(crate) const MAX_DEPTH: usize = HALVING_DEPTH + 13;
/// From this depth on leaves are halved by count, which takes at most 13 levels: 4 * 4^13 is `Child::MAX_TRIANGLES`.
const HALVING_DEPTH: usize = 18;
const MAX_LEAF: usize = 4;
/// Enlargement of boxes relative to the mesh's radius: well above single-precision rounding.
const MARGIN: f64 = 2e-6;

/// Where unused boxes are, as points: finite, so that no arithmetic on them is undefined.
const NOWHERE: f32 = 1e30;

/// Four boxes side by side.
#[derive(Debug, Clone)]
pub(crate) struct Node {
    pub low: [[f32; 4]; 3],
    pub high: [[f32; 4]; 3],
    pub child: [Child; 4],
}

/// A node's index, or a run of triangles: bit 31 set, count in bits 28..31, first in the rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Child(pub u32);

impl Child {
    const LEAF: u32 = 1 << 31;
    /// Most triangles that a run's first index can address.
    pub const MAX_TRIANGLES: usize = 1 << 28;

    fn leaf(first: usize, count: usize) -> Self {
        Child(Self::LEAF | (count as u32) << 28 | first as u32)
    }

    /// The run of triangles, if it is one.
    #[inline]
    pub fn triangles(self) -> Option<Range<usize>> {
        (self.0 & Self::LEAF != 0).then(|| {
            let first = (self.0 & ((1 << 28) - 1)) as usize;
            first..first + (self.0 >> 28 & 7) as usize
        })
    }
}

#[derive(Debug, Clone)]
pub(crate) struct Tree {
    /// The root is first.
    pub nodes: Vec<Node>,
    pub center: Vector3<f64>,
    /// Of a sphere around the triangles.
    pub radius: f64,
}

/// Triangles that are next to each other in leaf order.
struct Group {
    bounds: Aabb,
    slots: Range<usize>,
    /// Where the binary tree parts them; nowhere once it went too deep.
    branch: Option<usize>,
}

/// What a tree is grown from: the binary tree, its leaf order, and the boxes that it is over.
struct Source<'a> {
    branches: &'a [Branch],
    order: &'a [u32],
    boxes: &'a [Aabb],
}

impl Tree {
    /// The tree, and the triangles' order in its leaves. There must be at least one triangle.
    pub fn new(corners: &[[Vector3<f64>; 3]]) -> (Tree, Vec<u32>) {
        let all = corners.iter().flatten();
        let low = all.clone().fold(Vector3::repeat(f64::INFINITY), |a, v| a.inf(v));
        let high = all.clone().fold(Vector3::repeat(f64::NEG_INFINITY), |a, v| a.sup(v));
        let center = (low + high) * 0.5;
        let radius = all.map(|v| (v - center).norm()).fold(0.0, f64::max);
        let margin = MARGIN * radius;
        // Adding and subtracting this rounds to 6e-8 of the radius, which bounds the depth of the binary tree.
        let coarse = radius * f64::from(1 << 28);
        let boxes: Vec<Aabb> = corners
            .iter()
            .map(|[a, b, c]| {
                let low = (a.inf(b).inf(c) - center).add_scalar(coarse - margin).add_scalar(-coarse);
                let high = (a.sup(b).sup(c) - center).add_scalar(coarse + margin).add_scalar(-coarse);
                Aabb::new(<[f64; 3]>::from(low).into(), <[f64; 3]>::from(high).into())
            })
            .collect();
        let (branches, order) = bvh::build(&boxes);
        let nodes = collapse(&branches, &order, &boxes);
        (Tree { nodes, center, radius }, order)
    }
}

/// The nodes over a binary tree with leaves in this order, of which there must be one: at most `MAX_DEPTH` levels,
/// however deep that tree is.
pub(crate) fn collapse(branches: &[Branch], order: &[u32], boxes: &[Aabb]) -> Vec<Node> {
    let root = Group { bounds: branches[0].bounds, slots: 0..order.len(), branch: Some(0) };
    let mut nodes = Vec::new();
    Source { branches, order, boxes }.grow(&mut nodes, root, 0);
    nodes
}

impl Source<'_> {
    /// Adds the node over `group` and all below it; returns its index.
    fn grow(&self, nodes: &mut Vec<Node>, group: Group, depth: usize) -> u32 {
        let index = nodes.len();
        nodes.push(Node { low: [[NOWHERE; 4]; 3], high: [[NOWHERE; 4]; 3], child: [Child::leaf(0, 0); 4] });
        for (lane, group) in self.quarter(group, depth).into_iter().enumerate() {
            let node = &mut nodes[index];
            for k in 0..3 {
                node.low[k][lane] = group.bounds.mins[k] as f32;
                node.high[k][lane] = group.bounds.maxs[k] as f32;
            }
            nodes[index].child[lane] = if group.slots.len() <= MAX_LEAF {
                Child::leaf(group.slots.start, group.slots.len())
            } else {
                Child(self.grow(nodes, group, depth + 1))
            };
        }
        index as u32
    }

    /// Up to four groups, by splitting again and again the one of largest area, or when halving of most triangles.
    fn quarter(&self, mut group: Group, depth: usize) -> Vec<Group> {
        let halving = depth >= HALVING_DEPTH;
        if halving {
            group.branch = None;
        }
        let mut groups = vec![group];
        while groups.len() < 4 {
            let size = |i: usize| {
                let group = &groups[i];
                if halving {
                    group.slots.len() as f64
                } else {
                    group.bounds.half_area()
                }
            };
            let open = (0..groups.len()).filter(|&i| groups[i].slots.len() > MAX_LEAF);
            let Some(largest) = open.max_by(|&a, &b| size(a).total_cmp(&size(b))) else { break };
            let (left, right) = self.split(&groups[largest]);
            groups[largest] = left;
            groups.insert(largest + 1, right);
        }
        groups
    }

    fn split(&self, group: &Group) -> (Group, Group) {
        let Range { start, end } = group.slots;
        if let Some(branch) = group.branch {
            let child = self.branches[branch].child;
            let [left, right] = [&self.branches[child], &self.branches[child + 1]];
            let middle = start + left.count;
            (
                Group { bounds: left.bounds, slots: start..middle, branch: Some(child) },
                Group { bounds: right.bounds, slots: middle..end, branch: Some(child + 1) },
            )
        } else {
            let middle = start.midpoint(end);
            (self.run(start..middle), self.run(middle..end))
        }
    }

    fn run(&self, slots: Range<usize>) -> Group {
        let mut bounds = Aabb::new_invalid();
        self.order[slots.clone()].iter().for_each(|&id| bounds.merge(&self.boxes[id as usize]));
        Group { bounds, slots, branch: None }
    }
}
