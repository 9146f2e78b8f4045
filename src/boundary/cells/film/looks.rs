//! How often the film looks at what it has met.
//!
//! The lines of a lattice cross a border as often as there are lines, so that the crossings in a
//! pixel go with the square root of its samples. With one look at each the noise of the jumps,
//! which is that of the light on both sides, would fall as much more slowly than that of all else:
//! of a ball under an even sky it was nearly all of the variance with 64 samples a pixel. Where
//! crossings are few many looks cost little.
//!
//! The looks at one place, and at the places about it, have consecutive numbers of a sequence whose
//! blocks are well spread over bounces and lights (`paths::random`). A pixel's part of an outline
//! is then looked at from as many different directions as there are looks in it.

use super::cell::FilmCell;
use crate::boundary::cells::line_search::{Candidate, Met};
use std::ops::Range;

/// Of a tile, so many come to one look, which is from both sides. It takes less than a sample,
/// whose path looks for borders.
const SAMPLES_PER_LOOK: usize = 2;
/// Radiances on one side that differ by less, relative to those of the two sides, are even.
const EVEN: f64 = 0.05;
/// Looks at one crossing.
const MOST_LOOKS: usize = 16;
/// What is met with a small chance stands for many, and the looks that all of these would have had
/// are given to it, up to so many: more are as good for specks, and cost time in hair.
const MOST_BY_CHANCE: f64 = 8.0;

/// Which looks each of what was met has. None where the light hardly varies beside a border, so
/// that one says all. `points` are those of the tile.
pub fn many(
    met: &[Met<FilmCell>],
    chances: &[f64],
    samples: usize,
    points: [usize; 2],
) -> Vec<Range<u32>> {
    let looks = looks(met, chances, samples);
    let mut many = vec![0..0; met.len()];
    // In a crowd all of a line have the same numbers (`FilmCell::crowd`).
    let mut next = ((points[0] + points[1]) * MOST_LOOKS) as u32;
    let mut by_place: Vec<usize> = Vec::new();
    for (number, met) in met.iter().enumerate().filter(|(i, _)| looks[*i] > 1) {
        match met.at.cell.line_of_crowd() {
            Some(line) => {
                let first = line * MOST_LOOKS as u32;
                many[number] = first..first + looks[number];
            }
            None => by_place.push(number),
        }
    }
    let place = |number: &usize| {
        let cell = &met[*number].at.cell;
        (cell.morton(), cell.axis())
    };
    by_place.sort_by_key(place);
    for number in by_place {
        many[number] = next..next + looks[number];
        next += looks[number];
    }
    many
}

/// How often to look at each of what was met with these chances among a tile's samples.
fn looks(met: &[Met<FilmCell>], chances: &[f64], samples: usize) -> Vec<u32> {
    let varies = |met: &Met<FilmCell>| {
        let Candidate { crossing, cell, .. } = &met.at;
        crossing.is_silhouette() && !cell.is_even_beside(crossing.s, EVEN)
    };
    let varying: Vec<bool> = met.iter().map(varies).collect();
    let count = varying.iter().filter(|varies| **varies).count().max(1);
    let of_varying = (samples / (SAMPLES_PER_LOOK * count)).clamp(1, MOST_LOOKS) as u32;
    let of = |number: usize| {
        let by_chance = match met[number].at.crossing.is_silhouette() {
            true => (1.0 / chances[number]).min(MOST_BY_CHANCE) as u32,
            false => 1,
        };
        let by_noise = if varying[number] { of_varying } else { 1 };
        by_chance.max(by_noise)
    };
    (0..met.len()).map(of).collect()
}
