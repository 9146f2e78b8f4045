//! Integrators, by the names that Mitsuba 3 knows them by. All that make an image of surfaces make
//! the same one in the mean.

use super::camera::{cannot_stand_inside, no_children};
use super::data::Integrator;
use super::error::SceneError;
use super::xml::{Object, Tree};

/// The `path` that Mitsuba uses when a scene has no integrator.
pub(super) const DEFAULT_INTEGRATOR: Integrator = Integrator {
    max_depth: u32::MAX,
    rr_depth: 5,
    hide_emitters: false,
};

/// What an integrator says of the image, and remarks on what it would do besides.
pub(super) fn integrator(
    tree: &Tree,
    object: &Object,
    remarks: &mut Vec<String>,
) -> Result<Integrator, SceneError> {
    let mut remark =
        |what: &str| remarks.push(format!("{}: {} {what}", object.place, object.shown()));
    // How work is cut into pieces changes no image.
    object.integer("samples_per_pass")?;
    object.integer("block_size")?;
    if object.plugin == "direct" {
        // How often each of two ways to find light is gone changes no mean, while both are.
        for name in ["shading_samples", "emitter_samples", "bsdf_samples"] {
            object.count(name, 1, 0)?;
        }
    }
    match object.plugin.as_str() {
        "aov" | "moment" => {
            remark("gives the image of the integrator inside it, and nothing else");
            object.string("aovs")?;
            return integrator(tree, inner(tree, object)?, remarks);
        }
        "ptracer" | "volpath" | "volpathmis" | "prbvolpath" => {
            remark("renders as \"path\", which has the same image: there are no media here");
        }
        _ => {}
    }
    no_children(tree, object)?;
    Ok(Integrator {
        max_depth: max_depth(object)?,
        rr_depth: object.count("rr_depth", 5, 1)?,
        hide_emitters: object.boolean("hide_emitters", false)?,
    })
}

/// The integrator inside another.
fn inner<'a>(tree: &'a Tree, object: &Object) -> Result<&'a Object, SceneError> {
    let mut found = None;
    for child in &object.children {
        let inner = &tree.objects[child.object];
        if inner.tag != "integrator" {
            return Err(cannot_stand_inside(child, inner, object));
        }
        if found.replace(inner).is_some() {
            let what = format!("give {} one integrator", object.shown());
            return Err(SceneError::at(&child.place, what));
        }
    }
    found.ok_or_else(|| {
        let what = format!(
            "{} has no integrator inside, such as <integrator type=\"path\"/>: there is no image to make",
            object.shown()
        );
        object.error(what)
    })
}

fn max_depth(object: &Object) -> Result<u32, SceneError> {
    // "direct" is a path tracer of two segments; it has no max_depth of its own.
    if object.plugin.starts_with("direct") {
        return Ok(2);
    }
    let default = if object.plugin.starts_with("prb") {
        6
    } else {
        -1
    };
    match object.integer("max_depth")?.unwrap_or(default) {
        -1 => Ok(u32::MAX),
        depth => u32::try_from(depth).map_err(|_| {
            let what = format!("\"max_depth\" must be -1 (no limit) or at least 0, not {depth}");
            object.property_error("max_depth", what)
        }),
    }
}
