//! First hits of both backends on the same rays.
//!
//! Two hits agree if they are the same triangle at the same distance, to rounding. If the triangles
//! differ, the nearer one must pass a test in f64: the ray must go by one of its edges so closely
//! that rounding to f32 may decide either way, or begin so closely to it, or both triangles must be
//! equally far. Whatever is neither is an error of a backend.

use super::{backends, build};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::ops::Add;
use warpath::bench::meshes::{Class, Random, generate};
use warpath::trace::{Accel, Coherence, Hits, MISS, Rays, all_lanes};

/// Rays a mesh class, and triangles of its mesh.
const RAYS: usize = if cfg!(feature = "long-tests") {
    10_000_000
} else {
    200_000
};
const TRIANGLES: usize = if cfg!(feature = "long-tests") {
    200_000
} else {
    20_000
};

/// What rounding may move a corner by beside a ray: some units in the last place of coordinates up
/// to 2, and of distances up to 3.
const ROUNDING: f64 = 4e-6;

#[derive(Clone, Copy, Debug, Default)]
struct Counts {
    /// The same triangle, or both nothing.
    same: usize,
    /// Another triangle at the same distance.
    tie: usize,
    /// Another triangle, or none, past an edge of the nearer one that is within rounding.
    edge: usize,
    /// Another triangle, or none, past one that the ray begins on, within rounding.
    start: usize,
    /// Not to be explained by rounding.
    wrong: usize,
}

impl Add for Counts {
    type Output = Self;
    fn add(self, o: Self) -> Self {
        Self {
            same: self.same + o.same,
            tie: self.tie + o.tie,
            edge: self.edge + o.edge,
            start: self.start + o.start,
            wrong: self.wrong + o.wrong,
        }
    }
}

struct Mesh {
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Mesh {
    fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize].as_dvec3())
    }

    /// How far the ray goes by the nearest edge of a triangle, and the sine of its angle with the
    /// triangle's plane.
    fn margin(&self, triangle: u32, origin: DVec3, direction: DVec3) -> (f64, f64) {
        let d = direction.normalize();
        let corners = self.corners(triangle);
        let beside = corners.map(|p| (p - origin).reject_from_normalized(d));
        let distance = |i: usize| {
            let (p, q) = (beside[i], beside[(i + 1) % 3]);
            let along = (q - p).length_squared();
            let s = if along > 0.0 {
                (-p.dot(q - p) / along).clamp(0.0, 1.0)
            } else {
                0.0
            };
            (p + s * (q - p)).length()
        };
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let sine = normal.normalize_or_zero().dot(d).abs();
        (distance(0).min(distance(1)).min(distance(2)), sine)
    }

    fn compare(&self, rays: &Rays<8>, hits: [&Hits<8>; 2], lane: usize) -> Counts {
        let [a, b] = hits.map(|h| (h.t[lane], h.triangle[lane], h.u[lane], h.v[lane]));
        let count = |counts: Counts| counts;
        let (o, d) = (
            rays.origin(lane).as_dvec3(),
            rays.direction(lane).as_dvec3(),
        );
        if a.1 == MISS && b.1 == MISS {
            return count(Counts {
                same: 1,
                ..Counts::default()
            });
        }
        let nearer = if a.0 <= b.0 { a } else { b };
        let (margin, sine) = self.margin(nearer.1, o, d);
        // A plane that is met at a small angle is met far from where it should be.
        let slack = (ROUNDING / sine.max(1e-9)) as f32 / d.length() as f32;
        let close = (a.0 - b.0).abs() <= slack;
        if a.1 == b.1 && close {
            // Barycentrics are off by what the point is off, over the triangle's height.
            let corners = self.corners(a.1);
            let area = (corners[1] - corners[0])
                .cross(corners[2] - corners[0])
                .length();
            let longest = (0..3)
                .map(|i| corners[i].distance(corners[(i + 1) % 3]))
                .fold(0.0, f64::max);
            let off = (ROUNDING / sine.max(1e-9) * longest / area) as f32;
            let right = (a.2 - b.2).abs() <= off && (a.3 - b.3).abs() <= off;
            return if right {
                Counts {
                    same: 1,
                    ..Counts::default()
                }
            } else {
                Counts {
                    wrong: 1,
                    ..Counts::default()
                }
            };
        }
        match (a.1 != b.1 && close, margin <= ROUNDING) {
            (true, _) => Counts {
                tie: 1,
                ..Counts::default()
            },
            (false, true) => Counts {
                edge: 1,
                ..Counts::default()
            },
            _ if nearer.0 <= slack => Counts {
                start: 1,
                ..Counts::default()
            },
            _ => {
                println!("{o} {d}: {a:?} {b:?}, {margin:e} from an edge, sine {sine:e}");
                Counts {
                    wrong: 1,
                    ..Counts::default()
                }
            }
        }
    }
}

/// Eight rays: from far towards the ball, or from within; a bundle, or each on its own.
fn rays(random: &mut Random) -> Rays<8> {
    let mut rays = Rays::default();
    let inside = random.unit() < 0.5;
    let together = random.unit() < 0.5;
    let origin = |random: &mut Random| {
        if inside {
            random.in_ball()
        } else {
            2.0 * random.direction()
        }
    };
    let (from, to) = (origin(random), random.in_ball());
    for lane in 0..8 {
        let (from, to) = if together {
            (from, to + 0.01 * random.in_ball())
        } else {
            (origin(random), random.in_ball())
        };
        rays.set(lane, from, to - from, 0.0, f32::INFINITY);
    }
    rays
}

fn all_rays(mesh: &Mesh, accels: [&Accel; 2]) -> Counts {
    const AT_ONCE: usize = 1000;
    let add = |chunk: usize| {
        let mut random = Random(chunk as u64);
        let mut counts = Counts::default();
        for _ in 0..AT_ONCE {
            let rays = rays(&mut random);
            let hits = accels.map(|accel| {
                let mut hits = Hits::default();
                accel.intersect(&rays, all_lanes::<8>(), &mut hits, Coherence::Coherent);
                hits
            });
            for lane in 0..8 {
                counts = counts + mesh.compare(&rays, [&hits[0], &hits[1]], lane);
            }
        }
        counts
    };
    let chunks = RAYS.div_ceil(8 * AT_ONCE);
    (0..chunks)
        .into_par_iter()
        .map(add)
        .reduce(Counts::default, Counts::add)
}

#[test]
fn hits_agree() {
    for (class, name) in Class::ALL {
        let (positions, triangles) = generate(class, TRIANGLES);
        let mesh = Mesh {
            positions,
            triangles,
        };
        let [embree, wide, binary] = backends().map(|b| build(b, &mesh.positions, &mesh.triangles));
        for other in [&wide, &binary] {
            let counts = all_rays(&mesh, [&embree, other]);
            println!("{name}, embree and {}: {counts:?}", other.backend());
            assert_eq!(counts.wrong, 0, "{name}");
            let differ = counts.tie + counts.edge + counts.start;
            let apart = differ as f64 / (counts.same + differ) as f64;
            assert!(apart < 2e-3, "{name}: {apart} of the hits differ");
        }
        // The two trees hold the same triangles, of which the test alone decides.
        let trees = all_rays(&mesh, [&wide, &binary]);
        assert_eq!(
            trees.tie + trees.edge + trees.start + trees.wrong,
            0,
            "{name}: {trees:?}"
        );
    }
}
