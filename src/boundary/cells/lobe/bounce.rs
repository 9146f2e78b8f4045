//! Where a lane's lobe leads, in f64.

use super::line::{LaneSurface, Lobe};
use crate::discontinuity::boundary::{dvec3, vector};
use crate::kernels::bsdf::{LobeMasks, RoughTransmission, bsdf_sample};
use crate::kernels::frame::direction_from_local;
use crate::kernels::layered::layered_sample;
use crate::kernels::relief::relief_shadow;
use crate::paths::rays::lane_of;
use crate::paths::surface::lobe_sample::View;
use glam::DVec3;

impl LaneSurface<'_> {
    /// The next direction at a coordinate, and the weight per unit of the coordinate's measure.
    pub(super) fn bounce(&self, local: DVec3) -> (DVec3, DVec3) {
        let (next, weight) = self.unhidden(local);
        if self.at.vertices.kinds.relief >> self.lane & 1 == 0 {
            return (next, weight);
        }
        let [base, turned] = [self.base_n, self.n].map(vector);
        (next, weight * relief_shadow(base, turned, vector(next)))
    }

    /// What a path goes on with that is drawn at a coordinate of this weight.
    pub fn weight_of_path(&self, local: DVec3, weight: DVec3) -> DVec3 {
        let vertices = self.at.vertices;
        match self.lobe {
            Lobe::Diffuse => weight,
            Lobe::Reflected | Lobe::Refracted => {
                let view = View::of_lane(vertices, self.at.surface, self.lane);
                weight / view.pdf_normal(vertices, self.lane, local)
            }
        }
    }

    /// The same without what a turned surface hides of itself.
    fn unhidden(&self, local: DVec3) -> (DVec3, DVec3) {
        let local = vector(local);
        let Some(interface) = self.interface else {
            let n = vector(self.n);
            let next = dvec3(direction_from_local(n, local));
            return (
                next,
                lane_of(self.at.vertices.diffuse_reflectance, self.lane).as_dvec3(),
            );
        };
        let lobes = LobeMasks {
            is_diffuse: self.lobe == Lobe::Diffuse,
            is_reflected: self.lobe == Lobe::Reflected,
            is_refracted: self.lobe == Lobe::Refracted,
            is_coat: self.at.vertices.lobes.coat >> self.lane & 1 == 1,
        };
        if let Some(layers) = self.layers {
            let (next, weight) = layered_sample(
                vector(self.n),
                vector(self.direction),
                local,
                interface,
                layers,
                lobes,
                self.at.vertices.kinds.masks_of_lane(self.lane),
            );
            return (dvec3(next), dvec3(weight));
        }
        let (next, weight) = bsdf_sample(
            vector(self.n),
            vector(self.direction),
            local,
            interface,
            self.transmission.unwrap_or(RoughTransmission::none()),
            lobes,
            self.at.vertices.kinds.masks_of_lane(self.lane),
        );
        (dvec3(next), dvec3(weight))
    }
}
