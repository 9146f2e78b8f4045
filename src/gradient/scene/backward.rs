//! Sums of cotangents: one tile's, sparse, and the whole film's, in the order of the tiles.

use crate::gradient::scene::sparse::SparseVectors;
use crate::gradient::scene::wanted::{Wanted, first_texels};
use crate::gradient::terms::{Object, Terms, TileTerms};
use crate::lanes::{LANES, Lane, V3};
use crate::paths::drift_body::BodyMotion;
use crate::paths::film::camera::Camera;
use crate::paths::film::drift::Drift;
use crate::paths::integral::ByIntegral;
use crate::paths::rays::lane_of;
use crate::paths::surface::texture::Lookup;
use crate::room::{self, NoRoom};
use crate::scene::{CameraDifferential, Scene, SceneDifferential};
use crate::trace::geometry::Geometry;
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// The camera's cotangents.
#[derive(Clone, Copy, Debug, Default)]
pub struct CameraSum {
    pub origin: DVec3,
    pub axes: [DVec3; 3],
    pub tan_half_x_fov: f64,
}

impl CameraSum {
    /// Adds cotangents of the origin, the axes and the tangent of half the opening angle.
    pub fn add(&mut self, origin: DVec3, axes: [DVec3; 3], tan_half_x_fov: f64) {
        self.origin += origin;
        for (sum, bar) in self.axes.iter_mut().zip(axes) {
            *sum += bar;
        }
        self.tan_half_x_fov += tan_half_x_fov;
    }
}

/// The environment map's cotangents.
#[derive(Clone, Copy, Debug, Default)]
pub struct EnvironmentSum {
    pub rotation: DVec3,
    pub scale: f64,
}

/// Where one tile's sweep adds to. Its dense scratch is used again by the next tile.
pub struct TileSums {
    positions: SparseVectors,
    normals: SparseVectors,
    /// Texels of all textures, one after another.
    texels: SparseVectors,
    /// The number of the first texel of each texture.
    first_texel: Vec<u32>,
    camera: CameraSum,
    environment: EnvironmentSum,
    /// Of the velocities of the film's nodes.
    drift: BTreeMap<usize, [f64; 2]>,
    /// Of the motions of bodies that directions follow.
    bodies: BTreeMap<usize, BodyMotion>,
    pub delta_lights: Vec<DVec3>,
    /// Per texture.
    pub to_uv: Vec<[f64; 6]>,
    /// Whether few terms carry it all.
    terms: Terms,
    /// What borders have brought, added up as sizes.
    pub brought: ByIntegral<f64>,
    /// Terms that were left out because they were not finite.
    not_finite: u64,
}

/// One tile's sums, ready to be added to the film's.
pub struct TileGradient {
    /// Terms that were left out because they were not finite.
    pub not_finite: u64,
    /// What borders have brought, added up as sizes.
    pub brought: ByIntegral<f64>,
    positions: Vec<(u32, Vec3)>,
    normals: Vec<(u32, Vec3)>,
    texels: Vec<(u32, Vec3)>,
    pub terms: TileTerms,
    camera: CameraSum,
    environment: EnvironmentSum,
    drift: BTreeMap<usize, [f64; 2]>,
    bodies: BTreeMap<usize, BodyMotion>,
    delta_lights: Vec<DVec3>,
    to_uv: Vec<[f64; 6]>,
}

impl TileSums {
    /// What one takes in memory before anything is added.
    pub fn bytes_needed(scene: &Scene, geometry: &Geometry, wanted: &Wanted) -> u64 {
        let numbers: usize = wanted.counts(scene, geometry).iter().sum();
        SparseVectors::BYTES * numbers as u64
    }

    pub fn new(scene: &Scene, geometry: &Geometry, wanted: &Wanted) -> Self {
        let [positions, normals, texels] = wanted.counts(scene, geometry);
        Self {
            positions: SparseVectors::new(positions),
            normals: SparseVectors::new(normals),
            texels: SparseVectors::new(texels),
            first_texel: first_texels(scene),
            camera: CameraSum::default(),
            environment: EnvironmentSum::default(),
            drift: BTreeMap::new(),
            bodies: BTreeMap::new(),
            delta_lights: vec![DVec3::ZERO; scene.delta_lights.len()],
            to_uv: vec![[0.0; 6]; scene.textures.len()],
            terms: Terms::new(scene.meshes.len(), scene.textures.len()),
            brought: ByIntegral::default(),
            not_finite: 0,
        }
    }

    /// Whether a term may be added: it is counted if it may not.
    pub fn admits(&mut self, is_finite: bool) -> bool {
        self.not_finite += u64::from(!is_finite);
        is_finite
    }

    /// The vector if it may be added, in single precision too, else zero.
    pub fn admitted(&mut self, v: DVec3) -> DVec3 {
        if self.admits(v.as_vec3().is_finite()) {
            v
        } else {
            DVec3::ZERO
        }
    }

    /// Sums a vector's lanes that `bits` selects, in f64.
    pub fn over_lanes(&mut self, v: V3<Lane>, bits: u32) -> DVec3 {
        let lanes = (0..LANES).filter(|&l| bits >> l & 1 == 1);
        lanes.map(|l| self.admitted(lane_of(v, l).as_dvec3())).sum()
    }

    /// Ends a term of the gradient: what one packet of paths or one border on the film brings.
    pub fn end_term(&mut self) {
        self.terms.end_term();
    }

    /// Adds to the position of a mesh's vertex.
    pub fn add_position(&mut self, mesh: usize, vertex: u32, value: Vec3) {
        if self.admits(value.is_finite()) {
            self.terms.add(Object::Mesh(mesh), value.as_dvec3());
            self.positions.add(vertex, value);
        }
    }

    /// Adds to the camera's origin, the axes of its film and the tangent of half its opening angle.
    pub fn add_camera(
        &mut self,
        camera: &Camera,
        origin: DVec3,
        film_axes: [DVec3; 3],
        tan_half_x_fov: f64,
    ) {
        let axes = camera.axes_adjoint(origin, film_axes);
        self.camera.add(origin, axes, tan_half_x_fov);
        let all = origin + axes.iter().sum::<DVec3>() + DVec3::splat(tan_half_x_fov);
        self.terms.add(Object::Camera, all);
    }

    /// Adds to the rotation and the scale of the environment map.
    pub fn add_environment(&mut self, rotation: DVec3, scale: f64) {
        self.environment.rotation += rotation;
        self.environment.scale += scale;
        self.terms
            .add(Object::Environment, rotation + DVec3::splat(scale));
    }

    /// Adds to the film's velocity at a point, in pixels, and to its divergence.
    pub fn add_drift(&mut self, drift: &Drift, at: [f64; 2], velocity: [f64; 2], divergence: f64) {
        for share in drift.grid.shares(at) {
            if drift.followed[share.node].is_empty() {
                continue;
            }
            let bars = [0, 1].map(|i| share.weight * velocity[i] + share.gradient[i] * divergence);
            if self.admits(bars.iter().all(|b| b.is_finite())) {
                let sum = self.drift.entry(share.node).or_default();
                sum[0] += bars[0];
                sum[1] += bars[1];
            }
        }
    }

    /// Adds to the motion of a body that directions follow.
    pub fn add_body(&mut self, body: usize, bar: BodyMotion) {
        let bar = BodyMotion {
            velocity: self.admitted(bar.velocity),
            rotation: self.admitted(bar.rotation),
        };
        *self.bodies.entry(body).or_default() += bar;
    }

    /// Adds to a vertex's normal.
    pub fn add_normal(&mut self, vertex: u32, value: Vec3) {
        if self.admits(value.is_finite()) {
            self.normals.add(vertex, value);
        }
    }

    /// Adds to the texels of a texture and its `to_uv`, as far as they are wanted.
    pub fn add_texture(&mut self, wanted: &Wanted, texture: usize, found: &Lookup, bar: Vec3) {
        for (&texel, weight) in found.texels.iter().zip(found.weights) {
            if weight != 0.0 {
                self.add_texel(wanted, texture, texel, bar * weight);
            }
        }
        if wanted.to_uv[texture] && self.admits(bar.is_finite()) {
            let sum = &mut self.to_uv[texture];
            for (s, v) in sum.iter_mut().zip(found.to_uv_bar(bar)) {
                *s += f64::from(v);
            }
        }
    }

    /// Adds to a texel of a texture, if it is wanted.
    pub fn add_texel(&mut self, wanted: &Wanted, texture: usize, texel: u32, value: Vec3) {
        if wanted.texels[texture] && self.admits(value.is_finite()) {
            self.terms.add(Object::Texture(texture), value.as_dvec3());
            self.texels.add(self.first_texel[texture] + texel, value);
        }
    }

    /// Takes the tile's sums, leaving zeros.
    pub fn take(&mut self) -> TileGradient {
        TileGradient {
            not_finite: std::mem::take(&mut self.not_finite),
            brought: std::mem::take(&mut self.brought),
            positions: self.positions.drain(),
            normals: self.normals.drain(),
            texels: self.texels.drain(),
            terms: self.terms.take(),
            camera: std::mem::take(&mut self.camera),
            environment: std::mem::take(&mut self.environment),
            drift: std::mem::take(&mut self.drift),
            bodies: std::mem::take(&mut self.bodies),
            to_uv: {
                let zeros = vec![[0.0; 6]; self.to_uv.len()];
                std::mem::replace(&mut self.to_uv, zeros)
            },
            delta_lights: {
                let zeros = vec![DVec3::ZERO; self.delta_lights.len()];
                std::mem::replace(&mut self.delta_lights, zeros)
            },
        }
    }
}

/// The film's sums, in f64.
pub struct FilmSums {
    positions: Vec<DVec3>,
    normals: Vec<DVec3>,
    texels: Vec<DVec3>,
    camera: CameraSum,
    environment: EnvironmentSum,
    /// Of the velocities of the film's nodes.
    pub drift: BTreeMap<usize, [f64; 2]>,
    /// Of those of bodies that directions follow.
    pub bodies: BTreeMap<usize, BodyMotion>,
    delta_lights: Vec<DVec3>,
    to_uv: Vec<[f64; 6]>,
}

impl FilmSums {
    pub fn new(scene: &Scene, geometry: &Geometry, wanted: &Wanted) -> Result<Self, NoRoom> {
        let [positions, normals, texels] = wanted.counts(scene, geometry);
        Ok(Self {
            positions: room::filled(DVec3::ZERO, positions)?,
            normals: room::filled(DVec3::ZERO, normals)?,
            texels: room::filled(DVec3::ZERO, texels)?,
            camera: CameraSum::default(),
            environment: EnvironmentSum::default(),
            drift: BTreeMap::new(),
            bodies: BTreeMap::new(),
            delta_lights: vec![DVec3::ZERO; scene.delta_lights.len()],
            to_uv: vec![[0.0; 6]; scene.textures.len()],
        })
    }

    /// Adds a tile; the order of the calls is the order of summation.
    pub fn add(&mut self, tile: &TileGradient) {
        for &(v, value) in &tile.positions {
            self.positions[v as usize] += value.as_dvec3();
        }
        for &(v, value) in &tile.normals {
            self.normals[v as usize] += value.as_dvec3();
        }
        for &(texel, value) in &tile.texels {
            self.texels[texel as usize] += value.as_dvec3();
        }
        let camera = &tile.camera;
        self.camera
            .add(camera.origin, camera.axes, camera.tan_half_x_fov);
        self.environment.rotation += tile.environment.rotation;
        self.environment.scale += tile.environment.scale;
        for (&node, value) in &tile.drift {
            let sum = self.drift.entry(node).or_default();
            sum[0] += value[0];
            sum[1] += value[1];
        }
        for (&body, &value) in &tile.bodies {
            *self.bodies.entry(body).or_default() += value;
        }
        for (sum, value) in self.to_uv.iter_mut().zip(&tile.to_uv) {
            for (s, v) in sum.iter_mut().zip(value) {
                *s += v;
            }
        }
        for (sum, value) in self.delta_lights.iter_mut().zip(&tile.delta_lights) {
            *sum += value;
        }
    }

    /// Multiplies all sums.
    pub fn scale(&mut self, factor: f64) {
        let vectors = self.positions.iter_mut().chain(&mut self.normals);
        let vectors = vectors
            .chain(&mut self.texels)
            .chain(&mut self.delta_lights);
        for v in vectors.chain([&mut self.camera.origin, &mut self.environment.rotation]) {
            *v *= factor;
        }
        self.camera.axes.iter_mut().for_each(|axis| *axis *= factor);
        let numbers = self.to_uv.iter_mut().flatten();
        for x in numbers.chain([&mut self.camera.tan_half_x_fov, &mut self.environment.scale]) {
            *x *= factor;
        }
    }

    /// What was asked for, as the gradient of the scene; leaves zeros.
    pub fn take(
        &mut self,
        scene: &Scene,
        geometry: &Geometry,
        camera: &Camera,
        request: &SceneDifferential,
    ) -> SceneDifferential {
        let mut gradient = request.clone();
        let positions = &mut self.positions;
        let given = crate::gradient::scene::normals::adjoint(
            scene,
            geometry,
            request,
            &self.normals,
            positions,
        );
        for (mesh, given) in given.into_iter().enumerate() {
            let range =
                geometry.first_vertex[mesh] as usize..geometry.first_vertex[mesh + 1] as usize;
            if let Some(values) = &mut gradient.positions[mesh] {
                *values = positions[range].iter().map(|v| v.as_vec3()).collect();
            }
            if gradient.given_normals[mesh].is_some() {
                gradient.given_normals[mesh] = given;
            }
        }
        for (texels, first) in gradient.texels.iter_mut().zip(first_texels(scene)) {
            for (i, texel) in texels.iter_mut().flatten().enumerate() {
                *texel = self.texels[first as usize + i].as_vec3().to_array();
            }
        }
        for (slot, sum) in gradient.to_uv.iter_mut().zip(&self.to_uv) {
            if slot.is_some() {
                *slot = Some(sum.map(|x| x as f32));
            }
        }
        if let Some(environment) = &mut gradient.environment {
            environment.rotation = self.environment.rotation.as_vec3();
            environment.scale = self.environment.scale as f32;
        }
        for (slot, sum) in gradient.delta_lights.iter_mut().zip(&self.delta_lights) {
            if slot.is_some() {
                *slot = Some(sum.as_vec3());
            }
        }
        if gradient.camera.is_some() {
            let sums = &self.camera;
            let rotation: DVec3 = camera
                .axes
                .iter()
                .zip(sums.axes)
                .map(|(axis, bar)| axis.as_dvec3().cross(bar))
                .sum();
            let tan = camera.tan_half_x_fov;
            gradient.camera = Some(CameraDifferential {
                translation: sums.origin.as_vec3(),
                rotation: rotation.as_vec3(),
                x_fov_deg: (sums.tan_half_x_fov * 0.5 * (1.0 + tan * tan)).to_radians() as f32,
                axes: sums.axes.map(|bar| bar.as_vec3()),
                principal_point_offset: camera
                    .axis_per_offset()
                    .map(|by| match camera.parallel_half_width() {
                        None => by.dot(sums.axes[2]) as f32,
                        Some(_) => (by * camera.reach()).dot(sums.origin) as f32,
                    })
                    .into(),
            });
        }
        self.clear();
        gradient
    }

    fn clear(&mut self) {
        self.positions.fill(DVec3::ZERO);
        self.normals.fill(DVec3::ZERO);
        self.texels.fill(DVec3::ZERO);
        self.camera = CameraSum::default();
        self.environment = EnvironmentSum::default();
        self.drift.clear();
        self.bodies.clear();
        self.delta_lights.fill(DVec3::ZERO);
        self.to_uv.fill([0.0; 6]);
    }
}
