//! A tangent or a cotangent of a scene: one number for every number that can move.

use super::{Normals, Rgb, Scene};
use glam::{Vec2, Vec3};

/// Forward dScene/dθ, backward dLoss/dScene. What is `None` does not move, or is not asked for.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneDifferential {
    /// Per mesh, per vertex; world units.
    pub positions: Vec<Option<Vec<Vec3>>>,
    /// Per mesh, per vertex: only for meshes with [`Normals::Given`] (others follow their
    /// positions).
    pub given_normals: Vec<Option<Vec<Vec3>>>,
    /// Per texture, per texel.
    pub texels: Vec<Option<Vec<Rgb>>>,
    /// Per texture: of the two rows of `to_uv`.
    pub to_uv: Vec<Option<[f32; 6]>>,
    pub environment: Option<EnvironmentDifferential>,
    /// Per delta light: motion of a point light, world units.
    pub delta_lights: Vec<Option<Vec3>>,
    /// The sensor that renders.
    pub camera: Option<CameraDifferential>,
}

/// Motion of the environment map.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnvironmentDifferential {
    pub scale: f32,
    /// Radians about the world axes.
    pub rotation: Vec3,
}

/// Motion of the camera that renders.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CameraDifferential {
    /// World units.
    pub translation: Vec3,
    /// Radians about the world axes through the camera's position.
    pub rotation: Vec3,
    /// Degrees, as in the file.
    pub x_fov_deg: f32,
    /// Of the axes, besides the rotation: the columns of a change of `to_world` that is not rigid.
    pub axes: [Vec3; 3],
    /// Of the principal point, as a fraction of the film's width and height.
    pub principal_point_offset: Vec2,
}

impl SceneDifferential {
    /// Nothing moves.
    pub fn none(scene: &Scene) -> Self {
        Self {
            positions: vec![None; scene.meshes.len()],
            given_normals: vec![None; scene.meshes.len()],
            texels: vec![None; scene.textures.len()],
            to_uv: vec![None; scene.textures.len()],
            environment: None,
            delta_lights: vec![None; scene.delta_lights.len()],
            camera: None,
        }
    }

    /// Whether anything that shapes visibility moves: vertices or the camera.
    pub fn moves_geometry(&self) -> bool {
        self.camera.is_some() || self.positions.iter().any(Option::is_some)
    }

    /// Whether an index of refraction changes that bends rays, or a picture that turns normals.
    pub fn refraction_moves(&self, scene: &Scene) -> bool {
        let turns = |t: usize| self.texels[t].is_some() || self.to_uv[t].is_some();
        let mut reliefs = scene.materials.iter().filter_map(|m| m.relief);
        reliefs.any(|r| turns(r.texture)) || self.bends(scene)
    }

    fn bends(&self, scene: &Scene) -> bool {
        scene.materials.iter().any(|m| match m.bsdf {
            super::Bsdf::Dielectric { eta, .. } => self.texels[eta].is_some(),
            super::Bsdf::Principled(p) => p.transmits && self.texels[p.eta].is_some(),
            _ => false,
        })
    }

    /// Whether an environment map may turn: what hides it hides other parts of it then.
    pub fn turns_environment(&self, scene: &Scene) -> bool {
        self.environment.is_some() && scene.environment.as_ref().is_some_and(|e| e.map.is_some())
    }

    /// Whether anything moves edges that something may see.
    pub fn moves_edges(&self, scene: &Scene) -> bool {
        self.moves_geometry()
            || self.refraction_moves(scene)
            || self.turns_environment(scene)
            || self.delta_lights.iter().any(Option::is_some)
    }

    /// Makes room (zeros) for the texels of a texture.
    pub fn want_texels(&mut self, scene: &Scene, texture: usize) -> &mut Vec<Rgb> {
        let texels = scene.textures[texture].texels.len();
        self.texels[texture].get_or_insert_with(|| vec![[0.0; 3]; texels])
    }

    /// Makes room (zeros) for the vertices of mesh `index`, and for its normals if they are its own
    /// data.
    pub fn want_mesh(&mut self, scene: &Scene, index: usize) {
        let mesh = &scene.meshes[index];
        let zeros = || vec![Vec3::ZERO; mesh.positions.len()];
        self.positions[index].get_or_insert_with(zeros);
        if matches!(mesh.normals, Normals::Given(_)) {
            self.given_normals[index].get_or_insert_with(zeros);
        }
    }

    /// What the inner product with `tangent` adds up: the sum of the absolute values of the
    /// products, to which rounding is relative.
    pub fn inner_magnitude(&self, tangent: &Self) -> f64 {
        fn of<'a>(numbers: impl IntoIterator<Item = &'a f32>) -> Vec<f32> {
            numbers.into_iter().copied().collect()
        }
        let vectors = |all: &[Option<Vec<Vec3>>]| -> Vec<Vec<f32>> {
            let flat =
                |v: &Option<Vec<Vec3>>| v.iter().flatten().flat_map(|p| p.to_array()).collect();
            all.iter().map(flat).collect()
        };
        let parts = |d: &Self| -> Vec<Vec<f32>> {
            let (environment, camera) = (
                d.environment.unwrap_or_default(),
                d.camera.unwrap_or_default(),
            );
            let texels = d.texels.iter().map(|t| of(t.iter().flatten().flatten()));
            let to_uv = d.to_uv.iter().map(|m| of(m.iter().flatten()));
            let lights = d
                .delta_lights
                .iter()
                .map(|l| of(&l.unwrap_or_default().to_array()));
            let mut parts: Vec<Vec<f32>> = texels.chain(to_uv).chain(lights).collect();
            parts.extend(vectors(&d.positions));
            parts.extend(vectors(&d.given_normals));
            parts.push(vec![environment.scale, camera.x_fov_deg]);
            parts.push(camera.principal_point_offset.to_array().to_vec());
            parts.push(camera.axes.iter().flat_map(|a| a.to_array()).collect());
            for rotation in [environment.rotation, camera.translation, camera.rotation] {
                parts.push(rotation.to_array().to_vec());
            }
            parts
        };
        let (own, other) = (parts(self), parts(tangent));
        let pairs = own.iter().zip(&other);
        let products = pairs.flat_map(|(a, b)| a.iter().zip(b));
        products
            .map(|(a, b)| (f64::from(*a) * f64::from(*b)).abs())
            .sum()
    }

    /// The mean of several differentials of one shape.
    pub fn mean(all: &[Self]) -> Self {
        let mut mean = all[0].clone();
        let n = all.len() as f64;
        let average = |of: &dyn Fn(&Self) -> Vec3| -> Vec3 {
            (all.iter().map(|d| of(d).as_dvec3()).sum::<glam::DVec3>() / n).as_vec3()
        };
        let vectors = |slot: &mut Option<Vec<Vec3>>, of: &dyn Fn(&Self) -> &Option<Vec<Vec3>>| {
            for i in 0..slot.as_ref().map_or(0, Vec::len) {
                let value = average(&|d| of(d).as_ref().map_or(Vec3::ZERO, |v| v[i]));
                slot.as_mut().unwrap_or(&mut Vec::new())[i] = value;
            }
        };
        for i in 0..mean.positions.len() {
            vectors(&mut mean.positions[i], &|d| &d.positions[i]);
            vectors(&mut mean.given_normals[i], &|d| &d.given_normals[i]);
        }
        for (t, texels) in mean.texels.iter_mut().enumerate() {
            for (i, texel) in texels.iter_mut().flatten().enumerate() {
                let of = |d: &Self| d.texels[t].as_ref().map_or([0.0; 3], |v| v[i]);
                *texel = average(&|d| Vec3::from(of(d))).to_array();
            }
        }
        for (t, numbers) in mean.to_uv.iter_mut().enumerate() {
            for (i, number) in numbers.iter_mut().flatten().enumerate() {
                let of = |d: &Self| d.to_uv[t].map_or(0.0, |v| v[i]);
                *number = average(&|d| Vec3::splat(of(d))).x;
            }
        }
        if let Some(environment) = &mut mean.environment {
            let of = |d: &Self| d.environment.unwrap_or_default();
            environment.rotation = average(&|d| of(d).rotation);
            environment.scale = average(&|d| Vec3::splat(of(d).scale)).x;
        }
        for (i, motion) in mean.delta_lights.iter_mut().enumerate() {
            if let Some(motion) = motion {
                *motion = average(&|d| d.delta_lights[i].unwrap_or_default());
            }
        }
        if mean.camera.is_some() {
            let of = |d: &Self| d.camera.unwrap_or_default();
            mean.camera = Some(CameraDifferential {
                translation: average(&|d| of(d).translation),
                rotation: average(&|d| of(d).rotation),
                x_fov_deg: average(&|d| Vec3::splat(of(d).x_fov_deg)).x,
                axes: [0, 1, 2].map(|i| average(&|d| of(d).axes[i])),
                principal_point_offset: average(&|d| of(d).principal_point_offset.extend(0.0))
                    .truncate(),
            });
        }
        mean
    }
}
