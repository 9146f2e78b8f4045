//! Scenes and meshes that are broken: the message begins with the place.

use crate::workplace::{text, warpath};
use std::path::Path;

const SENSOR: &str =
    r#"<sensor type="perspective" id="cam"><float name="fov" value="40"/></sensor>"#;

/// What stands on line 2 of a scene, and the message.
const SCENES: [(&str, &str); 15] = [
    (
        r#"<shape type="cube">"#,
        "s.xml:3:76: not well-formed XML: expected 'shape' tag",
    ),
    (
        r#"<shape type="spere"/>"#,
        r#"s.xml:2:1: <shape type="spere"> is not supported; the nearest known name is "sphere""#,
    ),
    (
        r#"<shape type="rectangle"><bsdf type="diffuse"><spectrum name="reflectance" value="400:0.1"/></bsdf></shape>"#,
        "s.xml:2:46: <spectrum>",
    ),
    (
        r#"<shape type="rectangle"><bsdf type="diffuse"><rgb name="reflectance" value="0.1, red, 0.2"/></bsdf></shape>"#,
        r#"s.xml:2:46: <rgb>: "red" is not a number"#,
    ),
    (
        r#"<shape type="rectangle"><bsdf type="diffuse"><rgb name="reflectance" value="0.1, 1.5, 0.2"/></bsdf></shape>"#,
        r#"s.xml:2:46: "reflectance" must be between 0 and 1"#,
    ),
    (
        r#"<medium type="homogeneous"/>"#,
        r#"s.xml:2:1: <medium type="homogeneous"> is not supported"#,
    ),
    (
        r#"<shape type="rectangle"><ref id="nothing"/></shape>"#,
        r#"s.xml:2:25: no object has the id "nothing""#,
    ),
    (
        r#"<integrator type="path"><integer name="max_depth" value="$depth"/></integrator>"#,
        "s.xml:2:25: undefined parameter $depth",
    ),
    (
        r#"<integrator type="path"/><integrator type="path"/>"#,
        "s.xml:2:26: a scene has only one integrator",
    ),
    (
        r#"<include filename="s.xml"/>"#,
        "s.xml:2:1: s.xml includes itself",
    ),
    (
        r#"<sensor type="distant"/>"#,
        r#"s.xml:2:1: <sensor type="distant"> is not supported"#,
    ),
    (
        r#"<sensor type="perspective"><float name="fov" value="200"/></sensor>"#,
        r#"s.xml:2:28: "fov" must be between 0 and 180 degrees, not 200"#,
    ),
    (
        r#"<shape type="ply"><string name="filename" value="nowhere.ply"/></shape>"#,
        r#"s.xml:2:19: file "nowhere.ply" is not there"#,
    ),
    (r#"<shape type="ply" id="a"/>"#, "s.xml:2:1: "),
    (
        r#"<emitter type="constant"/><emitter type="constant"/>"#,
        "s.xml:2:27: a scene has only one environment emitter",
    ),
];

/// A mesh file, its contents and the message.
const MESHES: [(&str, &str, &str); 7] = [
    (
        "m.ply",
        "not a mesh",
        "m.ply:1: this is no valid PLY header",
    ),
    (
        "m.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
         property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n",
        "m.ply:11: the file is truncated",
    ),
    (
        "m.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
         property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n",
        "m.ply, face 0: vertex index 7 is out of range",
    ),
    (
        "m.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\n\
         property list uchar int vertex_indices\nend_header\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n",
        "m.ply, vertex 1: the position is not finite",
    ),
    (
        "m.ply",
        "ply\nformat ascii 1.0\nelement vertex 999999999999\nproperty float x\nend_header\n",
        "m.ply",
    ),
    (
        "m.obj",
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
        "m.obj:4: vertex index 9 is out of range",
    ),
    (
        "m.obj",
        "v 0 0 zero\nf 1 1 1\n",
        r#"m.obj:1: "zero" is not a number"#,
    ),
];

fn assert_refused(directory: &Path, what: &str, message: &str) {
    // Parameters are listed beside what is not supported.
    let is_listed = message.contains("is not supported");
    let commands = if is_listed {
        &["render"][..]
    } else {
        &["render", "params"]
    };
    for command in commands {
        let out = warpath(directory, &[*command, "s.xml"]);
        let stderr = text(&out.stderr);
        assert_eq!(out.status.code(), Some(3), "{what}: {stderr}");
        assert!(
            stderr.starts_with(&format!("error: {message}")) && !stderr.contains("panicked"),
            "{what}: {stderr}"
        );
        assert!(
            out.stdout.is_empty() && stderr.lines().count() <= 3,
            "{what}: {stderr}"
        );
    }
}

fn write_scene(directory: &Path, inside: &str) {
    let scene = format!("<scene version=\"3.0.0\">\n{inside}\n{SENSOR}</scene>\n");
    std::fs::write(directory.join("s.xml"), scene).unwrap();
}

#[test]
fn broken_scenes_are_refused_with_their_place() {
    let directory = tempfile::tempdir().unwrap();
    for (inside, message) in SCENES {
        write_scene(directory.path(), inside);
        assert_refused(directory.path(), inside, message);
    }
    let whole = [
        (&b""[..], "s.xml:1:1: not well-formed XML"),
        (
            b"<scene version=\"3.0.0\">\xe9</scene>",
            "s.xml:1:24: the file is not UTF-8",
        ),
        (b"<bsdf type=\"diffuse\"/>", "s.xml:1:1: "),
    ];
    for (bytes, message) in whole {
        std::fs::write(directory.path().join("s.xml"), bytes).unwrap();
        assert_refused(directory.path(), message, message);
    }
}

#[test]
fn broken_meshes_are_refused_with_their_place() {
    let directory = tempfile::tempdir().unwrap();
    for (file, contents, message) in MESHES {
        let plugin = &file[2..];
        write_scene(
            directory.path(),
            &format!(r#"<shape type="{plugin}"><string name="filename" value="{file}"/></shape>"#),
        );
        std::fs::write(directory.path().join(file), contents).unwrap();
        assert_refused(directory.path(), message, message);
    }
}
