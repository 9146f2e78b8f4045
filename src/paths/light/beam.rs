//! What a spot or a projector sends toward a point, as a share of its power, and how that changes
//! with the point.

use crate::lanes::{LANES, Lane, V3};
use crate::paths::rays::{from_lanes, lane_of, splat};
use crate::paths::surface::texture::{Lookup, lookup};
use crate::scene::{Beam, BeamProfile, DeltaLight, Texture};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// The intensity toward one point: power times picture times shape.
#[derive(Clone, Copy, Debug)]
pub struct Intensity {
    pub power: Lookup,
    pub picture: Option<(usize, Lookup)>,
    shape: f32,
    /// By the point in the light's own axes: of the shape, and of the places in the textures.
    shape_by_local: Vec3,
    uv_by_local: [Vec3; 2],
}

impl Intensity {
    fn picture_value(&self) -> Vec3 {
        self.picture.map_or(Vec3::ONE, |(_, found)| found.value)
    }

    /// W/sr.
    pub fn value(&self) -> Vec3 {
        self.power.value * self.picture_value() * self.shape
    }

    /// The change of the value if the texels change by what `of` says of each texture, and the
    /// point by `local` in the light's own axes.
    pub fn tangent(&self, power: Vec3, picture: Vec3, local: Vec3) -> Vec3 {
        let [u, v] = self.uv_by_local.map(|by| by.dot(local));
        let moved = |found: &Lookup| found.by_uv[0] * u + found.by_uv[1] * v;
        let power = power + moved(&self.power);
        let picture = picture + self.picture.map_or(Vec3::ZERO, |(_, found)| moved(&found));
        let shape = self.shape_by_local.dot(local);
        (power * self.picture_value() + self.power.value * picture) * self.shape
            + self.power.value * self.picture_value() * shape
    }

    /// From the cotangent of the value those of the power's texels (each by its weight), of the
    /// picture's, and of the point in the light's own axes.
    pub fn cotangents(&self, bar: Vec3) -> (Vec3, Vec3, Vec3) {
        let power = bar * self.picture_value() * self.shape;
        let picture = bar * self.power.value * self.shape;
        let shape = bar.dot(self.power.value * self.picture_value());
        let mut local = self.shape_by_local * shape;
        for (axis, by) in self.uv_by_local.iter().enumerate() {
            let mut slope = self.power.by_uv[axis].dot(power);
            if let Some((_, found)) = &self.picture {
                slope += found.by_uv[axis].dot(picture);
            }
            local += *by * slope;
        }
        (power, picture, local)
    }
}

/// What a light with a beam sends toward the point `from_light` away from it (world axes); nothing
/// outside the beam.
pub fn intensity(
    textures: &[Texture],
    light: &DeltaLight,
    beam: &Beam,
    from_light: Vec3,
) -> Option<Intensity> {
    let d = beam.to_local * from_light;
    match beam.profile {
        BeamProfile::Spot {
            beam_width_rad,
            cutoff_rad,
            texture,
        } => {
            let cos = d.z / d.length();
            if cos.is_nan() || cos <= cutoff_rad.cos() {
                return None;
            }
            let power = lookup(&textures[light.power], Vec2::ZERO);
            let (shape, shape_by_local) = if cos >= beam_width_rad.cos() {
                (1.0, Vec3::ZERO)
            } else {
                let slope = 1.0 / (cutoff_rad - beam_width_rad);
                // dθ/dd: outwards across the axis, over the distance.
                let outwards = Vec3::new(d.x, d.y, 0.0).normalize_or_zero();
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                let turn = (outwards * cos - Vec3::Z * sin) / d.length();
                ((cutoff_rad - cos.acos()) * slope, turn * -slope)
            };
            let (uv, uv_by_local) = on_plane(d, Vec2::splat(cutoff_rad.tan()), 0.5);
            Some(Intensity {
                power,
                picture: texture.map(|t| (t, lookup(&textures[t], uv))),
                shape,
                shape_by_local,
                uv_by_local,
            })
        }
        BeamProfile::Projector {
            half_tangents,
            scale,
            axis,
        } => {
            // As on a camera's film, u counts against x and v against y.
            let (uv, uv_by_local) = on_plane(d, half_tangents, -0.5);
            if d.z.is_nan() || d.z <= 0.0 || uv.clamp(Vec2::ZERO, Vec2::ONE) != uv {
                return None;
            }
            let r = from_light.length();
            let along = axis.dot(from_light);
            let shape = PI * scale * r * r * r / (d.z * d.z * along);
            // In the world, then along the light's own axes: d = to_local·w, so ∂/∂d = M⁻ᵀ ∂/∂w.
            let by_world = from_light * (3.0 / (r * r)) - axis / along;
            let to_world_transposed = beam.to_local.inverse().transpose();
            let shape_by_local = to_world_transposed * by_world - Vec3::Z * (2.0 / d.z);
            Some(Intensity {
                power: lookup(&textures[light.power], uv),
                picture: None,
                shape,
                shape_by_local: shape_by_local * shape,
                uv_by_local,
            })
        }
    }
}

/// Where `d` meets the plane z = 1, of which ± `half` from the middle is the unit square, and how
/// that changes with `d`.
fn on_plane(d: Vec3, half: Vec2, sign: f32) -> (Vec2, [Vec3; 2]) {
    let per = sign / (half * d.z);
    let uv = 0.5 + Vec2::new(d.x, d.y) * per;
    let by = |axis: usize| {
        let mut by = Vec3::ZERO;
        by[axis] = per[axis];
        by.z = -d[axis] / d.z * per[axis];
        by
    };
    (uv, [by(0), by(1)])
}

/// The power of a light toward the points `x`, per lane: that of a light without a beam is the same
/// everywhere.
pub fn power_toward(textures: &[Texture], light: &DeltaLight, away: V3<Lane>) -> V3<Lane> {
    let Some(beam) = &light.beam else {
        return splat(Vec3::from(textures[light.power].texels[0]));
    };
    let values: [Vec3; LANES] = std::array::from_fn(|lane| {
        intensity(textures, light, beam, lane_of(away, lane)).map_or(Vec3::ZERO, |i| i.value())
    });
    from_lanes(&values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{DeltaLightKind, Layout, Wrap};
    use glam::{Affine2, Mat3};

    /// By central differences of the value along each axis.
    fn slopes_agree(light: &DeltaLight, textures: &[Texture], at: Vec3) {
        let beam = light.beam.as_ref().unwrap();
        let here = intensity(textures, light, beam, at).unwrap();
        let step = 1e-2;
        for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
            let side = |s: f32| {
                let moved = intensity(textures, light, beam, at + axis * (s * step)).unwrap();
                moved.value()
            };
            let difference = (side(1.0) - side(-1.0)) / (2.0 * step);
            let local = beam.to_local * axis;
            let tangent = here.tangent(Vec3::ZERO, Vec3::ZERO, local);
            let scale = here.value().length() / at.length();
            assert!(
                (difference - tangent).length() < 0.01 * scale,
                "{axis}: {difference} against {tangent}"
            );
            let w = Vec3::new(0.3, -0.7, 0.5);
            let (_, _, back) = here.cotangents(w);
            let (one, other) = (back.dot(local), w.dot(tangent));
            assert!((one - other).abs() < 1e-4 * scale, "{one} against {other}");
        }
    }

    #[test]
    fn intensities_change_as_their_slopes_say() {
        let picture = Texture {
            texels: vec![
                [0.1, 0.9, 0.4],
                [0.8, 0.2, 0.5],
                [0.3, 0.6, 0.7],
                [0.9, 0.1, 0.2],
            ],
            layout: Layout::Bitmap {
                width: 2,
                height: 2,
                wrap: Wrap::Repeat,
                bilinear: true,
                to_uv: Affine2::from_scale(Vec2::new(0.9, 1.1)),
            },
            ..Texture::constant("picture".into(), [0.0; 3])
        };
        let textures = [Texture::constant("power".into(), [2.0, 3.0, 5.0]), picture];
        let turned = Mat3::from_rotation_x(0.4) * Mat3::from_rotation_z(1.1);
        let light = |profile, power| DeltaLight {
            key: "light".into(),
            kind: DeltaLightKind::Point {
                position: Vec3::ZERO,
            },
            power,
            beam: Some(Beam {
                to_local: turned,
                profile,
            }),
        };
        let spot = |texture| BeamProfile::Spot {
            beam_width_rad: 0.2,
            cutoff_rad: 0.9,
            texture,
        };
        let at = turned.transpose() * Vec3::new(0.7, -0.5, 2.0);
        slopes_agree(&light(spot(None), 0), &textures, at);
        slopes_agree(&light(spot(Some(1)), 0), &textures, at);
        let projector = BeamProfile::Projector {
            half_tangents: Vec2::new(0.6, 0.5),
            scale: 2.0,
            axis: turned.transpose() * Vec3::Z,
        };
        slopes_agree(&light(projector, 1), &textures, at);
    }
}
