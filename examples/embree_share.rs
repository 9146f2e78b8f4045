//! How much of a gradient pass is Embree: rays a second against a bare loop over rays of the same
//! kinds.
//!
//! `cargo run --release --example embree_share [-- SCENE.xml KEY=NUMBERS [SPP]]`, on one thread.
//! The bare loop does nothing but queries, eight rays at a time as the tracer's, of each kind:
//! camera rays, shadow rays, bounces that look for the nearest surface, and bounces that only ask
//! whether anything is there. The time that Embree takes of the pass is then the number of rays of
//! each kind times what one of them costs in the bare loop.

use glam::Vec3;
use std::collections::BTreeMap;
use std::time::Instant;
use warpath::lanes::LANES;
use warpath::methods::{self, Method, Progress, Settings};
use warpath::paths::film::camera::Camera;
use warpath::scene::{self, Scene, parameters};
use warpath::trace::geometry::{Geometry, NO_TRIANGLE};
use warpath::trace::{Accel, AccelOptions, Backend, Coherence, Hits, MISS, MeshView, Rays};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

const OWN: [(&str, &str); 5] = [
    ("scenes/demo.xml", "occluder.translation=1,0,0"),
    ("scenes/silhouette.xml", "ball.translation=1,0,0.3"),
    ("scenes/camera.xml", "cam.translation=1,0,0"),
    ("scenes/indirect.xml", "ball.translation=1,0,0"),
    ("scenes/environment.xml", "ring.translation=1,0,0"),
];

fn main() -> Result<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    println!(
        "| scene | Mrays | s | Mrays/s | bare loop: camera | shadow | bounce | any hit | same rays in the bare loop, Mrays/s | Embree's share |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    match arguments.as_slice() {
        [] => OWN
            .iter()
            .try_for_each(|(scene, direction)| measure(scene, direction, 64)),
        [scene, direction] => measure(scene, direction, 64),
        [scene, direction, spp] => measure(scene, direction, spp.parse()?),
        _ => Err("embree_share [SCENE.xml KEY=NUMBERS [SPP]]".into()),
    }
}

struct Quiet;

impl Progress for Quiet {
    fn advance(&self, _: u64, _: u64) {}
    fn cancelled(&self) -> bool {
        false
    }
}

fn measure(path: &str, direction: &str, spp: u32) -> Result<()> {
    let scene = scene::load(path, &[])?;
    let (key, numbers) = direction.split_once('=').ok_or("KEY=NUMBERS")?;
    let parameter = parameters::find(&scene, key)?;
    let numbers: Vec<f32> = numbers
        .split(',')
        .map(str::parse)
        .collect::<std::result::Result<_, _>>()?;
    let settings = Settings {
        constants: Default::default(),
        part_of_film: None,
        counts_tiles: false,
        noise: None,
        spp,
        seed: 1,
        threads: 1,
        max_depth: scene.integrator.max_depth,
        rr_depth: scene.integrator.rr_depth,
        hide_emitters: scene.integrator.hide_emitters,
        sensor: 0,
        resolution: None,
        method: Method::Reparam,
        backend: Backend::default(),
        standard_error: true,
        groups: None,
    };
    let statistics =
        methods::forward(&scene, &settings, &[(parameter, numbers)], &Quiet)?.statistics;
    let seconds = statistics.seconds["primal"];
    let total: u64 = statistics.rays.values().sum();
    let costs = Costs::measure(&scene)?;
    let embree = costs.seconds(&statistics.rays, scene.area_lights.is_empty());
    let million = |kind: f64| 1e-6 / kind;
    println!(
        "| {} | {:.2} | {seconds:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.2} | {:.0} % |",
        path.trim_start_matches("scenes/").trim_end_matches(".xml"),
        total as f64 / 1e6,
        total as f64 / seconds / 1e6,
        million(costs.camera),
        million(costs.shadow),
        million(costs.nearest),
        million(costs.any),
        total as f64 / embree / 1e6,
        100.0 * embree / seconds
    );
    Ok(())
}

/// Seconds a ray in the bare loop.
struct Costs {
    camera: f64,
    shadow: f64,
    nearest: f64,
    any: f64,
}

impl Costs {
    fn measure(scene: &Scene) -> Result<Self> {
        let views: Vec<MeshView> = scene
            .meshes
            .iter()
            .map(|m| MeshView {
                positions: &m.positions,
                triangles: &m.triangles,
            })
            .collect();
        let accel = Accel::build(&views, AccelOptions::new(true, 1))?;
        let geometry = Geometry::new(scene);
        let camera = camera_rays(scene);
        let mut random = Random(1);
        let mut shadow = Packets::default();
        let mut bounce = Packets::default();
        for packet in &camera.0 {
            let mut hits = Hits::<LANES>::default();
            accel.intersect(&packet.0, packet.1, &mut hits, Coherence::Coherent);
            for lane in (0..LANES).filter(|&l| hits.mesh[l] != MISS) {
                let triangle =
                    geometry.first_triangle[hits.mesh[lane] as usize] + hits.triangle[lane];
                let (x, n) = surface(
                    &geometry,
                    triangle,
                    packet.0.origin(lane),
                    packet.0.direction(lane),
                    hits.t[lane],
                );
                bounce.push(x, random.cosine(n), f32::INFINITY);
                if let Some(y) = light_point(scene, &mut random) {
                    shadow.push(x, y - x, 1.0 - 1e-4);
                }
            }
        }
        let intersect = |packets: &Packets, coherence| {
            packets.time(|rays, active| {
                let mut hits = Hits::<LANES>::default();
                accel.intersect(rays, active, &mut hits, coherence);
                hits.mesh[0]
            })
        };
        let occluded = |packets: &Packets| {
            packets.time(|rays, active| accel.occluded(rays, active, Coherence::Incoherent))
        };
        Ok(Self {
            camera: intersect(&camera, Coherence::Coherent),
            shadow: occluded(&shadow),
            nearest: intersect(&bounce, Coherence::Incoherent),
            any: occluded(&bounce),
        })
    }

    /// Of all rays by kind. Without area lights the last bounce only asks whether the environment
    /// is seen.
    fn seconds(&self, rays: &BTreeMap<&'static str, u64>, only_environment: bool) -> f64 {
        rays.iter()
            .map(|(kind, count)| {
                let cost = match *kind {
                    "camera" => self.camera,
                    "shadow" | "light_cell" => self.shadow,
                    "bounce" | "bounce_cell" if only_environment => self.any,
                    _ => self.nearest,
                };
                cost * *count as f64
            })
            .sum()
    }
}

/// Rays in packets, with the lanes that are used.
#[derive(Default)]
struct Packets(Vec<(Rays<LANES>, u32)>);

impl Packets {
    fn push(&mut self, origin: Vec3, direction: Vec3, far: f32) {
        if self
            .0
            .last()
            .is_none_or(|p| p.1.count_ones() as usize == LANES)
        {
            self.0.push((Rays::default(), 0));
        }
        if let Some((rays, active)) = self.0.last_mut() {
            let lane = active.count_ones() as usize;
            rays.set(lane, origin, direction, 0.0, far);
            *active |= 1 << lane;
        }
    }

    /// Seconds a ray: the best of five passes.
    fn time(&self, query: impl Fn(&Rays<LANES>, u32) -> u32) -> f64 {
        let rays: u32 = self.0.iter().map(|p| p.1.count_ones()).sum();
        let pass = || {
            let start = Instant::now();
            self.0
                .iter()
                .for_each(|(rays, active)| _ = std::hint::black_box(query(rays, *active)));
            start.elapsed().as_secs_f64()
        };
        (0..5).map(|_| pass()).fold(f64::INFINITY, f64::min) / rays.max(1) as f64
    }
}

/// Four rays a pixel, in rows.
fn camera_rays(scene: &Scene) -> Packets {
    let camera = Camera::new(&scene.sensors[0]);
    let [width, height] = scene.sensors[0].film.crop_size;
    let mut packets = Packets::default();
    for y in 0..2 * height {
        for x in 0..2 * width {
            let d = camera.direction(x as f32 / 2.0 + 0.2, y as f32 / 2.0 + 0.3);
            packets.push(camera.origin, Vec3::new(d.x, d.y, d.z), camera.far_clip);
        }
    }
    packets
}

/// A point just off a surface, and its normal there, on the side that the ray came from.
fn surface(
    geometry: &Geometry,
    triangle: u32,
    origin: Vec3,
    direction: Vec3,
    t: f32,
) -> (Vec3, Vec3) {
    debug_assert_ne!(triangle, NO_TRIANGLE);
    let [a, b, c] = geometry.triangles[triangle as usize].map(|v| geometry.positions[v as usize]);
    let n = (b - a).cross(c - a).normalize();
    let n = if n.dot(direction) > 0.0 { -n } else { n };
    (origin + direction * t + n * 1e-4, n)
}

/// A point on the first area light.
fn light_point(scene: &Scene, random: &mut Random) -> Option<Vec3> {
    let mesh = &scene.meshes[scene.area_lights.first()?.mesh];
    let triangle = mesh.triangles[(random.uniform() * mesh.triangles.len() as f32) as usize];
    let [a, b, c] = triangle.map(|v| mesh.positions[v as usize]);
    let (mut s, mut r) = (random.uniform(), random.uniform());
    if s + r > 1.0 {
        (s, r) = (1.0 - s, 1.0 - r);
    }
    Some(a + (b - a) * s + (c - a) * r)
}

/// xorshift64*.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f32 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        (self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 40) as f32 / (1u64 << 24) as f32
    }

    /// A direction distributed as the cosine about `n`.
    fn cosine(&mut self, n: Vec3) -> Vec3 {
        let z = 2.0 * self.uniform() - 1.0;
        let (sin, cos) = (std::f32::consts::TAU * self.uniform()).sin_cos();
        let radius = (1.0 - z * z).max(0.0).sqrt();
        (n + Vec3::new(radius * cos, radius * sin, z) * 0.9999).normalize()
    }
}
