//! parry's binary tree, with its topology laid open.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::partitioning::{Bvh, BvhBuildStrategy, TraversalAction};

/// A node over `count` leaves; its children are `child` and `child + 1`, or none if `child` is 0.
pub(crate) struct Branch {
    pub bounds: Aabb,
    pub child: usize,
    pub count: usize,
}

/// The nodes, the root first, and the boxes' indices in depth-first order: those of a left child come first.
///
/// There must be at least one box.
pub(crate) fn build(boxes: &[Aabb]) -> (Vec<Branch>, Vec<u32>) {
    // Its other strategy, Ploc, answers closest points a fifth slower and goes as deep as many equal boxes are.
    let bvh = Bvh::from_leaves(BvhBuildStrategy::Binned, boxes);
    let mut branches = vec![Branch { bounds: bvh.root_aabb(), child: 0, count: 0 }];
    // Nodes whose children are still to come, the next one last.
    let mut parents = vec![0];
    bvh.traverse(|node| {
        let index = branches.len();
        branches.push(Branch { bounds: node.aabb(), child: 0, count: usize::from(node.is_leaf()) });
        // Children come in pairs, the right one next after the left; then all below the left, then the right.
        if index % 2 == 1 {
            if let Some(parent) = parents.pop() {
                branches[parent].child = index;
            }
        } else {
            parents.extend([index, index - 1].into_iter().filter(|&i| branches[i].count == 0));
        }
        TraversalAction::Continue
    });
    // Children come after their parents. The root over a single leaf has no right child.
    for index in (0..branches.len()).rev() {
        let child = branches[index].child;
        if child > 0 {
            branches[index].count = branches[child..].iter().take(2).map(|branch| branch.count).sum();
        }
    }
    (branches, bvh.leaves(|_| true).collect())
}
