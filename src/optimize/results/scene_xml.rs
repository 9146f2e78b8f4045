//! A scene as Mitsuba 3 XML, with its meshes and textures beside it: `render`, `optimize` and
//! Mitsuba read it.
//!
//! Everything is written as it stands, in world space: includes, defines, defaults and transforms
//! of the file that was read are gone. What one shape alone has stands inside it, so that
//! parameters keep their keys.

use super::meshes;
use super::surface_xml::Surfaces;
use super::text::{escaped, joined, plain};
use crate::jobs::failure::Failure;
use crate::output::atomic;
use crate::scene::{
    BeamProfile, DeltaLight, DeltaLightKind, Filter, Lens, Mesh, Normals, Scene, Sensor, Texture,
};
use glam::{Mat3, Mat4, Vec2};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// Writes `scene.xml` into a folder, and `scene/` with meshes and textures. Returns the names of
/// what was written.
pub fn write(directory: &Path, scene: &Scene) -> Result<Vec<String>, Failure> {
    let parts = directory.join("scene");
    atomic::prepare_directory(&parts)?;
    let mut files = Vec::new();
    let mut surfaces = Surfaces::new(scene, &parts);
    let mut text = String::from("<scene version=\"3.0.0\">\n");
    integrator(scene, &mut text);
    for sensor in &scene.sensors {
        self::sensor(sensor, &mut text);
    }
    let owned = |m: usize| {
        let key = &scene.materials[m].key;
        scene
            .meshes
            .iter()
            .any(|mesh| *key == format!("{}.bsdf", mesh.id))
    };
    // What masks and blends are made of stands inside them.
    let is_used = |m: usize| scene.meshes.iter().any(|mesh| mesh.material == m);
    for m in (0..scene.materials.len()).filter(|&m| is_used(m) && !owned(m)) {
        surfaces.material(m, Some(&scene.materials[m].key), "  ", &mut text)?;
    }
    for (number, mesh) in scene.meshes.iter().enumerate() {
        let name = format!("{number:03}-{}.ply", plain(&mesh.id));
        meshes::ply(&parts.join(&name), mesh, &attributes(scene, mesh))?;
        files.push(format!("scene/{name}"));
        let _ = writeln!(text, "  <shape type=\"ply\" id=\"{}\">", escaped(&mesh.id));
        let _ = writeln!(
            text,
            "    <string name=\"filename\" value=\"scene/{name}\"/>"
        );
        if matches!(mesh.normals, Normals::Flat) {
            text.push_str("    <boolean name=\"face_normals\" value=\"true\"/>\n");
        }
        match owned(mesh.material) {
            true => surfaces.material(mesh.material, None, "    ", &mut text)?,
            false => {
                let key = escaped(&scene.materials[mesh.material].key);
                let _ = writeln!(text, "    <ref id=\"{key}\"/>");
            }
        }
        if let Some(light) = mesh.area_light {
            text.push_str("    <emitter type=\"area\">\n");
            let radiance = scene.area_lights[light].radiance;
            surfaces.slot("radiance", radiance, "      ", &mut text)?;
            text.push_str("    </emitter>\n");
        }
        text.push_str("  </shape>\n");
    }
    lights(scene, &mut surfaces, &mut text)?;
    text.push_str("</scene>\n");
    files.extend(surfaces.files);
    atomic::write(&directory.join("scene.xml"), |file| {
        file.write_all(text.as_bytes())
    })?;
    files.insert(0, "scene.xml".into());
    Ok(files)
}

/// The attributes of a mesh that its material and its light ask for.
pub fn attributes<'a>(scene: &'a Scene, mesh: &Mesh) -> Vec<&'a Texture> {
    let light = mesh
        .area_light
        .map(|light| scene.area_lights[light].radiance);
    let of_parts = scene.parts_of(mesh.material).into_iter();
    let textures = of_parts.flat_map(|m| scene.textures_of(m));
    let mut found: Vec<usize> = textures.chain(light).collect();
    found.sort_unstable();
    found.dedup();
    let found = found.into_iter().map(|t| &scene.textures[t]);
    found.filter(|t| t.attribute().is_some()).collect()
}

fn integrator(scene: &Scene, text: &mut String) {
    let integrator = scene.integrator;
    let depth = match integrator.max_depth {
        u32::MAX => -1,
        depth => i64::from(depth),
    };
    let rr_depth = integrator.rr_depth.min(i32::MAX as u32);
    let _ = writeln!(
        text,
        "  <integrator type=\"path\"><integer name=\"max_depth\" value=\"{depth}\"/><integer name=\"rr_depth\" \
         value=\"{rr_depth}\"/><boolean name=\"hide_emitters\" value=\"{}\"/></integrator>",
        integrator.hide_emitters
    );
}

fn sensor(sensor: &Sensor, text: &mut String) {
    let film = &sensor.film;
    let filter = match film.filter {
        Filter::Box { .. } => "<rfilter type=\"box\"/>".to_string(),
        Filter::Tent { radius } => {
            format!("<rfilter type=\"tent\"><float name=\"radius\" value=\"{radius}\"/></rfilter>")
        }
        Filter::Gaussian { stddev } => {
            format!(
                "<rfilter type=\"gaussian\"><float name=\"stddev\" value=\"{stddev}\"/></rfilter>"
            )
        }
    };
    let offset = sensor.principal_point_offset;
    let fov_deg = f64::from(sensor.x_fov_rad).to_degrees();
    let seen = [
        ("fov", fov_deg),
        ("principal_point_offset_x", offset.x.into()),
        ("principal_point_offset_y", offset.y.into()),
    ];
    let (plugin, own, scale) = match sensor.lens {
        Lens::Pinhole => ("perspective", seen.to_vec(), Vec2::ONE),
        Lens::Thin {
            aperture_radius,
            focus_distance,
        } => {
            let lens = [
                ("aperture_radius", aperture_radius.into()),
                ("focus_distance", focus_distance.into()),
            ];
            ("thinlens", [&seen[..], &lens].concat(), Vec2::ONE)
        }
        Lens::Parallel { half_sides } => ("orthographic", Vec::new(), half_sides),
    };
    let _ = writeln!(
        text,
        "  <sensor type=\"{plugin}\" id=\"{}\">",
        escaped(&sensor.id)
    );
    if plugin != "orthographic" {
        text.push_str("    <string name=\"fov_axis\" value=\"x\"/>\n");
    }
    let clips = [
        ("near_clip", sensor.near_clip.into()),
        ("far_clip", sensor.far_clip.into()),
    ];
    for (name, value) in own.into_iter().chain(clips) {
        let _ = writeln!(text, "    <float name=\"{name}\" value=\"{value}\"/>");
    }
    let to_world = glam::Mat4::from(sensor.to_world);
    let rows = (to_world * glam::Mat4::from_scale(scale.extend(1.0))).transpose();
    let _ = writeln!(
        text,
        "    <transform name=\"to_world\"><matrix value=\"{}\"/></transform>",
        joined(&rows.to_cols_array())
    );
    let _ = writeln!(
        text,
        "    <sampler type=\"independent\"><integer name=\"sample_count\" value=\"{}\"/><integer name=\"seed\" \
         value=\"{}\"/></sampler>\n    <film type=\"hdrfilm\">",
        sensor.sample_count, sensor.seed
    );
    let sides = [
        ("width", film.width),
        ("height", film.height),
        ("crop_offset_x", film.crop_offset[0]),
        ("crop_offset_y", film.crop_offset[1]),
        ("crop_width", film.crop_size[0]),
        ("crop_height", film.crop_size[1]),
    ];
    for (name, value) in sides {
        let _ = writeln!(text, "      <integer name=\"{name}\" value=\"{value}\"/>");
    }
    let _ = writeln!(
        text,
        "      {filter}<boolean name=\"sample_border\" value=\"{}\"/>\n    </film>\n  </sensor>",
        film.sample_border
    );
}

fn lights(scene: &Scene, surfaces: &mut Surfaces, text: &mut String) -> Result<(), Failure> {
    for light in &scene.delta_lights {
        if light.beam.is_some() {
            beam(light, surfaces, text)?;
            continue;
        }
        let (plugin, place, v, power) = match light.kind {
            DeltaLightKind::Point { position } => ("point", "position", position, "intensity"),
            DeltaLightKind::Directional { direction } => {
                ("directional", "direction", direction, "irradiance")
            }
        };
        let _ = writeln!(
            text,
            "  <emitter type=\"{plugin}\" id=\"{}\">",
            escaped(&light.key)
        );
        let tag = if plugin == "point" { "point" } else { "vector" };
        let _ = writeln!(
            text,
            "    <{tag} name=\"{place}\" value=\"{}\"/>",
            joined(&v.to_array())
        );
        surfaces.slot(power, light.power, "    ", text)?;
        text.push_str("  </emitter>\n");
    }
    if let Some(environment) = &scene.environment {
        let key = escaped(&environment.key);
        match &environment.map {
            None => {
                let _ = writeln!(text, "  <emitter type=\"constant\" id=\"{key}\">");
                surfaces.slot("radiance", environment.radiance, "    ", text)?;
            }
            Some(map) => {
                let name = surfaces.picture(environment.radiance)?;
                let rows = glam::Mat4::from_mat3(map.to_world).transpose();
                let _ = writeln!(
                    text,
                    "  <emitter type=\"envmap\" id=\"{key}\">\n    <string name=\"filename\" value=\"{name}\"/>\n    \
                     <float name=\"scale\" value=\"{}\"/>\n    <transform name=\"to_world\"><matrix value=\"{}\"/></transform>",
                    map.scale,
                    joined(&rows.to_cols_array())
                );
            }
        }
        text.push_str("  </emitter>\n");
    }
    Ok(())
}

/// A point that shines differently into different directions.
fn beam(light: &DeltaLight, surfaces: &mut Surfaces, text: &mut String) -> Result<(), Failure> {
    let (Some(beam), DeltaLightKind::Point { position }) = (&light.beam, light.kind) else {
        return Ok(());
    };
    let key = escaped(&light.key);
    let place = |to_world: Mat3, text: &mut String| {
        let rows = Mat4::from_translation(position) * Mat4::from_mat3(to_world);
        let _ = writeln!(
            text,
            "    <transform name=\"to_world\"><matrix value=\"{}\"/></transform>",
            joined(&rows.transpose().to_cols_array())
        );
    };
    match beam.profile {
        BeamProfile::Spot {
            beam_width_rad,
            cutoff_rad,
            texture,
        } => {
            let _ = writeln!(text, "  <emitter type=\"spot\" id=\"{key}\">");
            place(beam.to_local.inverse(), text);
            for (name, rad) in [("cutoff_angle", cutoff_rad), ("beam_width", beam_width_rad)] {
                let value = f64::from(rad).to_degrees();
                let _ = writeln!(text, "    <float name=\"{name}\" value=\"{value}\"/>");
            }
            surfaces.slot("intensity", light.power, "    ", text)?;
            if let Some(texture) = texture {
                surfaces.slot("texture", texture, "    ", text)?;
            }
        }
        BeamProfile::Projector {
            half_tangents,
            scale,
            ..
        } => {
            let _ = writeln!(text, "  <emitter type=\"projector\" id=\"{key}\">");
            place(beam.to_local.inverse(), text);
            let fov = f64::from(half_tangents.x).atan().to_degrees() * 2.0;
            let _ = writeln!(
                text,
                "    <string name=\"fov_axis\" value=\"x\"/>\n    <float name=\"fov\" value=\"{fov}\"/>\n    \
                 <float name=\"scale\" value=\"{scale}\"/>"
            );
            surfaces.slot("irradiance", light.power, "    ", text)?;
        }
    }
    text.push_str("  </emitter>\n");
    Ok(())
}
