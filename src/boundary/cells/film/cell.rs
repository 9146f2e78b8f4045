//! An interval of a line of the film's lattice.

use crate::boundary::cells::line_search::Cell;
use crate::boundary::occlusion::{MOST_PROBE, nearest_angle, probe_angle};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::between::between;
use crate::discontinuity::boundary::{Boundary, dvec3};
use crate::discontinuity::crossing::Crossing;
use crate::paths::counts::Counts;
use crate::paths::estimator::FilmTile;
use crate::paths::moving::Sector;
use crate::paths::random::morton;
use crate::trace::geometry::NO_TRIANGLE;
use glam::{DVec3, Vec3};

/// How far beside a silhouette the probes look at most, in pixels.
const PROBE_PIXELS: f64 = 1e-3;

/// What is said to look alike does so for so many points of the lattice all around.
const ABOUT: usize = 3;
/// What is said to be even is so for so many: where one path in eight finds something else, of
/// fewer paths often none does.
const EVEN_ABOUT: usize = 8;

/// A row (axis 0) or a column (axis 1) of the lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct LatticeLine {
    pub axis: usize,
    pub number: usize,
}

/// The cells of a tile's lattice.
#[derive(Clone, Copy)]
pub struct LatticeCells<'a> {
    pub scene: &'a SearchScene<'a>,
    pub film: &'a FilmTile<'a>,
}

/// The interval between two neighbours, or a part of it.
#[derive(Clone, Copy)]
pub struct FilmCell<'a> {
    cells: LatticeCells<'a>,
    line: LatticeLine,
    start: [f64; 2],
    /// Pixels along the line.
    length: f64,
    triangles: [u32; 2],
    /// How many cells it stands for.
    pub weight: u32,
    /// Which random numbers probes have: those of the cell, or, in crowds, of the line. What is
    /// seen on the inner sides of a thin thing's two borders, in neighbouring cells, cancels then.
    pub numbers: u32,
}

impl<'a> LatticeCells<'a> {
    /// The number of a point of a line among those of the tile.
    pub fn index(&self, line: LatticeLine, at: usize) -> usize {
        let [column, row] = if line.axis == 0 {
            [at, line.number]
        } else {
            [line.number, at]
        };
        row * self.film.tile.points[0] + column
    }

    /// The triangle seen at a point of a line, which may lie beyond the lattice.
    fn triangle(&self, line: LatticeLine, at: i64, counts: &mut Counts) -> u32 {
        let FilmTile { tile, image, .. } = self.film;
        if (0..tile.points[line.axis] as i64).contains(&at) {
            return image.triangle[self.index(line, at as usize)];
        }
        counts.probe += 1;
        self.first_hit(self.position(line, at))
    }

    /// The film position of a point of a line.
    pub fn position(&self, line: LatticeLine, at: i64) -> [f64; 2] {
        let tile = self.film.tile;
        let mut position = [tile.position(1 - line.axis, line.number); 2];
        position[line.axis] = tile.first[line.axis] + at as f64 * tile.step[line.axis];
        position
    }

    /// The interval from point number `at` of a line to the next.
    pub fn cell(&self, line: LatticeLine, at: i64, counts: &mut Counts) -> FilmCell<'a> {
        FilmCell {
            cells: *self,
            start: self.position(line, at),
            line,
            length: self.film.tile.step[line.axis],
            triangles: [at, at + 1].map(|at| self.triangle(line, at, counts)),
            weight: 1,
            numbers: 0,
        }
    }

    /// Whether something that moves may be seen between point number `at` of a line and the next.
    pub fn moves(&self, line: LatticeLine, at: usize) -> bool {
        let drifts = |at: usize| self.film.drifts(self.position(line, at as i64));
        if drifts(at) || drifts(at + 1) {
            return true;
        }
        let [a, b] = [at, at + 1].map(|at| self.direction(line, at as f64));
        let origin = self.scene.view.camera.eye();
        self.scene.moving.meets(&Sector::between(origin, a, b))
    }

    /// Whether all points about number `at` of a line and the next that see the same mesh as these
    /// have one radiance.
    pub fn looks_alike(&self, line: LatticeLine, at: usize) -> bool {
        let radiance = &self.film.image.radiance;
        let first = radiance[self.index(line, at)];
        self.all_about(line, at, ABOUT, |point, _| radiance[point] == first)
    }

    /// Whether each of these points has the radiance of the one of the two that sees its mesh, up
    /// to this part of the difference between the two.
    pub fn is_even_about(&self, line: LatticeLine, at: usize, part: f64) -> bool {
        let radiance = |point: usize| Vec3::from(self.film.image.radiance[point]).as_dvec3();
        let [a, b] = [at, at + 1].map(|at| radiance(self.index(line, at)));
        let most = part * a.distance(b);
        self.all_about(line, at, EVEN_ABOUT, |point, [as_a, as_b]| {
            let near = |end: DVec3| radiance(point).distance(end) <= most;
            as_a && near(a) || as_b && near(b)
        })
    }

    /// Whether something holds of all these points, given for each whether it sees the mesh of the
    /// one and of the other.
    fn all_about(
        &self,
        line: LatticeLine,
        at: usize,
        about: usize,
        holds: impl Fn(usize, [bool; 2]) -> bool,
    ) -> bool {
        let FilmTile {
            tile, image, view, ..
        } = *self.film;
        let mesh = |point: usize| {
            let triangle = image.triangle[point];
            (triangle != NO_TRIANGLE).then(|| view.geometry.mesh_of_triangle[triangle as usize])
        };
        let meshes = [at, at + 1].map(|at| mesh(self.index(line, at)));
        let around = |number: usize, most: usize, points: usize| {
            number.saturating_sub(about)..(number + most + about).min(points)
        };
        let [along, across] = [tile.points[line.axis], tile.points[1 - line.axis]];
        around(line.number, 1, across).all(|number| {
            let line = LatticeLine { number, ..line };
            around(at, 2, along).all(|at| {
                let point = self.index(line, at);
                let sees = meshes.map(|of_end| of_end == mesh(point));
                sees == [false; 2] || holds(point, sees)
            })
        })
    }

    /// The direction at a distance from a line's first point in steps of the lattice.
    pub fn direction(&self, line: LatticeLine, steps: f64) -> DVec3 {
        let mut at = self.position(line, 0);
        at[line.axis] += steps * self.film.tile.step[line.axis];
        self.direction_at(at)
    }

    /// The direction through a film position.
    pub fn direction_at(&self, [u, v]: [f64; 2]) -> DVec3 {
        dvec3(self.scene.view.camera.direction(u, v))
    }

    /// Whether one surface is seen between two directions, given the triangles that are seen there.
    pub fn goes_on(&self, [a, b]: [DVec3; 2], seen: [u32; 2]) -> bool {
        let SearchScene {
            view, adjacency, ..
        } = *self.scene;
        let arc = Arc {
            origin: view.camera.eye(),
            a,
            b,
        };
        let found = || between(view.geometry, adjacency, &arc, seen, None, 0.0);
        seen[0] == seen[1] || matches!(found(), Ok([None, _]))
    }

    /// The triangle seen at a film position.
    fn first_hit(&self, at: [f64; 2]) -> u32 {
        let view = self.scene.view;
        let camera = &view.camera;
        let (origin, direction) = camera.ray_along(self.direction_at(at));
        let (origin, direction) = (origin.as_vec3(), direction.as_vec3());
        view.first_hit(origin, direction, camera.near_clip, camera.far_clip)
    }
}

impl FilmCell<'_> {
    /// Takes it for one of a crowd: it has the random numbers of its line.
    pub fn crowd(&mut self) {
        let [columns, rows] = self.cells.film.tile.points;
        let LatticeLine { axis, number } = self.line;
        self.numbers = (2 * columns * rows + axis * rows + number) as u32;
    }

    /// The number of its line among all of the tile, if it is one of a crowd.
    pub fn line_of_crowd(&self) -> Option<u32> {
        let [columns, rows] = self.cells.film.tile.points;
        self.numbers.checked_sub((2 * columns * rows) as u32)
    }

    /// Of where it starts: cells with like ones are near each other.
    pub fn morton(&self) -> u32 {
        let tile = self.cells.film.tile;
        let [column, row] = [0, 1].map(|axis| {
            let along = (self.start[axis] - tile.first[axis]) / tile.step[axis];
            along.round().max(0.0) as u32
        });
        morton(column, row)
    }

    /// Film position of a place.
    pub fn position(&self, s: f64) -> [f64; 2] {
        let mut at = self.start;
        at[self.line.axis] += s * self.length;
        at
    }

    /// [`LatticeCells::is_even_about`] the points on both sides of a place.
    pub fn is_even_beside(&self, s: f64, part: f64) -> bool {
        let last = self.cells.film.tile.points[self.line.axis] as f64 - 2.0;
        let at = self.coordinate(s).floor().clamp(0.0, last) as usize;
        self.cells.is_even_about(self.line, at, part)
    }

    /// 0 along a row, 1 along a column.
    pub fn axis(&self) -> usize {
        self.line.axis
    }

    /// The angle of a pixel along the line, in a direction.
    fn angle_per_pixel(&self, direction: DVec3) -> f64 {
        let camera = &self.cells.scene.view.camera;
        let per_pixel = camera.direction_per_pixel()[self.line.axis];
        direction.cross(per_pixel).length() / direction.length_squared()
    }

    /// How far beside a crossing probes look at most, in pixels.
    fn most_pixels(&self) -> f64 {
        PROBE_PIXELS.min(MOST_PROBE * self.cells.film.tile.step[self.line.axis])
    }

    /// How near to an edge of what its ends see probes look at most, in pixels: what they have
    /// between them are edges of their own, however fine the mesh.
    fn nearest_pixels(&self) -> f64 {
        let view = self.cells.scene.view;
        let origin = view.camera.eye();
        let seen = self.triangles.iter().filter(|&&t| t != NO_TRIANGLE);
        let angles = seen.map(|&t| {
            let [vertex, _, _] = view.geometry.triangles[t as usize];
            let point = view.geometry.positions[vertex as usize].as_dvec3();
            nearest_angle(view.geometry, point, origin, view.camera.reach())
        });
        let angle = angles.fold(0.0, f64::max);
        (angle / self.angle_per_pixel(self.direction(0.5))).min(self.most_pixels())
    }
}

impl Cell for FilmCell<'_> {
    type Line = LatticeLine;

    fn line(&self) -> LatticeLine {
        self.line
    }

    fn triangles(&self) -> [u32; 2] {
        self.triangles
    }

    fn part(&self, [from, to]: [f64; 2], triangles: [u32; 2]) -> Self {
        Self {
            start: self.position(from),
            length: (to - from) * self.length,
            triangles,
            ..*self
        }
    }

    fn arc(&self) -> Arc {
        Arc {
            origin: self.cells.scene.view.camera.eye(),
            a: self.direction(0.0),
            b: self.direction(1.0),
        }
    }

    fn direction(&self, s: f64) -> DVec3 {
        self.cells.direction_at(self.position(s))
    }

    /// Steps of the lattice from the line's first point.
    fn coordinate(&self, s: f64) -> f64 {
        let (tile, axis) = (self.cells.film.tile, self.line.axis);
        (self.position(s)[axis] - tile.first[axis]) / tile.step[axis]
    }

    fn first_hit(&self, s: f64) -> u32 {
        self.cells.first_hit(self.position(s))
    }

    fn gap(&self) -> f64 {
        2.0 * self.nearest_pixels() / self.length
    }

    fn beside(&self, crossing: &Crossing) -> f64 {
        let view = self.cells.scene.view;
        let origin = view.camera.eye();
        let direction = self.direction(crossing.s);
        let reach = view.camera.reach();
        let [angle, _] = probe_angle(view.geometry, crossing, (origin, reach), direction);
        let angle_per_pixel = self.angle_per_pixel(direction);
        let most = if crossing.is_tight() {
            MOST_PROBE * self.cells.film.tile.step[self.line.axis]
        } else {
            self.most_pixels()
        };
        (angle / angle_per_pixel).min(most) / self.length
    }

    fn moves(&self, boundary: &Boundary) -> bool {
        let scene = self.cells.scene;
        self.cells.film.drifts(self.position(0.5))
            || scene.moving.boundary(scene.view.geometry, boundary)
    }

    fn weight(&self) -> f64 {
        f64::from(self.weight)
    }
}
