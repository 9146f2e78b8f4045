//! Which plugins are known.

use super::unsupported::instead_of;
use crate::scene::nearest::{known_hint, shown};

/// Elements that make an object, with the plugins that each tag supports.
const KNOWN: &[(&str, &[&str])] = &[
    ("scene", &["scene"]),
    (
        "integrator",
        &[
            "path",
            "direct",
            "prb",
            "prb_basic",
            "prb_projective",
            "prb_reparam",
            "prbvolpath",
            "direct_projective",
            "direct_reparam",
            "volpath",
            "volpathmis",
            "ptracer",
            "aov",
            "moment",
        ],
    ),
    ("sensor", &["perspective", "thinlens", "orthographic"]),
    ("film", &["hdrfilm"]),
    ("rfilter", &["box", "tent", "gaussian"]),
    (
        "sampler",
        &[
            "independent",
            "stratified",
            "multijitter",
            "orthogonal",
            "ldsampler",
        ],
    ),
    (
        "shape",
        &[
            "ply",
            "obj",
            "serialized",
            "rectangle",
            "cube",
            "sphere",
            "disk",
            "cylinder",
            "shapegroup",
            "instance",
        ],
    ),
    (
        "bsdf",
        &[
            "diffuse",
            "twosided",
            "conductor",
            "roughconductor",
            "dielectric",
            "roughdielectric",
            "plastic",
            "roughplastic",
            "null",
            "mask",
            "thindielectric",
            "principled",
            "normalmap",
            "bumpmap",
            "blendbsdf",
        ],
    ),
    (
        "emitter",
        &[
            "area",
            "constant",
            "envmap",
            "point",
            "directional",
            "spot",
            "projector",
        ],
    ),
    ("texture", &["bitmap", "checkerboard", "mesh_attribute"]),
    ("medium", &[]),
    ("phase", &[]),
    ("volume", &[]),
    ("spectrum", &[]),
];

/// Elements that are properties, transforms or about the file.
pub(super) const OTHER_TAGS: &[&str] = &[
    "boolean",
    "integer",
    "float",
    "string",
    "rgb",
    "srgb",
    "spectrum",
    "point",
    "vector",
    "transform",
    "default",
    "include",
    "path",
    "ref",
];

/// The static name of an object's tag, if `tag` is one.
pub(super) fn object_tag(tag: &str) -> Option<&'static str> {
    KNOWN.iter().map(|k| k.0).find(|t| *t == tag)
}

/// Every tag that can stand inside an object.
pub(super) fn all_tags() -> impl Iterator<Item = &'static str> {
    KNOWN.iter().map(|k| k.0).chain(OTHER_TAGS.iter().copied())
}

/// Whether `<tag type="plugin">` can be loaded; the error is a sentence.
pub(super) fn check(tag: &str, plugin: &str) -> Result<(), String> {
    let Some((_, supported)) = KNOWN.iter().find(|k| k.0 == tag) else {
        return Err(format!("unknown element <{}>", shown(tag)));
    };
    // The many variants of path replay backpropagation differ in gradients only, not in the image.
    let any_prb = tag == "integrator" && plugin.starts_with("prb");
    if supported.contains(&plugin) || any_prb {
        return Ok(());
    }
    let shown = format!("<{tag} type=\"{}\"> is not supported", shown(plugin));
    if let Some(instead) = instead_of(tag, plugin) {
        return Err(format!("{shown}: {instead}"));
    }
    let hint = known_hint(plugin, supported.iter().copied());
    Err(format!("{shown}{hint}"))
}
