//! The bodies that directions follow (`paths::lobe_drift`), and how they move.
//!
//! A *ball* is seen by its outline, which rests if it turns about itself: the velocity of its
//! middle is followed. Others are seen by their parts, which turn with them, so that their rotation
//! is followed, too. Of a *wall*, which is flat, only the motion across its plane is followed.
//!
//! These are means over a few vertices vᵢ at the arms rᵢ from their middle. The velocity is v̄ =
//! ⟨v⟩. The rotation is that of least squares, ω = J⁻¹⟨r × v⟩ with J = ⟨r² − r rᵀ⟩; it is exact of
//! what moves rigidly.

use glam::{DMat3, DVec3};
use std::ops::AddAssign;

/// Vertices that stand for a body.
const MOST_VERTICES: usize = 64;
/// Of the product of a body's moments of inertia, relative to their mean's cube, below which all of
/// it lies on a line and has no rotation.
const LEAST_MOMENT: f64 = 1e-6;

/// Something that directions follow.
#[derive(Clone, Debug)]
pub struct Body {
    /// Of the sphere around it.
    pub centre: DVec3,
    pub radius: f64,
    /// Whether it may move.
    pub moves: bool,
    vertices: Vec<u32>,
    turning: Option<Turning>,
    /// Unit, of a wall, in whose plane its centre lies.
    plane_normal: Option<DVec3>,
}

/// What the rotation of a body is told from.
#[derive(Clone, Debug)]
struct Turning {
    middle: DVec3,
    arms: Vec<DVec3>,
    inverse_inertia: DMat3,
}

/// How a body moves, or the cotangent of that.
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyMotion {
    /// Of its middle.
    pub velocity: DVec3,
    pub rotation: DVec3,
}

impl AddAssign for BodyMotion {
    fn add_assign(&mut self, other: Self) {
        self.velocity += other.velocity;
        self.rotation += other.rotation;
    }
}

impl Body {
    /// Of these vertices, in a sphere of this centre and radius. `None` if they lie in a point.
    pub fn new(
        vertices: Vec<u32>,
        position: impl Fn(u32) -> DVec3,
        (centre, radius): (DVec3, f64),
        [moves, is_ball]: [bool; 2],
    ) -> Option<Self> {
        if radius == 0.0 {
            return None;
        }
        let step = vertices.len().div_ceil(MOST_VERTICES);
        let vertices: Vec<u32> = vertices.into_iter().step_by(step).collect();
        let positions: Vec<DVec3> = vertices.iter().map(|&v| position(v)).collect();
        Some(Self {
            centre,
            radius,
            moves,
            vertices,
            turning: (!is_ball).then(|| Turning::new(&positions)),
            plane_normal: None,
        })
    }

    /// The same as a wall in the plane through its centre with this unit normal.
    pub fn as_wall(self, normal: DVec3) -> Self {
        Self {
            plane_normal: Some(normal),
            ..self
        }
    }

    /// The normal of a wall.
    pub fn plane_normal(&self) -> Option<DVec3> {
        self.plane_normal
    }

    pub fn is_ball(&self) -> bool {
        self.turning.is_none()
    }

    /// From what it turns about to `x`.
    pub fn arm(&self, x: DVec3) -> DVec3 {
        self.turning.as_ref().map_or(DVec3::ZERO, |c| x - c.middle)
    }

    /// How it moves, given the velocities of vertices.
    pub fn motion(&self, of: impl Fn(u32) -> DVec3) -> BodyMotion {
        let one = 1.0 / self.vertices.len() as f64;
        let sum: DVec3 = self.vertices.iter().map(|&v| of(v)).sum();
        let rotation = self.turning.as_ref().map_or(DVec3::ZERO, |turning| {
            let arms = turning.arms.iter().zip(&self.vertices);
            let moment: DVec3 = arms.map(|(r, &v)| r.cross(of(v))).sum();
            turning.inverse_inertia * (moment * one)
        });
        BodyMotion {
            velocity: sum * one,
            rotation,
        }
    }

    /// From the cotangent of that to those of its vertices.
    pub fn motion_adjoint(&self, bar: BodyMotion, mut of: impl FnMut(u32, DVec3)) {
        let one = 1.0 / self.vertices.len() as f64;
        let turn = self
            .turning
            .as_ref()
            .map(|c| c.inverse_inertia * bar.rotation);
        for (i, &v) in self.vertices.iter().enumerate() {
            let arm = self.turning.as_ref().map_or(DVec3::ZERO, |c| c.arms[i]);
            let by_rotation = turn.map_or(DVec3::ZERO, |turn| turn.cross(arm));
            of(v, (bar.velocity + by_rotation) * one);
        }
    }
}

impl Turning {
    fn new(positions: &[DVec3]) -> Self {
        let one = 1.0 / positions.len() as f64;
        let middle = positions.iter().sum::<DVec3>() * one;
        let arms: Vec<DVec3> = positions.iter().map(|&p| p - middle).collect();
        let mut inertia = DMat3::ZERO;
        for r in &arms {
            let outer = DMat3::from_cols(*r * r.x, *r * r.y, *r * r.z);
            inertia += (DMat3::from_diagonal(DVec3::splat(r.length_squared())) - outer) * one;
        }
        let mean = (inertia.x_axis.x + inertia.y_axis.y + inertia.z_axis.z) / 3.0;
        let is_line = inertia.determinant() <= LEAST_MOMENT * mean * mean * mean;
        Self {
            middle,
            arms,
            inverse_inertia: if is_line {
                DMat3::ZERO
            } else {
                inertia.inverse()
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn positions() -> Vec<DVec3> {
        let at = |i: u32| {
            let x = f64::from(i);
            DVec3::new((2.1 * x).sin(), (1.3 * x).cos(), 0.3 * (0.7 * x).sin())
        };
        (0..200).map(at).collect()
    }

    fn body() -> Body {
        let p = positions();
        let all = (0..p.len() as u32).collect();
        Body::new(all, |v| p[v as usize], (DVec3::ZERO, 2.0), [true, false]).unwrap()
    }

    #[test]
    fn a_rigid_motion_is_told_exactly() {
        let (body, p) = (body(), positions());
        let (velocity, rotation) = (DVec3::new(0.3, -0.7, 1.1), DVec3::new(-0.4, 0.9, 0.2));
        let motion = body.motion(|v| velocity + rotation.cross(p[v as usize]));
        let x = DVec3::new(2.0, 1.0, -3.0);
        let found = motion.velocity + motion.rotation.cross(body.arm(x));
        assert!(found.distance(velocity + rotation.cross(x)) < 1e-12);
        assert!(motion.rotation.distance(rotation) < 1e-12);
    }

    #[test]
    fn the_adjoint_is_the_transpose() {
        let (body, p) = (body(), positions());
        let of = |v: u32| p[v as usize].cross(DVec3::ONE) * p[v as usize].x;
        let motion = body.motion(of);
        let bar = BodyMotion {
            velocity: DVec3::new(0.2, 0.5, -0.3),
            rotation: DVec3::new(1.0, -0.6, 0.4),
        };
        let there = motion.velocity.dot(bar.velocity) + motion.rotation.dot(bar.rotation);
        let mut back = 0.0;
        body.motion_adjoint(bar, |v, v_bar| back += v_bar.dot(of(v)));
        assert!((there - back).abs() < 1e-12, "{there} {back}");
    }

    #[test]
    fn what_lies_on_a_line_has_no_rotation() {
        let all = (0..20).collect();
        let at = |v: u32| DVec3::new(f64::from(v), 0.0, 0.0);
        let body = Body::new(all, at, (DVec3::ZERO, 2.0), [true, false]).unwrap();
        assert_eq!(body.motion(at).rotation, DVec3::ZERO);
    }
}
