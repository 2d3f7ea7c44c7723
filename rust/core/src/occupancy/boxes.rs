//! Voxels merged to boxes.

use std::collections::BTreeSet;

use super::voxel::Voxel;

/// An axis-aligned box of voxels.
///
/// ```
/// use std::sync::Arc;
///
/// use contactsense::occupancy::{ContactMemory, MemoryOptions};
/// use contactsense::robot::Robot;
///
/// let mut memory = ContactMemory::new(Arc::new(Robot::example_arm()), MemoryOptions::default())?;
/// memory.add_free(&[0.4; 7])?;
/// let free = memory.boxes(0.0, 0.4);
/// assert!(!free.is_empty() && (0..3).all(|axis| free[0].lower[axis] < free[0].upper[axis]));
/// # Ok::<(), contactsense::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VoxelBox {
    /// Corner with the least coordinates, world frame (m).
    pub lower: [f64; 3],
    /// Corner with the greatest.
    pub upper: [f64; 3],
}

/// Boxes that hold exactly these voxels, each one once: each box begins at the first voxel that is left, and grows along z, then
/// y, then x as far as all voxels are there.
pub(super) fn boxes(voxels: impl Iterator<Item = Voxel>, resolution: f64) -> Vec<VoxelBox> {
    let mut left: BTreeSet<[i32; 3]> = voxels.map(|Voxel(index)| index).collect();
    let mut found = vec![];
    while let Some(&first) = left.first() {
        let mut last = first;
        for axis in [2, 1, 0] {
            loop {
                let mut next = last;
                next[axis] += 1;
                let mut low = first;
                low[axis] = next[axis];
                if !cells(low, next).all(|cell| left.contains(&cell)) {
                    break;
                }
                last = next;
            }
        }
        cells(first, last).for_each(|cell| {
            left.remove(&cell);
        });
        found.push(VoxelBox {
            lower: first.map(|index| f64::from(index) * resolution),
            upper: last.map(|index| (f64::from(index) + 1.0) * resolution),
        });
    }
    found
}

/// All cells from one corner to the other, both included.
fn cells(low: [i32; 3], high: [i32; 3]) -> impl Iterator<Item = [i32; 3]> {
    (low[0]..=high[0])
        .flat_map(move |x| (low[1]..=high[1]).flat_map(move |y| (low[2]..=high[2]).map(move |z| [x, y, z])))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_is_one_box_and_an_l_is_two() {
        let block = cells([0, 0, 0], [2, 1, 3]).map(Voxel);
        let merged = boxes(block, 0.5);
        assert_eq!(merged, [VoxelBox { lower: [0.0; 3], upper: [1.5, 1.0, 2.0] }]);
        let corner = cells([0, 0, 0], [3, 0, 0]).chain(cells([0, 1, 0], [0, 3, 0])).map(Voxel);
        let merged = boxes(corner, 1.0);
        let volume = |b: &VoxelBox| (0..3).map(|k| b.upper[k] - b.lower[k]).product::<f64>();
        assert_eq!((merged.len(), merged.iter().map(volume).sum::<f64>()), (2, 7.0));
    }
}
