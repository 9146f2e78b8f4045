//! What kinds of surfaces a packet has met, a bit a lane.

use crate::kernels::bsdf::KindMasks;
use crate::kernels::layered::LitMasks;
use crate::lanes::{Lane, Real};
use crate::paths::rays::lane_mask;

/// Where light comes from that a vertex looks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LightKind {
    /// Samples of area lights and of the environment: narrow lobes see these along bounces instead.
    Sampled,
    /// Delta lights, which no bounce finds.
    Delta,
    /// The same, of which only what is scattered diffusely counts.
    Diffuse,
}

/// The kinds of a packet's surfaces, a bit a lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kinds {
    pub conductor: u32,
    pub dielectric: u32,
    pub plastic: u32,
    pub null: u32,
    /// Of the dielectric ones, panes.
    pub thin: u32,
    /// Mixtures in parts of which something is seen. Chains alone meet these; paths meet their
    /// parts.
    pub mixed: u32,
    pub principled: u32,
    /// Rough metal and glass whose roughness depends on the direction.
    pub grained: u32,
    /// Of the principled ones, those that let light through.
    pub transmits: u32,
    /// A picture turns the normal.
    pub relief: u32,
    /// Interfaces without roughness.
    pub smooth: u32,
    pub ggx: u32,
    pub nonlinear: u32,
    /// The specular reflection is wide enough to be lit by light samples.
    pub wide: u32,
    /// Seen from the inside.
    pub inside: u32,
    /// One-sided surfaces seen from behind: they count as diffuse and black.
    pub black: u32,
}

impl Kinds {
    /// Lanes that need more than a diffuse reflectance.
    pub fn special(&self) -> u32 {
        self.conductor | self.dielectric | self.plastic | self.null | self.principled
    }

    /// Lanes whose formulas are those of `kernels::layered`.
    pub fn layered(&self) -> u32 {
        self.principled | self.grained
    }

    /// Lanes of which the part of the light that is scattered diffusely depends on the direction.
    pub fn uneven_below(&self) -> u32 {
        self.plastic | self.principled | self.relief
    }

    /// Lanes that see the world along a deterministic map of the ray, at least in part.
    pub fn in_chains(&self) -> u32 {
        self.smooth | self.null | self.mixed
    }

    /// Lanes with a lobe too narrow for light samples: lights are seen in it along bounces alone.
    pub fn seen_along_bounces(&self) -> u32 {
        self.special() & (!self.wide | self.principled)
    }

    /// Lanes that delta lights light otherwise than through [`Self::rough_glass`]: all that are not
    /// perfectly smooth.
    pub fn lit_by_delta_lights(&self) -> u32 {
        !(self.dielectric | self.null | (self.conductor & self.smooth))
    }

    /// Lanes of rough glass and of what else lets light through that rough interfaces scatter.
    pub fn rough_glass(&self) -> u32 {
        (self.dielectric & !self.smooth) | self.transmits
    }

    /// What of each lane `light` lights: diffuse reflection and the lobes in the second mask.
    pub fn lit_by(&self, light: LightKind) -> [u32; 2] {
        match light {
            LightKind::Sampled => [self.lit_by_samples(), self.wide],
            LightKind::Delta => [self.lit_by_delta_lights(), !self.smooth],
            LightKind::Diffuse => [self.lit_by_delta_lights(), 0],
        }
    }

    /// Lanes that scatter diffusely, or have a lobe, so that light samples light them.
    pub fn lit_by_samples(&self) -> u32 {
        !(self.dielectric | self.null | (self.conductor & !self.wide))
    }
}

impl Kinds {
    /// Of packets, as the kernels take them.
    pub fn masks<F: Real<Mask = <Lane as Real>::Mask>>(&self) -> KindMasks<F> {
        self.map(lane_mask)
    }

    /// Of one lane.
    pub fn masks_of_lane<F: Real<Mask = bool>>(&self, lane: usize) -> KindMasks<F> {
        self.map(|bits| bits >> lane & 1 == 1)
    }

    /// Which lobes of layered surfaces this kind of light lights.
    pub fn lit_masks<F: Real<Mask = <Lane as Real>::Mask>>(&self, light: LightKind) -> LitMasks<F> {
        let [_, lobes] = self.lit_by(light);
        let coat = match light {
            LightKind::Sampled | LightKind::Diffuse => 0,
            LightKind::Delta => u32::MAX,
        };
        LitMasks {
            has_lobe: lane_mask(lobes),
            has_coat: lane_mask(coat),
        }
    }

    fn map<F: Real>(&self, mask: impl Fn(u32) -> F::Mask) -> KindMasks<F> {
        KindMasks {
            is_conductor: mask(self.conductor),
            is_plastic: mask(self.plastic),
            is_smooth: mask(self.smooth),
            is_ggx: mask(self.ggx),
            is_nonlinear: mask(self.nonlinear),
            is_thin: mask(self.thin),
            is_principled: mask(self.principled),
            is_entering: mask(!self.inside),
        }
    }
}
