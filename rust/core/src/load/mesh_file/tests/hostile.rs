//! Files made to crash a parser, or to keep it busy for ever.

use super::{area, collada as document, CONCAVE_AREA, INSTANCE};
use crate::load::mesh_file::{collada, obj, stl};

const TRIANGLE: &str =
    r##"<triangles><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>"##;

/// Nodes that each hold the next one twice, `levels` deep, around `leaf`.
fn doubled(levels: usize, leaf: &str) -> String {
    let nodes = (0..levels).map(|i| {
        let next = format!(r##"<instance_node url="#n{}"/>"##, i + 1);
        format!(r##"<node id="n{i}">{next}{next}</node>"##)
    });
    nodes.chain([format!(r##"<node id="n{levels}">{leaf}</node>"##)]).collect()
}

fn refused(text: &str, why: &str) {
    let error = collada::parse(text).unwrap_err();
    assert!(error.text.contains(why), "{error}");
}

#[test]
fn nodes_that_double_are_bounded() {
    let start = r##"<node><instance_node url="#n0"/></node>"##;
    let few = collada::parse(&document(TRIANGLE, &doubled(3, INSTANCE), start)).unwrap();
    assert_eq!(few.triangles.len(), 8);
    refused(&document(&TRIANGLE.repeat(1000), &doubled(13, INSTANCE), start), "triangles; simplify");
    // Two to the power of these levels of one triangle, of nothing, and of a transform.
    refused(&document(TRIANGLE, &doubled(26, INSTANCE), start), "too many times");
    refused(&document(TRIANGLE, &doubled(60, ""), start), "too many times");
    refused(&document(TRIANGLE, &doubled(60, "<scale>1 1 1</scale>"), start), "too many times");
    let shared = r##"<node id="n0"><instance_node url="#n0"/></node>"##;
    refused(&document(TRIANGLE, shared, start), "contain themselves");
}

#[test]
fn positions_are_read_once_for_many_primitives() {
    let soup = collada::parse(&document(&TRIANGLE.repeat(1000), "", INSTANCE)).unwrap();
    assert_eq!((soup.vertices.len(), soup.triangles.len()), (5, 1000));
}

#[test]
fn numbers_of_collada_are_checked() {
    let good = document(TRIANGLE, "", INSTANCE);
    collada::parse(&good).unwrap();
    let accessor = r##"source="#a" stride="3""##;
    let largest = u64::MAX.to_string();
    for number in [&largest, "4294967295", "-1", "1e3", "", "1025"] {
        refused(&good.replace(r#"offset="0""#, &format!(r#"offset="{number}""#)), "offset");
        refused(&good.replace("0 1 2</p>", &format!("0 1 {number}x</p>")), "no number");
    }
    refused(&good.replace("0 1 2</p>", "0 1 4294967295</p>"), "out of range");
    for attribute in ["count", "offset", "stride"] {
        let text = good.replace(accessor, &format!(r##"source="#a" {attribute}="{largest}""##));
        let _ = collada::parse(&text); // an error, or nothing left: no panic
    }
    let polylist = r##"<polylist><input semantic="VERTEX" source="#v" offset="0"/><vcount>5</vcount><p>0 1 2 3 4</p></polylist>"##;
    let good = document(polylist, "", INSTANCE);
    assert!((area(&collada::parse(&good).unwrap()) - CONCAVE_AREA).abs() < 1e-12);
    refused(&good.replace("<vcount>5", &format!("<vcount>{largest}")), "cut short");
    refused(&good.replace("<vcount>5", "<vcount>4 2"), "cut short");
}

#[test]
fn counts_of_stl_are_checked() {
    let mut bytes = vec![0; 84];
    bytes.extend([0; 50]);
    for (count, fits) in [(0, true), (1, true), (2, false), (u32::MAX, false)] {
        bytes[80..84].copy_from_slice(&count.to_le_bytes());
        assert_eq!(stl::parse(&bytes).is_ok(), fits, "{count}");
    }
    let facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    let good = format!("solid\n{facet}endsolid\n  solid two\n{facet}endsolid two\n");
    assert_eq!(stl::parse(good.as_bytes()).unwrap().triangles.len(), 2);
    for (from, to) in [
        ("vertex 1 0 0\n", ""),
        ("vertex 1 0 0", "vertex 1 0 0\nvertex 1 0 0"),
        ("vertex 1 0 0", "vertex 1 0"),
        ("vertex 1 0 0", "vertex 1 0 0 0"),
        ("1 0 0", "1e60 0 0"),
        ("endsolid two", ""),
    ] {
        assert!(stl::parse(good.replace(from, to).as_bytes()).is_err(), "{from:?} {to:?}");
    }
}

#[test]
fn numbers_of_obj_are_checked() {
    let good = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(obj::parse(good).unwrap().triangles, [[0, 1, 2]]);
    for index in
        ["0", "4", "-4", "9223372036854775807", "-9223372036854775808", "99999999999999999999", "x", "/1"]
    {
        assert!(obj::parse(&good.replace("f 1", &format!("f {index}"))).is_err(), "{index}");
    }
    for vertex in ["v 1 0", "v 1 0 x", "v nan 0 0", "v 1e400 0 0", "v 1 0 0 0"] {
        assert!(obj::parse(&good.replace("v 1 0 0", vertex)).is_err(), "{vertex}");
    }
    assert!(obj::parse("f\nf 1\nv 0 0 0\nf 1 1\n\\\n").unwrap().triangles.is_empty());
}

/// A face of `n` corners on a circle, every other one drawn in by `depth`.
fn large_face(n: usize, depth: f64) -> String {
    let corner = |i: usize| {
        let (sin, cos) = (std::f64::consts::TAU * i as f64 / n as f64).sin_cos();
        let radius = 1.0 - depth * (i % 2) as f64;
        format!("v {} {} 0\n", radius * cos, radius * sin)
    };
    let vertices: String = (0..n).map(corner).collect();
    vertices + "f" + &(1..=n).map(|i| format!(" {i}")).collect::<String>()
}

#[test]
fn faces_of_a_million_corners_end() {
    let disc = obj::parse(&large_face(1_000_000, 0.0)).unwrap();
    assert!((area(&disc) - std::f64::consts::PI).abs() < 1e-6);
    let star = obj::parse(&large_face(2_000, 0.5)).unwrap();
    assert_eq!(star.triangles.len(), 1998);
    assert!(obj::parse(&large_face(1_000_000, 0.5)).unwrap_err().contains("concave face of 1000000"));
}
