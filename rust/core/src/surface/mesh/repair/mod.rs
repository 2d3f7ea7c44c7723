//! Repair of meshes as found in the wild.

pub(crate) mod components;
mod nesting;
mod slivers;
pub(crate) mod weld;
mod winding;

use nalgebra::Vector3;

use crate::{Error, Result};

/// Vertices nearer than this share of the mesh's size are one.
const SAME: f64 = 1e-9;

pub(crate) struct Repaired {
    pub vertices: Vec<Vector3<f64>>,
    pub triangles: Vec<[u32; 3]>,
    pub closed: bool,
}

/// Merges vertices, removes degenerate and duplicate triangles, and turns windings outward; says what was done.
pub(crate) fn repair(
    vertices: Vec<Vector3<f64>>,
    mut triangles: Vec<[u32; 3]>,
    remarks: &mut Vec<String>,
) -> Result<Repaired> {
    let mut used = vec![false; vertices.len()];
    triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let referenced = || vertices.iter().zip(&used).filter(|(_, used)| **used).map(|(v, _)| v);
    let low = referenced().fold(Vector3::repeat(f64::INFINITY), |a, v| a.inf(v));
    let high = referenced().fold(Vector3::repeat(f64::NEG_INFINITY), |a, v| a.sup(v));
    let tolerance = SAME * (high - low).norm();

    let loose = used.iter().filter(|used| !**used).count();
    say(remarks, loose, "vertex in no triangle dropped", "vertices in no triangle dropped");
    let (vertices, index) = weld::weld(&compact(vertices, &used, &mut triangles), tolerance);
    triangles.iter_mut().for_each(|t| *t = t.map(|v| index[v as usize]));
    let merged = index.len() - vertices.len();
    say(remarks, merged, "duplicate vertex merged", "duplicate vertices merged");

    let flat = slivers::remove(&vertices, &mut triangles, tolerance);
    say(remarks, flat, "degenerate triangle removed", "degenerate triangles removed");
    let double = components::remove_duplicates(&mut triangles);
    say(remarks, double, "duplicate triangle removed", "duplicate triangles removed");
    if triangles.is_empty() {
        return Err(Error::geometry(
            "mesh: nothing is left once degenerate and duplicate triangles are removed",
        ));
    }

    let outcome = winding::orient(&vertices, &mut triangles);
    say(
        remarks,
        outcome.turned,
        "triangle turned to agree with its neighbours",
        "triangles turned to agree with their neighbours",
    );
    say(
        remarks,
        outcome.flipped,
        "component had inward normals: turned outward",
        "components had inward normals: turned outward",
    );
    say(
        remarks,
        outcome.one_sided,
        "edge where no winding agrees: one-sided",
        "edges where no winding agrees: one-sided",
    );
    say(
        remarks,
        outcome.unchecked,
        "component not compared with all others: it may be a cavity",
        "components not compared with all others: they may be cavities",
    );
    let closed = winding::balanced(&triangles);
    if !closed {
        remarks.push("the mesh is open: a line can go in without coming out".into());
    }
    let mut used = vec![false; vertices.len()];
    triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let vertices = compact(vertices, &used, &mut triangles);
    Ok(Repaired { vertices, triangles, closed })
}

fn say(remarks: &mut Vec<String>, count: usize, one: &str, many: &str) {
    if count > 0 {
        remarks.push(format!("{count} {}", if count == 1 { one } else { many }));
    }
}

/// Drops unused vertices and renumbers the triangles.
fn compact(vertices: Vec<Vector3<f64>>, used: &[bool], triangles: &mut [[u32; 3]]) -> Vec<Vector3<f64>> {
    let mut next = 0;
    let index: Vec<u32> = used
        .iter()
        .map(|&used| {
            let own = next;
            next += u32::from(used);
            own
        })
        .collect();
    triangles.iter_mut().for_each(|t| *t = t.map(|v| index[v as usize]));
    vertices.into_iter().zip(used).filter(|(_, used)| **used).map(|(v, _)| v).collect()
}
