//! Sampling an environment map: directions, and lines on which the shadows' edges are looked for.
//!
//! Directions keep their place on the map when it turns. In these coordinates the radiance is
//! constant, and so are the densities of both strategies that sample it (light samples and wide
//! bounces): as for area lights, multiple importance weights may be frozen, and what is left to
//! differentiate is the surface and what hides the environment.
//!
//! Lines are meridians about two axes of the map (`boundary::cells::lobe::line`), each drawn by the
//! map's power along it, with points at quantiles of its power: most lines run through the sun,
//! most of their points lie in it.

use crate::paths::environment::guide::Guide;
use crate::paths::environment::map;
use crate::paths::light::patches::luminance;
use crate::room::{self, Cancelled, NoRoom, Unfinished};
use crate::scene::{EnvironmentMap, Layout, Texture};
use glam::{DVec3, Vec3};
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The part of all samples that is spread evenly, so that what bins are too coarse for is not
/// missed.
const EVEN: f64 = 0.1;
/// Columns of meridians about the second axis, at most.
const MOST_COLUMNS: usize = 1024;
/// Samples along each side of a texel's cell when the map is turned to another axis: this many
/// where the map is coarse, fewer where it is as fine as the table.
const SUBDIVISIONS: usize = 4;

/// Rows of samples that are worked out at once, and then added in their order.
const ROWS_AT_ONCE: usize = 64;

/// A map, prepared for sampling.
pub struct MapDistribution {
    /// About +y, as the map has it: it also draws directions.
    /// Then about +x.
    tables: [Meridians; 2],
    map: EnvironmentMap,
}

/// Power over longitude φ and latitude ψ about an axis: d = axis·sin ψ + (b·cos φ + c·sin φ)·cos ψ.
struct Meridians {
    axis: DVec3,
    b: DVec3,
    c: DVec3,
    columns: usize,
    rows: usize,
    /// Of each column, and their sums up to and including it (to 1).
    column_sum: Vec<f64>,
    /// Within each column, sums up to and including each row (to 1).
    row_sum: Vec<f64>,
    column_guide: Guide,
    row_guide: Guide,
}

/// A meridian, with points on it.
pub struct Meridian {
    pub axis: usize,
    /// 1/p(φ).
    pub inverse_density: f64,
    pub pole: DVec3,
    pub middle: DVec3,
    column: usize,
}

impl MapDistribution {
    /// Prepares a map on the threads of the pool this is called in.
    pub fn new(
        texture: &Texture,
        map: &EnvironmentMap,
        cancelled: Cancelled,
    ) -> Result<Self, Unfinished> {
        let (width, height) = match texture.layout {
            Layout::Bitmap { width, height, .. } => (width as usize, height as usize),
            _ => (1, 2),
        };
        let (y, x, z) = (DVec3::Y, DVec3::X, DVec3::Z);
        let (columns, rows) = (width, (height - 1).max(1));
        // u = atan2(x, −z)/2π: φ = 2πu with b = −z, c = x; rows run from the north pole down.
        let mut first = Meridians::empty(y, -z, x, columns, rows);
        let other = columns.max(2 * rows).min(MOST_COLUMNS);
        let mut second = Meridians::empty(x, y, z, other, other.div_ceil(2));
        let n = (2 * MOST_COLUMNS / columns).clamp(1, SUBDIVISIONS);
        let place = |i: usize, of: usize| (i as f64 + 0.5) / (of * n) as f64;
        let longitudes: Vec<[f64; 2]> = (0..columns * n)
            .map(|column| TAU * place(column, columns))
            .map(|phi| [phi.cos(), phi.sin()])
            .collect();
        // Neighbours that go into one cell of the second table: where the map is finer than that,
        // looking up every sample's cell would take as long as reading the map.
        let together = (longitudes.len() / (2 * MOST_COLUMNS)).max(1);
        // The power of each sample of a row, and the cells of the second table that they lie in.
        let samples_of = |row: usize| -> (Vec<f64>, Vec<usize>) {
            let psi = FRAC_PI_2 - PI * place(row, rows);
            let (sin, cos) = (psi.sin(), psi.cos());
            let power = |column: usize| {
                let at = [column, row].map(|i| (i as f64 + 0.5) / n as f64);
                let value = map::value_at(texture, [width as u32, height as u32], at);
                luminance(value.to_array()) * f64::from(map.scale) * cos
            };
            let cell = |some: &[[f64; 2]]| {
                let [cos_phi, sin_phi] = some[some.len() / 2];
                second.cell(first.axis * sin + (first.b * cos_phi + first.c * sin_phi) * cos)
            };
            (
                (0..longitudes.len()).map(power).collect(),
                longitudes.chunks(together).map(cell).collect(),
            )
        };
        let all: Vec<usize> = (0..rows * n).collect();
        let (mut first_power, mut second_power) = (first.no_power()?, second.no_power()?);
        for some in all.chunks(ROWS_AT_ONCE) {
            if cancelled() {
                return Err(Unfinished::Interrupted);
            }
            let found: Vec<_> = some.par_iter().map(|&row| samples_of(row)).collect();
            // In one order, whatever the number of threads.
            for (&row, (powers, cells)) in some.iter().zip(&found) {
                let first_row = first.row(FRAC_PI_2 - PI * place(row, rows));
                for (column, power) in powers.iter().enumerate() {
                    first_power[column / n * rows + first_row] += power;
                    second_power[cells[column / together]] += power;
                }
            }
        }
        first.row_sum = first_power;
        second.row_sum = second_power;
        first.finish();
        second.finish();
        Ok(Self {
            tables: [first, second],
            map: *map,
        })
    }

    fn to_world(&self, d: DVec3) -> DVec3 {
        (self.map.to_world * d.as_vec3()).as_dvec3().normalize()
    }

    fn to_map(&self, d: DVec3) -> DVec3 {
        (self.map.to_world.transpose() * d.as_vec3())
            .as_dvec3()
            .normalize()
    }

    /// A world direction from two uniform numbers, and its density over solid angle.
    pub fn sample(&self, u: f64, v: f64) -> (Vec3, f32) {
        let table = &self.tables[0];
        let (column, phi, p_phi) = table.draw_column(u);
        let (psi, p_psi) = table.draw_row(column, v);
        let d = self.to_world(table.direction(phi, psi));
        (d.as_vec3(), (p_phi * p_psi / psi.cos().max(1e-6)) as f32)
    }

    /// Density over solid angle of a world direction.
    pub fn pdf(&self, d: Vec3) -> f32 {
        let table = &self.tables[0];
        let (phi, psi) = table.place(self.to_map(d.as_dvec3()));
        let column = table.column(phi);
        let p = table.column_density(column) * table.row_density(column, table.row(psi));
        (p / psi.cos().max(1e-6)) as f32
    }

    /// The two poles in the world.
    pub fn poles(&self) -> [DVec3; 2] {
        [0, 1].map(|axis| self.to_world(self.tables[axis].axis))
    }

    /// A meridian about one of the two axes, drawn by a uniform number.
    pub fn line(&self, axis: usize, u: f64) -> Meridian {
        let table = &self.tables[axis];
        let (column, phi, density) = table.draw_column(u);
        Meridian {
            axis,
            inverse_density: 1.0 / density,
            pole: self.to_world(table.axis),
            middle: self.to_world(table.direction(phi, 0.0)),
            column,
        }
    }

    /// The part of a line's power that lies below latitude `psi`.
    pub fn power_below(&self, line: &Meridian, psi: f64) -> f64 {
        self.tables[line.axis].power_below(line.column, psi)
    }

    /// The latitude below which a part of a line's power lies.
    pub fn quantile(&self, line: &Meridian, part: f64) -> f64 {
        self.tables[line.axis].draw_row(line.column, part).0
    }
}

impl Meridians {
    fn empty(axis: DVec3, b: DVec3, c: DVec3, columns: usize, rows: usize) -> Self {
        Self {
            axis,
            b,
            c,
            columns,
            rows,
            column_sum: vec![0.0; columns],
            row_sum: Vec::new(),
            column_guide: Guide::default(),
            row_guide: Guide::default(),
        }
    }

    fn no_power(&self) -> Result<Vec<f64>, NoRoom> {
        room::filled(0.0, self.columns * self.rows)
    }

    fn direction(&self, phi: f64, psi: f64) -> DVec3 {
        self.axis * psi.sin() + (self.b * phi.cos() + self.c * phi.sin()) * psi.cos()
    }

    fn place(&self, d: DVec3) -> (f64, f64) {
        let phi = d.dot(self.c).atan2(d.dot(self.b)).rem_euclid(TAU);
        (phi, d.dot(self.axis).clamp(-1.0, 1.0).asin())
    }

    fn column(&self, phi: f64) -> usize {
        ((phi / TAU * self.columns as f64) as usize).min(self.columns - 1)
    }

    /// Rows run from the negative pole up.
    fn row(&self, psi: f64) -> usize {
        ((psi / PI + 0.5) * self.rows as f64).clamp(0.0, self.rows as f64 - 1.0) as usize
    }

    /// Where among the rows of all columns a direction lies.
    fn cell(&self, d: DVec3) -> usize {
        let (phi, psi) = self.place(d);
        self.column(phi) * self.rows + self.row(psi)
    }

    /// From power to sums, with an even part mixed in.
    fn finish(&mut self) {
        let rows = self.rows;
        let row_angle = PI / rows as f64;
        // Evenly over the sphere: cos ψ of each row, up to its norm.
        let even: Vec<f64> = (0..rows)
            .map(|r| ((r as f64 + 0.5) * row_angle - FRAC_PI_2).cos())
            .collect();
        let even_sum: f64 = even.iter().sum();
        let total: f64 = self.row_sum.iter().sum();
        let columns = self.columns;
        let finish = |powers: &mut [f64]| {
            let mut below = 0.0;
            for (power, even) in powers.iter_mut().zip(&even) {
                let share = if total > 0.0 { *power / total } else { 0.0 };
                let even = even / even_sum / columns as f64;
                let part = if total > 0.0 { EVEN } else { 1.0 };
                below += share * (1.0 - part) + even * part;
                *power = below;
            }
            powers.iter_mut().for_each(|p| *p /= below);
            below
        };
        let sums: Vec<f64> = self.row_sum.par_chunks_mut(rows).map(finish).collect();
        let mut sum = 0.0;
        for (column, below) in self.column_sum.iter_mut().zip(sums) {
            sum += below;
            *column = sum;
        }
        self.column_sum.iter_mut().for_each(|c| *c /= sum);
        self.column_guide = Guide::new(&self.column_sum, columns);
        self.row_guide = Guide::new(&self.row_sum, rows);
    }

    /// Column, longitude and density over longitude.
    fn draw_column(&self, u: f64) -> (usize, f64, f64) {
        let column = self.column_guide.find(0, &self.column_sum, u);
        let column = column.min(self.columns - 1);
        let below = if column == 0 {
            0.0
        } else {
            self.column_sum[column - 1]
        };
        let part = ((u - below) / (self.column_sum[column] - below)).clamp(0.0, 1.0);
        let phi = TAU * (column as f64 + part) / self.columns as f64;
        (column, phi, self.column_density(column))
    }

    fn column_density(&self, column: usize) -> f64 {
        let below = if column == 0 {
            0.0
        } else {
            self.column_sum[column - 1]
        };
        (self.column_sum[column] - below) * self.columns as f64 / TAU
    }

    /// Latitude and density over latitude.
    fn draw_row(&self, column: usize, v: f64) -> (f64, f64) {
        let sums = &self.row_sum[column * self.rows..(column + 1) * self.rows];
        let row = self.row_guide.find(column, sums, v).min(self.rows - 1);
        let below = if row == 0 { 0.0 } else { sums[row - 1] };
        let part = ((v - below) / (sums[row] - below)).clamp(0.0, 1.0);
        let psi = PI * (row as f64 + part) / self.rows as f64 - FRAC_PI_2;
        (psi, self.row_density(column, row))
    }

    fn row_density(&self, column: usize, row: usize) -> f64 {
        let sums = &self.row_sum[column * self.rows..(column + 1) * self.rows];
        let below = if row == 0 { 0.0 } else { sums[row - 1] };
        (sums[row] - below) * self.rows as f64 / PI
    }

    fn power_below(&self, column: usize, psi: f64) -> f64 {
        let sums = &self.row_sum[column * self.rows..(column + 1) * self.rows];
        let row = self.row(psi);
        let below = if row == 0 { 0.0 } else { sums[row - 1] };
        let part = ((psi / PI + 0.5) * self.rows as f64 - row as f64).clamp(0.0, 1.0);
        below + (sums[row] - below) * part
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Wrap;

    fn sunny() -> (Texture, EnvironmentMap) {
        let (width, height) = (32u32, 17u32);
        let mut texture = Texture::constant("sky".into(), [0.2, 0.3, 0.4]);
        texture.texels = vec![[0.2, 0.3, 0.4]; (width * height) as usize];
        texture.texels[(5 * width + 9) as usize] = [300.0, 280.0, 200.0];
        texture.layout = Layout::Bitmap {
            width,
            height,
            wrap: Wrap::Repeat,
            bilinear: true,
            to_uv: glam::Affine2::IDENTITY,
        };
        let map = EnvironmentMap {
            to_world: glam::Mat3::from_euler(glam::EulerRot::XYZ, 0.3, 0.5, -0.8),
            scale: 2.0,
        };
        (texture, map)
    }

    /// ∫L dω by samples over their density is that over a grid, for directions and for lines of
    /// both axes.
    #[test]
    fn samples_and_lines_integrate_the_map() {
        let (texture, map) = sunny();
        let distribution = MapDistribution::new(&texture, &map, &|| false).unwrap();
        let radiance = |d: Vec3| luminance(map::lookup(&texture, &map, d).value.to_array());
        let n = 400;
        let grid = |i: usize, n: usize| (i as f64 + 0.5) / n as f64;
        let mut exact = 0.0;
        for i in 0..2 * n {
            for j in 0..n {
                let (phi, psi) = (TAU * grid(i, 2 * n), PI * grid(j, n) - FRAC_PI_2);
                let d = DVec3::new(psi.cos() * phi.cos(), psi.sin(), psi.cos() * phi.sin());
                exact += radiance(distribution.to_world(d).as_vec3()) * psi.cos() * TAU * PI
                    / (2 * n * n) as f64;
            }
        }
        let mut by_samples = 0.0;
        for i in 0..n {
            for j in 0..n {
                let (d, pdf) = distribution.sample(grid(i, n), grid(j, n));
                by_samples += radiance(d) / pdf as f64 / (n * n) as f64;
                let again = distribution.pdf(d);
                assert!((again - pdf).abs() < 2e-2 * pdf, "{again} against {pdf}");
            }
        }
        assert!(
            (by_samples / exact - 1.0).abs() < 5e-3,
            "{by_samples} against {exact}"
        );
        for axis in 0..2 {
            let mut by_lines = 0.0;
            for i in 0..n {
                let line = distribution.line(axis, grid(i, n));
                for j in 0..n {
                    let psi = PI * grid(j, n) - FRAC_PI_2;
                    let d = line.pole * psi.sin() + line.middle * psi.cos();
                    by_lines += radiance(d.as_vec3()) * psi.cos() * line.inverse_density * PI
                        / (n * n) as f64;
                }
            }
            assert!(
                (by_lines / exact - 1.0).abs() < 2e-2,
                "{axis}: {by_lines} against {exact}"
            );
        }
    }
}
