//! Texture coordinates and pictures.

use super::{SENSOR, floats, scene, with_files};
use glam::{Affine2, Vec2, Vec3};
use warpath::scene::source::Memory;
use warpath::scene::{Layout, Scene, Wrap};

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
