//! Mesh files of all kinds, written here.

use std::path::{Path, PathBuf};

use super::meshes::{block, icosphere, surface, Soup};
use crate::load::load_mesh;
use crate::Error;

/// A file that is removed in the end.
struct File(PathBuf);

impl File {
    fn new(name: &str, content: &[u8]) -> Self {
        let path = std::env::temp_dir().join(format!("contactsense-{}-{name}", std::process::id()));
        std::fs::write(&path, content).unwrap();
        File(path)
    }

    fn load(&self) -> crate::Result<Soup> {
        load_mesh(&self.0, [1.0; 3])
    }
}

impl Drop for File {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn binary_stl((vertices, triangles): &Soup, header: &str) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for t in triangles {
        bytes.extend([0; 12]);
        for x in t.iter().flat_map(|&v| vertices[v as usize]) {
            bytes.extend((x as f32).to_le_bytes());
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn ascii_stl((vertices, triangles): &Soup) -> String {
    let mut text = "solid block\n".to_string();
    for t in triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for &v in t {
            let [x, y, z] = vertices[v as usize];
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid block\n"
}

fn obj((vertices, _): &Soup) -> String {
    let mut text: String = vertices.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
    for quad in [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]] {
        text += &format!("f {}\n", quad.map(|v: i32| (v + 1).to_string()).join(" "));
    }
    text
}

fn collada((vertices, _): &Soup, unit: &str, nodes: &str) -> String {
    let numbers = vertices.iter().flatten().map(f64::to_string).collect::<Vec<_>>().join(" ");
    let quads = "0 4 6 2 1 3 7 5 0 1 5 4 2 6 7 3 0 2 3 1 4 5 7 6";
    format!(
        r##"<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
        <asset>{unit}<up_axis>Y_UP</up_axis></asset>
        <library_geometries><geometry id="g"><mesh>
          <source id="s"><float_array id="a" count="24">{numbers}</float_array><technique_common>
            <accessor source="#a" count="8" stride="3"/></technique_common></source>
          <vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
          <polylist count="6"><input semantic="VERTEX" source="#v" offset="0"/>
            <vcount>4 4 4 4 4 4</vcount><p>{quads}</p></polylist>
        </mesh></geometry></library_geometries>
        <library_visual_scenes><visual_scene id="scene">{nodes}</visual_scene></library_visual_scenes>
        <scene><instance_visual_scene url="#scene"/></scene></COLLADA>"##
    )
}

fn corners((vertices, triangles): &Soup) -> [[f64; 3]; 2] {
    let used = || triangles.iter().flatten().map(|&v| vertices[v as usize]);
    let fold =
        |f: fn(f64, f64) -> f64, start: f64| used().fold([start; 3], |a, v| [0, 1, 2].map(|k| f(a[k], v[k])));
    [fold(f64::min, f64::INFINITY), fold(f64::max, f64::NEG_INFINITY)]
}

fn near(a: [[f64; 3]; 2], b: [[f64; 3]; 2]) -> bool {
    a.iter().flatten().zip(b.iter().flatten()).all(|(a, b)| (a - b).abs() < 1e-6)
}

const LOW: [f64; 3] = [-0.5, 0.25, 1.0];
const HIGH: [f64; 3] = [0.5, 0.75, 3.0];

#[test]
fn all_kinds_give_the_same_block() {
    let mesh = block(LOW, HIGH);
    let files = [
        File::new("binary.stl", &binary_stl(&mesh, "made for a test")),
        File::new("solid.STL", &binary_stl(&mesh, "solid made for a test")),
        File::new("ascii.stl", ascii_stl(&mesh).as_bytes()),
        File::new("block.obj", obj(&mesh).as_bytes()),
        File::new(
            "block.dae",
            collada(&mesh, "", r##"<node><instance_geometry url="#g"/></node>"##).as_bytes(),
        ),
    ];
    for file in files {
        let loaded = file.load().unwrap();
        assert_eq!((loaded.0.len(), loaded.1.len()), (8, 12), "{:?}", file.0);
        assert!(near(corners(&loaded), [LOW, HIGH]));
        let (surface, remarks) = surface(&loaded);
        assert!(surface.watertight() && remarks.is_empty(), "{:?} {remarks:?}", file.0);
    }
}

#[test]
fn mirrors_keep_normals_outward() {
    let file = File::new("mirror.stl", &binary_stl(&icosphere(1, 0.5), ""));
    for scale in [[1.0, -1.0, 1.0], [-2.0, -2.0, -2.0], [-1.0, -1.0, 3.0]] {
        let (surface, remarks) = surface(&load_mesh(&file.0, scale).unwrap());
        assert!(remarks.is_empty() && surface.watertight(), "{scale:?} {remarks:?}");
    }
}

#[test]
fn collada_transforms_units_and_instances() {
    let mesh = block(LOW, HIGH);
    let cases = [
        ("small move", "<node><translate>0.003 0 0</translate>*</node>", [[-0.497, 0.25, 1.0], [0.503, 0.75, 3.0]]),
        (
            "nested, outer first",
            "<node><rotate>0 0 1 90</rotate><node><translate>1 0 0</translate><scale>2 1 1</scale>*</node></node>",
            [[-0.75, 0.0, 1.0], [-0.25, 2.0, 3.0]],
        ),
        ("twice", "<node>*</node><node><translate>10 0 0</translate>*</node>", [LOW, [10.5, 0.75, 3.0]]),
        (
            "mirrored",
            "<node><matrix>-1 0 0 4 0 1 0 0 0 0 1 0 0 0 0 1</matrix>*</node>",
            [[3.5, 0.25, 1.0], [4.5, 0.75, 3.0]],
        ),
    ];
    for (name, nodes, expected) in cases {
        let nodes = nodes.replace('*', r##"<instance_geometry url="#g"/>"##);
        for (unit, size) in [("", 1.0), (r#"<unit meter="0.001" name="millimeter"/>"#, 0.001)] {
            let file = File::new(
                &format!("{}-{size}.dae", name.replace(' ', "_")),
                collada(&mesh, unit, &nodes).as_bytes(),
            );
            let loaded = file.load().unwrap();
            let scaled = corners(&loaded).map(|corner| corner.map(|x| x / size));
            assert!(near(scaled, expected), "{name}: {scaled:?}");
            assert!(surface(&loaded).1.is_empty(), "{name}");
        }
    }
}

#[test]
fn bad_files_are_named() {
    let mesh = block(LOW, HIGH);
    let stl = binary_stl(&mesh, "");
    let dae = collada(&mesh, "", r##"<node><instance_geometry url="#g"/></node>"##);
    let text = ascii_stl(&mesh);
    let files = [
        File::new("short.stl", &stl[..stl.len() - 60]),
        File::new("shorter.stl", &stl[..40]),
        File::new("empty.stl", b""),
        File::new("text.stl", &text.as_bytes()[..text.len() / 2]),
        File::new("cut.dae", &dae.as_bytes()[..dae.len() / 2]),
        File::new("index.dae", dae.replace("4 5 7 6<", "4 5 7 99<").as_bytes()),
        File::new("node.dae", dae.replace("#g", "#h").as_bytes()),
        File::new("number.dae", dae.replace("0.25", "a").as_bytes()),
        File::new("index.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n"),
        File::new("none.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"),
        File::new("noise.obj", &stl),
        File::new("nan.stl", text.replace("0.25", "nan").as_bytes()),
        File::new("block.ply", &stl),
    ];
    for file in files {
        match file.load() {
            Err(Error::Geometry { problem: message, .. }) => {
                assert!(message.contains(file.0.to_str().unwrap()), "{message}");
                assert!(message.contains(".stl, .obj, .dae"), "{message}");
            }
            other => panic!("{:?}: {other:?}", file.0),
        }
    }
    assert!(load_mesh(Path::new("nowhere.stl"), [1.0; 3]).is_err());
    let good = File::new("good.stl", &stl);
    for scale in [[0.0, 1.0, 1.0], [1.0, f64::NAN, 1.0]] {
        assert!(load_mesh(&good.0, scale).is_err());
    }
}
