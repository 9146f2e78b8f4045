//! Good scenes: Mitsuba's defaults and conventions.

use glam::{Vec3, Vec3A};
use std::io;
use std::path::Path;
use warpath::scene::source::{FileSource, Memory};
use warpath::scene::{Filter, Normals, Rgb, Scene, SceneError, load_from};

const SENSOR: &str =
    "<sensor type=\"perspective\" id=\"cam\"><float name=\"fov\" value=\"40\"/></sensor>";

fn with_files(inside: &str, files: Memory, defines: &[(&str, &str)]) -> Scene {
    let files = files.with(
        "s/s.xml",
        format!("<scene version=\"3.0.0\">\n{inside}</scene>"),
    );
    let defines: Vec<_> = defines
        .iter()
        .map(|(n, v)| (n.to_string(), v.to_string()))
        .collect();
    load_from(&files, "s/s.xml", &defines).unwrap_or_else(|e| panic!("{e}"))
}

fn scene(inside: &str) -> Scene {
    with_files(&format!("{inside}{SENSOR}"), Memory::new(), &[])
}

/// The horizontal opening angle of a sensor with these properties, degrees.
fn x_fov_deg(properties: &str) -> f32 {
    let sensor = format!("<sensor type=\"perspective\">{properties}</sensor>");
    with_files(&sensor, Memory::new(), &[]).sensors[0]
        .x_fov_rad
        .to_degrees()
}

/// The triangle's geometric normal.
fn face_normal(scene: &Scene, mesh: usize, triangle: usize) -> Vec3 {
    let mesh = &scene.meshes[mesh];
    let [a, b, c] = mesh.triangles[triangle].map(|i| mesh.positions[i as usize]);
    (b - a).cross(c - a).normalize()
}

fn colour(scene: &Scene, material: usize) -> Rgb {
    let texture = scene.materials[material].bsdf.colour();
    scene.constant(texture.expect("a colour"))
}

#[test]
fn defaults_are_mitsubas() {
    let scene = scene(
        "<integrator type=\"path\"/><shape type=\"cube\"/><shape type=\"cube\"><emitter type=\"area\"/></shape>",
    );
    let sensor = &scene.sensors[0];
    assert_eq!((sensor.film.width, sensor.film.height), (768, 576));
    assert_eq!(sensor.film.crop_size, [768, 576]);
    assert_eq!(sensor.film.filter, Filter::Gaussian { stddev: 0.5 });
    assert!(!sensor.film.sample_border);
    assert_eq!((sensor.sample_count, sensor.seed), (4, 0));
    assert_eq!((sensor.near_clip, sensor.far_clip), (0.01, 10_000.0));
    assert_eq!(
        (scene.integrator.max_depth, scene.integrator.rr_depth),
        (u32::MAX, 5)
    );
    // A shape without a bsdf is grey; if it emits, black.
    assert_eq!(colour(&scene, scene.meshes[0].material), [0.5; 3]);
    assert_eq!(colour(&scene, scene.meshes[1].material), [0.0; 3]);
    assert!(!scene.materials[0].two_sided);
    assert_eq!(scene.constant(scene.area_lights[0].radiance), [1.0; 3]);
    let ids: Vec<&str> = scene.meshes.iter().map(|m| m.id.as_str()).collect();
    assert_eq!(ids, ["Cube", "Cube_1"]);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn integrators_have_their_own_depths() {
    let depth = |integrator: &str| scene(integrator).integrator.max_depth;
    assert_eq!(depth("<integrator type=\"prb\"/>"), 6);
    assert_eq!(depth("<integrator type=\"direct\"/>"), 2);
    assert_eq!(
        depth(
            "<integrator type=\"prb_reparam\"><integer name=\"max_depth\" value=\"3\"/></integrator>"
        ),
        3
    );
}

#[test]
fn field_of_view_follows_its_axis() {
    let film = "<film type=\"hdrfilm\"><integer name=\"width\" value=\"200\"/><integer name=\"height\" value=\"100\"/></film>";
    let fov = |axis: &str| {
        x_fov_deg(&format!(
            "<float name=\"fov\" value=\"40\"/><string name=\"fov_axis\" value=\"{axis}\"/>{film}"
        ))
    };
    let wide = 2.0 * (2.0 * 20f32.to_radians().tan()).atan().to_degrees();
    let diagonal = 2.0
        * (20f32.to_radians().tan() * 2.0 / 5f32.sqrt())
            .atan()
            .to_degrees();
    for (axis, expected) in [
        ("x", 40.0),
        ("larger", 40.0),
        ("y", wide),
        ("smaller", wide),
        ("diagonal", diagonal),
    ] {
        assert!((fov(axis) - expected).abs() < 1e-4, "{axis}: {}", fov(axis));
    }
}

#[test]
fn camera_looks_along_z_with_x_to_the_left() {
    let look = "<transform name=\"to_world\"><lookat origin=\"0 -4 0\" target=\"0 0 0\" up=\"0 0 1\"/></transform>";
    let sensor =
        format!("<sensor type=\"perspective\"><float name=\"fov\" value=\"40\"/>{look}</sensor>");
    let to_world = with_files(&sensor, Memory::new(), &[]).sensors[0].to_world;
    assert_eq!(to_world.matrix3.z_axis, Vec3A::Y);
    assert_eq!(to_world.matrix3.x_axis, Vec3A::NEG_X);
    assert_eq!(to_world.translation, Vec3A::new(0.0, -4.0, 0.0));
}

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

#[test]
fn references_share_materials_and_colours_have_many_spellings() {
    let scene = scene(
        "<bsdf type=\"diffuse\" id=\"red\"><srgb name=\"reflectance\" value=\"#ff0000\"/></bsdf>\
         <shape type=\"cube\"><bsdf type=\"twosided\"><ref id=\"red\"/></bsdf></shape>\
         <shape type=\"cube\"><bsdf type=\"twosided\"><ref id=\"red\"/></bsdf></shape>\
         <shape type=\"cube\"><ref id=\"grey\"/></shape>\
         <bsdf type=\"diffuse\" id=\"grey\"><spectrum name=\"reflectance\" value=\"0.25\"/></bsdf>\
         <shape type=\"cube\"><bsdf type=\"diffuse\"><float name=\"reflectance\" value=\"0.75\"/></bsdf></shape>",
    );
    let materials: Vec<usize> = scene.meshes.iter().map(|m| m.material).collect();
    assert_eq!(materials, [0, 0, 1, 2]);
    assert_eq!(colour(&scene, 0), [1.0, 0.0, 0.0]);
    assert!(scene.materials[0].two_sided);
    assert_eq!(
        (scene.materials[1].key.as_str(), colour(&scene, 1)),
        ("grey", [0.25; 3])
    );
    assert_eq!(colour(&scene, 2), [0.75; 3]);
}

#[test]
fn includes_paths_and_defines_resolve() {
    let triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let files = Memory::new()
        .with("s/parts/shapes.xml", "<scene version=\"3.0.0\"><default name=\"n\" value=\"7\"/>\
               <shape type=\"obj\" id=\"near\"><string name=\"filename\" value=\"near.obj\"/></shape>\
               <shape type=\"obj\" id=\"far\"><string name=\"filename\" value=\"far_$n.obj\"/></shape></scene>")
        .with("s/paint.xml", "<bsdf version=\"3.0.0\" type=\"diffuse\" id=\"paint\"/>")
        .with("s/parts/near.obj", triangle)
        .with("s/library/far_8.obj", triangle);
    let inside = format!(
        "<path value=\"library\"/><include filename=\"parts/shapes.xml\"/><include filename=\"paint.xml\"/>{SENSOR}"
    );
    let scene = with_files(&inside, files, &[("n", "8")]);
    assert_eq!(scene.meshes.len(), 2);
    assert_eq!(scene.materials.last().unwrap().key, "paint");
}

#[test]
fn what_was_not_read_is_said() {
    let scene = scene(
        "<integrator type=\"path\">\n  <integer name=\"max_dept\" value=\"4\"/></integrator>",
    );
    assert_eq!(
        scene.warnings,
        [
            "s/s.xml:3:3: property \"max_dept\" of <integrator type=\"path\"> was not read; the nearest one it reads is \"max_depth\""
        ]
    );
}

#[test]
fn the_hash_is_of_what_was_read() {
    let hash = |n: &str, obj: &str| {
        let inside = format!(
            "<default name=\"n\" value=\"1\"/><shape type=\"obj\"><string name=\"filename\" value=\"m.obj\"/>\
             <transform name=\"to_world\"><translate x=\"$n\"/></transform></shape>{SENSOR}"
        );
        with_files(&inside, Memory::new().with("s/m.obj", obj), &[("n", n)]).hash
    };
    let obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    assert_eq!(hash("2", obj), hash("2", obj));
    assert_ne!(hash("2", obj), hash("3", obj));
    assert_ne!(hash("2", obj), hash("2", &obj.replace("1 0 0", "2 0 0")));
}

/// A disk on which nothing can be read.
struct Broken;

impl FileSource for Broken {
    fn read(&self, _: &Path) -> io::Result<Vec<u8>> {
        Err(io::ErrorKind::PermissionDenied.into())
    }

    fn exists(&self, _: &Path) -> bool {
        true
    }
}

#[test]
fn a_file_that_cannot_be_read_is_no_bad_input() {
    let error = load_from(&Broken, "s.xml", &[]).unwrap_err();
    assert!(
        error.is_io() && error.to_string().starts_with("s.xml: "),
        "{error}"
    );
    let missing = load_from(&Memory::new(), "s.xml", &[]).unwrap_err();
    assert!(matches!(missing, SceneError::Missing { .. }) && !missing.is_io());
}
