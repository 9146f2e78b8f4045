//! What surfaces are made of, if that is several materials (`paths::surface::choice`).

use crate::paths::surface::texture::Lookup;
use crate::scene::{Bsdf, Scene};

/// One of the materials that a surface is made of.
pub struct Part {
    /// Its number in the table of materials.
    pub entry: usize,
    /// Its fraction is the product of these.
    pub fractions: Vec<Fraction>,
    /// Whether there is any of it.
    pub is_there: bool,
}

impl Part {
    fn new(scene: &Scene, entry: usize, fractions: &[Fraction]) -> Self {
        let is_nothing = |f: &Fraction| {
            let none = if f.is_rest { 1.0 } else { 0.0 };
            let mut texels = scene.textures[f.texture].texels.iter();
            texels.all(|t| t[0] == none)
        };
        Self {
            entry,
            fractions: fractions.to_vec(),
            is_there: !fractions.iter().any(is_nothing),
        }
    }
}

/// What a texture says of a mixture of two.
#[derive(Clone, Copy)]
pub struct Fraction {
    pub texture: usize,
    /// The rest, rather than what the texture says.
    pub is_rest: bool,
}

impl Fraction {
    /// The fraction, where the texture has been looked up.
    pub fn value(self, found: &Lookup) -> f32 {
        if self.is_rest {
            1.0 - found.value.x
        } else {
            found.value.x
        }
    }
}

/// What a material is made of, if that is several.
pub fn parts(scene: &Scene, material: usize) -> Vec<Part> {
    let mut out = Vec::new();
    let is_one = scene.materials[material].bsdf.nested().is_empty();
    if !is_one {
        collect(scene, material, &mut Vec::new(), &mut out);
    }
    out
}

fn collect(scene: &Scene, material: usize, way: &mut Vec<Fraction>, out: &mut Vec<Part>) {
    let (texture, [rest, chosen]) = match scene.materials[material].bsdf {
        Bsdf::Mask { opacity, nested } => (opacity, [None, Some(nested)]),
        Bsdf::Blend { weight, nested } => (weight, nested.map(Some)),
        _ => {
            out.push(Part::new(scene, material, way));
            return;
        }
    };
    for (is_rest, nested) in [(true, rest), (false, chosen)] {
        way.push(Fraction { texture, is_rest });
        match nested {
            Some(nested) => collect(scene, nested, way, out),
            // What is not there stands behind all others.
            None => out.push(Part::new(scene, scene.materials.len(), way)),
        }
        way.pop();
    }
}
