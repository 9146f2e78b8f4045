//! Tracing paths, one packet of lanes at a time: camera ray, light sample, bounce, and so on.
//!
//! At every vertex the light that arrives from area lights is an integral over the lights' own surface
//! (`kernels::light`), estimated by light samples and by bounces that happen to end on a light, combined by the
//! power heuristic. Everything else (the environment, light reflected by other surfaces) arrives along bounces
//! drawn proportionally to the cosine. The weights and densities are numbers at θ₀: they are ways of *sampling*
//! an integrand that is differentiated in coordinates which no strategy depends on, so freezing them is exact
//! (METHODS §1.6 warns of freezing them where strategies move differently).

use super::bounce_cells::{self, Seen};
use super::camera::{Camera, splat};
use super::light_cells::{self, Lines};
use super::lights::Lights;
use super::random::Stream;
use super::store::{LightSamples, TileStore, Vertices, lane_mask, masked};
use crate::kernels::frame::direction_from_local;
use crate::kernels::light::triangle_irradiance;
use crate::kernels::normal::{face_normal, shading_normal};
use crate::lanes::{LANES, Lane, Mask, Real, V3};
use crate::scene::{Rgb, Scene};
use crate::trace::geometry::{Geometry, NO_TRIANGLE, gather};
use crate::trace::{Accel, Coherence, Hits, Rays};
use crate::warp::adjacency::Adjacency;
use glam::Vec3;

/// Pairs of random numbers that a vertex consumes.
pub const PAIRS_PER_VERTEX: u32 = 4;

/// What limits a path.
#[derive(Clone, Copy, Debug)]
pub struct PathLimits {
    pub max_depth: u32,
    pub rr_depth: u32,
    pub hide_emitters: bool,
}

/// What was done: rays traced by kind, and silhouettes that could not be found.
#[derive(Clone, Copy, Debug, Default)]
pub struct Counts {
    pub camera: u64,
    pub shadow: u64,
    pub bounce: u64,
    /// Shadow rays to a light's rim: they only find silhouettes.
    pub light_cell: u64,
    /// Rays along the horizon and beside it: they only find silhouettes.
    pub bounce_cell: u64,
    /// Rays that look for and beside silhouettes, and those of the paths that go on from there.
    pub probe: u64,
    /// Cells between whose ends a silhouette was found.
    pub resolved: u64,
    /// Cells whose ends differ though no silhouette was found between them.
    pub unresolved: u64,
    /// Samples dropped because they were not finite.
    pub not_finite: u64,
}

impl Counts {
    /// All rays.
    pub fn rays(&self) -> u64 {
        self.camera + self.shadow + self.bounce + self.light_cell + self.bounce_cell + self.probe
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, o: Self) {
        self.camera += o.camera;
        self.shadow += o.shadow;
        self.bounce += o.bounce;
        self.light_cell += o.light_cell;
        self.bounce_cell += o.bounce_cell;
        self.probe += o.probe;
        self.resolved += o.resolved;
        self.unresolved += o.unresolved;
        self.not_finite += o.not_finite;
    }
}

/// Everything a path needs to know of the scene.
pub struct Tracer<'a> {
    pub scene: &'a Scene,
    pub geometry: &'a Geometry,
    pub accel: &'a Accel,
    pub lights: &'a Lights,
    pub camera: Camera,
    pub limits: PathLimits,
    /// Given if silhouettes are wanted, because something moves.
    pub adjacency: Option<&'a Adjacency>,
}

/// Rays that are about to be traced.
#[derive(Clone, Copy)]
pub struct RayPacket {
    pub active: u32,
    pub origin: V3<Lane>,
    pub direction: V3<Lane>,
    pub near: f32,
    pub far: f32,
}

/// Where a packet ended, seen from the next ray to leave.
pub struct Surface {
    pub x: V3<Lane>,
    /// Unit shading normal, on the side the ray came from.
    pub n: V3<Lane>,
    /// Unit geometric normal, as the triangle is wound.
    pub geometric: V3<Lane>,
}

impl Tracer<'_> {
    /// Traces the paths that begin with `rays` at vertex `depth` (0: the camera's) and appends their vertices.
    pub fn trace(
        &self,
        rays: RayPacket,
        stream: &Stream,
        index: &[u32; LANES],
        counts: &mut Counts,
        store: &mut TileStore,
    ) {
        self.trace_vertices(rays, 0, stream, index, counts, store);
        store.depths.push(store.vertices.len() as u32);
    }

    fn trace_vertices(
        &self,
        mut rays: RayPacket,
        first_depth: u32,
        stream: &Stream,
        index: &[u32; LANES],
        counts: &mut Counts,
        store: &mut TileStore,
    ) {
        let mut coherence = Coherence::Coherent;
        let mut throughput = V3::splat(1.0);
        let mut emission_weight = Lane::splat(if first_depth > 0 || self.limits.hide_emitters {
            0.0
        } else {
            1.0
        });
        let mut previous: Option<Surface> = None;
        for depth in first_depth.. {
            let triangle = self.intersect(&rays, coherence);
            *if depth == 0 {
                &mut counts.camera
            } else {
                &mut counts.bounce
            } += rays.active.count_ones() as u64;
            if let (Some(adjacency), Some(from)) = (self.adjacency, &previous) {
                bounce_cells::find(
                    self,
                    adjacency,
                    from,
                    &rays,
                    Seen::Triangles(&triangle),
                    depth,
                    stream,
                    index,
                    counts,
                    store,
                );
            }
            let mut vertices = Vertices {
                origin: rays.origin,
                direction: rays.direction,
                triangle,
                throughput,
                ..Vertices::default()
            };
            for (lane, &t) in triangle.iter().enumerate() {
                if rays.active >> lane & 1 == 1 {
                    *(if t == NO_TRIANGLE {
                        &mut vertices.escaped
                    } else {
                        &mut vertices.hit
                    }) |= 1 << lane;
                }
            }
            if depth == 0 && self.limits.hide_emitters {
                vertices.escaped = 0;
            }
            let surface = self.surface(&mut vertices);
            if let Some(previous) = &previous {
                emission_weight = self.bounce_mis_weight(&vertices, previous);
            }
            vertices.emission_weight = emission_weight;
            self.reflectance(&mut vertices);

            let segments = depth + 2;
            if vertices.hit != 0 && segments <= self.limits.max_depth {
                let goes_on = segments < self.limits.max_depth;
                let bounces = goes_on || self.scene.environment.is_some();
                let base = depth * PAIRS_PER_VERTEX;
                if !self.lights.is_empty() {
                    self.sample_lights(
                        &mut vertices,
                        &surface,
                        stream,
                        index,
                        base,
                        bounces,
                        counts,
                        store,
                    );
                }
                if bounces {
                    let (next, alive) =
                        self.bounce(&mut vertices, &surface, stream, index, base, depth);
                    rays = RayPacket {
                        active: alive,
                        ..next
                    };
                    throughput = throughput.times(vertices.reflectance) * vertices.survival;
                    coherence = Coherence::Incoherent;
                    let last = !goes_on;
                    store.vertices.push(vertices);
                    if alive == 0 {
                        return;
                    }
                    if last && self.lights.is_empty() {
                        // Only whether the environment is seen matters: any hit will do.
                        let end = self.last_bounce(&rays, throughput, counts);
                        if let Some(adjacency) = self.adjacency {
                            let sees = Seen::Environment(end.escaped);
                            bounce_cells::find(
                                self,
                                adjacency,
                                &surface,
                                &rays,
                                sees,
                                depth + 1,
                                stream,
                                index,
                                counts,
                                store,
                            );
                        }
                        store.vertices.push(end);
                        return;
                    }
                    previous = Some(surface);
                    continue;
                }
            }
            store.vertices.push(vertices);
            return;
        }
    }

    /// The vertices of a bounce of which only the escape counts.
    fn last_bounce(&self, rays: &RayPacket, throughput: V3<Lane>, counts: &mut Counts) -> Vertices {
        counts.bounce += rays.active.count_ones() as u64;
        let blocked = self
            .accel
            .occluded(&to_rays(rays), rays.active, Coherence::Incoherent);
        Vertices {
            origin: rays.origin,
            direction: rays.direction,
            throughput,
            escaped: rays.active & !blocked,
            ..Vertices::default()
        }
    }

    /// The triangle each ray meets first.
    pub fn intersect(&self, rays: &RayPacket, coherence: Coherence) -> [u32; LANES] {
        let mut hits = Hits::<LANES>::default();
        self.accel
            .intersect(&to_rays(rays), rays.active, &mut hits, coherence);
        std::array::from_fn(|l| {
            if rays.active >> l & 1 == 1 && hits.mesh[l] != crate::trace::MISS {
                self.geometry.first_triangle[hits.mesh[l] as usize] + hits.triangle[l]
            } else {
                NO_TRIANGLE
            }
        })
    }

    /// Position and normals where the rays end; sets `facing`.
    pub fn surface(&self, vertices: &mut Vertices) -> Surface {
        let corners = self.geometry.corners(&vertices.triangle);
        let [v0, v1, v2] = self.geometry.gather_positions(&corners);
        let (o, d) = (vertices.origin, vertices.direction);
        let (t, b1, b2) = crate::kernels::triangle::triangle_hit(o, d, v0, v1, v2);
        let geometric = face_normal(v0, v1, v2);
        let mut n = geometric;
        let smooth = self.smooth_lanes(&vertices.triangle);
        if smooth != 0 {
            let [n0, n1, n2] = self.geometry.gather_normals(&corners);
            n = V3::select(lane_mask(smooth), shading_normal(n0, n1, n2, b1, b2), n);
        }
        // The side that is seen is the triangle's, not the shading normal's: where that turns away at grazing angles a
        // one-sided surface would be black in a rim whose border is no edge of any mesh.
        vertices.facing = -(geometric.dot(d).signum()) * (n.dot(geometric).signum());
        Surface {
            x: o + d * t,
            n: n * vertices.facing,
            geometric,
        }
    }

    /// Lanes whose triangle is shaded smoothly.
    pub fn smooth_lanes(&self, triangle: &[u32; LANES]) -> u32 {
        if self.geometry.normals.is_empty() {
            return 0;
        }
        (0..LANES).fold(0, |bits, l| {
            let t = triangle[l];
            let smooth = t != NO_TRIANGLE
                && self.geometry.smooth[self.geometry.mesh_of_triangle[t as usize] as usize];
            bits | (smooth as u32) << l
        })
    }

    fn reflectance(&self, vertices: &mut Vertices) {
        // One-sided materials are black where the (unflipped) shading normal looks away.
        let facing = vertices.facing.to_array();
        vertices.reflectance = self.per_lane(&vertices.triangle, |mesh, lane| {
            let material = &self.scene.materials[self.scene.meshes[mesh].material];
            if material.two_sided || facing[lane] > 0.0 {
                material
                    .bsdf
                    .colour()
                    .map_or([0.0; 3], |t| self.scene.constant(t))
            } else {
                [0.0; 3]
            }
        });
    }

    /// A colour of each lane's mesh; zero where there is none.
    pub fn per_lane(&self, triangle: &[u32; LANES], of: impl Fn(usize, usize) -> Rgb) -> V3<Lane> {
        let mut rgb = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            if triangle[lane] != NO_TRIANGLE {
                let value = of(
                    self.geometry.mesh_of_triangle[triangle[lane] as usize] as usize,
                    lane,
                );
                for c in 0..3 {
                    rgb[c][lane] = value[c];
                }
            }
        }
        let [x, y, z] = rgb.map(Lane::new);
        V3 { x, y, z }
    }

    /// Radiance emitted toward where the ray came from, of each lane's triangle.
    pub fn emission(&self, vertices: &Vertices) -> V3<Lane> {
        if self.lights.is_empty() {
            return V3::splat(0.0);
        }
        self.emitted(vertices, |light| {
            self.scene.constant(self.scene.area_lights[light].radiance)
        })
    }

    /// A colour of each lane's light where its lit side was met; zero elsewhere.
    pub fn emitted(&self, vertices: &Vertices, of: impl Fn(usize) -> Rgb) -> V3<Lane> {
        self.per_lane(&vertices.triangle, |mesh, lane| {
            match self.lights.of_mesh[mesh] {
                Some(light) if self.sees_front(vertices, lane) => of(light as usize),
                _ => [0.0; 3],
            }
        })
    }

    /// Lanes whose material reflects on both sides.
    pub fn two_sided(&self, vertices: &Vertices) -> u32 {
        (0..LANES)
            .filter(|&l| vertices.hit >> l & 1 == 1)
            .fold(0, |bits, l| {
                let mesh = self.geometry.mesh_of_triangle[vertices.triangle[l] as usize] as usize;
                bits | (self.scene.materials[self.scene.meshes[mesh].material].two_sided as u32)
                    << l
            })
    }

    /// Whether a lane's ray meets the side of the triangle from which it is wound counter-clockwise.
    pub fn sees_front(&self, vertices: &Vertices, lane: usize) -> bool {
        let [p, q, r] = self.geometry.triangles[vertices.triangle[lane] as usize]
            .map(|v| self.geometry.positions[v as usize]);
        lane_of(vertices.direction, lane).dot((q - p).cross(r - p)) < 0.0
    }

    /// Power-heuristic weight of emission found by a bounce, against the light samples of the vertex it left.
    fn bounce_mis_weight(&self, vertices: &Vertices, from: &Surface) -> Lane {
        if self.lights.is_empty() {
            return Lane::splat(0.0);
        }
        let corners = self.geometry.corners(&vertices.triangle);
        let v = self.geometry.gather_positions(&corners);
        let d = vertices.direction;
        let (t, _, _) =
            crate::kernels::triangle::triangle_hit(vertices.origin, d, v[0], v[1], v[2]);
        let cos_light = -(d.dot(face_normal(v[0], v[1], v[2])));
        let cos = from.n.dot(d);
        let pdf_area = self.per_lane(&vertices.triangle, |mesh, _| {
            [self.lights.of_mesh[mesh].map_or(0.0, |l| self.lights.pdf_area[l as usize]); 3]
        });
        // Both densities over solid angle: cos/π against p_A·r²/cos_light.
        let bounce = cos * cos_light * Lane::splat(std::f32::consts::FRAC_1_PI);
        let light = pdf_area.x * t * t;
        let weight = bounce * bounce / (bounce * bounce + light * light);
        let emits =
            lane_mask(vertices.hit) & light.gt(Lane::splat(0.0)) & cos_light.gt(Lane::splat(0.0));
        <Lane as Real>::select(emits, weight, Lane::splat(0.0))
    }

    #[allow(clippy::too_many_arguments)]
    fn sample_lights(
        &self,
        vertices: &mut Vertices,
        surface: &Surface,
        stream: &Stream,
        index: &[u32; LANES],
        base: u32,
        with_bounce: bool,
        counts: &mut Counts,
        store: &mut TileStore,
    ) {
        let (s, r) = stream.pair(index, base);
        let (pick, _) = if self.lights.patches.len() > 1 {
            stream.pair(index, base + 1)
        } else {
            (Lane::splat(0.0), Lane::splat(0.0))
        };
        let (patch, _) = self.lights.pick(pick);
        let patches = patch.map(|p| &self.lights.patches[p as usize]);
        // Fold the square onto a single triangle, on which the density doubles.
        let drawn = [s.to_array(), r.to_array()];
        let [mut s, mut r] = drawn;
        let mut pdf = [0.0; LANES];
        for l in 0..LANES {
            pdf[l] = patches[l].probability;
            if patches[l].upper.is_none() {
                pdf[l] *= 2.0;
                if s[l] + r[l] > 1.0 {
                    (s[l], r[l]) = (1.0 - s[l], 1.0 - r[l]);
                }
            }
        }
        let irradiance = self.patch_irradiance(surface, &patch, &s, &r);
        let zero = Lane::splat(0.0);
        let lit = irradiance.gt(zero) & lane_mask(vertices.hit);
        let y = self.patch_points(&patch, &s, &r);
        let visible = self.visible(surface, y, lit.to_bits(), counts);
        let mut weight = Lane::splat(1.0) / Lane::new(pdf);
        if with_bounce {
            // In (s, r) the bounce's density is cos·cos_light·|e1×e2|/(π r²): the irradiance kernel itself.
            let light = Lane::new(pdf);
            weight *= light * light / (light * light + irradiance * irradiance);
        }
        vertices.light = LightSamples {
            patch,
            s: Lane::new(s),
            r: Lane::new(r),
            weight: <Lane as Real>::select(lane_mask(visible), weight, zero),
            irradiance: <Lane as Real>::select(lit, irradiance, zero),
        };
        if let Some(adjacency) = self.adjacency {
            let [s, r] = drawn;
            let (_, jitter) = stream.pair(index, base + 1);
            let lines = Lines {
                s,
                r,
                jitter: jitter.to_array(),
            };
            let first = store.light_crossings.len() as u32;
            light_cells::find(
                self,
                adjacency,
                vertices,
                surface,
                &patch,
                &lines,
                counts,
                &mut store.light_crossings,
            );
            vertices.crossings = [first, store.light_crossings.len() as u32];
        }
    }

    /// [`triangle_irradiance`] of each lane's patch at (s, r).
    pub fn patch_irradiance(
        &self,
        surface: &Surface,
        patch: &[u32; LANES],
        s: &[f32; LANES],
        r: &[f32; LANES],
    ) -> Lane {
        let (q, b) = self.patch_corners(patch, s, r);
        let [q0, q1, q2] = gather(&q, |v, _| self.geometry.positions[v as usize]);
        triangle_irradiance(surface.x, surface.n, q0, q1, q2, b[0], b[1])
    }

    /// The light triangle's vertices and barycentrics in each lane.
    pub fn patch_corners(
        &self,
        patch: &[u32; LANES],
        s: &[f32; LANES],
        r: &[f32; LANES],
    ) -> ([[u32; 3]; LANES], [Lane; 2]) {
        let mut corners = [[0; 3]; LANES];
        let mut b = [[0.0; LANES]; 2];
        for l in 0..LANES {
            let at;
            (corners[l], at) = self.lights.patches[patch[l] as usize].vertices_at(s[l], r[l]);
            (b[0][l], b[1][l]) = (at[0], at[1]);
        }
        (corners, b.map(Lane::new))
    }

    /// Points of each lane's patch.
    pub fn patch_points(
        &self,
        patch: &[u32; LANES],
        s: &[f32; LANES],
        r: &[f32; LANES],
    ) -> V3<Lane> {
        let points: [Vec3; LANES] =
            std::array::from_fn(|l| self.lights.patches[patch[l] as usize].point(s[l], r[l]));
        from_lanes(&points)
    }

    /// Which of the lanes in `active` see the point `y` from their surface.
    pub fn visible(&self, surface: &Surface, y: V3<Lane>, active: u32, counts: &mut Counts) -> u32 {
        if active == 0 {
            return 0;
        }
        let origin = leave(surface.x, surface.geometric, y - surface.x);
        let rays = RayPacket {
            active,
            origin,
            direction: y - origin,
            near: 0.0,
            far: SHADOW_FAR,
        };
        counts.shadow += active.count_ones() as u64;
        active
            & !self
                .accel
                .occluded(&to_rays(&rays), active, Coherence::Incoherent)
    }

    /// Draws the next direction and decides who goes on.
    fn bounce(
        &self,
        vertices: &mut Vertices,
        surface: &Surface,
        stream: &Stream,
        index: &[u32; LANES],
        base: u32,
        depth: u32,
    ) -> (RayPacket, u32) {
        let (u, v) = stream.pair(index, base + 2);
        vertices.local = cosine_direction(u, v);
        let [lx, ly, lz] = vertices.local;
        let direction = direction_from_local(surface.n, lx, ly, lz);
        let weight = vertices.throughput.times(vertices.reflectance);
        let brightest = weight.x.max(weight.y).max(weight.z);
        let zero = Lane::splat(0.0);
        let mut alive = lane_mask(vertices.hit) & brightest.gt(zero);
        let mut survival = Lane::splat(1.0);
        if depth + 1 >= self.limits.rr_depth {
            let chance = brightest.min(Lane::splat(0.95));
            let (u, _) = stream.pair(index, base + 3);
            alive = alive & u.lt(chance);
            survival = Lane::splat(1.0) / chance;
        }
        vertices.survival = <Lane as Real>::select(alive, survival, zero);
        let origin = leave(surface.x, surface.geometric, direction);
        let rays = RayPacket {
            active: 0,
            origin,
            direction,
            near: 0.0,
            far: f32::INFINITY,
        };
        (rays, alive.to_bits())
    }

    /// Radiance of each path: Σ over vertices of throughput · (emission + reflectance · light sample).
    pub fn radiance(&self, path: &[Vertices]) -> V3<Lane> {
        let mut sum = V3::splat(0.0);
        for vertices in path {
            sum = sum + vertices.throughput.times(self.arriving(vertices));
            if vertices.hit != 0 && !self.lights.is_empty() {
                sum = sum
                    + vertices
                        .throughput
                        .times(vertices.reflectance)
                        .times(self.sampled_light(vertices));
            }
        }
        sum
    }

    /// Emission and environment that the arriving rays found.
    pub fn arriving(&self, vertices: &Vertices) -> V3<Lane> {
        let mut sum = masked(
            vertices.hit,
            self.emission(vertices) * vertices.emission_weight,
        );
        if let (Some(environment), true) = (&self.scene.environment, vertices.escaped != 0) {
            sum = sum
                + masked(
                    vertices.escaped,
                    splat(Vec3::from(self.scene.constant(environment.radiance))),
                );
        }
        sum
    }

    /// What the light samples bring, before the reflectance here.
    pub fn sampled_light(&self, vertices: &Vertices) -> V3<Lane> {
        let lit = vertices.light.weight.gt(Lane::splat(0.0));
        if !lit.any() {
            return V3::splat(0.0);
        }
        let light = &vertices.light;
        let value = self.light_radiance(&light.patch) * (light.irradiance * light.weight);
        V3::select(lit, value, V3::splat(0.0))
    }

    /// Radiance of each lane's patch.
    pub fn light_radiance(&self, patch: &[u32; LANES]) -> V3<Lane> {
        self.per_patch(patch, |light| {
            self.scene.constant(self.scene.area_lights[light].radiance)
        })
    }

    /// A colour of the light to which each lane's patch belongs.
    pub fn per_patch(&self, patch: &[u32; LANES], of: impl Fn(usize) -> Rgb) -> V3<Lane> {
        let of = |p: u32| Vec3::from(of(self.lights.patches[p as usize].light as usize));
        if self.scene.area_lights.len() == 1 {
            splat(of(0))
        } else {
            from_lanes(&patch.map(of))
        }
    }

    /// Radiance along rays that lead to vertex `depth` of a path; without emission there, unless the camera sees it. For
    /// looking beside silhouettes, so no silhouettes are sought.
    pub fn radiance_along(
        &self,
        rays: RayPacket,
        depth: u32,
        stream: &Stream,
        index: &[u32; LANES],
        counts: &mut Counts,
    ) -> V3<Lane> {
        let plain = Tracer {
            adjacency: None,
            ..*self
        };
        let mut store = TileStore::default();
        let mut probed = Counts::default();
        plain.trace_vertices(rays, depth, stream, index, &mut probed, &mut store);
        counts.probe += probed.rays();
        plain.radiance(&store.vertices)
    }
}

impl Vertices {
    /// Unit shading normals on the side the rays came from.
    pub fn normal(&self, tracer: &Tracer) -> V3<Lane> {
        tracer.surface(&mut self.clone()).n
    }
}

/// Shadow rays stop a little before the light.
pub const SHADOW_FAR: f32 = 1.0 - 1e-4;

/// A cosine-distributed direction about +z from two uniform numbers.
pub fn cosine_direction(u: Lane, v: Lane) -> [Lane; 3] {
    let radius = u.sqrt();
    let angle = v * Lane::splat(std::f32::consts::TAU);
    let (sin, cos) = angle.sin_cos();
    let up = (Lane::splat(1.0) - u).max(Lane::splat(0.0)).sqrt();
    [radius * cos, radius * sin, up]
}

/// A point just off the surface, on the side that `direction` leaves to. The offset is some hundred units in the
/// last place of the largest coordinate: what rounding can have moved the hit by.
pub fn leave(x: V3<Lane>, geometric: V3<Lane>, direction: V3<Lane>) -> V3<Lane> {
    let size = x.x.abs().max(x.y.abs()).max(x.z.abs()) + Lane::splat(1.0);
    let step = size * Lane::splat(2e-5) * geometric.dot(direction).signum();
    x + geometric * step
}

/// As Embree takes them.
pub fn to_rays(rays: &RayPacket) -> Rays<LANES> {
    Rays {
        org_x: rays.origin.x.to_array(),
        org_y: rays.origin.y.to_array(),
        org_z: rays.origin.z.to_array(),
        tnear: [rays.near; LANES],
        dir_x: rays.direction.x.to_array(),
        dir_y: rays.direction.y.to_array(),
        dir_z: rays.direction.z.to_array(),
        tfar: [rays.far; LANES],
    }
}

/// One lane of a vector.
pub fn lane_of(v: V3<Lane>, lane: usize) -> Vec3 {
    Vec3::new(
        v.x.to_array()[lane],
        v.y.to_array()[lane],
        v.z.to_array()[lane],
    )
}

/// A vector a lane.
pub fn from_lanes(v: &[Vec3; LANES]) -> V3<Lane> {
    V3 {
        x: Lane::new(v.map(|p| p.x)),
        y: Lane::new(v.map(|p| p.y)),
        z: Lane::new(v.map(|p| p.z)),
    }
}
