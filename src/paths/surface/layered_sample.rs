//! Drawing among layers, and normals of facets with a grain.

use crate::discontinuity::boundary::{dvec3, vector};
use crate::kernels::fresnel::fresnel_dielectric;
use crate::kernels::layered::{
    coat_ndf, g1_grained_over_cos, grain_axes, grain_roughness, ndf_grained,
};
use crate::paths::rays::lane_of;
use crate::paths::store::Vertices;
use crate::paths::surface::interface::interface_of_lane;
use crate::paths::surface::layers::layers_of_lane;
use crate::paths::surface::microfacet_sample::visible_normal_of;
use crate::paths::surface::vertex::Surface;
use glam::DVec3;

/// The energy of a clear coat over that of the main specular lobe, and what sheen is taken for.
const COAT: f32 = 0.25;
/// No layer's weight among the others is smaller than this where paths go on from what is black,
/// and nothing passes with a chance smaller than this.
const LEAST: f32 = 0.1;

/// Facets whose roughness depends on the direction.
#[derive(Debug)]
pub struct Grain {
    /// Along it and across it, in the world.
    axes: [DVec3; 2],
    /// The same in the frame of the surface, of which the third axis is the normal.
    local: [DVec3; 2],
    /// Roughness along these.
    alpha: [f64; 2],
}

impl Grain {
    /// Of a lane, whose frame this is; `None` if it has neither grain nor layers.
    pub fn of_lane(
        vertices: &Vertices,
        surface: &Surface,
        lane: usize,
        frame: [DVec3; 3],
    ) -> Option<Self> {
        if vertices.kinds.layered() >> lane & 1 == 0 {
            return None;
        }
        let l = layers_of_lane(surface.layers.as_ref()?, lane);
        let s = interface_of_lane(surface.interface.as_ref()?, lane);
        let n = vector(lane_of(surface.n, lane).as_dvec3());
        let (u, v) = grain_axes(n, l.tangent);
        let is_principled = vertices.kinds.principled >> lane & 1 == 1;
        let (along, across) = grain_roughness(s, l, is_principled);
        let axes = [u, v].map(dvec3);
        Some(Self {
            axes,
            local: axes.map(|a| DVec3::from(frame.map(|axis| axis.dot(a)))),
            alpha: [along, across],
        })
    }

    /// From the frame of the surface to that of the grain.
    fn turned(&self, d: DVec3) -> DVec3 {
        DVec3::new(self.local[0].dot(d), self.local[1].dot(d), d.z)
    }

    /// A normal seen from the unit direction `wi`, both in the frame of the surface.
    pub fn visible_normal(&self, wi: DVec3, random: [f64; 2]) -> DVec3 {
        let h = visible_normal_of(self.turned(wi), self.alpha, random);
        (self.local[0] * h.x + self.local[1] * h.y + DVec3::Z * h.z).normalize()
    }

    /// D·G₁(ωᵢ)/cosθᵢ of GGX.
    pub fn visible_over_cos(&self, wi: DVec3, h: DVec3) -> f64 {
        let [along, across] = self.alpha;
        let (i, h) = (self.turned(wi), self.turned(h));
        ndf_grained(h.x, h.y, h.z, along, across, true)
            * g1_grained_over_cos(i.x, i.y, i.z, along, across, true)
    }

    /// Density over solid angle of [`Self::visible_normal`].
    pub fn pdf_normal(&self, wi: DVec3, h: DVec3) -> f64 {
        self.visible_over_cos(wi, h) * wi.dot(h).max(0.0)
    }

    /// Roughness along a unit direction across the normal, in the world.
    pub fn alpha_along(&self, tangent: DVec3) -> f64 {
        let [along, across] = [0, 1].map(|i| self.alpha[i] * self.axes[i].dot(tangent));
        along.hypot(across)
    }
}

/// The chances that layers are drawn with; the rest is the main specular lobe.
#[derive(Debug)]
pub struct Chances {
    pub diffuse: f32,
    pub coat: f32,
    pub gloss: f64,
    /// The part of what a dielectric lets through that passes.
    passes: f32,
    /// Index beyond over that on this side.
    ratio: f64,
    is_entering: bool,
    transmits: bool,
    least: f32,
}

impl Chances {
    /// Of a lane; `None` if it has no layers.
    pub fn of_lane(vertices: &Vertices, surface: &Surface, lane: usize) -> Option<Self> {
        if vertices.kinds.principled >> lane & 1 == 0 {
            return None;
        }
        let l = layers_of_lane(surface.layers.as_ref()?, lane);
        let s = interface_of_lane(surface.interface.as_ref()?, lane);
        let is_entering = vertices.kinds.inside >> lane & 1 == 0;
        let least = if surface.black_goes_on { LEAST } else { 0.0 };
        let rest = (1.0 - l.metallic) as f32;
        let spec_trans = l.spec_trans as f32;
        let (mut diffuse, mut coat) = (0.0, 0.0);
        if is_entering {
            diffuse = (rest * (1.0 - spec_trans) + COAT * rest * l.sheen as f32).max(least);
            coat = (COAT * l.clearcoat as f32).max(least);
        }
        let sum = 1.0 + diffuse + coat;
        Some(Self {
            diffuse: diffuse / sum,
            coat: coat / sum,
            gloss: l.clearcoat_gloss,
            passes: if is_entering { rest * spec_trans } else { 1.0 },
            ratio: if is_entering { s.eta.x } else { 1.0 / s.eta.x },
            is_entering,
            transmits: vertices.kinds.transmits >> lane & 1 == 1,
            least,
        })
    }

    /// The chance to pass a facet at this cosine, of those that the main lobe meets.
    pub fn passes(&self, cos: f64) -> f32 {
        if !self.transmits {
            return 0.0;
        }
        let glass = fresnel_dielectric(cos.max(1e-6), self.ratio) as f32;
        let passes = self.passes * (1.0 - glass);
        if self.is_entering {
            passes.clamp(self.least, 1.0 - self.least)
        } else {
            passes
        }
    }

    /// Roughness of the coat.
    pub fn coat_alpha(&self) -> f64 {
        0.1 - 0.099 * self.gloss
    }
}

/// A normal of the coat's facets (GTR1), about z.
pub fn coat_normal(gloss: f64, [u, v]: [f64; 2]) -> DVec3 {
    let alpha = 0.1 - 0.099 * gloss;
    let alpha2 = alpha * alpha;
    // 1 − cos² = (α²^(1−u) − α²)/(1 − α²), which keeps its digits where α is small.
    let sin2 = ((alpha2.powf(1.0 - u) - alpha2) / (1.0 - alpha2)).clamp(0.0, 1.0);
    let (sin, cos) = (v * std::f64::consts::TAU).sin_cos();
    let radius = sin2.sqrt();
    DVec3::new(radius * cos, radius * sin, (1.0 - sin2).sqrt())
}

/// Density over solid angle of [`coat_normal`].
pub fn pdf_coat_normal(gloss: f64, h: DVec3) -> f64 {
    coat_ndf(h.x * h.x + h.y * h.y, gloss) * h.z
}
