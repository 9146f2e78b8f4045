//! The forward sweep over bounces that drift (`paths::lobe_drift`).

use crate::discontinuity::boundary::{dvec3, vector};
use crate::gradient::path::bars::over;
use crate::gradient::path::forward::{
    D, ForwardSweep, MovingVertex, constant, dual_lane, value_of,
};
use crate::gradient::scene::forward::{dual_vector, tangent_of};
use crate::kernels::bsdf::Interface;
use crate::lanes::{Dual, LANES, Lane, V3};
use crate::paths::lobe_drift::LobeField;
use crate::paths::rays::{from_lanes, masked};
use crate::paths::surface::kinds::LightKind;
use crate::paths::surface::layers::{numbers, of_numbers};
use glam::{DVec3, Vec3};

impl ForwardSweep<'_> {
    /// A bounce carried along by what it meets, where directions drift.
    pub(super) fn drift(
        &self,
        here: &MovingVertex,
        direction: V3<D>,
        weight: V3<D>,
    ) -> (V3<D>, V3<D>) {
        let vertices = here.vertices;
        let drifts = vertices.drifts;
        if drifts == 0 {
            return (direction, weight);
        }
        let mut velocity = [Vec3::ZERO; LANES];
        let mut change = [0.0f32; LANES];
        for lane in (0..LANES).filter(|&l| drifts >> l & 1 == 1) {
            let moved = self.drift_velocity(here, lane, dual_lane(direction, lane));
            (velocity[lane], change[lane]) = (moved.0.as_vec3(), moved.1 as f32);
        }
        let velocity = from_lanes(&velocity);
        let carried = tangent_of(direction) + velocity;
        let mut changed = tangent_of(weight) + value_of(weight) * Lane::new(change);
        let uneven = drifts & vertices.kinds.uneven_below();
        if uneven != 0 {
            let w = dual_vector(value_of(direction), velocity);
            let sent = self.bsdf_evaluate(&here.still(), w, LightKind::Diffuse);
            let relative = over(tangent_of(sent), value_of(sent));
            changed = changed + masked(uneven, value_of(weight).times(relative));
        }
        (
            dual_vector(value_of(direction), carried),
            dual_vector(value_of(weight), changed),
        )
    }

    /// The velocity of the drift at a direction of a lane's lobe, and how it changes a sample's
    /// weight.
    fn drift_velocity(
        &self,
        here: &MovingVertex,
        lane: usize,
        direction: V3<Dual<f64>>,
    ) -> (DVec3, f64) {
        let Some((drift, velocities)) = &self.lobe_drift else {
            return (DVec3::ZERO, 0.0);
        };
        let [x, n] = [here.x, here.n].map(|v| dual_lane(v, lane));
        let value = |v: V3<Dual<f64>>| DVec3::new(v.x.value, v.y.value, v.z.value);
        let tangent = |v| dvec3(tangent_of(v));
        let x_moves = here.vertices.moves >> lane & 1 == 1;
        let rests = here.vertices.rests >> lane & 1 == 1;
        let field = drift.field([value(x), value(n), value(direction)], x_moves, rests);
        let velocity = |field: LobeField| {
            field.velocity(|body| velocities[body], tangent(x), tangent(direction))
        };
        field.map_or((DVec3::ZERO, 0.0), velocity)
    }

    /// A direction of a lane's lobe in which a border is seen, carried along likewise.
    pub(crate) fn carried(
        &self,
        here: &MovingVertex,
        lane: usize,
        direction: V3<Dual<f64>>,
    ) -> V3<Dual<f64>> {
        if here.vertices.drifts >> lane & 1 == 0 {
            return direction;
        }
        let (velocity, _) = self.drift_velocity(here, lane, direction);
        direction + dual_vector(V3::splat(0.0), vector(velocity))
    }
}

impl MovingVertex<'_> {
    /// The same with nothing moving.
    fn still(&self) -> Self {
        let vector = |v: V3<D>| dual_vector(value_of(v), V3::splat(0.0));
        let number = |d: D| constant(d.value);
        Self {
            x: vector(self.x),
            n: vector(self.n),
            base_n: vector(self.base_n),
            corners: self.corners.map(vector),
            b: self.b.map(number),
            direction: vector(self.direction),
            throughput: vector(self.throughput),
            diffuse_reflectance: vector(self.diffuse_reflectance),
            interface: self.interface.map(|s| Interface {
                reflectance: vector(s.reflectance),
                second_reflectance: vector(s.second_reflectance),
                eta: vector(s.eta),
                k: vector(s.k),
                alpha: number(s.alpha),
            }),
            layers: self
                .layers
                .map(|l| of_numbers(vector(l.tangent), numbers(&l).map(number))),
            vertices: self.vertices,
        }
    }
}
