//! Good scenes: Mitsuba's defaults and conventions.

use glam::{Affine2, Vec2, Vec3, Vec3A};
use std::io;
use std::path::Path;
use warpath::scene::source::{FileSource, Memory};
use warpath::scene::{
    Bsdf, DeltaLightKind, Distribution, Filter, Layout, Microfacets, Normals, Rgb, Scene,
    SceneError, Wrap, load_from,
};

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

/// The bsdf `<bsdf type="…">inside</bsdf>` of a scene.
fn bsdf(plugin: &str, inside: &str) -> (Scene, Bsdf) {
    let scene = scene(&format!("<bsdf type=\"{plugin}\">{inside}</bsdf>"));
    let bsdf = scene.materials[0].bsdf;
    assert!(scene.warnings.len() == 1, "{:?}", scene.warnings);
    (scene, bsdf)
}

#[test]
fn conductors_have_mitsubas_metals() {
    let (scene, metal) = bsdf("conductor", "");
    let Bsdf::Conductor {
        eta,
        k,
        specular_reflectance,
        microfacets: None,
    } = metal
    else {
        panic!("{metal:?}");
    };
    // A mirror that reflects everything.
    assert_eq!(
        (scene.constant(eta), scene.constant(k)),
        ([0.0; 3], [1.0; 3])
    );
    assert_eq!(scene.constant(specular_reflectance), [1.0; 3]);
    let gold = "<string name=\"material\" value=\"Au\"/>";
    let (scene, metal) = bsdf(
        "roughconductor",
        &format!(
            "{gold}<string name=\"distribution\" value=\"GGX\"/><boolean name=\"sample_visible\" value=\"false\"/>"
        ),
    );
    let Bsdf::Conductor {
        eta,
        microfacets: Some(Microfacets {
            distribution,
            alpha,
        }),
        ..
    } = metal
    else {
        panic!("{metal:?}");
    };
    assert_eq!(distribution, Distribution::Ggx);
    assert_eq!(scene.constant(eta), [0.14303598, 0.37530708, 1.4420453]);
    let alpha = &scene.textures[alpha];
    assert_eq!((alpha.texels[0], alpha.channels), ([0.1; 3], 1));
    assert_eq!(alpha.key, "RoughConductor.alpha");
    let (scene, metal) = bsdf("conductor", "<rgb name=\"eta\" value=\"0.2 0.9 1.1\"/>");
    let Bsdf::Conductor { eta, k, .. } = metal else {
        panic!("{metal:?}");
    };
    assert_eq!(
        (scene.constant(eta), scene.constant(k)),
        ([0.2, 0.9, 1.1], [1.0; 3])
    );
}

#[test]
fn roughness_is_at_least_mitsubas() {
    let alpha = |inside: &str| {
        let (scene, metal) = bsdf("roughconductor", inside);
        let rough = metal.slots().into_iter().find(|s| s.0 == "alpha");
        scene.constant(rough.expect("a rough metal").1)[0]
    };
    assert_eq!(alpha("<float name=\"alpha\" value=\"0\"/>"), 1e-4);
    assert_eq!(alpha("<spectrum name=\"alpha\" value=\"0.3\"/>"), 0.3);
    let both = "<float name=\"alpha_u\" value=\"0.25\"/><float name=\"alpha_v\" value=\"0.25\"/>";
    assert_eq!(alpha(both), 0.25);
}

#[test]
fn interfaces_take_indices_by_name_and_number() {
    let eta = |plugin: &str, inside: &str| {
        let (scene, bsdf) = bsdf(plugin, inside);
        let slot = bsdf.slots().into_iter().find(|s| s.0 == "eta");
        let texture = &scene.textures[slot.expect("an interface").1];
        assert_eq!(texture.channels, 1);
        texture.texels[0][0]
    };
    assert!((eta("dielectric", "") - 1.504_183).abs() < 1e-6);
    assert!((eta("plastic", "") - 1.489_587).abs() < 1e-6);
    let diamond =
        "<string name=\"int_ior\" value=\"Diamond\"/><float name=\"ext_ior\" value=\"1\"/>";
    assert_eq!(eta("roughdielectric", diamond), 2.419);
    assert_eq!(
        eta(
            "roughplastic",
            "<float name=\"int_ior\" value=\"1.5\"/><string name=\"ext_ior\" value=\"vacuum\"/>"
        ),
        1.5
    );
    let (scene, plastic) = bsdf(
        "roughplastic",
        "<boolean name=\"nonlinear\" value=\"true\"/><rgb name=\"diffuse_reflectance\" value=\"0.1 0.2 0.3\"/>",
    );
    let Bsdf::Plastic {
        diffuse_reflectance,
        nonlinear: true,
        microfacets: Some(_),
        ..
    } = plastic
    else {
        panic!("{plastic:?}");
    };
    assert_eq!(scene.constant(diffuse_reflectance), [0.1, 0.2, 0.3]);
    assert_eq!(bsdf("null", "").1, Bsdf::Null);
}

#[test]
fn a_texture_used_twice_is_one() {
    let scene = scene(
        "<texture type=\"checkerboard\" id=\"board\"><rgb name=\"color1\" value=\"1 0 0\"/>\
         <transform name=\"to_uv\"><scale x=\"4\" y=\"2\"/><rotate z=\"1\" angle=\"90\"/><translate x=\"0.5\" z=\"7\"/></transform></texture>\
         <shape type=\"rectangle\"><bsdf type=\"diffuse\"><ref id=\"board\" name=\"reflectance\"/></bsdf></shape>\
         <shape type=\"rectangle\"><bsdf type=\"twosided\"><bsdf type=\"plastic\">\
         <ref id=\"board\" name=\"diffuse_reflectance\"/></bsdf></bsdf>\
         <emitter type=\"area\"><ref id=\"board\" name=\"radiance\"/></emitter></shape>",
    );
    let board = scene.materials[0].bsdf.colour().unwrap();
    assert_eq!(scene.materials[1].bsdf.colour(), Some(board));
    assert_eq!(scene.area_lights[0].radiance, board);
    let texture = &scene.textures[board];
    assert_eq!(texture.key, "board");
    assert_eq!(texture.texels, [[0.4; 3], [1.0, 0.0, 0.0]]);
    assert_eq!(texture.limits, [0.0, 1.0]);
    let Layout::Checkerboard { to_uv } = texture.layout else {
        panic!("{:?}", texture.layout);
    };
    let there = to_uv.transform_point2(Vec2::new(1.0, 0.0));
    assert!((there - Vec2::new(0.5, 4.0)).length() < 1e-5, "{there}");
}

#[test]
fn one_bsdf_may_have_one_side_here_and_two_there() {
    let scene = scene(
        "<bsdf type=\"diffuse\" id=\"red\"/><shape type=\"cube\"><ref id=\"red\"/></shape>\
         <shape type=\"cube\"><bsdf type=\"twosided\"><ref id=\"red\"/></bsdf></shape>",
    );
    let [one, two] = [0, 1].map(|m: usize| &scene.materials[scene.meshes[m].material]);
    assert!(!one.two_sided && two.two_sided);
    assert_eq!(one.bsdf, two.bsdf);
}

#[test]
fn lights_without_extent_have_places_and_directions() {
    let turned = "<transform name=\"to_world\"><rotate y=\"1\" angle=\"90\"/><translate x=\"3\"/></transform>";
    let scene = scene(&format!(
        "<emitter type=\"point\" id=\"bulb\"><point name=\"position\" value=\"1 2 3\"/><rgb name=\"intensity\" value=\"5\"/></emitter>\
         <emitter type=\"point\">{turned}</emitter>\
         <emitter type=\"directional\"><vector name=\"direction\" x=\"0\" y=\"-2\" z=\"0\"/></emitter>\
         <emitter type=\"directional\">{turned}<rgb name=\"irradiance\" value=\"1 2 3\"/></emitter>"
    ));
    let kinds: Vec<DeltaLightKind> = scene.delta_lights.iter().map(|l| l.kind).collect();
    let point = |position| DeltaLightKind::Point { position };
    assert_eq!(kinds[0], point(Vec3::new(1.0, 2.0, 3.0)));
    assert_eq!(kinds[1], point(Vec3::new(3.0, 0.0, 0.0)));
    let along = |i: usize| match kinds[i] {
        DeltaLightKind::Directional { direction } => direction,
        other => panic!("{other:?}"),
    };
    assert_eq!(along(2), Vec3::NEG_Y);
    assert!((along(3) - Vec3::X).length() < 1e-6);
    assert_eq!(scene.constant(scene.delta_lights[0].power), [5.0; 3]);
    assert_eq!(scene.constant(scene.delta_lights[3].power), [1.0, 2.0, 3.0]);
    let keys: Vec<&str> = scene.delta_lights.iter().map(|l| l.key.as_str()).collect();
    assert_eq!(
        keys,
        [
            "bulb",
            "PointLight",
            "DirectionalEmitter",
            "DirectionalEmitter_1"
        ]
    );
    assert!(scene.warnings.len() == 1, "{:?}", scene.warnings);
}

const BOARD: &str =
    "<bsdf type=\"diffuse\"><texture type=\"checkerboard\" name=\"reflectance\"/></bsdf>";

/// The texture coordinates of the mesh at a vertex near `position`.
fn uvs_at(scene: &Scene, mesh: usize, position: Vec3) -> Vec<Vec2> {
    let mesh = &scene.meshes[mesh];
    assert_eq!(mesh.uvs.len(), mesh.positions.len());
    let near = mesh.positions.iter().zip(&mesh.uvs);
    near.filter(|(p, _)| (**p - position).length() < 1e-5)
        .map(|(_, uv)| *uv)
        .collect()
}

#[test]
fn formulas_have_mitsubas_texture_coordinates() {
    let scene = scene(&format!(
        "<shape type=\"rectangle\">{BOARD}</shape><shape type=\"cube\">{BOARD}</shape>\
         <shape type=\"sphere\">{BOARD}</shape><shape type=\"cube\"/>"
    ));
    assert_eq!(uvs_at(&scene, 0, Vec3::new(-1.0, -1.0, 0.0)), [Vec2::ZERO]);
    assert_eq!(uvs_at(&scene, 0, Vec3::new(1.0, -1.0, 0.0)), [Vec2::X]);
    // A corner of the cube has a vertex on each side; (u, v) by side: x, y, z.
    assert_eq!(scene.meshes[1].positions.len(), 24);
    let mut corner = uvs_at(&scene, 1, Vec3::new(1.0, -1.0, 1.0));
    corner.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    assert_eq!(
        corner,
        [Vec2::ZERO, Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0)]
    );
    let equator = uvs_at(&scene, 2, Vec3::X);
    assert_eq!(equator.len(), 2, "the seam is split");
    assert_eq!(uvs_at(&scene, 2, Vec3::Y), [Vec2::new(0.25, 0.5)]);
    // Without a texture its corners stay shared.
    assert_eq!(scene.meshes[3].positions.len(), 8);
    assert!(scene.meshes[3].uvs.is_empty());
}

#[test]
fn files_have_texture_coordinates() {
    let ply = |names: [&str; 2]| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property float s\nproperty float t\nproperty float {}\nproperty float {}\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n0 0 0 9 9 0.25 0.5\n1 0 0 9 9 1 0\n0 1 0 9 9 0 1\n3 0 1 2\n",
            names[0], names[1]
        )
    };
    // Vertex 2 has two texture coordinates.
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.25 0.125\nvt 1 0 0\nvt 0 1\nf 1/1 2/2 3/3\nf 1/1 3/2 4/3\n";
    let files = Memory::new()
        .with("s/uv.ply", ply(["u", "v"]))
        .with("s/texture.ply", ply(["texture_u", "texture_v"]))
        .with("s/m.obj", obj);
    let shape = |plugin: &str, file: &str, extra: &str| {
        format!(
            "<shape type=\"{plugin}\"><string name=\"filename\" value=\"{file}\"/>{extra}</shape>"
        )
    };
    let flip = |flip: bool| format!("{BOARD}<boolean name=\"flip_tex_coords\" value=\"{flip}\"/>");
    let shapes = [
        shape("ply", "uv.ply", BOARD),
        shape("ply", "texture.ply", &flip(true)),
        shape("obj", "m.obj", BOARD),
        shape("obj", "m.obj", &flip(false)),
        shape("obj", "m.obj", ""),
    ];
    let scene = with_files(&format!("{}{SENSOR}", shapes.concat()), files, &[]);
    let first = |m: usize| scene.meshes[m].uvs[0];
    assert_eq!(first(0), Vec2::new(0.25, 0.5));
    assert_eq!(first(1), Vec2::new(0.25, 0.5));
    assert_eq!(scene.meshes[1].uvs[1], Vec2::new(1.0, 1.0));
    // OBJ files count v downwards.
    assert_eq!(first(2), Vec2::new(0.25, 0.875));
    assert_eq!(first(3), Vec2::new(0.25, 0.125));
    assert_eq!(scene.meshes[2].positions.len(), 5);
    assert_eq!(scene.meshes[2].triangles, [[0, 1, 2], [0, 4, 3]]);
    // Without a texture vertices are not split.
    assert_eq!(scene.meshes[4].positions.len(), 4);
}

/// A picture file of 32-bit floating-point numbers (PFM, bottom row first) with `colour` at each column and row from the top.
fn floats(width: u32, height: u32, colour: impl Fn(u32, u32) -> Rgb) -> Vec<u8> {
    let mut bytes = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
    for y in (0..height).rev() {
        for x in 0..width {
            bytes.extend(colour(x, y).into_iter().flat_map(f32::to_le_bytes));
        }
    }
    bytes
}

/// An 8-bit PNG of one row.
fn bytes_of_a_row(row: &[[u8; 3]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, row.len() as u32, 1);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(row.as_flattened()).unwrap();
    drop(writer);
    bytes
}

#[test]
fn bitmaps_have_texels_wrapping_and_a_place() {
    let files = Memory::new()
        .with(
            "s/f.pfm",
            floats(3, 2, |x, y| [x as f32 * 0.1, y as f32, 0.5]),
        )
        .with("s/b.png", bytes_of_a_row(&[[0, 188, 255], [51, 51, 51]]));
    let texture = |name: &str, inside: &str| {
        format!(
            "<texture type=\"bitmap\" name=\"{name}\"><string name=\"filename\" {inside}</texture>"
        )
    };
    let float = texture("reflectance", "value=\"f.pfm\"/>");
    let options = "value=\"b.png\"/><string name=\"wrap_mode\" value=\"clamp\"/><string name=\"filter_type\" value=\"nearest\"/>\
        <transform name=\"to_uv\"><scale value=\"2\"/></transform>";
    let decoded = texture("reflectance", options);
    let raw = texture(
        "alpha",
        "value=\"b.png\"/><boolean name=\"raw\" value=\"true\"/>",
    );
    let shape = |bsdf: String| {
        format!(
            "<shape type=\"rectangle\" id=\"{}\">{bsdf}</shape>",
            bsdf.len()
        )
    };
    let inside = [
        shape(format!("<bsdf type=\"diffuse\">{float}</bsdf>")),
        shape(format!("<bsdf type=\"diffuse\">{decoded}</bsdf>")),
        shape(format!("<bsdf type=\"roughconductor\">{raw}</bsdf>")),
    ];
    let scene = with_files(&format!("{}{SENSOR}", inside.concat()), files, &[]);
    let [float, decoded] =
        [0, 1].map(|m: usize| &scene.textures[scene.materials[m].bsdf.colour().unwrap()]);
    // Row by row from the top.
    assert_eq!(float.texels[1], [0.1, 0.0, 0.5]);
    assert_eq!(float.texels[3], [0.0, 1.0, 0.5]);
    assert_eq!(
        float.layout,
        Layout::Bitmap {
            width: 3,
            height: 2,
            wrap: Wrap::Repeat,
            bilinear: true,
            to_uv: Affine2::IDENTITY
        }
    );
    assert_eq!(
        decoded.layout,
        Layout::Bitmap {
            width: 2,
            height: 1,
            wrap: Wrap::Clamp,
            bilinear: false,
            to_uv: Affine2::from_scale(Vec2::splat(2.0))
        }
    );
    let [r, g, b] = decoded.texels[0];
    assert!(r == 0.0 && (g - 0.502_886).abs() < 1e-5 && b == 1.0, "{g}");
    // As a number: the luminance of what is stored, with Mitsuba's weights.
    let alpha = scene.materials[2]
        .bsdf
        .slots()
        .into_iter()
        .find(|s| s.0 == "alpha");
    let alpha = &scene.textures[alpha.unwrap().1];
    assert_eq!((alpha.channels, alpha.texels[1]), (1, [0.2; 3]));
    let luminance = 0.715_160 * 188.0 / 255.0 + 0.072_169;
    assert!((alpha.texels[0][0] - luminance).abs() < 1e-6);
    let keys = warpath::scene::parameters::list(&scene);
    let data = keys
        .iter()
        .find(|p| p.key.ends_with("reflectance.data"))
        .unwrap();
    assert_eq!(data.shape, [2, 3, 3]);
    let data = keys.iter().find(|p| p.key.ends_with("alpha.data")).unwrap();
    assert_eq!(data.shape, [1, 2, 1]);
}

#[test]
fn environment_maps_turn_and_scale() {
    let files = Memory::new().with("s/sky.pfm", floats(4, 3, |x, y| [x as f32, y as f32, 7.0]));
    let sky = "<emitter type=\"envmap\" id=\"sky\"><string name=\"filename\" value=\"sky.pfm\"/><float name=\"scale\" value=\"2\"/>\
        <transform name=\"to_world\"><rotate x=\"1\" angle=\"90\"/><translate x=\"9\"/></transform></emitter>";
    let scene = with_files(&format!("{sky}{SENSOR}"), files.clone(), &[]);
    let environment = scene.environment.as_ref().unwrap();
    let map = environment.map.unwrap();
    assert_eq!(map.scale, 2.0);
    assert!((map.to_world * Vec3::Y - Vec3::Z).length() < 1e-6);
    let texture = &scene.textures[environment.radiance];
    assert_eq!(
        (texture.key.as_str(), texture.texels[5]),
        ("sky", [1.0, 1.0, 7.0])
    );
    let keys = warpath::scene::parameters::list(&scene);
    let keys: Vec<&str> = keys.iter().map(|p| p.key.as_str()).take(3).collect();
    assert_eq!(keys, ["sky.data", "sky.scale", "sky.rotation"]);
    let hash = |sky: &str| with_files(&format!("{sky}{SENSOR}"), files.clone(), &[]).hash;
    let other = Memory::new().with("s/sky.pfm", floats(4, 3, |_, _| [0.0; 3]));
    assert_ne!(
        hash(sky),
        with_files(&format!("{sky}{SENSOR}"), other, &[]).hash
    );
}

/// Mitsuba's RGB mode takes one value of an emitter's `spectrum` for equal energy at all wavelengths, which is reddish in
/// sRGB; other slots take it for grey (checked with `mi.traverse` of Mitsuba 3.9.1).
#[test]
fn spectra_of_emitters_are_no_greys() {
    let value = |inside: &str, key: &str| {
        let scene = scene(inside);
        let texture = scene.textures.iter().find(|t| t.key.ends_with(key));
        texture.expect("a texture").texels[0]
    };
    let spectrum = |name: &str| format!("<spectrum name=\"{name}\" value=\"3\"/>");
    let reddish = [3.614_381_8, 2.844_873, 2.726_748];
    for (emitter, key) in [
        ("<emitter type=\"constant\">RADIANCE</emitter>", "radiance"),
        (
            "<shape type=\"rectangle\"><emitter type=\"area\">RADIANCE</emitter></shape>",
            "radiance",
        ),
        ("<emitter type=\"point\">INTENSITY</emitter>", "intensity"),
        (
            "<emitter type=\"directional\">IRRADIANCE</emitter>",
            "irradiance",
        ),
    ] {
        let emitter = emitter.replace(&key.to_uppercase(), &spectrum(key));
        let got = value(&emitter, key);
        let apart = (Vec3::from(got) - Vec3::from(reddish)).abs().max_element();
        assert!(apart < 1e-5, "{emitter}: {got:?}");
    }
    let body = "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"0.5\"/></bsdf></shape>";
    assert_eq!(value(body, "reflectance"), [0.5; 3]);
    let checks = "<shape type=\"rectangle\"><emitter type=\"area\"><texture name=\"radiance\" type=\"checkerboard\">\
        <spectrum name=\"color0\" value=\"3\"/></texture></emitter></shape>";
    assert_eq!(value(checks, "radiance"), [3.0; 3]);
}
