//! Whole files, to be damaged.

pub const OBJ: &str = "# a block\nmtllib none.mtl\no block\nv 0 0 0\nv 0 0 1\nv 0 1 0\nv 0 1 1\nv 1 0 0\nv 1 0 1\nv 1 1 0\n\
    v 1 1 1\nvn 0 0 1\nvt 0 0\nusemtl m\nf 1/1/1 5//1 7 3\nf 2 4 8 6\nf 1 2 6 5\nf -6 -2 -1 -5\ng h\nf 1 3 4 2\n\
    f 5 6 8 \\\n 7\nl 1 2 3\n";

pub const COLLADA: &str = r##"<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="0.5"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="24">0 0 0 0 0 1 0 1 0 0 1 1 1 0 0 1 0 1 1 1 0 1 1 1</float_array>
<technique_common><accessor source="#a" count="8" stride="3" offset="0"/></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<polylist count="4"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#s" offset="1"/>
<vcount>4 4 3 3</vcount><p>0 0 4 0 6 0 2 0 1 0 3 0 7 0 5 0 0 1 1 1 5 1 0 1 5 1 4 1</p></polylist>
<triangles count="2"><input semantic="VERTEX" source="#v" offset="0"/><p>2 6 7 2 7 3</p></triangles>
<polygons><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 3 1</p></polygons>
<tristrips><input semantic="VERTEX" source="#v" offset="0"/><p>4 5 6 7</p></tristrips>
<trifans><input semantic="VERTEX" source="#v" offset="0"/><p>4 5 7 6</p></trifans>
</mesh></geometry></library_geometries>
<library_nodes><node id="n0"><translate>1 2 3</translate><rotate>0 0 1 90</rotate><instance_node url="#n1"/>
<instance_node url="#n1"/></node><node id="n1"><scale>1 1 -1</scale><instance_geometry url="#g"/></node></library_nodes>
<library_visual_scenes><visual_scene id="scene"><node><matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1</matrix>
<instance_node url="#n0"/></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#scene"/></scene></COLLADA>"##;

pub fn ascii_stl() -> String {
    let facet = |[a, b, c]: [&str; 3]| {
        format!(" facet normal 0 0 1\n  outer loop\n   vertex {a}\n   vertex {b}\n   vertex {c}\n  endloop\n endfacet\n")
    };
    let [o, x, y, z] = ["0 0 0", "1 0 0", "0 1e0 0", "0 0 1.5"];
    let facets: String = [[o, y, x], [o, x, z], [o, z, y], [x, y, z]].map(facet).concat();
    format!("solid a\n{facets}endsolid a\n")
}

pub fn binary_stl() -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    bytes.extend(4u32.to_le_bytes());
    let [o, x, y, z] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5f32]];
    for triangle in [[o, y, x], [o, x, z], [o, z, y], [x, y, z]] {
        bytes.extend([0; 12]);
        bytes.extend(triangle.as_flattened().iter().flat_map(|x| x.to_le_bytes()));
        bytes.extend([0; 2]);
    }
    bytes
}

pub const URDF: &str = r#"<?xml version="1.0"?><robot name="r"><link name="a"><collision><geometry><box size="1 1 1"/></geometry>
        </collision></link><link name="b"><inertial><origin xyz="0 0 1" rpy="0 1 0"/><mass value="2"/>
        <inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial><collision><origin xyz="0 0 1"/><geometry>
        <cylinder radius="0.1" length="1"/></geometry></collision></link><link name="c"><inertial><mass value="1"/>
        <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial><collision><geometry>
        <mesh filename="none.stl" scale="1 1 1"/></geometry></collision></link>
        <joint name="j" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/><origin xyz="0 0 1"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
        <joint name="k" type="prismatic"><parent link="b"/><child link="c"/><axis xyz="0 1 0"/>
        <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="j"/></joint></robot>"#;

/// The same, without the mesh that is missing.
pub fn whole_urdf() -> String {
    URDF.replace(r#"<mesh filename="none.stl" scale="1 1 1"/>"#, r#"<sphere radius="0.2"/>"#)
}

/// What parsers and arithmetic stumble over.
pub const WORDS: [&str; 28] = [
    "0",
    "-1",
    "1",
    "1e308",
    "-1e-320",
    "nan",
    "inf",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "9223372036854775807",
    "-9223372036854775808",
    "1000000",
    "\n",
    " ",
    "\\\n",
    "\"",
    "<",
    "/>",
    "&#0;",
    "\0",
    "#n0",
    "offset=\"99\"",
    "é",
    "- ",
    ": ",
    "[[",
    "&a *a",
];
