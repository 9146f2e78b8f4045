//! Keys of textures and of lights without a shape, by the slots that use them.

use super::entries::{Entry, range};
use super::{Target, Value};
use crate::scene::data::{DeltaLightKind, Layout, Scene, Texture};
use glam::Affine2;
use std::collections::HashSet;

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
}

impl<'s> Slots<'s> {
    pub fn new(scene: &'s Scene) -> Self {
        let mut slots = Self {
            scene,
            uses: scene.textures.iter().map(|_| Vec::new()).collect(),
            is_listed: vec![false; scene.textures.len()],
        };
        let mut users = vec![Vec::new(); scene.materials.len()];
        for mesh in &scene.meshes {
            users[mesh.material].push(mesh.id.as_str());
        }
        for (material, users) in scene.materials.iter().zip(users) {
            let owners = users.iter().map(|id| format!("{id}.bsdf"));
            let owners: Vec<String> = std::iter::once(material.key.clone())
                .chain(owners)
                .collect();
            let is_plastic = matches!(material.bsdf, crate::scene::data::Bsdf::Plastic { .. });
            for (name, texture) in material.bsdf.slots() {
                let is_plain = scene.textures[texture].channels == 1
                    && (name == "eta" || name == "alpha" && is_plastic);
                for owner in &owners {
                    // Mitsuba puts the colour of a two-sided bsdf one level down; both spellings are taken for both
                    // kinds.
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
        for texture in self.scene.materials[m].bsdf.textures() {
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
                out.push(self.entry(t, suffix, &[channels], Target::Texels(t)));
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
                let is_environment = self
                    .scene
                    .environment
                    .as_ref()
                    .is_some_and(|e| e.radiance == t);
                if !is_environment {
                    let why = "without a bilinear filter its texels meet in edges, whose motion is not followed";
                    out.push(self.to_uv(t, to_uv, (!bilinear).then_some(why)));
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

/// What such a parameter is now.
pub(super) fn value(scene: &Scene, target: Target) -> Value {
    let numbers = |texture: &Texture, texel: usize| {
        let texel = &texture.texels[texel][..texture.channels];
        Value::Numbers(texel.iter().map(|&v| f64::from(v)).collect())
    };
    match target {
        Target::Texels(t) if scene.textures[t].varies() => {
            let texture = &scene.textures[t];
            let all = texture.texels.iter();
            range(all.flat_map(|c| c[..texture.channels].iter().map(|&v| f64::from(v))))
        }
        Target::Texels(t) => numbers(&scene.textures[t], 0),
        Target::Texel { texture, texel } => numbers(&scene.textures[texture], texel),
        Target::ToUv(t) => {
            let to_uv = scene.textures[t].layout.to_uv().unwrap_or_default();
            Value::Numbers(rows(to_uv).map(f64::from).to_vec())
        }
        Target::EnvironmentScale => {
            let map = scene.environment.as_ref().and_then(|e| e.map);
            Value::Numbers(vec![map.map_or(1.0, |m| f64::from(m.scale))])
        }
        Target::DeltaLightPosition(i) => match scene.delta_lights[i].kind {
            DeltaLightKind::Point { position } => {
                Value::Numbers(position.to_array().map(f64::from).to_vec())
            }
            DeltaLightKind::Directional { .. } => Value::Numbers(Vec::new()),
        },
        _ => Value::Numbers(Vec::new()),
    }
}

/// The two rows of a 2×3 matrix, one after the other.
pub(super) fn rows(to_uv: Affine2) -> [f32; 6] {
    let (x, y, t) = (to_uv.x_axis, to_uv.y_axis, to_uv.translation);
    [x.x, y.x, t.x, x.y, y.y, t.y]
}

/// The transform of [`rows`].
pub(super) fn from_rows([a, b, c, d, e, f]: [f32; 6]) -> Affine2 {
    Affine2::from_cols_array(&[a, d, b, e, c, f])
}
