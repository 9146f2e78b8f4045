//! Keys of textures, delta lights and the environment, by the slots that use them.

use super::entry::{Entry, Fixed};
use super::target::Target;
use super::to_uv::rows;
use crate::scene::data::{BeamProfile, Bsdf, DeltaLightKind, Layout, Material, Scene};
use glam::Affine2;
use std::collections::{HashMap, HashSet};

/// One use of a texture.
struct Use {
    /// `floor.bsdf.reflectance`
    key: String,
    /// Mitsuba holds a plain number there rather than a texture: its key has no `.value`.
    is_plain: bool,
}

/// The textures of a scene with their uses, each listed once.
pub(super) struct Slots<'s> {
    scene: &'s Scene,
    uses: Vec<Vec<Use>>,
    is_listed: Vec<bool>,
    /// Why there is no derivative by a texture.
    refusals: HashMap<usize, &'static str>,
}

/// What each material is called: by its own key, and by the shapes and mixtures that it is part of.
fn owners(scene: &Scene) -> Vec<Vec<String>> {
    let keys = scene.materials.iter().map(|m| vec![m.key.clone()]);
    let mut owners: Vec<Vec<String>> = keys.collect();
    for mesh in &scene.meshes {
        owners[mesh.material].push(format!("{}.bsdf", mesh.id));
    }
    // Parts stand before what they are part of.
    for m in (0..scene.materials.len()).rev() {
        for (name, nested) in scene.materials[m].bsdf.nested() {
            for owner in owners[m].clone() {
                for level in ["", ".brdf_0"] {
                    owners[nested].push(format!("{owner}{level}.{name}"));
                }
            }
        }
    }
    owners
}

impl<'s> Slots<'s> {
    pub fn new(scene: &'s Scene) -> Self {
        let mut slots = Self {
            scene,
            uses: scene.textures.iter().map(|_| Vec::new()).collect(),
            is_listed: vec![false; scene.textures.len()],
            refusals: HashMap::new(),
        };
        for (material, owners) in scene.materials.iter().zip(owners(scene)) {
            if let Bsdf::Principled(p) = material.bsdf {
                if !p.transmits {
                    let why = "the surface lets no light through; give it a spec_trans above zero";
                    slots.refusals.insert(p.spec_trans, why);
                }
                if !p.is_brushed {
                    let why = "the surface has no grain; give it an anisotropic above zero";
                    slots.refusals.insert(p.anisotropic, why);
                }
            }
            let is_plastic = matches!(material.bsdf, Bsdf::Plastic { .. });
            for (name, texture) in material.slots() {
                let is_plain = scene.textures[texture].channels == 1
                    && (matches!(name, "eta" | "specular") || name == "alpha" && is_plastic);
                for owner in &owners {
                    // Mitsuba puts the colour of a two-sided bsdf one level down; both spellings
                    // are taken for both kinds.
                    for level in ["", ".brdf_0"] {
                        let key = format!("{owner}{level}.{name}");
                        slots.uses[texture].push(Use { key, is_plain });
                    }
                }
            }
        }
        for light in &scene.area_lights {
            slots.add(light.radiance, format!("{}.radiance", light.key));
        }
        slots
    }

    fn add(&mut self, texture: usize, key: String) {
        let is_plain = false;
        self.uses[texture].push(Use { key, is_plain });
    }

    /// The textures of a material that are not listed yet.
    pub fn material(&mut self, m: usize, out: &mut Vec<Entry>) {
        for texture in self.scene.textures_of(m) {
            self.texture(texture, out);
        }
    }

    /// A texture, unless it is listed already.
    pub fn texture(&mut self, t: usize, out: &mut Vec<Entry>) {
        if std::mem::replace(&mut self.is_listed[t], true) {
            return;
        }
        let texture = &self.scene.textures[t];
        let channels = texture.channels;
        match texture.layout {
            Layout::Constant => {
                let plain = self.uses[t].iter().any(|u| u.is_plain);
                let suffix = if plain { "" } else { ".value" };
                let mut entry = self.entry(t, suffix, &[channels], Target::Texels(t));
                entry.refusal = self.refusals.get(&t).copied();
                if entry.refusal.is_some() {
                    let number = f64::from(texture.texels[0][0]);
                    entry.target = None;
                    entry.fixed = Fixed::Numbers(vec![number; channels]);
                }
                out.push(entry);
            }
            Layout::Vertices | Layout::Faces => {
                let shape = [texture.texels.len(), channels];
                out.push(self.entry(t, "", &shape, Target::Texels(t)));
            }
            Layout::Checkerboard { to_uv } => {
                for number in 0..2 {
                    let texel = texture.checkerboard_texel(number);
                    let target = Target::Texel { texture: t, texel };
                    let suffix = format!(".color{number}.value");
                    out.push(self.entry(t, &suffix, &[channels], target));
                }
                let why = "its colours meet in edges, whose motion is not followed";
                out.push(self.to_uv(t, to_uv, Some(why)));
            }
            Layout::Bitmap {
                width,
                height,
                bilinear,
                to_uv,
                ..
            } => {
                let shape = [height as usize, width as usize, channels];
                out.push(self.entry(t, ".data", &shape, Target::Texels(t)));
                let bumps = |m: &Material| {
                    m.relief
                        .is_some_and(|r| r.bumps.is_some() && r.texture == t)
                };
                let is_bumpy = self.scene.materials.iter().any(bumps);
                let is_environment = self
                    .scene
                    .environment
                    .as_ref()
                    .is_some_and(|e| e.radiance == t);
                if !is_environment {
                    let why = "without a bilinear filter its texels meet in edges, whose motion is not followed";
                    let refusal = match (bilinear, is_bumpy) {
                        (false, _) => Some(why),
                        (true, true) => {
                            Some("the slopes of bumps meet in edges, whose motion is not followed")
                        }
                        (true, false) => None,
                    };
                    out.push(self.to_uv(t, to_uv, refusal));
                }
            }
        }
    }

    fn to_uv(&self, t: usize, to_uv: Affine2, refusal: Option<&'static str>) -> Entry {
        let mut entry = self.entry(t, ".to_uv", &[2, 3], Target::ToUv(t));
        if refusal.is_some() {
            let numbers = rows(to_uv).map(f64::from).to_vec();
            let aliases = std::mem::take(&mut entry.aliases);
            entry = Entry::numbers(entry.key, &[2, 3], numbers);
            entry.aliases = aliases;
            entry.refusal = refusal;
        }
        entry
    }

    /// A parameter of a texture, with a spelling for every use.
    fn entry(&self, t: usize, suffix: &str, shape: &[usize], target: Target) -> Entry {
        let key = &self.scene.textures[t].key;
        let mut entry = Entry::of(format!("{key}{suffix}"), shape, target);
        let mut known = HashSet::from([entry.key.clone()]);
        let mut spell = |alias: String| {
            if known.insert(alias.clone()) {
                entry.aliases.push(alias);
            }
        };
        for used in &self.uses[t] {
            spell(format!("{}{suffix}", used.key));
        }
        if suffix.is_empty() {
            spell(format!("{key}.value"));
            for used in &self.uses[t] {
                spell(format!("{}.value", used.key));
            }
        }
        entry
    }

    /// Position or direction, and power.
    pub fn delta_light(&mut self, i: usize, out: &mut Vec<Entry>) {
        let light = &self.scene.delta_lights[i];
        let key = &light.key;
        match light.kind {
            DeltaLightKind::Point { .. } => {
                let target = Target::DeltaLightPosition(i);
                out.push(Entry::of(format!("{key}.position"), &[3], target));
                let target = Target::DeltaLightTranslation(i);
                out.push(Entry::of(format!("{key}.translation"), &[3], target));
            }
            DeltaLightKind::Directional { direction } => {
                let numbers = direction.to_array().map(f64::from).to_vec();
                let mut entry = Entry::numbers(format!("{key}.direction"), &[3], numbers);
                entry.aliases.push(format!("{key}.to_world"));
                entry.refusal = Some("turning a directional light is not implemented");
                out.push(entry);
            }
        }
        self.texture(light.power, out);
        let mut fixed = |name: &str, number: f32, why| {
            let mut entry = Entry::numbers(format!("{key}.{name}"), &[1], vec![f64::from(number)]);
            entry.refusal = Some(why);
            out.push(entry);
        };
        match light.beam.map(|b| b.profile) {
            Some(BeamProfile::Spot {
                beam_width_rad,
                cutoff_rad,
                texture,
            }) => {
                let why = "the derivative by the width of a beam is not implemented";
                fixed("cutoff_angle", cutoff_rad.to_degrees(), why);
                fixed("beam_width", beam_width_rad.to_degrees(), why);
                if let Some(texture) = texture {
                    self.texture(texture, out);
                }
            }
            Some(BeamProfile::Projector { scale, .. }) => {
                let why = "what it multiplies can be: ask for the irradiance";
                fixed("scale", scale, why);
            }
            None => {}
        }
    }

    /// Radiance, and what moves an environment map.
    pub fn environment(&mut self, out: &mut Vec<Entry>) {
        let Some(environment) = &self.scene.environment else {
            return;
        };
        self.texture(environment.radiance, out);
        let key = &environment.key;
        if environment.map.is_some() {
            out.push(Entry::of(
                format!("{key}.scale"),
                &[1],
                Target::EnvironmentScale,
            ));
            out.push(Entry::of(
                format!("{key}.rotation"),
                &[3],
                Target::EnvironmentRotation,
            ));
        }
    }
}
