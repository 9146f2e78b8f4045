//! Shapes, transformed or from files.

use super::{SENSOR, face_normal, scene, with_files};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use glam::{Vec2, Vec3};
use std::io::Write;
use warpath::scene::Normals;
use warpath::scene::source::Memory;

#[test]
fn transforms_apply_in_order() {
    let scene = scene(
        "<shape type=\"rectangle\"><transform name=\"to_world\"><scale value=\"2\"/><rotate z=\"1\" angle=\"90\"/>\
         <translate x=\"5\"/><matrix value=\"1 0 0  0 1 0  0 0 1\"/></transform></shape>",
    );
    let corner = scene.meshes[0].positions[1];
    assert!(
        (corner - Vec3::new(7.0, 2.0, 0.0)).length() < 1e-5,
        "{corner}"
    );
}

/// Rodrigues' formula without a unit vector, as Mitsuba 3.9.1 has it (its `mi.traverse`).
#[test]
fn rotation_axes_are_taken_as_they_are() {
    let scene = scene(
        "<shape type=\"rectangle\"><transform name=\"to_world\"><translate z=\"1\"/>\
         <rotate x=\"1\" y=\"1\" angle=\"40\"/></transform></shape>",
    );
    let [a, _, _, b] = [0, 1, 2, 3].map(|i| scene.meshes[0].positions[i]);
    let middle = 0.5 * (a + b);
    let expected = Vec3::new(0.642_787_6, -0.642_787_6, 0.766_044_4);
    assert!((middle - expected).length() < 1e-5, "{middle}");
    assert!(scene.warnings[0].contains("1.414"), "{:?}", scene.warnings);
}

#[test]
fn mirrors_keep_normals_outside_and_flips_turn_them() {
    let mirror = "<transform name=\"to_world\"><scale x=\"-2\"/></transform>";
    let flip = "<boolean name=\"flip_normals\" value=\"true\"/>";
    let scene = scene(&format!(
        "<shape type=\"sphere\">{mirror}</shape><shape type=\"sphere\">{mirror}{flip}</shape>\
         <shape type=\"rectangle\">{flip}</shape>"
    ));
    for (mesh, sign) in [(0, 1.0), (1, -1.0)] {
        let triangle = scene.meshes[mesh].triangles[77];
        let outward = scene.meshes[mesh].positions[triangle[0] as usize];
        assert!(sign * face_normal(&scene, mesh, 77).dot(outward) > 0.0);
        let Normals::Computed(normals) = &scene.meshes[mesh].normals else {
            panic!("a sphere is smooth");
        };
        assert!(sign * normals[triangle[0] as usize].dot(outward) > 0.0);
    }
    assert_eq!(face_normal(&scene, 2, 0), Vec3::NEG_Z);
    assert!(
        scene.warnings[0].contains("subdivided 5 times"),
        "{:?}",
        scene.warnings
    );
}

#[test]
fn given_normals_go_with_the_inverse_transpose() {
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 1\nvn 0 -1 1\nf 1//1 2//1 3//1\n";
    let shape = format!(
        "<shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/><transform name=\"to_world\">\
         <scale x=\"-1\" z=\"3\"/></transform></shape>{SENSOR}"
    );
    let scene = with_files(&shape, Memory::new().with("s/m.obj", obj), &[]);
    let Normals::Given(normals) = &scene.meshes[0].normals else {
        panic!("the file has normals");
    };
    assert!((normals[0] - face_normal(&scene, 0, 0)).length() < 1e-6);
}

#[test]
fn obj_files_keep_their_vertex_numbers() {
    let obj = "# unused vertex 1\nmtllib x.mtl\nv 9 9 9\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvn 0 0 1\n\
               vn 0 0.6 0.8\ng first\nf 2/1/1 3/1/1 4//1 \\\n 5//1\nusemtl red\nf -4//2 -3//1 -2//1\n";
    let shape = |extra: &str| {
        format!(
            "<shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/>{extra}</shape>{SENSOR}"
        )
    };
    let load = |extra: &str| with_files(&shape(extra), Memory::new().with("s/m.obj", obj), &[]);
    let smooth = load("");
    let mesh = &smooth.meshes[0];
    // Vertex 1 is used with a second normal: it is repeated at the end.
    assert_eq!(mesh.triangles, [[1, 2, 3], [1, 3, 4], [5, 2, 3]]);
    assert_eq!(mesh.positions.len(), 6);
    assert_eq!(mesh.positions[5], mesh.positions[1]);
    let normals = mesh.normals.vertex().unwrap();
    assert_eq!(
        (normals[1], normals[5]),
        (Vec3::Z, Vec3::new(0.0, 0.6, 0.8))
    );
    let flat = load("<boolean name=\"face_normals\" value=\"true\"/>");
    assert_eq!(flat.meshes[0].positions.len(), 5);
    assert!(matches!(flat.meshes[0].normals, Normals::Flat));
}

#[test]
fn ply_encodings_agree_and_degenerate_faces_are_dropped_with_one_remark() {
    let header = |format: &str| {
        format!(
            "ply\nformat {format} 1.0\ncomment x\nelement vertex 5\nproperty double x\nproperty float y\n\
             property short z\nproperty uchar red\nelement face 3\nproperty list uchar uint vertex_indices\n\
             property list uint float weights\nelement extra 1\nproperty int i\nend_header\n"
        )
    };
    let vertices = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 2], [2, 0, 0]];
    let faces: [&[u32]; 3] = [&[0, 1, 2, 3], &[0, 1, 4], &[2, 2, 3]];
    let mut ascii = header("ascii");
    let (mut little, mut big) = (Vec::new(), Vec::new());
    for v in vertices {
        ascii += &format!("{} {} {} 255\n", v[0], v[1], v[2]);
        little.extend(f64::from(v[0]).to_le_bytes());
        big.extend(f64::from(v[0]).to_be_bytes());
        little.extend((v[1] as f32).to_le_bytes());
        big.extend((v[1] as f32).to_be_bytes());
        little.extend((v[2] as i16).to_le_bytes());
        big.extend((v[2] as i16).to_be_bytes());
        little.push(255);
        big.push(255);
    }
    for face in faces {
        ascii += &format!("{}", face.len());
        little.push(face.len() as u8);
        big.push(face.len() as u8);
        for &i in face {
            ascii += &format!(" {i}");
            little.extend(i.to_le_bytes());
            big.extend(i.to_be_bytes());
        }
        ascii += " 1\n0.5\n";
        little.extend(1u32.to_le_bytes().into_iter().chain(0.5f32.to_le_bytes()));
        big.extend(1u32.to_be_bytes().into_iter().chain(0.5f32.to_be_bytes()));
    }
    ascii += "7\n";
    little.extend([7; 4]);
    big.extend([7; 4]);
    let files = Memory::new()
        .with("s/a.ply", ascii)
        .with(
            "s/l.ply",
            [header("binary_little_endian").into_bytes(), little].concat(),
        )
        .with(
            "s/b.ply",
            [header("binary_big_endian").into_bytes(), big].concat(),
        );
    let shapes: String = ["a", "l", "b"]
        .map(|f| {
            format!("<shape type=\"ply\"><string name=\"filename\" value=\"{f}.ply\"/></shape>")
        })
        .concat();
    let scene = with_files(&format!("{shapes}{SENSOR}"), files, &[]);
    for mesh in &scene.meshes {
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(
            mesh.positions,
            vertices.map(|v| Vec3::from(v.map(|x| x as f32)))
        );
    }
    let dropped = |w: &&String| w.contains("dropped");
    assert_eq!(scene.warnings.iter().filter(dropped).count(), 3);
    assert!(
        scene.warnings[0].contains("a.ply: dropped 2 faces"),
        "{:?}",
        scene.warnings
    );
}

/// Places and texture coordinates are those at which Mitsuba 3.9.1 meets its own.
#[test]
fn round_shapes_are_mitsubas() {
    let scene = scene(
        "<shape type=\"disk\"/><shape type=\"cylinder\"><point name=\"p0\" value=\"1,2,3\"/>\
         <point name=\"p1\" value=\"1,5,3\"/><float name=\"radius\" value=\"0.5\"/>\
         <boolean name=\"flip_normals\" value=\"true\"/></shape><shape type=\"disk\"/>",
    );
    let near = |mesh: usize, at: Vec3| {
        let distance = |i: &usize| scene.meshes[mesh].positions[*i].distance(at);
        let vertices = 0..scene.meshes[mesh].positions.len();
        vertices.min_by(|i, j| distance(i).total_cmp(&distance(j)))
    };
    let on_rim = near(0, Vec3::new(0.6, -0.8, 0.0)).expect("a vertex");
    assert!((scene.meshes[0].uvs[on_rim] - Vec2::new(1.0, 0.852_416)).length() < 4e-3);
    assert_eq!(face_normal(&scene, 0, 7), Vec3::Z);
    let on_side = near(1, Vec3::new(1.458_26, 5.0, 3.2)).expect("a vertex");
    assert!((scene.meshes[1].uvs[on_side] - Vec2::new(0.934_505, 1.0)).length() < 4e-3);
    let Normals::Given(normals) = &scene.meshes[1].normals else {
        panic!("a cylinder is smooth");
    };
    assert!((normals[on_side] - Vec3::new(-0.916_515, 0.0, -0.4)).length() < 3e-2);
    let said = &scene.warnings;
    assert!(
        said.iter().any(|w| w.contains("this disk and 1 more")),
        "{said:?}"
    );
    assert!(
        said.iter()
            .any(|w| w.contains("the cylinder is tessellated"))
    );
}

/// A triangle in a zlib stream: number `z` in all its positions' third places.
fn stream(version: u16, z: f64, is_double: bool) -> Vec<u8> {
    let flags: u32 = 0x0001 | 0x0002 | 0x0008 | if is_double { 0x2000 } else { 0x1000 };
    let mut bytes = flags.to_le_bytes().to_vec();
    if version >= 4 {
        bytes.extend(b"name\0");
    }
    bytes.extend([3u64, 1].into_iter().flat_map(u64::to_le_bytes));
    let positions = [0.0, 0.0, z, 1.0, 0.0, z, 0.0, 1.0, z];
    let normals = [0.6, 0.0, 0.8].repeat(3);
    let (uvs, colours) = ([0.0, 0.25, 1.0, 0.25, 0.0, 0.5], [0.5; 9]);
    for number in [&positions[..], &normals, &uvs, &colours].concat() {
        match is_double {
            true => bytes.extend(number.to_le_bytes()),
            false => bytes.extend((number as f32).to_le_bytes()),
        }
    }
    bytes.extend([0u32, 1, 2].into_iter().flat_map(u32::to_le_bytes));
    let header = [0x041Cu16, version].map(u16::to_le_bytes).concat();
    let mut zlib = ZlibEncoder::new(header, Compression::default());
    zlib.write_all(&bytes).expect("memory");
    zlib.finish().expect("memory")
}

/// Both versions, both precisions, each with two meshes, of which `shape_index` picks one.
#[test]
fn serialized_files_hold_several_meshes() {
    for (version, is_double) in [(3, false), (3, true), (4, false), (4, true)] {
        let mut bytes = stream(version, 1.0, is_double);
        let second = bytes.len() as u64;
        bytes.extend(stream(version, 2.0, is_double));
        for offset in [0, second] {
            let size = if version >= 4 { 8 } else { 4 };
            bytes.extend(&offset.to_le_bytes()[..size]);
        }
        bytes.extend(2u32.to_le_bytes());
        let shape = |number: &str| {
            format!(
                "<shape type=\"serialized\"><string name=\"filename\" value=\"m.serialized\"/>{number}\
                 <bsdf type=\"diffuse\"><texture type=\"checkerboard\" name=\"reflectance\"/></bsdf></shape>"
            )
        };
        let second = shape("<integer name=\"shape_index\" value=\"1\"/>");
        let both = format!("{}{second}{SENSOR}", shape(""));
        let scene = with_files(&both, Memory::new().with("s/m.serialized", bytes), &[]);
        for (mesh, z) in scene.meshes.iter().zip([1.0, 2.0]) {
            assert_eq!(mesh.positions[1], Vec3::new(1.0, 0.0, z));
            assert_eq!(mesh.uvs[2], Vec2::new(0.0, 0.5));
            assert_eq!(mesh.triangles, [[0, 1, 2]]);
            let Normals::Given(normals) = &mesh.normals else {
                panic!("the file has normals");
            };
            assert!((normals[0] - Vec3::new(0.6, 0.0, 0.8)).length() < 1e-6);
        }
        assert_eq!(scene.meshes[1].id, "SerializedMesh_1");
    }
}
