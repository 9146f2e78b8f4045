//! Whether few samples carry a gradient: its standard error, from the spread of a few groups,
//! cannot be trusted then.
//!
//! Of n independent terms of finite variance the largest square is about 2 ln n / n of the sum of
//! all squares. Where terms are so heavy-tailed that the variance is infinite, or so rare that few
//! were met, the largest has a share that does not fall with n, and most runs underestimate their
//! error. A term here is what one packet of paths, or one border on the film, brings to an object's
//! gradient along a fixed direction.

use glam::DVec3;

/// What a gradient belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Object {
    Mesh(usize),
    Texture(usize),
    Camera,
    Environment,
}

/// A direction that no scene has a reason to be aligned with.
const ASKEW: DVec3 = DVec3::new(0.48, 0.6, 0.64);

/// Squares of the terms of one sum.
#[derive(Clone, Copy, Debug, Default)]
struct Squares {
    sum: f64,
    largest: f64,
}

impl Squares {
    fn add(&mut self, other: Squares) {
        self.sum += other.sum;
        self.largest = self.largest.max(other.largest);
    }
}

/// The squares of each object's terms.
#[derive(Clone, Debug, Default)]
pub struct Terms {
    meshes: usize,
    textures: usize,
    /// Of the present term, by object: meshes, textures, camera, environment.
    term: Vec<f64>,
    touched: Vec<usize>,
    squares: Vec<Squares>,
}

/// The squares of a tile's terms, of those objects that have any.
pub struct TileTerms(Vec<(usize, Squares)>);

impl Terms {
    pub fn new(meshes: usize, textures: usize) -> Self {
        let objects = meshes + textures + 2;
        Self {
            meshes,
            textures,
            term: vec![0.0; objects],
            touched: Vec::new(),
            squares: vec![Squares::default(); objects],
        }
    }

    fn index(&self, object: Object) -> usize {
        match object {
            Object::Mesh(mesh) => mesh,
            Object::Texture(texture) => self.meshes + texture,
            Object::Camera => self.meshes + self.textures,
            Object::Environment => self.meshes + self.textures + 1,
        }
    }

    /// Adds to the present term of an object.
    #[inline]
    pub fn add(&mut self, object: Object, value: DVec3) {
        let i = self.index(object);
        if self.term[i] == 0.0 {
            self.touched.push(i);
        }
        self.term[i] += value.dot(ASKEW);
    }

    /// Ends the present term of all objects.
    pub fn end_term(&mut self) {
        for i in self.touched.drain(..) {
            let square = std::mem::take(&mut self.term[i]).powi(2);
            self.squares[i].add(Squares {
                sum: square,
                largest: square,
            });
        }
    }

    /// Takes the squares of all terms so far.
    pub fn take(&mut self) -> TileTerms {
        let squares = self.squares.iter_mut().enumerate();
        let any = squares.filter(|(_, s)| s.sum > 0.0);
        TileTerms(any.map(|(i, s)| (i, std::mem::take(s))).collect())
    }

    /// Adds a tile's.
    pub fn absorb(&mut self, tile: &TileTerms) {
        for &(i, squares) in &tile.0 {
            self.squares[i].add(squares);
        }
    }

    /// The largest square's share in the sum of all; `None` where there is nothing.
    pub fn largest_share(&self, object: Object) -> Option<f64> {
        let Squares { sum, largest } = self.squares[self.index(object)];
        (sum > 0.0).then(|| largest / sum)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_of_many_terms_has_its_share() {
        let mut tile = Terms::new(2, 1);
        for x in [1.0, -1.0, 3.0, 1.0] {
            // A term may come in pieces.
            tile.add(Object::Mesh(1), DVec3::X * x);
            tile.add(Object::Mesh(1), DVec3::X * x);
            tile.add(Object::Camera, DVec3::Y);
            tile.end_term();
        }
        let mut all = Terms::new(2, 1);
        all.absorb(&tile.take());
        assert!((all.largest_share(Object::Mesh(1)).unwrap() - 0.75).abs() < 1e-12);
        assert!((all.largest_share(Object::Camera).unwrap() - 0.25).abs() < 1e-12);
        assert_eq!(all.largest_share(Object::Mesh(0)), None);
        assert!(tile.take().0.is_empty());
    }
}
