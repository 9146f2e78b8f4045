//! What cannot be differentiated is refused, in words.

use super::error::EngineError;
use super::estimators::{Discontinuity, Method};
use crate::boundary::edges::intersections;
use crate::discontinuity::adjacency::Adjacency;
use crate::paths::scene_view::SceneView;
use crate::scene::{BeamProfile, Bsdf, DeltaLight, Layout, Lens, Scene, SceneDifferential, Sensor};

/// Refuses gradients that would be silently wrong: discontinuities that the method does not find.
// Long: one refusal after another.
pub fn check(
    scene: &Scene,
    request: &SceneDifferential,
    sensor: &Sensor,
    method: Method,
) -> Result<(), EngineError> {
    let refuse = |what: String| Err(EngineError::Refused(what));
    if let (Some(environment), true) = (&scene.environment, request.environment.is_some())
        && environment.map.is_some_and(|map| map.scale == 0.0)
    {
        return refuse(format!(
            "{}: a map whose scale is 0 is not sampled, so its scale and rotation have no gradient; give it a small scale",
            environment.key
        ));
    }
    let misses = |kind| method.misses(kind);
    if misses(Discontinuity::SharpShadow)
        && let Some(i) = request.delta_lights.iter().position(Option::is_some)
    {
        return refuse(sharp_shadows(&scene.delta_lights[i].key));
    }
    let light_moves = request.delta_lights.iter().any(Option::is_some);
    let moves = request.moves_geometry() || request.refraction_moves(scene) || light_moves;
    if moves && misses(Discontinuity::JumpInBeam) {
        for light in &scene.delta_lights {
            if let Some(what) = beam_edge(scene, light, misses(Discontinuity::BeamBorder)) {
                return refuse(what);
            }
        }
    }
    if !moves {
        return Ok(());
    }
    if let Some(what) = behind_a_lens(sensor, misses) {
        return refuse(what);
    }
    let used = scene.meshes.iter().flat_map(|m| scene.parts_of(m.material));
    for m in used {
        let material = &scene.materials[m];
        let key = &material.key;
        let is_null = material.bsdf == Bsdf::Null;
        let is_mask = !is_null && scene.passes_straight_on(m);
        let is_smooth = !is_null && material.bsdf.is_smooth();
        if (is_null || is_mask) && misses(Discontinuity::BehindNull) {
            return refuse(format!(
                "{key}: behind a null surface or a mask edges are not found, so gradients by what moves would be wrong; \
                 use --method reparam, or take the surface out, or make the mask opaque"
            ));
        }
        if is_layered(&material.bsdf) && misses(Discontinuity::InLayers) {
            return refuse(format!(
                "{key}: {} does not follow what is seen in rough glass, in layered materials or in brushed ones, so \
                 gradients by what moves would be wrong; use --method reparam",
                method.name()
            ));
        }
        if is_smooth && misses(Discontinuity::Mirrored) {
            return refuse(format!(
                "{key}: edges seen in perfectly smooth reflections and refractions are not found, so gradients by what \
                 moves would be wrong; use --method reparam, or its rough variant with an alpha such as 0.01"
            ));
        }
    }
    if misses(Discontinuity::SharpShadow)
        && let Some(light) = scene.delta_lights.first()
    {
        return refuse(sharp_shadows(&light.key));
    }
    Ok(())
}

/// Refuses scenes with jumps that meshes alone do not tell of, if the method does not find them.
/// They matter on the meshes that `move`: on all, where what is seen from points that move counts.
pub fn check_geometry(
    view: &SceneView,
    adjacency: &Adjacency,
    method: Method,
    moves: &(dyn Fn(usize) -> bool + Sync),
) -> Result<(), EngineError> {
    let geometry = view.geometry;
    let id = |mesh: usize| &view.scene.meshes[mesh].id;
    let has_rulings = |mesh: &usize| {
        let pattern = &geometry.patterns[*mesh];
        moves(*mesh) && pattern.as_ref().is_some_and(|p| !p.rulings.is_empty())
    };
    if method.misses(Discontinuity::TextureEdge)
        && let Some(mesh) = (0..geometry.patterns.len()).find(has_rulings)
    {
        return Err(EngineError::Refused(format!(
            "{}: the edges of its checkerboard or unfiltered bitmap are not found by {}, so gradients by what moves \
             would be wrong; use --method reparam",
            id(mesh),
            method.name()
        )));
    }
    if method.misses(Discontinuity::Intersection)
        && let Some([one, other]) = intersections::find(view, adjacency, moves)
    {
        let what = if one == other {
            format!("{} passes through itself", id(one))
        } else {
            format!("{} and {} pass through each other", id(one), id(other))
        };
        return Err(EngineError::Refused(format!(
            "{what}: the lines in which surfaces meet are not found by {}, so gradients by what moves would be wrong; \
             use --method reparam",
            method.name()
        )));
    }
    Ok(())
}

/// Whether light is scattered otherwise than by one rough interface or diffusely.
fn is_layered(bsdf: &Bsdf) -> bool {
    match bsdf {
        Bsdf::Principled { .. } => true,
        Bsdf::Dielectric { microfacets, .. } => microfacets.is_some(),
        Bsdf::Conductor { microfacets, .. } => microfacets.is_some_and(|m| m.alpha_v.is_some()),
        _ => false,
    }
}

/// Why edges that a camera sees are not found.
fn behind_a_lens(sensor: &Sensor, misses: impl Fn(Discontinuity) -> bool) -> Option<String> {
    let (kind, instead) = match sensor.lens {
        Lens::Pinhole => return None,
        Lens::Thin { .. } if misses(Discontinuity::ThroughLens) => {
            ("through a lens with an aperture", "use --method reparam")
        }
        Lens::Parallel { .. } if misses(Discontinuity::InParallel) => {
            ("by a parallel projection", "use --method reparam")
        }
        Lens::Thin { .. } | Lens::Parallel { .. } => return None,
    };
    Some(format!(
        "{}: edges seen {kind} are not found, so gradients by what moves would be wrong; {instead}",
        sensor.id
    ))
}

/// Why the light of a beam has an edge on what it falls on, which nobody looks for.
fn beam_edge(scene: &Scene, light: &DeltaLight, misses_border: bool) -> Option<String> {
    let jumps = |t: usize| match scene.textures[t].layout {
        Layout::Constant | Layout::Vertices | Layout::Faces => false,
        Layout::Checkerboard { .. } => true,
        Layout::Bitmap { bilinear, .. } => !bilinear,
    };
    let why = match light.beam?.profile {
        BeamProfile::Projector { .. } if misses_border => {
            "what a projector shows ends at the picture's border (use --method reparam)"
        }
        BeamProfile::Projector { .. } if jumps(light.power) => {
            "its picture jumps; take a bitmap with a bilinear filter"
        }
        BeamProfile::Spot {
            beam_width_rad,
            cutoff_rad,
            ..
        } if beam_width_rad >= cutoff_rad && misses_border => {
            "the beam ends at its cutoff; use --method reparam, or give it a \"beam_width\" smaller than \"cutoff_angle\""
        }
        BeamProfile::Spot {
            texture: Some(texture),
            ..
        } if jumps(texture) => "its texture jumps; take a bitmap with a bilinear filter",
        BeamProfile::Spot { .. } | BeamProfile::Projector { .. } => return None,
    };
    Some(format!(
        "{}: {why}, and the motion of such edges is not followed, so gradients by what moves would be wrong",
        light.key
    ))
}

fn sharp_shadows(light: &str) -> String {
    format!(
        "{light}: the shadows of delta lights have sharp edges that are not found, so gradients by what moves \
         would be wrong; use --method reparam, or a small area light"
    )
}

/// Whether a reflectance is black somewhere and its gradient is asked for: paths have to go on from
/// black surfaces then.
pub fn asks_about_black(scene: &Scene, request: &SceneDifferential) -> bool {
    scene.materials.iter().any(|m| {
        let fractions = m.bsdf.fractions();
        m.textures().into_iter().any(|t| {
            let is_whole = |texel: &[f32; 3]| fractions.contains(&t) && texel.contains(&1.0);
            let is_black = |texel: &[f32; 3]| texel.contains(&0.0) || is_whole(texel);
            request.texels[t].is_some() && scene.textures[t].texels.iter().any(is_black)
        })
    })
}
