//! The backward sweep over bounces that drift (`paths::lobe_drift`).

use crate::gradient::path::backward::{BackwardSweep, Solved};
use crate::gradient::path::bars::{Cotangent, VertexBars, over};
use crate::gradient::scene::backward::TileSums;
use crate::kernels::frame::direction_from_local;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::drift_body::BodyMotion;
use crate::paths::lobe_drift::FieldBars;
use crate::paths::rays::{from_lanes, lane_of, masked};
use crate::paths::surface::kinds::LightKind;
use glam::{DVec3, Vec3};

impl BackwardSweep<'_> {
    /// From the cotangents of bounces and of their weights to those of what carries them. Returns
    /// those of the bounces as they are before they drift.
    pub(super) fn drift(
        &self,
        here: &Solved,
        direction_bar: V3<Lane>,
        weight_bar: V3<Lane>,
        bars: &mut VertexBars,
        sums: &mut TileSums,
    ) -> V3<Lane> {
        let vertices = here.vertices;
        if vertices.drifts == 0 {
            return direction_bar;
        }
        let direction = direction_from_local(here.n, vertices.local);
        let change_bar = weight_bar.dot(vertices.weight).to_array();
        let mut velocity_bar = direction_bar;
        let uneven = vertices.drifts & vertices.kinds.uneven_below();
        if uneven != 0 {
            let sent = self.bsdf_evaluate(here, direction, LightKind::Diffuse);
            let bar = over(weight_bar.times(vertices.weight), sent);
            let bar = Cotangent::of_lanes(uneven, bar);
            let none = &mut VertexBars::zero();
            let w = self.bsdf_evaluate_backward(here, direction, LightKind::Diffuse, bar, none);
            velocity_bar = velocity_bar + masked(uneven, w);
        }
        let [mut x, mut turning] = [[Vec3::ZERO; LANES]; 2];
        for lane in (0..LANES).filter(|&l| vertices.drifts >> l & 1 == 1) {
            let d = lane_of(direction, lane).as_dvec3();
            let bar = lane_of(velocity_bar, lane).as_dvec3();
            let found = self.carried(here, lane, d, (bar, change_bar[lane].into()), sums);
            x[lane] = sums.admitted(found.x).as_vec3();
            turning[lane] = sums.admitted(found.turning).as_vec3();
        }
        bars.x = bars.x + from_lanes(&x);
        direction_bar + from_lanes(&turning)
    }

    /// The same of one lane's direction `d`, from the cotangents of its velocity and of the change
    /// of its weight. Adds those of bodies.
    pub(crate) fn carried(
        &self,
        here: &Solved,
        lane: usize,
        d: DVec3,
        (velocity_bar, change_bar): (DVec3, f64),
        sums: &mut TileSums,
    ) -> FieldBars {
        let vertices = here.vertices;
        let Some(drift) = self.lobe_drift.filter(|_| vertices.drifts >> lane & 1 == 1) else {
            return FieldBars::default();
        };
        let [x, n] = [here.x, here.n].map(|v| lane_of(v, lane).as_dvec3());
        let x_moves = vertices.moves >> lane & 1 == 1;
        let rests = vertices.rests >> lane & 1 == 1;
        let Some(field) = drift.field([x, n, d], x_moves, rests) else {
            return FieldBars::default();
        };
        field.velocity_adjoint(velocity_bar, change_bar, |body, bar| {
            sums.add_body(body, bar)
        })
    }

    /// What stands for a body, from the cotangent of its motion.
    pub fn add_body(&self, body: usize, bar: BodyMotion, sums: &mut TileSums) {
        let Some(drift) = self.lobe_drift else { return };
        drift.bodies[body].motion_adjoint(bar, |v, v_bar| self.scatter_vertex(v, v_bar, sums));
    }
}
