//! How everything in the scene moves along one direction: a [`SceneDifferential`] spread over
//! [`Geometry`].

use crate::kernels::camera::camera_direction;
use crate::lanes::{Dual, LANES, Lane, Real, V3};
use crate::paths::environment::map;
use crate::paths::film::camera::Camera;
use crate::paths::rays::{from_lanes, lane_of, splat};
use crate::paths::surface::relief::Turned;
use crate::paths::surface::texture::Lookup;
use crate::scene::{
    CameraDifferential, Environment, EnvironmentDifferential, Relief, Rgb, Scene, SceneDifferential,
};
use crate::trace::geometry::{Geometry, NO_TRIANGLE, gather};
use glam::{DVec3, Vec3};

/// The tangent of a scene, numbered as [`Geometry`] numbers it.
pub struct Motion {
    /// Velocity of each vertex; empty if no mesh moves.
    pub positions: Vec<Vec3>,
    /// Change of each shading normal; empty if no smooth mesh moves.
    pub normals: Vec<Vec3>,
    /// Whether each mesh moves or its normals turn.
    pub moving_mesh: Vec<bool>,
    pub camera: Option<CameraDifferential>,
    /// Per texture, per texel.
    pub texels: Vec<Option<Vec<Rgb>>>,
    /// Per texture: the rows of `to_uv`.
    pub to_uv: Vec<Option<[f32; 6]>>,
    /// Whether any of them changes.
    pub colours: bool,
    /// Velocity of each delta light.
    pub delta_lights: Vec<Vec3>,
    pub environment: EnvironmentDifferential,
}

/// What moves of each mesh, over all vertices.
fn spread(geometry: &Geometry, of: &[Option<Vec<Vec3>>]) -> Vec<Vec3> {
    let mut all = vec![Vec3::ZERO; geometry.positions.len()];
    for (mesh, values) in of.iter().enumerate() {
        if let Some(values) = values {
            let first = geometry.first_vertex[mesh] as usize;
            all[first..first + values.len()].copy_from_slice(values);
        }
    }
    all
}

impl Motion {
    pub fn new(scene: &Scene, geometry: &Geometry, tangent: &SceneDifferential) -> Self {
        let mut motion = Self::without_normals(geometry, tangent);
        let mut smooth = motion.moving_mesh.iter().zip(&geometry.smooth);
        if smooth.any(|(m, s)| *m && *s) {
            let turned = crate::gradient::scene::normals::tangent(scene, tangent);
            motion.normals = spread(geometry, &turned);
        }
        motion
    }

    /// The same for those who look at no shading normal, which take long to differentiate.
    pub fn without_normals(geometry: &Geometry, tangent: &SceneDifferential) -> Self {
        let moving_mesh: Vec<bool> = tangent.positions.iter().map(Option::is_some).collect();
        let positions = match moving_mesh.contains(&true) {
            true => spread(geometry, &tangent.positions),
            false => Vec::new(),
        };
        Self {
            positions,
            normals: Vec::new(),
            moving_mesh,
            camera: tangent.camera,
            texels: tangent.texels.clone(),
            to_uv: tangent.to_uv.clone(),
            colours: tangent.texels.iter().any(Option::is_some)
                || tangent.to_uv.iter().any(Option::is_some),
            delta_lights: tangent
                .delta_lights
                .iter()
                .map(|m| m.unwrap_or_default())
                .collect(),
            environment: tangent.environment.unwrap_or_default(),
        }
    }

    /// How a texture changes where it is looked up.
    pub fn texture(&self, texture: usize, found: &Lookup) -> Vec3 {
        let mixed = self.texels[texture].as_ref();
        let moved = self.to_uv[texture].as_ref();
        mixed.map_or(Vec3::ZERO, |t| found.mix(t)) + moved.map_or(Vec3::ZERO, |m| found.moved(m))
    }

    /// How what turns normals changes where a relief is looked up: the direction, or the rises.
    pub fn relief(&self, relief: &Relief, turned: &Turned) -> Vec3 {
        match turned {
            Turned::Map(found, _) => self.texture(relief.texture, found) * 2.0,
            Turned::Bumps(rise, _) => {
                let Some(texels) = &self.texels[relief.texture] else {
                    return Vec3::ZERO;
                };
                let [x, y] = rise.by_texels.map(|weights| {
                    let parts = rise.texels.iter().zip(weights);
                    parts.map(|(&t, w)| texels[t as usize][0] * w).sum()
                });
                Vec3::new(x, y, 0.0) * relief.bumps.unwrap_or(1.0)
            }
        }
    }

    /// How the colour of a constant texture changes.
    pub fn texel(&self, texture: usize) -> Rgb {
        self.texels[texture].as_ref().map_or([0.0; 3], |t| t[0])
    }

    /// The change of the environment's radiance along directions that change by `turning`.
    pub fn environment_change(
        &self,
        scene: &Scene,
        environment: &Environment,
        direction: V3<Lane>,
        turning: V3<Lane>,
    ) -> V3<Lane> {
        let texels = self.texels[environment.radiance].as_ref();
        let Some(map) = &environment.map else {
            return splat(texels.map_or(Vec3::ZERO, |t| Vec3::from(t[0])));
        };
        let texture = &scene.textures[environment.radiance];
        from_lanes(&std::array::from_fn(|lane| {
            let (d, turning) = (lane_of(direction, lane), lane_of(turning, lane));
            let found = map::lookup(texture, map, d);
            let mixed: Vec3 = texels.map_or(Vec3::ZERO, |texels| {
                let parts = found.texels.iter().zip(found.weights);
                parts
                    .map(|(&t, w)| Vec3::from(texels[t as usize]) * w)
                    .sum()
            });
            // If the map turns by ω the direction turns by −ω as the map sees it.
            let seen = turning - self.environment.rotation.cross(d);
            let [u, v] = found.by_direction.map(|g| g.dot(seen));
            let brighter = found.value * (self.environment.scale / map.scale);
            mixed + brighter + found.by_uv[0] * u + found.by_uv[1] * v
        }))
    }

    /// Whether the mesh of a triangle moves.
    pub fn moves(&self, geometry: &Geometry, triangle: u32) -> bool {
        triangle != NO_TRIANGLE
            && self.moving_mesh[geometry.mesh_of_triangle[triangle as usize] as usize]
    }

    /// The velocity of a vertex.
    pub fn velocity(&self, vertex: u32) -> DVec3 {
        let velocity = self.positions.get(vertex as usize).copied();
        velocity.unwrap_or(Vec3::ZERO).as_dvec3()
    }

    /// A vertex with its velocity.
    pub fn point(&self, geometry: &Geometry, vertex: u32) -> V3<Dual<f64>> {
        let p = geometry.positions[vertex as usize].as_dvec3();
        let v = self.velocity(vertex);
        let dual = |value, tangent| Dual { value, tangent };
        V3 {
            x: dual(p.x, v.x),
            y: dual(p.y, v.y),
            z: dual(p.z, v.z),
        }
    }

    /// A vertex's shading normal, with how it turns.
    pub fn normal(&self, geometry: &Geometry, vertex: u32) -> V3<Dual<f64>> {
        let n = geometry.normals[vertex as usize];
        let turning = self.normals.get(vertex as usize).copied();
        dual_vector(splat(n), splat(turning.unwrap_or(Vec3::ZERO)))
    }

    /// The corners of a triangle in each lane with their velocities.
    pub fn corners(&self, geometry: &Geometry, corners: &[[u32; 3]; LANES]) -> [V3<Dual<Lane>>; 3] {
        join(
            geometry.gather_positions(corners),
            self.gather(&self.positions, corners),
        )
    }

    /// The shading normals at a triangle's corners in each lane, with how they turn.
    pub fn corner_normals(
        &self,
        geometry: &Geometry,
        corners: &[[u32; 3]; LANES],
    ) -> [V3<Dual<Lane>>; 3] {
        join(
            geometry.gather_normals(corners),
            self.gather(&self.normals, corners),
        )
    }

    fn gather(&self, of: &[Vec3], corners: &[[u32; 3]; LANES]) -> [V3<Lane>; 3] {
        if of.is_empty() {
            return [V3::splat(0.0); 3];
        }
        gather(corners, |v, _| {
            if v == u32::MAX {
                Vec3::ZERO
            } else {
                of[v as usize]
            }
        })
    }

    /// The camera's position and axes, and tan(x_fov/2), with their velocities.
    pub fn camera<F: Real>(&self, camera: &Camera) -> MovingCamera<F> {
        let motion = self.camera.unwrap_or_default();
        let dual = |value: Vec3, tangent: Vec3| dual_vector(splat::<F>(value), splat::<F>(tangent));
        let tan = camera.tan_half_x_fov;
        let half_width = camera.parallel_half_width();
        // d tan(φ/2)/dφ = (1 + tan²)/2.
        let tan_velocity = (motion.x_fov_deg as f64).to_radians() * 0.5 * (1.0 + tan * tan);
        // A shifted principal point is a view axis that leans.
        let [right, down] = camera.axis_per_offset().map(|by| by.as_vec3());
        let shift = motion.principal_point_offset;
        let leans = right * shift.x + down * shift.y;
        let (mut axes, mut translation) = (motion.axes, motion.translation);
        match half_width {
            None => axes[2] += leans,
            Some(_) => translation += leans * camera.reach() as f32,
        }
        let turns: [Vec3; 3] =
            std::array::from_fn(|i| motion.rotation.cross(camera.axes[i]) + axes[i]);
        let [x, y, _] = turns;
        let axes = camera.film_axes(camera.axes);
        let turns = camera.film_axes(turns);
        MovingCamera {
            origin: dual(camera.origin, translation + camera.on_lens([x, y])),
            axes: std::array::from_fn(|i| dual(axes[i], turns[i])),
            parallel_half_width: half_width.map(F::splat),
            tan_half_x_fov: Dual {
                value: F::splat(tan),
                tangent: F::splat(tan_velocity),
            },
        }
    }
}

/// A camera with its velocity.
#[derive(Clone, Copy)]
pub struct MovingCamera<F> {
    pub origin: V3<Dual<F>>,
    pub axes: [V3<Dual<F>>; 3],
    pub tan_half_x_fov: Dual<F>,
    /// Given if all its rays are parallel.
    pub parallel_half_width: Option<F>,
}

impl<F: Real> MovingCamera<F> {
    /// Where its ray through a film point begins, and its direction, given the camera's tangents
    /// there ([`Camera::film_to_camera`]).
    pub fn ray(&self, [px, py]: [Dual<F>; 2]) -> (V3<Dual<F>>, V3<Dual<F>>) {
        let [x, y, z] = self.axes;
        match self.parallel_half_width {
            None => {
                let direction = camera_direction(x, y, z, self.tan_half_x_fov, px, py);
                (self.origin, direction)
            }
            Some(half_width) => {
                let half = Dual {
                    value: half_width,
                    tangent: F::splat(0.0),
                };
                let zero = V3::splat(0.0);
                let beside = camera_direction(x, y, zero, half, px, py);
                (self.origin + beside, z)
            }
        }
    }
}

/// A vector with its tangent.
pub fn dual_vector<F>(value: V3<F>, tangent: V3<F>) -> V3<Dual<F>> {
    V3 {
        x: Dual {
            value: value.x,
            tangent: tangent.x,
        },
        y: Dual {
            value: value.y,
            tangent: tangent.y,
        },
        z: Dual {
            value: value.z,
            tangent: tangent.z,
        },
    }
}

/// The tangent of a vector.
pub fn tangent_of<F: Copy>(v: V3<Dual<F>>) -> V3<F> {
    V3 {
        x: v.x.tangent,
        y: v.y.tangent,
        z: v.z.tangent,
    }
}

fn join(values: [V3<Lane>; 3], tangents: [V3<Lane>; 3]) -> [V3<Dual<Lane>>; 3] {
    std::array::from_fn(|c| dual_vector(values[c], tangents[c]))
}
