//! The film points of a packet, carried by a drift of the film.

use crate::lanes::{Dual, LANES, Lane};
use crate::paths::film::drift::DriftVelocity;

/// The film points of a packet, as they drift.
pub struct Moved {
    at: [Lane; 2],
    pub velocity: [[f32; LANES]; 2],
    pub divergence: [f32; LANES],
}

impl Moved {
    pub fn new(at: [Lane; 2], active: u32, drift: Option<&DriftVelocity>) -> Self {
        let mut moved = Self {
            at,
            velocity: [[0.0; LANES]; 2],
            divergence: [0.0; LANES],
        };
        let Some(drift) = drift else { return moved };
        let [u, v] = moved.at.map(Lane::to_array);
        for lane in (0..LANES).filter(|&l| active >> l & 1 == 1) {
            let (velocity, divergence) = drift.at([u[lane].into(), v[lane].into()]);
            moved.divergence[lane] = divergence as f32;
            for (lanes, v) in moved.velocity.iter_mut().zip(velocity) {
                lanes[lane] = v as f32;
            }
        }
        moved
    }

    pub fn film_point(&self) -> [Dual<Lane>; 2] {
        [0, 1].map(|i| Dual {
            value: self.at[i],
            tangent: Lane::new(self.velocity[i]),
        })
    }
}
