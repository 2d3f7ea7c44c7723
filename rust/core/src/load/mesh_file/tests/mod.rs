//! Tests of the parsers: polygons, and files made to do harm.

mod hostile;
mod polygons;

use super::soup::Soup;

fn area(soup: &Soup) -> f64 {
    let corners = soup.triangles.iter().map(|t| t.map(|v| soup.vertices[v as usize]));
    corners.map(|[a, b, c]| 0.5 * (b - a).cross(&(c - a)).norm()).sum()
}

/// A COLLADA document; `nodes` stand in its scene and in its library of nodes, and `geometry` has the id `g`.
fn collada(primitives: &str, library: &str, nodes: &str) -> String {
    format!(
        r##"<COLLADA><library_geometries><geometry id="g"><mesh>
        <source id="s"><float_array id="a">{CONCAVE}</float_array>
        <technique_common><accessor source="#a" stride="3"/></technique_common></source>
        <vertices id="v"><input semantic="POSITION" source="#s"/></vertices>{primitives}
        </mesh></geometry></library_geometries><library_nodes>{library}</library_nodes>
        <library_visual_scenes><visual_scene id="scene">{nodes}</visual_scene></library_visual_scenes>
        <scene><instance_visual_scene url="#scene"/></scene></COLLADA>"##
    )
}

const INSTANCE: &str = r##"<node><instance_geometry url="#g"/></node>"##;
/// A square of 2 m with a notch from one side to near the opposite one: 2.2 m^2.
const CONCAVE: &str = "0 0 0 2 0 0 2 2 0 1 0.2 0 0 2 0";
const CONCAVE_AREA: f64 = 2.2;
