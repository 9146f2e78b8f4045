//! The integrals along a path, over each of which something may jump.

use std::ops::{AddAssign, Index, IndexMut};

/// What an integral is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integral {
    Film,
    Lights,
    Environment,
    Lobes,
}

/// One of each integral.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ByIntegral<T>([T; 4]);

impl<T> Index<Integral> for ByIntegral<T> {
    type Output = T;

    fn index(&self, integral: Integral) -> &T {
        &self.0[integral as usize]
    }
}

impl<T> IndexMut<Integral> for ByIntegral<T> {
    fn index_mut(&mut self, integral: Integral) -> &mut T {
        &mut self.0[integral as usize]
    }
}

impl<T: AddAssign + Copy> AddAssign for ByIntegral<T> {
    fn add_assign(&mut self, other: Self) {
        for (sum, term) in self.0.iter_mut().zip(other.0) {
            *sum += term;
        }
    }
}

/// Borders that were looked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Borders {
    /// Samples of those that were found, one for each piece of an outline, each chain and each end
    /// of a shadow; a cell may have several.
    pub found: u64,
    /// Cells whose ends differ though none was found between them.
    pub lost: u64,
    /// What those that were found have brought, added up as sizes: forward to the image, in reverse
    /// to the vertices that they are made of.
    pub brought: f64,
}

impl ByIntegral<Borders> {
    /// What those over lights and environment maps have brought, of what all have; one if that is
    /// nothing.
    pub fn lights_share(&self) -> f64 {
        let lights = self[Integral::Lights].brought + self[Integral::Environment].brought;
        let all = self.all().brought;
        if all > 0.0 { lights / all } else { 1.0 }
    }

    /// All of them.
    pub fn all(&self) -> Borders {
        let mut all = Borders::default();
        self.0.iter().for_each(|borders| all += *borders);
        all
    }

    /// Adds what they have brought.
    pub fn add_brought(&mut self, brought: &ByIntegral<f64>) {
        for (borders, brought) in self.0.iter_mut().zip(brought.0) {
            borders.brought += brought;
        }
    }

    /// What those that are lost would have brought, as a part of what those that were found have
    /// brought, if each were like the mean of what was found in its integral (where nothing was,
    /// in all). `None` if nothing was found.
    pub fn missing_part(&self) -> Option<f64> {
        let all = self.all();
        let missing = self.0.iter().map(|borders| {
            let like = if borders.found > 0 { *borders } else { all };
            borders.lost as f64 * like.brought / like.found as f64
        });
        (all.brought > 0.0).then(|| missing.sum::<f64>() / all.brought)
    }
}

impl AddAssign for Borders {
    fn add_assign(&mut self, other: Self) {
        self.found += other.found;
        self.lost += other.lost;
        self.brought += other.brought;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_lost_is_like_what_was_found_in_its_integral() {
        let mut borders = ByIntegral::default();
        assert_eq!(borders.missing_part(), None);
        let of = |found, lost, brought| Borders {
            found,
            lost,
            brought,
        };
        borders[Integral::Film] = of(10, 1, 90.0);
        borders[Integral::Lobes] = of(90, 9, 10.0);
        // One of 9 and nine of 10/90, of 100.
        assert!((borders.missing_part().unwrap_or(0.0) - 0.1).abs() < 1e-12);
        borders[Integral::Lights] = of(0, 3, 0.0);
        // Three more of 100/100.
        assert!((borders.missing_part().unwrap_or(0.0) - 0.13).abs() < 1e-12);
    }
}
