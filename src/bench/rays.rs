//! What rays a renderer asks for, in packets of its own width.

use super::cases::Case;
use super::meshes::Random;
use crate::lanes::LANES;
use crate::paths::film::camera::Camera;
use crate::trace::{Accel, Coherence, Hits, MISS, Rays, all_lanes};
use glam::Vec3;

/// Rays of each kind: 256 × 256.
const SIDE_BITS: u32 = 8;
pub const RAYS: usize = 1 << (2 * SIDE_BITS);

/// Rays of one kind.
pub struct Workload {
    pub name: &'static str,
    pub coherence: Coherence,
    /// Only whether anything is met is asked.
    pub occlusion: bool,
    pub packets: Vec<Rays<LANES>>,
}

#[derive(Clone, Copy)]
struct Ray {
    origin: Vec3,
    direction: Vec3,
    tfar: f32,
}

/// A point that the camera sees, and the normal on its side.
#[derive(Clone, Copy)]
struct Seen {
    point: Vec3,
    normal: Vec3,
}

/// All kinds, the same whatever `accel` is; none if the camera sees nothing. One is asked twice,
/// the second time without telling that its rays go together: what packets are worth.
pub fn workloads(case: &Case, accel: &Accel) -> Option<Vec<Workload>> {
    let mut random = Random(3);
    let primary = primary(case);
    let seen = seen(case, accel, &primary);
    if seen.is_empty() {
        return None;
    }
    let seen = |i: usize| seen[i % seen.len()];
    let bounce: Vec<Ray> = (0..RAYS)
        .map(|i| {
            // The cosine's distribution: a point of the sphere that stands on the surface.
            let direction = seen(i).normal + 0.9999 * random.direction();
            Ray::from(seen(i).point, direction.normalize())
        })
        .collect();
    let lamps = lamps(case);
    let shadow: Vec<Ray> = (0..RAYS)
        .map(|i| shadow(seen(i), &lamps, &mut random))
        .collect();
    let bundle = |angle_rad: f32, random: &mut Random| {
        let ray = |i: usize| {
            let axis = bounce[i / 16 * 16];
            // Anywhere in a cone of this half-angle.
            let aside = random.in_ball().reject_from(axis.direction);
            Ray::from(axis.origin, axis.direction + angle_rad.tan() * aside)
        };
        (0..RAYS).map(ray).collect::<Vec<Ray>>()
    };
    let bundles = [0.001, 0.01, 0.1].map(|angle_rad| bundle(angle_rad, &mut random));
    let (coherent, incoherent) = (Coherence::Coherent, Coherence::Incoherent);
    Some(vec![
        Workload::new("primary", coherent, false, &primary),
        Workload::new("primary, not told", incoherent, false, &primary),
        Workload::new("bundle 0.001 rad", coherent, false, &bundles[0]),
        Workload::new("bundle 0.01 rad", coherent, false, &bundles[1]),
        Workload::new("bundle 0.1 rad", incoherent, false, &bundles[2]),
        Workload::new("diffuse bounce", incoherent, false, &bounce),
        Workload::new("shadow", coherent, true, &shadow),
    ])
}

impl Workload {
    fn new(name: &'static str, coherence: Coherence, occlusion: bool, rays: &[Ray]) -> Self {
        let packet = |rays: &[Ray]| {
            let mut packet = Rays::default();
            for (lane, ray) in rays.iter().enumerate() {
                packet.set(lane, ray.origin, ray.direction, 0.0, ray.tfar);
            }
            packet
        };
        Self {
            name,
            coherence,
            occlusion,
            packets: rays.chunks_exact(LANES).map(packet).collect(),
        }
    }

    /// Traces some of its packets; how many rays met something.
    pub fn trace(&self, accel: &Accel, packets: &[Rays<LANES>]) -> u64 {
        let mut met = 0;
        for rays in packets {
            met += if self.occlusion {
                accel
                    .occluded(rays, all_lanes::<LANES>(), self.coherence)
                    .count_ones() as u64
            } else {
                let mut hits = Hits::default();
                accel.intersect(rays, all_lanes::<LANES>(), &mut hits, self.coherence);
                hits.mesh.iter().filter(|m| **m != MISS).count() as u64
            };
        }
        met
    }
}

impl Ray {
    fn from(origin: Vec3, direction: Vec3) -> Self {
        Self {
            origin,
            direction,
            tfar: f32::INFINITY,
        }
    }
}

/// Through the whole film, neighbours together.
fn primary(case: &Case) -> Vec<Ray> {
    let sensor = &case.scene.sensors[0];
    let camera = Camera::new(sensor);
    let [width, height] = sensor.film.crop_size.map(|s| s as f32);
    // Morton order: x in the even bits, y in the odd ones.
    let every_second =
        |bits: usize| (0..SIDE_BITS).fold(0, |all, i| all | (bits >> (2 * i) & 1) << i);
    let side = (1 << SIDE_BITS) as f32;
    (0..RAYS)
        .map(|i| {
            let (x, y) = (every_second(i), every_second(i >> 1));
            let (u, v) = ((x as f32 + 0.5) / side, (y as f32 + 0.5) / side);
            let d = camera.direction(u * width, v * height);
            Ray::from(camera.origin, Vec3::new(d.x, d.y, d.z))
        })
        .collect()
}

fn seen(case: &Case, accel: &Accel, primary: &[Ray]) -> Vec<Seen> {
    let mut seen = Vec::new();
    for ray in primary {
        let mut rays = Rays::<1>::default();
        rays.set(0, ray.origin, ray.direction, 0.0, ray.tfar);
        let mut hits = Hits::default();
        accel.intersect(&rays, 1, &mut hits, Coherence::Incoherent);
        let Some(mesh) = case.scene.meshes.get(hits.mesh[0] as usize) else {
            continue;
        };
        let corners = mesh.triangles[hits.triangle[0] as usize];
        let [a, b, c] = corners.map(|v| mesh.positions[v as usize]);
        let normal = (b - a).cross(c - a).normalize_or(-ray.direction);
        let normal = if normal.dot(ray.direction) > 0.0 {
            -normal
        } else {
            normal
        };
        let point = ray.origin + hits.t[0] * ray.direction;
        let off = 1e-5 * (1.0 + point.abs().max_element());
        seen.push(Seen {
            point: point + off * normal,
            normal,
        });
    }
    seen
}

/// Triangles that emit.
fn lamps(case: &Case) -> Vec<[Vec3; 3]> {
    let lit = case
        .scene
        .meshes
        .iter()
        .filter(|mesh| mesh.area_light.is_some());
    lit.flat_map(|mesh| {
        mesh.triangles
            .iter()
            .map(|t| t.map(|v| mesh.positions[v as usize]))
    })
    .collect()
}

/// Towards a point of a lamp; without lamps, anywhere.
fn shadow(seen: Seen, lamps: &[[Vec3; 3]], random: &mut Random) -> Ray {
    let at = (random.unit() * lamps.len() as f32) as usize;
    match lamps.get(at) {
        Some([a, b, c]) => {
            let (s, t) = (random.unit(), random.unit());
            let (s, t) = if s + t > 1.0 {
                (1.0 - s, 1.0 - t)
            } else {
                (s, t)
            };
            let light = *a + s * (*b - *a) + t * (*c - *a);
            Ray {
                tfar: 0.999,
                ..Ray::from(seen.point, light - seen.point)
            }
        }
        None => {
            let direction = random.direction();
            let side = direction.dot(seen.normal).signum();
            Ray::from(seen.point, side * direction)
        }
    }
}
