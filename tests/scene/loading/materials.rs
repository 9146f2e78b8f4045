//! Materials and who shares them.

use super::{SENSOR, colour, scene, with_files};
use glam::Vec2;
use warpath::scene::source::Memory;
use warpath::scene::{Bsdf, Distribution, Layout, Microfacets, Scene, load_from};

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

/// Colours of spectra are those of Mitsuba 3.9.1 (its `mi.traverse`).
#[test]
fn spectra_are_colours() {
    let inside = "<shape type=\"sphere\"><bsdf type=\"diffuse\"><spectrum name=\"reflectance\" value=\"400:.1,700:.5\"/></bsdf></shape>\
                  <shape type=\"sphere\"><bsdf type=\"diffuse\"><spectrum name=\"reflectance\" filename=\"x.spd\"/></bsdf></shape>\
                  <shape type=\"sphere\"><emitter type=\"area\"><spectrum name=\"radiance\" value=\"400:.1 700:.5\"/></emitter></shape>";
    let files = Memory::new().with("s/x.spd", "# nm\n400 0.1\n700 0.5\n");
    let scene = with_files(&format!("{inside}{SENSOR}"), files, &[]);
    let reflectances = [0, 1].map(|mesh: usize| colour(&scene, scene.meshes[mesh].material));
    let emission = scene.constant(scene.area_lights[0].radiance);
    let expected = [
        (reflectances[0], [0.421_193_5, 0.290_557_86, 0.153_907_73]),
        (reflectances[1], [0.421_193_5, 0.290_557_86, 0.153_907_73]),
        (emission, [0.496_092_1, 0.276_840_27, 0.135_822_86]),
    ];
    for (ours, mitsubas) in expected {
        for (a, b) in ours.into_iter().zip(mitsubas) {
            assert!((a - b).abs() < 1e-6, "{ours:?}, not {mitsubas:?}");
        }
    }
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
        microfacets:
            Some(Microfacets {
                distribution,
                alpha,
                ..
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
        let rough = metal.slots().into_iter().find(|s| s.0.starts_with("alpha"));
        scene.constant(rough.expect("a rough metal").1)[0]
    };
    assert_eq!(alpha("<float name=\"alpha\" value=\"0\"/>"), 1e-4);
    assert_eq!(alpha("<spectrum name=\"alpha\" value=\"0.3\"/>"), 0.3);
    let both = "<float name=\"alpha_u\" value=\"0.25\"/><float name=\"alpha_v\" value=\"0.25\"/>";
    assert_eq!(alpha(both), 0.25);
    let (scene, metal) = bsdf(
        "roughconductor",
        &both.replace("_v\" value=\"0.25", "_v\" value=\"0"),
    );
    let across = metal.slots().into_iter().find(|s| s.0 == "alpha_v");
    assert_eq!(
        scene.constant(across.expect("a brushed metal").1),
        [1e-4; 3]
    );
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

/// Keys are those of Mitsuba 3.9.1 (its `mi.traverse`).
#[test]
fn mixtures_and_layers_have_mitsubas_keys() {
    let scene = scene(
        "<bsdf type=\"mask\" id=\"leaf\"><float name=\"opacity\" value=\"0.25\"/>\
           <bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf></bsdf>\
         <bsdf type=\"blendbsdf\" id=\"mix\"><float name=\"weight\" value=\"0.75\"/>\
           <bsdf type=\"diffuse\"/><bsdf type=\"roughconductor\"/></bsdf>\
         <bsdf type=\"principled\" id=\"paint\"><float name=\"eta\" value=\"1.4\"/>\
           <float name=\"anisotropic\" value=\"0.5\"/></bsdf>\
         <bsdf type=\"normalmap\" id=\"relief\"><rgb name=\"normalmap\" value=\"0.5 0.5 1\"/>\
           <bsdf type=\"plastic\"/></bsdf>\
         <bsdf type=\"twosided\" id=\"two\"><bsdf type=\"twosided\">\
           <bsdf type=\"diffuse\"/></bsdf></bsdf>\
         <shape type=\"cube\" id=\"box\"><ref id=\"leaf\"/></shape>",
    );
    let find = |key: &str| warpath::scene::parameters::find(&scene, key).map(|p| p.key);
    for key in [
        "leaf.opacity.value",
        "leaf.nested_bsdf.brdf_0.reflectance.value",
        "two.brdf_0.brdf_0.reflectance.value",
        "mix.weight.value",
        "mix.bsdf_0.reflectance.value",
        "mix.bsdf_1.eta.value",
        "paint.base_color.value",
        "paint.eta",
        "paint.clearcoat_gloss.value",
        "relief.normalmap.value",
        "relief.nested_bsdf.diffuse_reflectance.value",
    ] {
        assert_eq!(find(key).expect("a parameter"), key);
    }
    let alias = find("box.bsdf.nested_bsdf.reflectance.value").expect("an alias");
    assert_eq!(alias, "leaf.nested_bsdf.brdf_0.reflectance.value");
    let refused = find("paint.spec_trans.value").expect_err("it lets no light through");
    assert!(
        refused.to_string().contains("lets no light through"),
        "{refused}"
    );
    let leaf = scene.meshes[0].material;
    assert!(scene.passes_straight_on(leaf));
    assert_eq!(scene.parts_of(leaf).len(), 2);
}

/// Faces without area are left out with what belongs to them. What nobody asks for may be anything.
#[test]
fn faces_bring_numbers_and_colours() {
    let file = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
                property float my_weight_0\nelement face 3\nproperty list uchar int vertex_indices\nproperty float r\n\
                property float g\nproperty float b\nproperty float rough_0\nproperty float two_0\nproperty float two_1\n\
                property float odd_0\n\
                end_header\n0 0 0 0.1\n1 0 0 0.2\n0 1 0 0.3\n1 1 0 0.4\n\
                3 0 1 2 0.1 0.2 0.3 0.4 0 0 1\n3 0 0 2 0.5 0.5 0.5 0.5 0 0 1\n3 1 3 2 0.6 0.7 0.8 0.9 0 0 nan\n";
    let files = || Memory::new().with("s/a.ply", file);
    let shape = |alpha: &str| {
        format!(
            "<shape type=\"ply\" id=\"kite\"><string name=\"filename\" value=\"a.ply\"/><bsdf type=\"roughconductor\">\
             <texture type=\"mesh_attribute\" name=\"specular_reflectance\"><string name=\"name\" value=\"face_color\"/>\
             </texture><texture type=\"mesh_attribute\" name=\"alpha\"><string name=\"name\" value=\"{alpha}\"/>\
             </texture></bsdf></shape>{SENSOR}"
        )
    };
    let scene = with_files(&shape("face_rough"), files(), &[]);
    let texture = |key: &str| {
        let mut textures = scene.textures.iter();
        textures.find(|t| t.key == key).expect("a texture")
    };
    let colour = texture("kite.face_color");
    assert_eq!(colour.layout, Layout::Faces);
    assert_eq!(colour.texels, [[0.1, 0.2, 0.3], [0.6, 0.7, 0.8]]);
    assert_eq!(texture("kite.face_rough").texels, [[0.4; 3], [0.9; 3]]);
    let found = warpath::scene::parameters::find(&scene, "kite.face_rough");
    assert_eq!(found.expect("numbers").shape, [2, 1]);
    let scene = with_files(&shape("vertex_my_weight"), files(), &[]);
    let weights = scene
        .textures
        .iter()
        .find(|t| t.key == "kite.vertex_my_weight");
    assert_eq!(weights.expect("numbers").texels.len(), 4);
    for (name, message) in [
        ("face_odd", "not finite"),
        ("face_two", "\"face_color\", \"face_rough\""),
        ("face_color", "three numbers where one number"),
    ] {
        let text = format!("<scene version=\"3.0.0\">\n{}</scene>", shape(name));
        let files = files().with("s/s.xml", text);
        let error = load_from(&files, "s/s.xml", &[]).expect_err("refused");
        let error = error.to_string();
        assert!(error.contains(message), "{error}");
    }
}

/// Colours are as the file has them, and bytes are no fractions, as in Mitsuba.
#[test]
fn vertices_bring_colours() {
    let ply = |colour: &str, kind: &str, [red, green, blue]: [&str; 3]| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
             property {kind} {red}\nproperty {kind} {green}\nproperty {kind} {blue}\nelement face 1\n\
             property list uchar int vertex_indices\nend_header\n0 0 0 {colour}\n1 0 0 {colour}\n0 1 0 {colour}\n3 0 1 2\n"
        )
    };
    let shape = |id: &str, scale: &str| {
        format!(
            "<shape type=\"ply\" id=\"{id}\"><string name=\"filename\" value=\"a.ply\"/><bsdf type=\"diffuse\">\
             <texture type=\"mesh_attribute\" name=\"reflectance\"><string name=\"name\" value=\"vertex_color\"/>\
             <float name=\"scale\" value=\"{scale}\"/></texture></bsdf></shape>{SENSOR}"
        )
    };
    let files = Memory::new().with(
        "s/a.ply",
        ply("51 102 255", "uchar", ["red", "green", "blue"]).as_str(),
    );
    let scene = with_files(&shape("kite", "0.00390625"), files, &[]);
    let texture = &scene.textures[scene.materials[0].bsdf.textures()[0]];
    assert_eq!(texture.layout, Layout::Vertices);
    assert_eq!(
        texture.texels,
        [[51.0 / 256.0, 102.0 / 256.0, 255.0 / 256.0]; 3]
    );
    assert_eq!(texture.key, "kite.vertex_color");
    let found = warpath::scene::parameters::find(&scene, "kite.bsdf.reflectance");
    assert_eq!(found.expect("colours").shape, [3, 3]);

    let numbered = ply("0.25 0.5 1", "float", ["color_0", "color_1", "color_2"]);
    let files = Memory::new().with("s/a.ply", numbered.as_str());
    let scene = with_files(&shape("kite", "1"), files, &[]);
    let texture = &scene.textures[scene.materials[0].bsdf.textures()[0]];
    assert_eq!(texture.texels, [[0.25, 0.5, 1.0]; 3]);
}
