//! The forward sweep: from stored vertices, camera side first, to the derivative of each path's
//! radiance.

use crate::gradient::scene::forward::{Motion, MovingCamera, dual_vector, tangent_of};
use crate::kernels::bsdf::{
    Interface, RoughTransmission, bsdf_evaluate, bsdf_sample, consistent_normal,
};
use crate::kernels::frame::direction_from_local;
use crate::kernels::layered::{Layers, layered_evaluate, layered_sample};
use crate::kernels::normal::{face_normal, shading_normal};
use crate::kernels::triangle::triangle_hit;
use crate::lanes::{Dual, Lane, Mask, Real, V3};
use crate::paths::boundary_sample::BoundarySample;
use crate::paths::drift_body::{Body, BodyMotion};
use crate::paths::lobe_drift::LobeDrift;
use crate::paths::radiance::Scored;
use crate::paths::rays::{lane_mask, masked};
use crate::paths::scene_view::SceneView;
use crate::paths::store::{TileStore, Vertices};
use crate::paths::surface::kinds::LightKind;
use crate::paths::surface::layers::{numbers, of_numbers, tangent};
use crate::paths::surface::texture::Lookup;
use crate::scene::{Lens, Rgb};

pub(crate) type D = Dual<Lane>;

/// Runs forward sweeps over a tile's store.
pub struct ForwardSweep<'a> {
    pub view: &'a SceneView<'a>,
    pub motion: &'a Motion,
    /// What directions over lobes move with, and how each body that it follows moves.
    pub(crate) lobe_drift: Option<(&'a LobeDrift, Vec<BodyMotion>)>,
    camera_lanes: MovingCamera<Lane>,
    pub(crate) camera_f64: MovingCamera<f64>,
}

/// The state that one vertex hands to the next.
pub(crate) struct Arriving {
    pub origin: V3<D>,
    pub direction: V3<D>,
    pub throughput: V3<D>,
}

impl Arriving {
    /// Keeps the tangents, and takes the values from the path that was stored: its rays start a
    /// little off the surfaces, which matters where the next one is near.
    fn follow(&mut self, vertices: &Vertices) {
        self.origin = dual_vector(vertices.origin, tangent_of(self.origin));
        self.direction = dual_vector(vertices.direction, tangent_of(self.direction));
        self.throughput = dual_vector(vertices.arriving_throughput(), tangent_of(self.throughput));
    }
}

/// A vertex with everything about it moving.
pub(crate) struct MovingVertex<'a> {
    pub vertices: &'a Vertices,
    pub x: V3<D>,
    pub n: V3<D>,
    /// The same before a picture turned it.
    pub base_n: V3<D>,
    pub corners: [V3<D>; 3],
    pub b: [D; 2],
    /// The ray that arrived, and the path's weight with it.
    pub direction: V3<D>,
    pub throughput: V3<D>,
    pub diffuse_reflectance: V3<D>,
    /// Given if any lane is more than diffuse.
    pub interface: Option<Interface<D>>,
    /// Given if any lane has layers or a grain.
    pub layers: Option<Layers<D>>,
}

impl<'a> ForwardSweep<'a> {
    pub fn new(
        view: &'a SceneView<'a>,
        motion: &'a Motion,
        lobe_drift: Option<&'a LobeDrift>,
    ) -> Self {
        let motions = |drift: &'a LobeDrift| {
            let of = |body: &Body| body.motion(|v| motion.velocity(v));
            (drift, drift.bodies.iter().map(of).collect())
        };
        Self {
            view,
            motion,
            lobe_drift: lobe_drift.map(motions),
            camera_lanes: motion.camera(&view.camera),
            camera_f64: motion.camera(&view.camera),
        }
    }

    /// d radiance/dθ of the paths of packet `packet`, whose camera rays go through the film points
    /// (`u`, `v`), which may move.
    pub fn radiance_derivative(&self, store: &TileStore, packet: usize, at: [D; 2]) -> V3<Lane> {
        self.path_derivative(store, packet, at, &[], &mut |_, _| ())
    }

    /// The same if samples move, whose scores multiply `scored` ([`SceneView::scored`]); tells what
    /// each boundary sample brings.
    pub(crate) fn path_derivative(
        &self,
        store: &TileStore,
        packet: usize,
        [u, v]: [D; 2],
        scored: &[Scored],
        each: &mut impl FnMut(&BoundarySample, Rgb),
    ) -> V3<Lane> {
        let camera = &self.camera_lanes;
        let (px, py) = self.view.camera.film_to_camera(u, v);
        let (origin, direction) = camera.ray([px, py]);
        let mut chain = Arriving {
            origin,
            direction,
            throughput: V3::splat(1.0),
        };
        let path = store.path(packet);
        if matches!(self.view.camera.lens, Lens::Thin { .. }) {
            // Such a camera stands still.
            chain.origin = dual_vector(path[0].origin, V3::splat(0.0));
            chain.direction = dual_vector(path[0].direction, V3::splat(0.0));
        }
        let mut sum = V3::splat(0.0);
        let mut previous: Option<MovingVertex> = None;
        for (k, vertices) in path.iter().enumerate() {
            let (contribution, here) =
                self.vertex(store, vertices, &mut chain, previous.as_ref(), each);
            sum = sum + contribution;
            if let (Some(here), Some([own, next])) = (&here, scored.get(k..k + 2)) {
                sum = sum + self.moving_environment_sample(store, here, own.environment);
                sum = sum + self.turn_bounce(store, here, &mut chain, next.radiance);
            }
            previous = here;
        }
        sum
    }

    /// One vertex's contribution to the tangent; moves the chain on.
    fn vertex<'v>(
        &self,
        store: &TileStore,
        vertices: &'v Vertices,
        chain: &mut Arriving,
        previous: Option<&MovingVertex>,
        each: &mut impl FnMut(&BoundarySample, Rgb),
    ) -> (V3<Lane>, Option<MovingVertex<'v>>) {
        chain.follow(vertices);
        let relays = store.relays(vertices);
        let mut sum = self.turned_rays(relays, vertices, chain);
        if vertices.escaped != 0 {
            sum = sum + masked(vertices.escaped, self.escape(vertices, chain, previous));
        }
        if vertices.hit == 0 {
            return (sum, None);
        }
        let mut here = self.moving_vertex(vertices, chain);
        if !self.view.lights.is_empty() {
            sum = sum + masked(vertices.hit, self.emission(chain, &here, previous));
        }
        sum = sum + self.delta_lights(store, &here);
        if !relays.is_empty() {
            let brings;
            (brings, here) = self.slid(relays, here, chain);
            sum = sum + brings;
        }
        if !self.view.lights.is_empty() {
            let still = !vertices.warped.light;
            sum = sum + masked(still, self.light_sample(&here));
            if vertices.warped.light != 0 {
                sum = sum + self.moving_light_sample(store, &here);
            }
        }
        if let Some(sample) = store.environment_sample(vertices) {
            let lit = sample.weight.gt(Lane::splat(0.0));
            if lit.any() && !store.samples_move() {
                let brings = self.environment_brings(&here, sample.direction, sample.weight);
                sum = sum + V3::select(lit, brings, V3::splat(0.0));
            }
        }
        for sample in store.boundary(vertices) {
            let brings = self.boundary(&store.found, sample, &here);
            each(sample, brings);
            sum = add_lane(sum, sample.lane, brings);
        }
        let (direction, weight) = self.bounce(&here);
        chain.origin = here.x;
        chain.direction = direction;
        chain.throughput = here.throughput.times(weight) * constant(vertices.survival);
        (sum, Some(here))
    }

    /// The ray's end, solved again with everything moving.
    pub(super) fn moving_vertex<'v>(
        &self,
        vertices: &'v Vertices,
        chain: &Arriving,
    ) -> MovingVertex<'v> {
        let geometry = self.view.geometry;
        let ids = geometry.corners(&vertices.triangle);
        let corners = self.motion.corners(geometry, &ids);
        let [v0, v1, v2] = corners;
        let (t, b1, b2) = triangle_hit(chain.origin, chain.direction, v0, v1, v2);
        let mut n = face_normal(v0, v1, v2);
        let smooth = self.view.smooth_lanes(&vertices.triangle);
        if smooth != 0 {
            let [n0, n1, n2] = self.motion.corner_normals(geometry, &ids);
            n = V3::select(lane_mask(smooth), shading_normal(n0, n1, n2, b1, b2), n);
        }
        n = n * constant(vertices.facing);
        let special = vertices.kinds.special();
        let kept_above = (special | vertices.kinds.relief) & smooth;
        if kept_above != 0 {
            let turned = consistent_normal(n, chain.direction);
            n = V3::select(lane_mask(kept_above), turned, n);
        }
        let base_n = n;
        if vertices.kinds.relief != 0 {
            n = self.turned(vertices, chain, n, corners, [b1, b2]);
        }
        let special = special | vertices.kinds.relief;
        let mut here = MovingVertex {
            vertices,
            x: chain.origin + chain.direction * t,
            n,
            base_n,
            corners,
            b: [b1, b2],
            direction: chain.direction,
            throughput: chain.throughput,
            diffuse_reflectance: dual_vector(vertices.diffuse_reflectance, V3::splat(0.0)),
            interface: None,
            layers: None,
        };
        if let Some(choice) = &vertices.choice {
            let b = here.b.map(|b| b.value);
            let db = here.b.map(|b| b.tangent);
            let change = |t: usize, found: &Lookup| self.motion.texture(t, found);
            let change = self.view.choice_change(vertices, choice, b, db, change);
            let factor = Dual {
                value: self.view.choice_factors(vertices, choice, b),
                tangent: change,
            };
            here.throughput = chain.throughput * factor;
        }
        if special != 0 || self.view.materials.any_texture || self.motion.colours {
            let interface = self.interface(&here);
            here.diffuse_reflectance = interface.reflectance;
            here.interface = (special != 0).then_some(interface);
            here.layers = self.layers(&here);
        }
        here
    }

    fn interface(&self, here: &MovingVertex) -> Interface<D> {
        let b = here.b.map(|b| b.value);
        let db = here.b.map(|b| b.tangent);
        let view = self.view;
        let value = view.interface(here.vertices, b);
        let change = |t: usize, found: &Lookup| self.motion.texture(t, found);
        let tangent = view.interface_change(here.vertices, b, db, change);
        Interface {
            reflectance: dual_vector(value.reflectance, tangent.reflectance),
            second_reflectance: dual_vector(value.second_reflectance, tangent.second_reflectance),
            eta: dual_vector(value.eta, tangent.eta),
            k: dual_vector(value.k, tangent.k),
            alpha: Dual {
                value: value.alpha,
                tangent: tangent.alpha,
            },
        }
    }

    /// Layers and grain, with their tangents.
    fn layers(&self, here: &MovingVertex) -> Option<Layers<D>> {
        let vertices = here.vertices;
        if vertices.kinds.layered() == 0 {
            return None;
        }
        let grain = self.view.grain(&vertices.triangle).map(constant);
        let along = tangent(here.corners, grain);
        let b = here.b.map(|b| b.value);
        let db = here.b.map(|b| b.tangent);
        let view = self.view;
        let value = view.layers(vertices, b, value_of(along))?;
        let change = |t: usize, found: &Lookup| self.motion.texture(t, found);
        let change = view.layers_change(vertices, b, db, tangent_of(along), change);
        let (value, change) = (numbers(&value), numbers(&change));
        let dual = |i: usize| Dual {
            value: value[i],
            tangent: change[i],
        };
        Some(of_numbers(along, std::array::from_fn(dual)))
    }

    /// What a rough plastic lets through toward directions at cosine `cos_out`.
    fn transmission(&self, here: &MovingVertex, cos_out: Lane) -> RoughTransmission<D> {
        let n = value_of(here.n);
        let t = self.view.transmission(here.vertices, n, cos_out);
        t.map(constant)
    }

    /// π times the BSDF for light of this kind that arrives along `w`.
    pub(crate) fn bsdf_evaluate(&self, here: &MovingVertex, w: V3<D>, light: LightKind) -> V3<D> {
        let Some(interface) = &here.interface else {
            return here.diffuse_reflectance;
        };
        let cos_out = value_of(here.n).dot(value_of(w).normalize());
        let [lit, lobes] = here.vertices.kinds.lit_by(light);
        let value = bsdf_evaluate(
            here.n,
            here.direction,
            w,
            *interface,
            self.transmission(here, cos_out),
            here.vertices.kinds.masks(),
            lane_mask(lobes),
        );
        let kinds = &here.vertices.kinds;
        let value = match here.layers {
            None => value,
            Some(layers) => {
                let (n, direction) = (here.n, here.direction);
                let lit = kinds.lit_masks(light);
                let layered =
                    layered_evaluate(n, direction, w, *interface, layers, kinds.masks(), lit);
                V3::select(lane_mask(kinds.layered()), layered, value)
            }
        };
        let value = self.shown(here, w, value);
        V3::select(lane_mask(lit), value, V3::splat(0.0))
    }

    /// The next ray's direction, and what the path is multiplied with.
    fn bounce(&self, here: &MovingVertex) -> (V3<D>, V3<D>) {
        let vertices = here.vertices;
        let local = dual_vector(vertices.local, V3::splat(0.0));
        let Some(interface) = &here.interface else {
            let direction = direction_from_local(here.n, local);
            return self.drift(here, direction, here.diffuse_reflectance);
        };
        let (direction, weight) = bsdf_sample(
            here.n,
            here.direction,
            local,
            *interface,
            self.transmission(here, vertices.local.z),
            vertices.lobes.masks(),
            vertices.kinds.masks(),
        );
        let (mut direction, mut weight) = (direction, weight);
        if let Some(layers) = here.layers {
            let is_layered = lane_mask(vertices.kinds.layered());
            let (own, layered) = layered_sample(
                here.n,
                here.direction,
                local,
                *interface,
                layers,
                vertices.lobes.masks(),
                vertices.kinds.masks(),
            );
            direction = V3::select(is_layered, own, direction);
            weight = V3::select(is_layered, layered, weight);
        }
        weight = self.shown(here, direction, weight);
        (direction, weight) = self.rest(here, direction, weight);
        self.drift(here, direction, weight * constant(vertices.inverse_density))
    }
}

/// A number that does not move.
pub fn constant(value: Lane) -> D {
    Dual {
        value,
        tangent: Lane::splat(0.0),
    }
}

pub(crate) fn value_of(v: V3<D>) -> V3<Lane> {
    V3 {
        x: v.x.value,
        y: v.y.value,
        z: v.z.value,
    }
}

pub(crate) fn dual_number(d: D, lane: usize) -> Dual<f64> {
    Dual {
        value: d.value.to_array()[lane] as f64,
        tangent: d.tangent.to_array()[lane] as f64,
    }
}

pub(crate) fn dual_lane(v: V3<D>, lane: usize) -> V3<Dual<f64>> {
    V3 {
        x: dual_number(v.x, lane),
        y: dual_number(v.y, lane),
        z: dual_number(v.z, lane),
    }
}

fn add_lane(v: V3<Lane>, lane: u8, value: Rgb) -> V3<Lane> {
    let add = |x: Lane, y: f32| {
        let mut x = x.to_array();
        x[lane as usize] += y;
        Lane::new(x)
    };
    V3 {
        x: add(v.x, value[0]),
        y: add(v.y, value[1]),
        z: add(v.z, value[2]),
    }
}
