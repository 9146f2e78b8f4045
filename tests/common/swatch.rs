//! One flat surface looked at from chosen directions: its bounces without a path around them.

use super::scenes::floor;
use glam::{DVec3, Vec3};
use warpath::lanes::{LANES, Lane, V3};
use warpath::paths::at::{At, Numbers};
use warpath::paths::film::camera::Camera;
use warpath::paths::light::patches::Lights;
use warpath::paths::random::Stream;
use warpath::paths::rays::{from_lanes, lane_of};
use warpath::paths::scene_view::{PathLimits, SceneView};
use warpath::paths::store::{Lobes, Vertices};
use warpath::paths::surface::materials::MaterialTable;
use warpath::paths::surface::vertex::Surface;
use warpath::scene::{Bsdf, Distribution, Microfacets, Scene};
use warpath::trace::geometry::Geometry;
use warpath::trace::{Accel, AccelOptions, MeshView};

/// A scene's first mesh, which must be a [`floor`], and a view's parts.
pub struct Swatch {
    scene: Scene,
    geometry: Geometry,
    accel: Accel,
    lights: Lights,
    materials: MaterialTable,
    /// Looked at from below.
    inside: bool,
}

/// Where a path goes on, in the frame of the surface.
pub struct Bounce {
    pub direction: DVec3,
    pub weight: Vec3,
    pub lobes: Lobes,
}

/// A scene with a floor, "floor", to be painted.
pub fn bare() -> Scene {
    use super::scenes::{BOX, Build, scene};
    scene(Vec3::Z, Vec3::ZERO, 40.0, [4; 2], BOX).solid("floor", floor(1.0, 0.0), [0.7, 0.5, 0.3])
}

impl Swatch {
    pub fn new(scene: Scene, inside: bool) -> Self {
        let geometry = Geometry::new(&scene);
        let views = scene.meshes.iter().map(|m| MeshView {
            positions: &m.positions,
            triangles: &m.triangles,
        });
        let views: Vec<MeshView> = views.collect();
        let accel = Accel::build(&views, AccelOptions::new(true, 1)).expect("a built scene");
        Self {
            lights: Lights::new(&scene, &geometry, false),
            materials: MaterialTable::new(&scene),
            accel,
            geometry,
            scene,
            inside,
        }
    }

    pub fn view(&self) -> SceneView<'_> {
        SceneView {
            scene: &self.scene,
            delta_lights: &self.scene.delta_lights,
            geometry: &self.geometry,
            accel: &self.accel,
            lights: &self.lights,
            materials: &self.materials,
            map_distribution: None,
            camera: Camera::new(&self.scene.sensors[0]),
            limits: PathLimits {
                max_depth: u32::MAX,
                rr_depth: u32::MAX,
                hide_emitters: false,
                black_goes_on: false,
            },
        }
    }

    /// Between the world and the frame in which the side that is seen looks up: its own inverse.
    pub fn turned(&self, d: DVec3) -> DVec3 {
        if self.inside {
            DVec3::new(d.x, -d.y, -d.z)
        } else {
            d
        }
    }

    /// Unit directions in the world, from those in the frame; lanes beyond the last repeat it.
    pub fn packet(&self, directions: &[DVec3]) -> V3<Lane> {
        let last = directions.len() - 1;
        from_lanes(&std::array::from_fn(|lane| {
            self.turned(directions[lane.min(last)]).as_vec3()
        }))
    }

    /// The surface seen from `toward` in each lane.
    pub fn seen(&self, view: &SceneView, toward: &[DVec3]) -> (Vertices, Surface) {
        let toward = self.packet(toward);
        let mut vertices = Vertices {
            hit: (1 << LANES) - 1,
            origin: toward,
            direction: -toward,
            triangle: [0; LANES],
            ..Vertices::default()
        };
        let surface = view.surface(&mut vertices);
        (vertices, surface)
    }

    /// Here, for code that draws no random numbers.
    pub fn at<'a>(
        view: &'a SceneView<'a>,
        vertices: &'a Vertices,
        surface: &'a Surface,
        stream: &'a Stream,
    ) -> At<'a> {
        let numbers = Numbers {
            stream,
            index: &[0; LANES],
            depth: 0,
        };
        At {
            view,
            vertices,
            surface,
            numbers,
        }
    }

    /// Bounces by `points` points of each of `streams` streams: `each(stream, lane of toward,
    /// bounce)`.
    pub fn bounces(
        &self,
        toward: &[DVec3],
        streams: u32,
        points: u32,
        mut each: impl FnMut(usize, usize, Bounce),
    ) {
        assert!(toward.len() <= LANES);
        let view = self.view();
        let (vertices, surface) = self.seen(&view, toward);
        for number in 0..streams {
            let stream = Stream::new(23, [number / 512, number % 512]);
            for point in 0..points {
                let mut vertices = vertices.clone();
                let numbers = Numbers {
                    stream: &stream,
                    index: &[point; LANES],
                    depth: 0,
                };
                let whole = Lane::splat(1.0);
                let rays = view.bsdf_sample(&mut vertices, &surface, whole, &numbers);
                for lane in 0..toward.len() {
                    let bit = |bits: u32| bits >> lane & 1;
                    let lobes = Lobes {
                        diffuse: bit(vertices.lobes.diffuse),
                        reflected: bit(vertices.lobes.reflected),
                        refracted: bit(vertices.lobes.refracted),
                        coat: bit(vertices.lobes.coat),
                    };
                    let bounce = Bounce {
                        direction: self.turned(lane_of(rays.direction, lane).as_dvec3()),
                        weight: lane_of(vertices.weight, lane),
                        lobes,
                    };
                    each(number as usize, lane, bounce);
                }
            }
        }
    }
}

/// The scene with other numbers of the floor's material: slots as `params` names them, such as
/// `alpha`.
pub fn with(mut scene: Scene, slots: &[(&str, [f32; 3])]) -> Scene {
    for (slot, value) in slots {
        let key = format!("floor.bsdf.{slot}");
        let texture = scene.textures.iter_mut().find(|t| t.key == key);
        texture.expect("a slot").texels = vec![*value];
    }
    scene
}

/// The scene with a smooth floor, or one of another distribution of microfacets.
pub fn with_facets(mut scene: Scene, distribution: Option<Distribution>) -> Scene {
    let material = scene.meshes[0].material;
    match &mut scene.materials[material].bsdf {
        Bsdf::Conductor { microfacets, .. }
        | Bsdf::Dielectric { microfacets, .. }
        | Bsdf::Plastic { microfacets, .. } => {
            *microfacets = microfacets
                .and_then(|m| distribution.map(|distribution| Microfacets { distribution, ..m }));
        }
        _ => {}
    }
    scene
}
