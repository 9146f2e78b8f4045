//! Parameters of one scene with everything in it.

mod differences;
mod keys;
mod setting;

use super::*;
use crate::scene::data::{EnvironmentMap, Layout, Scene, Wrap};
use crate::scene::load_from;
use crate::scene::source::Memory;

const PLY_WITH_NORMALS: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nproperty float nx\nproperty float ny\nproperty float nz\nelement face 2\n\
    property list uchar int vertex_indices\nend_header\n0 0 0 0 0 1\n1 0 0.1 0 0.6 0.8\n1 2 0 0 0 1\n\
    0 1 -0.2 0.6 0 0.8\n3 0 1 2\n3 0 2 3\n";

const PLY_PLAIN: &str = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
    property float z\nelement face 4\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n\
    0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

const SCENE: &str = r#"<scene version="3.0.0">
  <bsdf type="twosided" id="paint"><bsdf type="diffuse"><rgb name="reflectance" value="0.2 0.3 0.4"/></bsdf></bsdf>
  <sensor type="perspective" id="cam"><float name="fov" value="40"/>
    <transform name="to_world"><lookat origin="1 -4 2" target="0 0 0" up="0 0 1"/></transform></sensor>
  <sensor type="perspective"><float name="fov" value="50"/></sensor>
  <shape type="ply" id="given"><string name="filename" value="given.ply"/><ref id="paint"/>
    <transform name="to_world"><scale x="-1" y="2" z="1.5"/><translate x="0.3"/></transform></shape>
  <shape type="ply" id="computed"><string name="filename" value="plain.ply"/></shape>
  <shape type="ply"><string name="filename" value="plain.ply"/><boolean name="face_normals" value="true"/>
    <ref id="paint"/></shape>
  <shape type="rectangle" id="light"><emitter type="area"><rgb name="radiance" value="3 2 1"/></emitter></shape>
  <emitter type="constant" id="env"><rgb name="radiance" value="0.5 0.6 0.7"/></emitter>
  <emitter type="point" id="bulb"><point name="position" x="1" y="2" z="3"/></emitter>
  <emitter type="directional" id="sun"><rgb name="irradiance" value="3 2 1"/></emitter>
  <texture type="checkerboard" id="board"><rgb name="color0" value="0.1 0.2 0.3"/></texture>
  <texture type="checkerboard" id="coarse"><float name="color0" value="0.3"/><float name="color1" value="0.6"/></texture>
  <shape type="cube" id="box"><bsdf type="roughconductor" id="metal"><string name="material" value="Au"/>
    <ref id="coarse" name="alpha"/><ref id="board" name="specular_reflectance"/></bsdf></shape>
  <shape type="rectangle" id="floor"><bsdf type="twosided"><bsdf type="roughplastic">
    <ref id="board" name="diffuse_reflectance"/></bsdf></bsdf></shape>
  <shape type="cube" id="pane"><bsdf type="dielectric"/></shape>
  <shape type="cube" id="frost"><bsdf type="roughdielectric"/></shape>
  <shape type="shapegroup" id="pair"><shape type="ply" id="inner"><string name="filename" value="given.ply"/></shape>
    <shape type="cube"><transform name="to_world"><translate x="2"/></transform></shape></shape>
  <shape type="instance" id="twin"><ref id="pair"/>
    <transform name="to_world"><scale x="1.5" y="0.8"/><rotate z="1" angle="30"/><translate y="1"/></transform></shape>
  <emitter type="spot" id="torch"><transform name="to_world"><translate x="2"/></transform></emitter>
</scene>"#;

/// The loaded scene, with pictures put into it: a bitmap in place of the reflectance of `computed`,
/// a grey one with a `nearest` filter as the roughness of `frost`, and an environment map.
fn scene() -> Scene {
    let mut scene = loaded();
    let mut random = Random(3);
    let mut picture = |scene: &mut Scene, key: &str, bilinear: bool| {
        let slot = scene.textures.iter().position(|t| t.key == key);
        let texture = &mut scene.textures[slot.expect("the slot is there")];
        let grey = texture.channels == 1;
        texture.texels = (0..12)
            .map(|_| {
                let [r, g, b] = [0; 3].map(|_| 0.5 + 0.4 * random.next());
                if grey { [r; 3] } else { [r, g, b] }
            })
            .collect();
        texture.layout = Layout::Bitmap {
            width: 4,
            height: 3,
            wrap: Wrap::Repeat,
            bilinear,
            to_uv: glam::Affine2::from_scale_angle_translation(
                glam::Vec2::new(2.0, 3.0),
                0.3,
                glam::Vec2::new(0.1, 0.2),
            ),
        };
    };
    picture(&mut scene, "computed.bsdf.reflectance", true);
    picture(&mut scene, "frost.bsdf.alpha", false);
    picture(&mut scene, "env.radiance", true);
    for texture in scene
        .textures
        .iter_mut()
        .filter(|t| t.key == "env.radiance")
    {
        texture.key = "env".to_string();
    }
    if let Some(environment) = &mut scene.environment {
        environment.map = Some(EnvironmentMap {
            to_world: glam::Mat3::from_rotation_x(0.7),
            scale: 1.5,
        });
    }
    scene
}

fn loaded() -> Scene {
    let files = Memory::new()
        .with("s.xml", SCENE)
        .with("given.ply", PLY_WITH_NORMALS)
        .with("plain.ply", PLY_PLAIN);
    load_from(&files, "s.xml", &[]).expect("the test scene loads")
}

/// Numbers in −1…1 that are the same on every run.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 40) as f32 / (1u64 << 23) as f32 - 1.0
    }

    fn values(&mut self, count: usize) -> Vec<f32> {
        (0..count).map(|_| self.next()).collect()
    }
}
