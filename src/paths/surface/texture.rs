//! What a texture is at a point, and how that changes with its texels and with the point.

use crate::scene::{Layout, Rgb, Texture, Wrap};
use glam::{DVec2, Vec2, Vec3};

/// Texels that a point mixes, and the slopes over texture coordinates.
#[derive(Clone, Copy, Debug)]
pub struct Lookup {
    pub value: Vec3,
    pub texels: [u32; 4],
    pub weights: [f32; 4],
    /// Along u and v as the mesh has them (before `to_uv`).
    pub by_uv: [Vec3; 2],
    /// Along u and v after `to_uv`.
    pub by_place: [Vec3; 2],
    /// As the mesh has them.
    pub uv: Vec2,
}

impl Lookup {
    /// One texel, which does not change from place to place.
    pub fn of_one(texture: &Texture, texel: u32) -> Self {
        Self {
            value: Vec3::from(texture.texels[texel as usize]),
            texels: [texel; 4],
            weights: [1.0, 0.0, 0.0, 0.0],
            by_uv: [Vec3::ZERO; 2],
            by_place: [Vec3::ZERO; 2],
            uv: Vec2::ZERO,
        }
    }

    /// How the value changes if the rows of `to_uv` change by these.
    pub fn moved(&self, to_uv: &[f32; 6]) -> Vec3 {
        let row = |r: usize| to_uv[r] * self.uv.x + to_uv[r + 1] * self.uv.y + to_uv[r + 2];
        self.by_place[0] * row(0) + self.by_place[1] * row(3)
    }

    /// The cotangent of the rows of `to_uv`.
    pub fn to_uv_bar(&self, bar: Vec3) -> [f32; 6] {
        let [x, y] = self.by_place.map(|by| by.dot(bar));
        let uv = self.uv;
        [x * uv.x, x * uv.y, x, y * uv.x, y * uv.y, y]
    }

    /// How the value changes if the texels change by these.
    pub fn mix(&self, texels: &[Rgb]) -> Vec3 {
        self.texels
            .iter()
            .zip(self.weights)
            .map(|(&t, w)| Vec3::from(texels[t as usize]) * w)
            .sum()
    }
}

/// The texture at texture coordinates `uv`; constants have the same value everywhere.
pub fn lookup(texture: &Texture, uv: Vec2) -> Lookup {
    match texture.layout {
        // Those of vertices and faces are looked up on their triangles.
        Layout::Constant | Layout::Vertices | Layout::Faces => Lookup::of_one(texture, 0),
        Layout::Checkerboard { to_uv } => {
            let at = to_uv.transform_point2(uv);
            let is_late = |x: f32| x - x.floor() > 0.5;
            Lookup::of_one(texture, (is_late(at.x) != is_late(at.y)) as u32)
        }
        Layout::Bitmap {
            width,
            height,
            wrap,
            bilinear,
            to_uv,
        } => {
            let at = to_uv.transform_point2(uv);
            let size = [width, height];
            let scale = Vec2::new(width as f32, height as f32);
            if !bilinear {
                let [x, y] = [at.x * scale.x, at.y * scale.y].map(|x| x.floor() as i64);
                let texel = wrapped(x, size[0], wrap) + wrapped(y, size[1], wrap) * width;
                return Lookup::of_one(texture, texel);
            }
            let at = at * scale - 0.5;
            let low = at.floor();
            let part = at - low;
            let [x, y] = [low.x as i64, low.y as i64];
            let index = |dx: i64, dy: i64| {
                wrapped(x + dx, size[0], wrap) + wrapped(y + dy, size[1], wrap) * width
            };
            let texels = [index(0, 0), index(1, 0), index(0, 1), index(1, 1)];
            let weights = [
                (1.0 - part.x) * (1.0 - part.y),
                part.x * (1.0 - part.y),
                (1.0 - part.x) * part.y,
                part.x * part.y,
            ];
            let [a, b, c, d] = texels.map(|t| Vec3::from(texture.texels[t as usize]));
            let by_x = ((b - a) * (1.0 - part.y) + (d - c) * part.y) * scale.x;
            let by_y = ((c - a) * (1.0 - part.x) + (d - b) * part.x) * scale.y;
            let m = to_uv.matrix2;
            Lookup {
                value: a * weights[0] + b * weights[1] + c * weights[2] + d * weights[3],
                texels,
                weights,
                by_uv: [
                    by_x * m.x_axis.x + by_y * m.x_axis.y,
                    by_x * m.y_axis.x + by_y * m.y_axis.y,
                ],
                by_place: [by_x, by_y],
                uv,
            }
        }
    }
}

/// Texels that a point mixes, in double precision.
#[derive(Clone, Copy, Debug)]
pub struct Mix {
    pub texels: [u32; 4],
    pub weights: [f64; 4],
    /// The slopes of the weights along u and v as the mesh has them.
    pub by_uv: [[f64; 4]; 2],
}

/// The same as [`lookup`] does, for those who look at places that single precision does not tell
/// apart.
pub fn mix(texture: &Texture, uv: DVec2) -> Mix {
    let one = |texel| Mix {
        texels: [texel; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
        by_uv: [[0.0; 4]; 2],
    };
    let Layout::Bitmap {
        width,
        height,
        wrap,
        bilinear,
        to_uv,
    } = texture.layout
    else {
        return one(lookup(texture, uv.as_vec2()).texels[0]);
    };
    let [x_axis, y_axis] = [to_uv.matrix2.x_axis, to_uv.matrix2.y_axis].map(|a| a.as_dvec2());
    let at = x_axis * uv.x + y_axis * uv.y + to_uv.translation.as_dvec2();
    let scale = DVec2::new(f64::from(width), f64::from(height));
    let at = at * scale - if bilinear { 0.5 } else { 0.0 };
    let low = at.floor();
    let [x, y] = [low.x as i64, low.y as i64];
    let index =
        |dx: i64, dy: i64| wrapped(x + dx, width, wrap) + wrapped(y + dy, height, wrap) * width;
    if !bilinear {
        return one(index(0, 0));
    }
    let DVec2 { x: s, y: t } = at - low;
    let by_x = [t - 1.0, 1.0 - t, -t, t].map(|w| w * scale.x);
    let by_y = [s - 1.0, -s, 1.0 - s, s].map(|w| w * scale.y);
    Mix {
        texels: [index(0, 0), index(1, 0), index(0, 1), index(1, 1)],
        weights: [(1.0 - s) * (1.0 - t), s * (1.0 - t), (1.0 - s) * t, s * t],
        // Along u both coordinates of the picture change, by the first column.
        by_uv: [x_axis, y_axis]
            .map(|column| std::array::from_fn(|i| by_x[i] * column.x + by_y[i] * column.y)),
    }
}

/// How a picture of heights rises.
#[derive(Clone, Copy, Debug)]
pub struct Rise {
    /// Along u and v as the mesh has them.
    pub by_uv: [f32; 2],
    pub texels: [u32; 4],
    /// The slopes of `by_uv` by these texels.
    pub by_texels: [[f32; 4]; 2],
    /// The slopes of `by_uv` along u and v.
    pub bends: [[f32; 2]; 2],
}

/// How a texture rises at texture coordinates `uv`: zero where it is no filtered picture.
pub fn rise(texture: &Texture, uv: Vec2) -> Rise {
    let found = lookup(texture, uv);
    let mut rise = Rise {
        by_uv: found.by_uv.map(|by| by.x),
        texels: found.texels,
        by_texels: [[0.0; 4]; 2],
        bends: [[0.0; 2]; 2],
    };
    let Layout::Bitmap {
        width,
        height,
        bilinear: true,
        to_uv,
        ..
    } = texture.layout
    else {
        return rise;
    };
    let scale = Vec2::new(width as f32, height as f32);
    let at = to_uv.transform_point2(uv) * scale - 0.5;
    let part = at - at.floor();
    let by_x = [part.y - 1.0, 1.0 - part.y, -part.y, part.y].map(|w| w * scale.x);
    let by_y = [part.x - 1.0, -part.x, 1.0 - part.x, part.x].map(|w| w * scale.y);
    let m = to_uv.matrix2;
    // Along u both coordinates of the picture change, by the first column.
    for (row, column) in [m.x_axis, m.y_axis].into_iter().enumerate() {
        rise.by_texels[row] = std::array::from_fn(|t| by_x[t] * column.x + by_y[t] * column.y);
    }
    let [a, b, c, d] = found.texels.map(|t| texture.texels[t as usize][0]);
    let twist = (a - b - c + d) * scale.x * scale.y;
    let columns = [m.x_axis, m.y_axis];
    rise.bends = columns.map(|p| columns.map(|q| twist * (p.x * q.y + p.y * q.x)));
    rise
}

/// The texel that stands for texel `at` of a row of `size`.
fn wrapped(at: i64, size: u32, wrap: Wrap) -> u32 {
    let size = size as i64;
    let inside = match wrap {
        Wrap::Repeat => at.rem_euclid(size),
        Wrap::Clamp => at.clamp(0, size - 1),
        Wrap::Mirror => {
            let at = at.rem_euclid(2 * size);
            at.min(2 * size - 1 - at)
        }
    };
    inside as u32
}
