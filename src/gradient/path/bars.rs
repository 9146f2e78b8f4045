//! Cotangents of a vertex, as the backward sweep collects them.

use crate::kernels::bsdf::Interface;
use crate::kernels::layered::Layers;
use crate::lanes::{Lane, Real, V3};
use crate::paths::rays::{lane_mask, masked};
use crate::paths::surface::layers::{numbers, of_numbers};

/// A cotangent in some of the lanes.
#[derive(Clone, Copy)]
pub(crate) struct Cotangent {
    pub bits: u32,
    /// Zero in the others.
    pub value: V3<Lane>,
}

impl Cotangent {
    /// In the lanes of `bits`.
    pub fn of_lanes(bits: u32, value: V3<Lane>) -> Self {
        Self {
            bits,
            value: masked(bits, value),
        }
    }
}

/// Cotangents of a vertex, as they are collected.
pub(crate) struct VertexBars {
    pub x: V3<Lane>,
    pub n: V3<Lane>,
    /// Of the normal before a picture turned it, besides what turns with it.
    pub base_n: V3<Lane>,
    /// Of the ray that arrived (besides what moves x), and of the path's weight with it.
    pub direction: V3<Lane>,
    pub throughput: V3<Lane>,
    /// Of the path's weight before the choice among materials.
    pub arriving: V3<Lane>,
    pub interface: Interface<Lane>,
    /// Given if anything was added.
    pub layers: Option<Box<Layers<Lane>>>,
    /// Of the barycentrics.
    pub b: [Lane; 2],
}

impl VertexBars {
    pub fn zero() -> Self {
        let (zero, none) = (Lane::splat(0.0), V3::splat(0.0));
        Self {
            x: none,
            n: none,
            base_n: none,
            direction: none,
            throughput: none,
            arriving: none,
            interface: Interface {
                reflectance: none,
                second_reflectance: none,
                eta: none,
                k: none,
                alpha: zero,
            },
            layers: None,
            b: [zero; 2],
        }
    }

    /// Adds the cotangents of layers in the lanes of `bits`.
    pub fn add_layers(&mut self, bits: u32, l: &Layers<Lane>) {
        let zero = Lane::splat(0.0);
        let selected = of_numbers(
            masked(bits, l.tangent),
            numbers(l).map(|n| <Lane as Real>::select(lane_mask(bits), n, zero)),
        );
        let sum = match &self.layers {
            None => selected,
            Some(sum) => {
                let (a, b) = (numbers(sum.as_ref()), numbers(&selected));
                of_numbers(
                    sum.tangent + selected.tangent,
                    std::array::from_fn(|i| a[i] + b[i]),
                )
            }
        };
        self.layers = Some(Box::new(sum));
    }

    /// Adds the cotangents of an interface in the lanes of `bits`.
    pub fn add_interface(&mut self, bits: u32, s: &Interface<Lane>) {
        let zero = Lane::splat(0.0);
        let sum = &mut self.interface;
        sum.reflectance = sum.reflectance + masked(bits, s.reflectance);
        sum.second_reflectance = sum.second_reflectance + masked(bits, s.second_reflectance);
        sum.eta = sum.eta + masked(bits, s.eta);
        sum.k = sum.k + masked(bits, s.k);
        sum.alpha += <Lane as Real>::select(lane_mask(bits), s.alpha, zero);
    }
}

/// Cotangents of directions at a vertex, and of their scores.
pub(crate) struct TurningBars {
    pub direction: V3<Lane>,
    pub score: Lane,
}

/// One over the other where that is not zero, else zero.
pub(crate) fn over(a: V3<Lane>, b: V3<Lane>) -> V3<Lane> {
    let zero = Lane::splat(0.0);
    let part = |a: Lane, b: Lane| <Lane as Real>::select(b.gt(zero), a / b, zero);
    V3::new(part(a.x, b.x), part(a.y, b.y), part(a.z, b.z))
}
