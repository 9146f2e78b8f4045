//! Which properties each plugin reads.

use super::xml::Object;

/// The properties that a plugin reads, for hints.
pub(super) fn properties_of(object: &Object) -> &'static [&'static str] {
    match (object.tag, object.plugin.as_str()) {
        ("integrator", "aov" | "moment") => &["aovs"],
        ("integrator", plugin) if plugin.starts_with("direct") => &["rr_depth", "hide_emitters"],
        ("integrator", _) => &["max_depth", "rr_depth", "hide_emitters"],
        ("sensor", _) => &[
            "fov",
            "fov_axis",
            "focal_length",
            "to_world",
            "near_clip",
            "far_clip",
            "principal_point_offset_x",
            "principal_point_offset_y",
        ],
        ("film", _) => &[
            "width",
            "height",
            "crop_offset_x",
            "crop_offset_y",
            "crop_width",
            "crop_height",
            "sample_border",
            "pixel_format",
            "component_format",
            "file_format",
        ],
        ("sampler", _) => &["sample_count", "seed"],
        ("rfilter", "tent") => &["radius"],
        ("rfilter", "gaussian") => &["stddev"],
        ("shape", plugin) => properties_of_shape(plugin),
        ("bsdf", plugin) => properties_of_bsdf(plugin),
        ("texture", "mesh_attribute") => &["name", "scale"],
        ("texture", "bitmap") => &["filename", "raw", "wrap_mode", "filter_type", "to_uv"],
        ("texture", _) => &["color0", "color1", "to_uv"],
        ("emitter", "envmap") => &["filename", "scale", "to_world"],
        ("emitter", "point") => &["position", "intensity", "to_world"],
        ("emitter", "directional") => &["direction", "irradiance", "to_world"],
        ("emitter", _) => &["radiance"],
        _ => &[],
    }
}

fn properties_of_shape(plugin: &str) -> &'static [&'static str] {
    match plugin {
        "ply" | "obj" => &[
            "filename",
            "face_normals",
            "flip_normals",
            "flip_tex_coords",
            "to_world",
        ],
        "serialized" => &[
            "filename",
            "shape_index",
            "face_normals",
            "flip_normals",
            "flip_tex_coords",
            "to_world",
        ],
        "cylinder" => &["p0", "p1", "radius", "flip_normals", "to_world"],
        "sphere" => &[
            "center",
            "radius",
            "face_normals",
            "flip_normals",
            "to_world",
        ],
        _ => &["flip_normals", "to_world"],
    }
}

fn properties_of_bsdf(plugin: &str) -> &'static [&'static str] {
    match plugin {
        "diffuse" => &["reflectance"],
        "mask" => &["opacity"],
        "normalmap" => &[
            "normalmap",
            "flip_invalid_normals",
            "use_shadowing_function",
        ],
        "bumpmap" => &["scale", "flip_invalid_normals", "use_shadowing_function"],
        "principled" => &[
            "base_color",
            "roughness",
            "anisotropic",
            "metallic",
            "spec_trans",
            "eta",
            "specular",
            "spec_tint",
            "sheen",
            "sheen_tint",
            "flatness",
            "clearcoat",
            "clearcoat_gloss",
        ],
        "blendbsdf" => &["weight"],
        "conductor" => &["material", "eta", "k", "specular_reflectance"],
        "roughconductor" => &[
            "material",
            "eta",
            "k",
            "specular_reflectance",
            "distribution",
            "alpha",
            "alpha_u",
            "alpha_v",
        ],
        "dielectric" | "thindielectric" => &[
            "int_ior",
            "ext_ior",
            "specular_reflectance",
            "specular_transmittance",
        ],
        "roughdielectric" => &[
            "int_ior",
            "ext_ior",
            "specular_reflectance",
            "specular_transmittance",
            "distribution",
            "alpha",
            "alpha_u",
            "alpha_v",
        ],
        "plastic" | "roughplastic" => &[
            "int_ior",
            "ext_ior",
            "diffuse_reflectance",
            "specular_reflectance",
            "nonlinear",
            "distribution",
            "alpha",
        ],
        _ => &[],
    }
}
