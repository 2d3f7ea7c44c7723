//! Edges of a mesh, what they connect, and which triangles are there twice.

use std::collections::HashMap;

/// One use of an edge: the triangle, and whether it runs from the smaller vertex to the larger.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Use {
    pub triangle: u32,
    pub forward: bool,
}

/// All uses of all edges, those of an edge together.
pub(crate) struct Edges {
    uses: Vec<([u32; 2], Use)>,
}

impl Edges {
    pub fn new(triangles: &[[u32; 3]]) -> Self {
        let mut uses: Vec<([u32; 2], Use)> = triangles
            .iter()
            .enumerate()
            .flat_map(|(i, &[a, b, c])| {
                [[a, b], [b, c], [c, a]].map(|[from, to]| {
                    let edge = Use { triangle: i as u32, forward: from < to };
                    ([from.min(to), from.max(to)], edge)
                })
            })
            .collect();
        uses.sort_unstable_by_key(|&(edge, Use { triangle, .. })| (edge, triangle));
        Edges { uses }
    }

    /// The uses of each edge.
    pub fn iter(&self) -> impl Iterator<Item = &[([u32; 2], Use)]> {
        self.uses.chunk_by(|a, b| a.0 == b.0)
    }
}

/// The component of each triangle, and how many there are. Triangles on an edge are connected if `joins` says so of
/// the number of triangles there.
pub(crate) fn components(count: usize, edges: &Edges, joins: impl Fn(usize) -> bool) -> (Vec<u32>, usize) {
    let mut parent: Vec<u32> = (0..count as u32).collect();
    for uses in edges.iter().filter(|uses| joins(uses.len())) {
        for pair in uses.windows(2) {
            let (a, b) = (root(&mut parent, pair[0].1.triangle), root(&mut parent, pair[1].1.triangle));
            parent[a.max(b) as usize] = a.min(b);
        }
    }
    let mut label = HashMap::new();
    let labels = (0..count as u32)
        .map(|i| {
            let next = label.len() as u32;
            *label.entry(root(&mut parent, i)).or_insert(next)
        })
        .collect();
    (labels, label.len())
}

fn root(parent: &mut [u32], mut i: u32) -> u32 {
    while parent[i as usize] != i {
        parent[i as usize] = parent[parent[i as usize] as usize];
        i = parent[i as usize];
    }
    i
}

/// Removes triangles with the same three vertices and returns how many went.
///
/// One of each group stays, except for two that face opposite ways and wall off the inside of a mesh that is closed
/// without them: both go. A mesh given with both sides of every triangle keeps one side.
pub(crate) fn remove_duplicates(triangles: &mut Vec<[u32; 3]>) -> usize {
    let before = triangles.len();
    let mut groups: HashMap<[u32; 3], Vec<u32>> = HashMap::with_capacity(before);
    for (i, &t) in triangles.iter().enumerate() {
        let mut sorted = t;
        sorted.sort_unstable();
        groups.entry(sorted).or_default().push(i as u32);
    }
    if groups.len() == before {
        return 0;
    }
    let mut keep = vec![true; before];
    let mut twin = vec![false; before];
    for group in groups.values().filter(|group| group.len() > 1) {
        group[1..].iter().for_each(|&i| keep[i as usize] = false);
        let first = triangles[group[0] as usize];
        let opposite = group.iter().filter(|&&i| !same_winding(first, triangles[i as usize])).count();
        twin[group[0] as usize] = 2 * opposite == group.len();
    }
    let mut kept: Vec<[u32; 3]> = Vec::with_capacity(groups.len());
    let mut is_twin = Vec::with_capacity(groups.len());
    for i in (0..before).filter(|&i| keep[i]) {
        kept.push(triangles[i]);
        is_twin.push(twin[i]);
    }
    if is_twin.contains(&true) {
        let edges = Edges::new(&kept);
        let (label, count) = components(kept.len(), &edges, |_| true);
        // Walls: the component has other triangles, and those close without the twins.
        let mut walls = vec![false; count];
        for i in (0..kept.len()).filter(|&i| !is_twin[i]) {
            walls[label[i] as usize] = true;
        }
        for uses in edges.iter() {
            let single = uses.iter().filter(|(_, edge)| !is_twin[edge.triangle as usize]).count();
            if single % 2 == 1 {
                walls[label[uses[0].1.triangle as usize] as usize] = false;
            }
        }
        let mut i = 0;
        kept.retain(|_| {
            i += 1;
            !(is_twin[i - 1] && walls[label[i - 1] as usize])
        });
    }
    *triangles = kept;
    before - triangles.len()
}

fn same_winding([a, b, c]: [u32; 3], other: [u32; 3]) -> bool {
    other == [a, b, c] || other == [b, c, a] || other == [c, a, b]
}
