//! Scenes put together from plain data.

use super::shapes::{Shape, icosphere};
use glam::{Affine3A, EulerRot, Mat3, Quat, Vec2, Vec3, vec3};
use warpath::scene::{
    AreaLight, Bsdf, DeltaLight, DeltaLightKind, Environment, Film, Filter, Integrator, Lens,
    Material, Mesh, Normals, Rgb, Scene, Sensor, Texture, vertex_normals,
};

pub const BOX: Filter = Filter::Box { radius: 0.5 };
pub const TENT: Filter = Filter::Tent { radius: 1.0 };
pub const GAUSSIAN: Filter = Filter::Gaussian { stddev: 0.5 };

/// A scene with one camera, "cam", which looks from one point at another, z up.
pub fn scene(from: Vec3, at: Vec3, x_fov_deg: f32, size: [u32; 2], filter: Filter) -> Scene {
    let z = (at - from).normalize();
    let up = if z.z.abs() > 0.99 { Vec3::Y } else { Vec3::Z };
    let x = up.cross(z).normalize();
    let axes = Mat3::from_cols(x, z.cross(x), z);
    let film = Film {
        width: size[0],
        height: size[1],
        crop_offset: [0; 2],
        crop_size: size,
        filter,
        sample_border: true,
    };
    let sensor = Sensor {
        lens: Lens::Pinhole,
        id: "cam".into(),
        to_world: Affine3A::from_mat3_translation(axes, from),
        x_fov_rad: x_fov_deg.to_radians(),
        near_clip: 1e-3,
        far_clip: 1e4,
        principal_point_offset: Vec2::ZERO,
        film,
        sample_count: 16,
        seed: 0,
    };
    Scene {
        meshes: Vec::new(),
        materials: Vec::new(),
        textures: Vec::new(),
        area_lights: Vec::new(),
        delta_lights: Vec::new(),
        instances: Vec::new(),
        environment: None,
        sensors: vec![sensor],
        integrator: Integrator {
            max_depth: 2,
            rr_depth: u32::MAX,
            hide_emitters: false,
        },
        warnings: Vec::new(),
        hash: 0,
    }
}

/// Scenes are built by a chain of these.
pub trait Build: Sized {
    /// Paths of at most this many segments.
    fn depth(self, depth: u32) -> Self;
    /// A constant environment, "env".
    fn constant_environment(self, radiance: Rgb) -> Self;
    /// A flat-shaded, two-sided, diffuse mesh.
    fn solid(self, id: &str, shape: Shape, reflectance: Rgb) -> Self;
    /// The same with smooth normals that follow the vertices.
    fn smooth(self, id: &str, shape: Shape, reflectance: Rgb) -> Self;
    /// The same with these normals, data of their own.
    fn with_normals(self, id: &str, shape: Shape, normals: Vec<Vec3>, reflectance: Rgb) -> Self;
    /// A point or a directional light.
    fn delta_light(self, key: &str, kind: DeltaLightKind, power: Rgb) -> Self;
    /// A black mesh that shines to its front.
    fn light(self, id: &str, shape: Shape, radiance: Rgb) -> Self;
}

fn add(
    scene: &mut Scene,
    id: &str,
    (positions, triangles): Shape,
    normals: Normals,
    reflectance: Rgb,
) {
    let key = format!("{id}.bsdf");
    let reflectance = texture(
        scene,
        Texture {
            limits: [0.0, 1.0],
            ..Texture::constant(format!("{key}.brdf_0.reflectance"), reflectance)
        },
    );
    scene.materials.push(Material {
        key,
        bsdf: Bsdf::Diffuse { reflectance },
        two_sided: true,
        relief: None,
    });
    scene.meshes.push(Mesh {
        id: id.into(),
        positions,
        to_world: Default::default(),
        triangles,
        normals,
        uvs: Vec::new(),
        material: scene.materials.len() - 1,
        area_light: None,
    });
}

/// The index of a new texture.
fn texture(scene: &mut Scene, texture: Texture) -> usize {
    scene.textures.push(texture);
    scene.textures.len() - 1
}

impl Build for Scene {
    fn depth(mut self, depth: u32) -> Self {
        self.integrator.max_depth = depth;
        self
    }

    fn constant_environment(mut self, radiance: Rgb) -> Self {
        let radiance = texture(
            &mut self,
            Texture::constant("env.radiance".into(), radiance),
        );
        self.environment = Some(Environment {
            key: "env".into(),
            radiance,
            map: None,
        });
        self
    }

    fn solid(mut self, id: &str, shape: Shape, reflectance: Rgb) -> Self {
        add(&mut self, id, shape, Normals::Flat, reflectance);
        self
    }

    fn smooth(mut self, id: &str, shape: Shape, reflectance: Rgb) -> Self {
        let normals = Normals::Computed(vertex_normals(&shape.0, &shape.1));
        add(&mut self, id, shape, normals, reflectance);
        self
    }

    fn with_normals(
        mut self,
        id: &str,
        shape: Shape,
        normals: Vec<Vec3>,
        reflectance: Rgb,
    ) -> Self {
        add(&mut self, id, shape, Normals::Given(normals), reflectance);
        self
    }

    fn delta_light(mut self, key: &str, kind: DeltaLightKind, power: Rgb) -> Self {
        let name = match kind {
            DeltaLightKind::Point { .. } => "intensity",
            DeltaLightKind::Directional { .. } => "irradiance",
        };
        let power = texture(&mut self, Texture::constant(format!("{key}.{name}"), power));
        self.delta_lights.push(DeltaLight {
            key: key.into(),
            kind,
            power,
            beam: None,
        });
        self
    }

    fn light(mut self, id: &str, shape: Shape, radiance: Rgb) -> Self {
        add(&mut self, id, shape, Normals::Flat, [0.0; 3]);
        let mesh = self.meshes.len() - 1;
        self.meshes[mesh].area_light = Some(self.area_lights.len());
        let key = format!("{id}.emitter");
        let radiance = texture(
            &mut self,
            Texture::constant(format!("{key}.radiance"), radiance),
        );
        self.area_lights.push(AreaLight {
            mesh,
            radiance,
            key,
        });
        self
    }
}

/// The parallelogram with these corner and edges, facing along `u` × `v`.
pub fn parallelogram(corner: Vec3, u: Vec3, v: Vec3) -> Shape {
    (
        vec![corner, corner + u, corner + u + v, corner + v],
        vec![[0, 1, 2], [0, 2, 3]],
    )
}

/// The square of this half side about the origin in the plane z = `z`, facing up.
pub fn floor(half: f32, z: f32) -> Shape {
    parallelogram(
        vec3(-half, -half, z),
        vec3(2.0 * half, 0.0, 0.0),
        vec3(0.0, 2.0 * half, 0.0),
    )
}

/// A square that faces down.
pub fn ceiling(centre: Vec3, half: f32) -> Shape {
    let (u, v) = (vec3(0.0, 2.0 * half, 0.0), vec3(2.0 * half, 0.0, 0.0));
    parallelogram(centre - (u + v) / 2.0, u, v)
}

/// A box of these half sides about the origin, its sides sharing eight corners.
pub fn cuboid(half: Vec3) -> Shape {
    let sign = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    let corner = |i: u32| half * vec3(sign(i & 1), sign(i & 2), sign(i & 4));
    let mut triangles = Vec::new();
    for axis in 0..3 {
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let low = [0, v, u + v, u];
        let high = [0, u, u + v, v].map(|i| i + (1 << axis));
        for [a, b, c, d] in [low, high] {
            triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    ((0..8).map(corner).collect(), triangles)
}

/// The shape with its triangles torn apart, and the normal of its triangle at each vertex: as
/// programs write bodies with hard edges.
pub fn torn_apart((positions, triangles): Shape) -> (Shape, Vec<Vec3>) {
    let corners = triangles.iter().flatten();
    let torn: Vec<Vec3> = corners.map(|&v| positions[v as usize]).collect();
    let normal = |t: &[Vec3]| (t[1] - t[0]).cross(t[2] - t[0]).normalize();
    let normals = torn.chunks(3).flat_map(|t| [normal(t); 3]).collect();
    let triangles = (0..torn.len() as u32 / 3).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]);
    ((torn, triangles.collect()), normals)
}

/// A regular polygon in the plane of `normal`.
pub fn disc(centre: Vec3, normal: Vec3, radius: f32, corners: u32) -> Shape {
    let (u, v) = normal.any_orthonormal_pair();
    let mut positions = vec![centre];
    for i in 0..corners {
        let angle = f64::from(i) / f64::from(corners) * std::f64::consts::TAU;
        positions.push(centre + radius * (u * angle.cos() as f32 + v * angle.sin() as f32));
    }
    (
        positions,
        (0..corners)
            .map(|i| [0, 1 + i, 1 + (i + 1) % corners])
            .collect(),
    )
}

/// A prism over an L: concave, so that it hides and shades itself.
pub fn l_shape(size: f32, height: f32) -> Shape {
    let outline = [
        [0.0, 0.0],
        [2.0, 0.0],
        [2.0, 1.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [0.0, 2.0],
    ];
    let at = |[x, y]: [f32; 2], z| vec3((x - 1.0) * size, (y - 1.0) * size, z);
    let positions = outline
        .iter()
        .map(|p| at(*p, 0.0))
        .chain(outline.iter().map(|p| at(*p, height)));
    let mut triangles = Vec::new();
    for [a, b, c] in [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]] {
        triangles.extend([[a, c, b], [a + 6, b + 6, c + 6]]);
    }
    for i in 0..6 {
        let j = (i + 1) % 6;
        triangles.extend([[i, j, j + 6], [i, j + 6, i + 6]]);
    }
    (positions.collect(), triangles)
}

/// A sphere of triangles.
pub fn ball(levels: u32, centre: Vec3, radius: f32) -> Shape {
    icosphere(levels, centre, radius)
}

/// A ball on which every third vertex stands out, the others being at the second of these parts of
/// the radius.
pub fn spiky(centre: Vec3, radius: f32, [long, short]: [f32; 2]) -> Shape {
    let (mut positions, triangles) = ball(2, centre, radius);
    for (i, p) in positions.iter_mut().enumerate() {
        let length = if i % 3 == 0 { long } else { short };
        *p = centre + (*p - centre) * length;
    }
    (positions, triangles)
}

/// The shape turned by Euler angles (degrees, about x, y, z) about the origin and then moved.
pub fn placed((positions, triangles): Shape, degrees: Vec3, to: Vec3) -> Shape {
    let r = degrees * (std::f32::consts::PI / 180.0);
    let turn = Quat::from_euler(EulerRot::XYZ, r.x, r.y, r.z);
    (
        positions.into_iter().map(|p| turn * p + to).collect(),
        triangles,
    )
}
