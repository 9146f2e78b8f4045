//! Lines over the hemisphere on which silhouettes are looked for.
//!
//! A line is a half great circle from −P to P through a direction M across P: d(ψ) = P·sin ψ +
//! M·cos ψ. With φ turning M about P the measure is dω = cos ψ dψ dφ. A line drawn with density
//! p(φ) that a silhouette crosses with angular speed ψ̇ contributes (L₋ − L₊)·f cosθ·ψ̇·cos ψ/p(φ).
//!
//! Two families of lines are used, about two orthogonal axes P, which share the motion of each
//! border (`boundary::cells::lobe::families`).
//!
//! **Diffuse lobes**: the axes lie on the horizon, and the line goes through the
//! cosine-distributed bounce, so that p(φ) = sin φ / 2 with φ counted from the horizon.
//!
//! **Reflected and refracted lobes**: the axes lie across the direction of a smooth surface, and φ
//! has the marginal density of a lobe of GGX's shape, as wide as the roughness turns that direction
//! (docs/method.md, 5).

use super::families::Family;
use crate::boundary::inclusion::Intervals;
use crate::boundary::shadows::chance_of_any;
use crate::kernels::bsdf::{Interface, RoughTransmission};
use crate::kernels::layered::Layers;
use crate::lanes::Lane;
use crate::paths::at::At;
use crate::paths::moving::Sector;
use crate::paths::rays::lane_of;
use crate::paths::store::Vertices;
use crate::paths::surface::interface::interface_of_lane;
use crate::paths::surface::layers::layers_of_lane;
use crate::paths::surface::lobe_sample::{View, frame_of_lane};
use glam::DVec3;
use std::f64::consts::{FRAC_1_PI, FRAC_PI_2, PI};

/// Points on a line besides its two ends on the horizon, and the bounce if it lies on it: jittered,
/// so that no silhouette hides between the same two points for all vertices.
pub const INNER_POINTS: usize = 4;
/// No lobe is taken for narrower (radians).
const NARROWEST: f64 = 1e-4;
/// Lines end this far above the horizon (radians), where no ray grazes the surface.
pub const RIM: f64 = 1e-4;

/// How points lie on a line.
#[derive(Clone, Copy, Debug)]
enum Spread {
    /// At equal angles, and the bounce.
    Diffuse,
    /// Within a lobe of this width.
    Lobe { width: f64 },
}

/// One line of one lane, or a part of it.
#[derive(Clone)]
pub struct Line {
    /// Whose pole is P, unit.
    pub family: Family,
    /// M, unit and orthogonal to P.
    middle: DVec3,
    spread: Spread,
    /// 1/p(φ).
    pub inverse_density: f64,
    /// Of all points, increasing.
    pub psi: Vec<f64>,
    /// Which of them is the bounce.
    pub bounce: Option<usize>,
    /// Whether it lies on the line, in this part or in the other.
    through_bounce: bool,
}

/// The lobe that a lane's path goes on in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lobe {
    Diffuse,
    Reflected,
    Refracted,
}

impl Lobe {
    /// Of a lane; `None` where it has no width.
    pub fn of_lane(vertices: &Vertices, lane: usize) -> Option<Self> {
        let bit = 1u32 << lane;
        let lobes = vertices.lobes;
        if lobes.diffuse & bit != 0 {
            return Some(Lobe::Diffuse);
        }
        if vertices.kinds.smooth & bit != 0 {
            return None;
        }
        if lobes.reflected & bit != 0 {
            Some(Lobe::Reflected)
        } else if lobes.refracted & bit != 0 {
            Some(Lobe::Refracted)
        } else {
            None
        }
    }
}

/// What a lane's surface is, in f64.
pub struct LaneSurface<'a> {
    pub(super) at: &'a At<'a>,
    pub(super) lane: usize,
    pub lobe: Lobe,
    pub n: DVec3,
    /// The same before a picture turned it.
    pub(super) base_n: DVec3,
    pub(super) direction: DVec3,
    pub(super) interface: Option<Interface<f64>>,
    /// Given if the lane has layers or a grain.
    pub(super) layers: Option<Layers<f64>>,
    pub(super) transmission: Option<RoughTransmission<f64>>,
}

impl<'a> LaneSurface<'a> {
    pub fn new(at: &'a At<'a>, lane: usize, lobe: Lobe) -> Self {
        let At {
            vertices, surface, ..
        } = *at;
        Self {
            at,
            lane,
            lobe,
            n: lane_of(surface.n, lane).as_dvec3(),
            base_n: lane_of(surface.base_n, lane).as_dvec3(),
            direction: lane_of(vertices.direction, lane).as_dvec3(),
            interface: surface
                .interface
                .as_ref()
                .map(|s| interface_of_lane(s, lane)),
            layers: match &surface.layers {
                Some(l) if vertices.kinds.layered() >> lane & 1 == 1 => {
                    Some(layers_of_lane(l, lane))
                }
                _ => None,
            },
            transmission: None,
        }
    }

    pub fn lane(&self) -> usize {
        self.lane
    }

    /// With what a rough plastic lets through, looked up for directions at cosine `cos_out`.
    fn with_transmission(&mut self, cos_out: f64) {
        let At {
            view,
            vertices,
            surface,
            ..
        } = *self.at;
        let all = view.transmission(vertices, surface.n, Lane::splat(cos_out as f32));
        self.transmission = Some(all.map(|x| f64::from(x.to_array()[self.lane])));
    }

    /// The coordinate of the unit direction `d`, in the frame of the shading normal, and BSDF times
    /// cosine there.
    pub fn value(&mut self, d: DVec3) -> Option<(DVec3, DVec3, f64)> {
        let wi = -self.direction.normalize();
        let (coordinate, density) = match self.lobe {
            Lobe::Diffuse => (d, self.n.dot(d) * FRAC_1_PI),
            Lobe::Reflected => {
                let h = (wi + d).normalize();
                (h, 0.25 / wi.dot(h))
            }
            Lobe::Refracted => {
                let ratio = self.ratio();
                let h = (wi + d * ratio).normalize();
                let h = if h.dot(self.n) < 0.0 { -h } else { h };
                let (i, o) = (wi.dot(h), d.dot(h));
                if i <= 0.0 || o >= 0.0 {
                    // No facet that looks outward refracts into this direction.
                    return None;
                }
                let sum = i + ratio * o;
                (h, ratio * ratio * o.abs() / (sum * sum))
            }
        };
        if self.lobe == Lobe::Diffuse && self.interface.is_some() {
            self.with_transmission(self.n.dot(d));
        }
        let frame = frame_of_lane(self.at.surface, self.lane);
        let local = DVec3::from(frame.map(|axis| axis.dot(coordinate)));
        if local.z <= 0.0 {
            return None;
        }
        let (_, weight) = self.bounce(local);
        Some((local, weight, density))
    }

    /// Index beyond the interface over that on this side.
    fn ratio(&self) -> f64 {
        let eta = self.interface.map_or(1.0, |s| s.eta.x);
        if self.at.vertices.kinds.inside >> self.lane & 1 == 1 {
            1.0 / eta
        } else {
            eta
        }
    }

    /// Where a smooth surface would send light, and by about how much the lobe strays from there.
    pub fn main_direction(&self) -> (DVec3, f64) {
        let main = self.bounce(DVec3::Z).0.normalize();
        let alpha = View::of_lane(self.at.vertices, self.at.surface, self.lane).alpha;
        let tilted = [DVec3::X, DVec3::Y].map(|tangent| {
            let local = (DVec3::Z + tangent * alpha).normalize();
            self.bounce(local).0.angle_between(main)
        });
        (main, tilted[0].max(tilted[1]).clamp(NARROWEST, 1.0))
    }

    /// +1 if the lobe leaves on the side of the normal, −1 if beyond the surface.
    fn side(&self) -> f64 {
        if self.lobe == Lobe::Refracted {
            -1.0
        } else {
            1.0
        }
    }
}

impl Line {
    /// The line through a diffuse bounce, of which `jitter` in [0, 1) places the points.
    pub fn diffuse(at: &LaneSurface, bounce: DVec3, axis: usize, jitter: f64, on: bool) -> Self {
        let frame = frame_of_lane(at.at.surface, at.lane);
        let family = Family {
            poles: [frame[0], frame[1]],
            axis,
        };
        let pole = family.pole();
        let middle = (bounce - pole * bounce.dot(pole)).normalize();
        let of_bounce = bounce.dot(pole).atan2(bounce.dot(middle));
        let (psi, bounce) = Self::points(jitter, on.then_some(of_bounce));
        Self {
            family,
            middle,
            spread: Spread::Diffuse,
            inverse_density: 2.0 / middle.dot(at.n).max(1e-9),
            psi,
            bounce,
            through_bounce: on,
        }
    }

    /// The points of a line of diffuse light, increasing, and which of them is the bounce.
    fn points(jitter: f64, bounce: Option<f64>) -> (Vec<f64>, Option<usize>) {
        let end = FRAC_PI_2 - RIM;
        let inner =
            (0..INNER_POINTS).map(|k| PI * (k as f64 + jitter) / INNER_POINTS as f64 - FRAC_PI_2);
        let mut psi: Vec<f64> = inner.collect();
        let place = bounce.map(|bounce| {
            let before = psi.partition_point(|&p| p < bounce);
            psi.insert(before, bounce);
            before + 1
        });
        psi.iter_mut().for_each(|p| *p = p.clamp(-end, end));
        psi.insert(0, -end);
        psi.push(end);
        (psi, place)
    }

    /// A line through a rough surface's lobe: `place` in [0, 1) draws it, `jitter` its points.
    /// `None` if all of it lies below the horizon.
    pub fn lobe(at: &LaneSurface, axis: usize, place: f64, jitter: f64) -> Option<Self> {
        // Where all light is reflected there is no other direction; any will do.
        let main = at.bounce(DVec3::Z).0.normalize();
        let frame = frame_of_lane(at.at.surface, at.lane);
        let view = View::of_lane(at.at.vertices, at.at.surface, at.lane);
        let across = at.n.cross(view.world);
        // Where the ray arrives along the normal any plane will do.
        let across = across.try_normalize().unwrap_or(frame[0]);
        let across = if across.length_squared() > 0.5 {
            across
        } else {
            frame[0]
        };
        let poles = [
            main.cross(across).normalize(),
            across - main * across.dot(main),
        ];
        let poles = [poles[0], poles[1].normalize()];
        let tilted = |tangent: DVec3| {
            let alpha = view.alpha_along(at.at.vertices, at.lane, tangent);
            let h = (at.n + tangent * alpha).normalize();
            let local = DVec3::from(frame.map(|axis| axis.dot(h)));
            let angle = at.bounce(local).0.angle_between(main);
            angle.clamp(NARROWEST, 1.0)
        };
        let widths = [tilted(across.cross(at.n)), tilted(across)];
        let (pole, other) = (poles[axis], poles[1 - axis]);
        let (width, turn) = (widths[axis], widths[1 - axis]);
        let q = 2.0 * place - 1.0;
        let phi = turn * q / (1.0 - q * q).max(1e-12).sqrt();
        if phi.abs() >= PI {
            return None;
        }
        let middle = main * phi.cos() + other * phi.sin();
        let [low, high] = above_horizon(pole, middle, at.n * at.side())?;
        let scale = 1.0 + (phi / turn).powi(2);
        // Of (1 + φ² + ψ²)⁻², which is GGX's shape in units of its width, the part on one line is
        // √(1 + φ²) times as wide as on the one through its middle.
        let width = width * scale.sqrt();
        let spread = Spread::Lobe { width };
        let mut psi: Vec<f64> = (0..INNER_POINTS)
            .map(|k| 2.0 * (k as f64 + jitter) / INNER_POINTS as f64 - 1.0)
            .map(|q| width * q / (1.0 - q * q).max(1e-12).sqrt())
            .filter(|p| (low..high).contains(p))
            .collect();
        psi.insert(0, low);
        psi.push(high);
        Some(Self {
            family: Family { poles, axis },
            middle,
            spread,
            inverse_density: 2.0 * turn * scale * scale.sqrt(),
            psi,
            bounce: None,
            through_bounce: false,
        })
    }

    /// Where it crosses the plane of the triangle that it starts on, whose normal this is, and its
    /// parts before and beyond that; `None` where all of it lies on one side. Rays leave on one
    /// side or the other, so that what they see jumps there. Shading normals are why a line crosses
    /// that plane.
    pub fn cut(&self, geometric: DVec3) -> Option<(f64, [Self; 2])> {
        let at = -(self.middle.dot(geometric) / self.family.pole().dot(geometric)).atan();
        let (&first, &last) = (self.psi.first()?, self.psi.last()?);
        if !(first + 2.0 * RIM..last - 2.0 * RIM).contains(&at) {
            return None;
        }
        let [end, start] = [at - RIM, at + RIM];
        let place = |psi: f64| self.psi.partition_point(|&p| p < psi);
        let (before, beyond) = (place(end), place(start));
        let part = |psi: Vec<f64>, bounce: Option<usize>| Self {
            psi,
            bounce,
            ..self.clone()
        };
        let mut low = self.psi[..before].to_vec();
        low.push(end);
        let mut high = vec![start];
        high.extend(&self.psi[beyond..]);
        let low = part(low, self.bounce.filter(|&b| b < before));
        let high = part(
            high,
            self.bounce.filter(|&b| b >= beyond).map(|b| b - beyond + 1),
        );
        Some((at, [low, high]))
    }

    /// The direction at ψ, unit.
    pub fn direction(&self, psi: f64) -> DVec3 {
        self.family.pole() * psi.sin() + self.middle * psi.cos().max(0.0)
    }

    /// Where a direction on the line lies on it.
    pub fn psi_of(&self, direction: DVec3) -> f64 {
        self.family
            .pole()
            .dot(direction)
            .atan2(self.middle.dot(direction))
    }

    /// Where it can see something from `x`.
    pub fn sector(&self, x: DVec3, at: &LaneSurface) -> Sector {
        Sector {
            origin: x,
            normal: self.family.pole().cross(self.middle),
            inward: [self.middle, at.n * at.side()],
        }
    }

    /// The intervals between borders at these ψ, increasing.
    pub fn intervals(&self, psi: &[f64]) -> Intervals {
        let places = psi.iter().map(|&psi| self.place(psi)).collect();
        let mut intervals =
            Intervals::with_extra(places, psi.iter().map(|&psi| bounces_below(psi)));
        if !self.through_bounce {
            intervals.extra.fill(0.0);
        }
        intervals
    }

    /// The chance that any point lies between two ψ.
    pub fn chance_between(&self, interval: [f64; 2]) -> f64 {
        let [from, to] = interval.map(|psi| self.place(psi));
        let [below, above] = interval.map(bounces_below);
        let extra = if self.through_bounce {
            above - below
        } else {
            0.0
        };
        chance_of_any(to - from, extra)
    }

    /// The ψ of a place.
    pub fn at_place(&self, place: f64) -> f64 {
        let part = place / INNER_POINTS as f64;
        match self.spread {
            Spread::Diffuse => (part - 0.5) * PI,
            Spread::Lobe { width } => {
                let q = 2.0 * part - 1.0;
                width * q / (1.0 - q * q).max(1e-12).sqrt()
            }
        }
    }

    /// Of a ψ in distances of the jittered points.
    pub fn place(&self, psi: f64) -> f64 {
        let part = match self.spread {
            Spread::Diffuse => psi * FRAC_1_PI + 0.5,
            Spread::Lobe { width } => 0.5 * (psi / psi.hypot(width) + 1.0),
        };
        part * INNER_POINTS as f64
    }
}

/// The chance that the bounce lies below a ψ of its line: cosine-distributed directions are uniform
/// over the disk, of which sin ψ is a coordinate, so that its density is 2/π cos²ψ.
fn bounces_below(psi: f64) -> f64 {
    0.5 + (psi + psi.sin() * psi.cos()) * FRAC_1_PI
}

/// The part of a line that lies above the horizon of `n`, as an interval of ψ: a little less, since
/// the directions of its ends are rounded and must not leave on the other side of the surface.
pub fn above_horizon(pole: DVec3, middle: DVec3, n: DVec3) -> Option<[f64; 2]> {
    // n·d = A sin ψ + B cos ψ changes sign once, at an end if the pole lies on the horizon.
    let (a, b) = (pole.dot(n), middle.dot(n));
    let zero = -(b / a).atan();
    let (mut low, mut high) = (-FRAC_PI_2, FRAC_PI_2);
    if a > 0.0 {
        low = zero;
    } else if a < 0.0 {
        high = zero;
    } else if b <= 0.0 {
        return None;
    }
    (high - low > 3.0 * RIM).then_some([low + RIM, high - RIM])
}
