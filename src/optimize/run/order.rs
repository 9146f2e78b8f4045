//! Which views a step looks at.

use crate::optimize::config::{Config, Order};
use crate::optimize::problem::seeds;

/// Indices of a step's views. Each view comes once in a round.
pub fn views_of(config: &Config, views: usize, step: u64) -> Vec<usize> {
    let batch = config
        .views
        .batch
        .map_or(views, |n| (n as usize).min(views));
    let first = step as usize * batch;
    let mut chosen: Vec<usize> = (first..first + batch)
        .map(|at| {
            let (round, place) = (at / views, at % views);
            match config.views.order {
                Order::InTurn => place,
                Order::Shuffled => shuffled(config.seed, views, round as u64)[place],
            }
        })
        .collect();
    // Sums are in the order of views, and a view that two rounds share counts twice.
    chosen.sort_unstable();
    chosen
}

/// Fisher and Yates.
fn shuffled(seed: u64, views: usize, round: u64) -> Vec<usize> {
    let mut order: Vec<usize> = (0..views).collect();
    for last in (1..views).rev() {
        let drawn = seeds::of(seed, [seeds::ORDER, round, last as u64]);
        order.swap(last, (drawn % (last as u64 + 1)) as usize);
    }
    order
}

#[cfg(test)]
mod tests {
    use super::shuffled;

    #[test]
    fn a_round_has_every_view_once() {
        let rounds: Vec<Vec<usize>> = (0..20).map(|round| shuffled(7, 6, round)).collect();
        for round in &rounds {
            let mut sorted = round.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, [0, 1, 2, 3, 4, 5]);
        }
        assert!(rounds.iter().any(|round| *round != rounds[0]));
    }
}
