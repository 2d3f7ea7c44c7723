//! Winding made consistent and outward.

use nalgebra::Vector3;

use super::components::{components, Edges};
use super::nesting::{outermost, Shell};

/// Share of the volume of a sphere of the same area from which on an open mesh has an inside.
const CLEARLY_CURVED: f64 = 0.01;

/// What was done.
#[derive(Debug, Default)]
pub(crate) struct Outcome {
    /// Triangles turned to agree with their neighbours.
    pub turned: usize,
    /// Components turned inside out.
    pub flipped: usize,
    /// Edges across which no winding agrees, as on a Moebius strip.
    pub one_sided: usize,
    /// Closed components that may lie inside others, which would have taken too long to find out.
    pub unchecked: usize,
}

/// Makes each component's winding consistent, and outward if it has an inside.
pub(crate) fn orient(vertices: &[Vector3<f64>], triangles: &mut [[u32; 3]]) -> Outcome {
    let edges = Edges::new(triangles);
    let (label, count) = components(triangles.len(), &edges, |uses| uses == 2);
    let mut outcome = Outcome::default();
    agree(vertices, triangles, &edges, &label, count, &mut outcome);

    let mut members: Vec<Vec<u32>> = vec![Vec::new(); count];
    label.iter().enumerate().for_each(|(i, &l)| members[l as usize].push(i as u32));
    let closed = closed(triangles, &label, count);
    let volume: Vec<f64> = members.iter().map(|m| measure(vertices, triangles, m).0).collect();
    let shells: Vec<Shell> = (0..count)
        .filter(|&i| closed[i])
        .map(|i| Shell::new(vertices, triangles, &members[i], volume[i]))
        .collect();
    // An inward shell inside another is a cavity and stays. If the outermost shell around it is turned, it turns too.
    let (outermost, unchecked) = outermost(vertices, triangles, &shells);
    outcome.unchecked = unchecked;
    let turn: Vec<bool> = (0..shells.len()).map(|i| shells[outermost[i].unwrap_or(i)].volume < 0.0).collect();
    let mut flip = vec![false; triangles.len()];
    for (shell, _) in shells.iter().zip(&turn).filter(|(_, &turn)| turn) {
        outcome.flipped += 1;
        shell.members.iter().for_each(|&i| flip[i as usize] = true);
    }
    // Open components are patches of one skin: a concave one is not wrong by itself, so they turn together.
    let open: Vec<u32> =
        (0..count).filter(|&i| !closed[i]).flat_map(|i| members[i].iter().copied()).collect();
    let (open_volume, open_area) = measure(vertices, triangles, &open);
    let sphere = open_area.powf(1.5) / (6.0 * std::f64::consts::PI.sqrt());
    if open_volume < -CLEARLY_CURVED * sphere {
        outcome.flipped += closed.iter().filter(|&&closed| !closed).count();
        open.iter().for_each(|&i| flip[i as usize] = true);
    }
    triangles.iter_mut().zip(flip).filter(|(_, flip)| *flip).for_each(|(t, _)| t.swap(1, 2));
    outcome
}

/// Whether each edge is used as often in one direction as in the other.
pub(crate) fn balanced(triangles: &[[u32; 3]]) -> bool {
    closed(triangles, &vec![0; triangles.len()], 1)[0]
}

fn closed(triangles: &[[u32; 3]], label: &[u32], count: usize) -> Vec<bool> {
    let mut closed = vec![true; count];
    let mut balance: Vec<(u32, i32)> = Vec::new();
    for uses in Edges::new(triangles).iter() {
        balance.clear();
        balance.extend(
            uses.iter().map(|(_, edge)| (label[edge.triangle as usize], if edge.forward { 1 } else { -1 })),
        );
        balance.sort_unstable_by_key(|&(label, _)| label);
        for own in balance.chunk_by(|a, b| a.0 == b.0) {
            if own.iter().map(|&(_, step)| step).sum::<i32>() != 0 {
                closed[own[0].0 as usize] = false;
            }
        }
    }
    closed
}

/// Floods each component across its edges with two triangles; the larger area keeps its winding.
fn agree(
    vertices: &[Vector3<f64>],
    triangles: &mut [[u32; 3]],
    edges: &Edges,
    label: &[u32],
    count: usize,
    outcome: &mut Outcome,
) {
    let mut neighbours: Vec<[(u32, bool); 3]> = vec![[(u32::MAX, false); 3]; triangles.len()];
    let mut link = |from: u32, to: u32, opposed: bool| {
        if let Some(free) = neighbours[from as usize].iter_mut().find(|n| n.0 == u32::MAX) {
            *free = (to, opposed);
        }
    };
    for uses in edges.iter().filter(|uses| uses.len() == 2) {
        let (a, b) = (uses[0].1, uses[1].1);
        link(a.triangle, b.triangle, a.forward == b.forward);
        link(b.triangle, a.triangle, a.forward == b.forward);
    }
    let mut turn: Vec<Option<bool>> = vec![None; triangles.len()];
    let mut area = vec![[0.0; 2]; count];
    let mut queue = Vec::new();
    let mut contradictions = 0;
    for seed in 0..triangles.len() {
        if turn[seed].is_some() {
            continue;
        }
        turn[seed] = Some(false);
        queue.push(seed);
        while let Some(i) = queue.pop() {
            let own = turn[i] == Some(true);
            let [a, b, c] = triangles[i].map(|v| vertices[v as usize]);
            area[label[i] as usize][usize::from(own)] += (b - a).cross(&(c - a)).norm();
            for &(j, opposed) in neighbours[i].iter().filter(|n| n.0 != u32::MAX) {
                let wanted = own != opposed;
                match turn[j as usize] {
                    None => {
                        turn[j as usize] = Some(wanted);
                        queue.push(j as usize);
                    }
                    Some(turn) if turn != wanted => contradictions += 1,
                    Some(_) => {}
                }
            }
        }
    }
    outcome.one_sided = contradictions / 2;
    for (i, t) in triangles.iter_mut().enumerate() {
        let [kept, turned] = area[label[i] as usize];
        if (turn[i] == Some(true)) != (turned > kept) {
            t.swap(1, 2);
            outcome.turned += 1;
        }
    }
}

/// Signed volume about the members' middle [m^3], and area (m^2).
fn measure(vertices: &[Vector3<f64>], triangles: &[[u32; 3]], members: &[u32]) -> (f64, f64) {
    let corners = |&i: &u32| triangles[i as usize].map(|v| vertices[v as usize]);
    let mut area = 0.0;
    let mut middle = Vector3::zeros();
    for [a, b, c] in members.iter().map(corners) {
        let own = 0.5 * (b - a).cross(&(c - a)).norm();
        area += own;
        middle += (a + b + c) * (own / 3.0);
    }
    if area > 0.0 {
        middle /= area;
    }
    let volume = members
        .iter()
        .map(corners)
        .map(|[a, b, c]| (a - middle).dot(&(b - middle).cross(&(c - middle))) / 6.0)
        .sum();
    (volume, area)
}
