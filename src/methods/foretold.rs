//! How much noise differences have of what jumps, foretold from the borders that cells find.
//!
//! Where a border moves with velocity V over a coordinate that a path draws, and the path's
//! radiance jumps by J there, a central difference of step h changes by J/(2h) with the chance
//! 2hV. That is JV in the mean, which is what the border's sample brings to the gradient, and
//! JV·J/(2h) in the mean square. A pilot's few differences seldom meet what is rare, such as the
//! edge of a bright lamp that hardly moves; cells find it at every look.
//!
//! V is the velocity beside samples that are carried as those of the differences are. It is right
//! to a factor of two: directions over lobes drift here where cells' do (`paths::lobe_drift`), and
//! do not in differences; J is averaged over looks; and samples of a lattice are not independent.

use super::moved_packet::Moved;
use super::stage::Stage;
use super::steps::Steps;
use crate::gradient::path::forward::ForwardSweep;
use crate::lanes::LANES;
use crate::paths::boundary_sample::{BoundarySample, Coordinate};
use crate::paths::film::tile::TracedTile;
use crate::scene::Rgb;

/// The part of a tile in the variance of the image by differences, over all its numbers.
pub fn variance_of_tile(
    steps: &Steps,
    stage: &Stage,
    sweep: &ForwardSweep,
    traced: &TracedTile,
) -> f64 {
    let drift = steps.carried();
    let mut sum = 0.0;
    let packets: Vec<_> = traced.packets().collect();
    for (number, packet) in packets.into_iter().enumerate() {
        let mut squares = [0.0; LANES];
        let at = Moved::new([packet.u, packet.v], packet.active, drift).film_point();
        sweep.borders(&traced.store, number, at, |sample, brings| {
            squares[sample.lane as usize] += mean_square(steps, sample, brings);
        });
        for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1) {
            let [x, y] = &traced.taps;
            let [x, y] = [&x[packet.column + lane], &y[packet.row]];
            sum += squares[lane] * x.sum_of_squares() * y.sum_of_squares();
        }
    }
    let area = traced.tile.step[0] * traced.tile.step[1];
    for sample in traced.store.film_boundary() {
        let Coordinate::Film { at, piece } = sample.at else {
            continue;
        };
        stage.filter.along(at, &piece, |share, at, [x, y]| {
            let velocity = drift.map_or([0.0; 2], |d| d.at(at).0);
            let brings = sweep.film_boundary(&traced.store.found, sample, at, velocity);
            let square = mean_square(steps, sample, brings) * f64::from(share) * area;
            sum += square * x.sum_of_squares() * y.sum_of_squares();
        });
    }
    sum
}

/// Of the change that a border brings to one path's difference.
fn mean_square(steps: &Steps, sample: &BoundarySample, brings: Rgb) -> f64 {
    let length = |c: Rgb| c.iter().map(|c| f64::from(*c).powi(2)).sum::<f64>().sqrt();
    let (brings, jump) = (length(brings), f64::from(sample.jump));
    let square = steps.mean_square_of_jump(brings, jump);
    if square.is_finite() { square } else { 0.0 }
}
