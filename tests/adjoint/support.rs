//! What every generated adjoint is held to.

use warpath::lanes::{Dual, LANES, Lane};

/// One kernel over flat arrays of numbers; the build writes the table of these.
pub struct Check {
    pub name: &'static str,
    /// Least, greatest, and whether a random sign is put on it.
    pub ranges: &'static [(f64, f64, bool)],
    pub outputs: usize,
    pub primal: fn(&[f64]) -> Vec<f64>,
    pub dual: fn(&[Dual<f64>]) -> Vec<Dual<f64>>,
    pub lanes: fn(&[Lane]) -> Vec<Lane>,
    pub adjoint: fn(&[f64], &[f64]) -> Vec<f64>,
    pub adjoint_lanes: fn(&[Lane], &[Lane]) -> Vec<Lane>,
}

const SAMPLES: usize = 200;

/// Checks every kernel of the table in every way, and reports all that fail.
pub fn check_all(checks: Vec<Check>) {
    assert!(!checks.is_empty(), "the table of adjoints is empty");
    let mut failures = Vec::new();
    for check in &checks {
        for way in [
            against_forward_mode,
            against_differences,
            lanes_against_scalars,
        ] {
            failures.extend(way(check).err().map(|e| format!("{}: {e}", check.name)));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// ⟨Jv, w⟩ = ⟨v, Jᵀw⟩ to rounding, the left side from dual numbers.
fn against_forward_mode(check: &Check) -> Result<(), String> {
    let mut random = Random::new(check.name);
    for _ in 0..SAMPLES {
        let (x, v, w) = random.sample(check);
        let duals: Vec<_> = x.iter().zip(&v).map(|(&x, &v)| Dual::new(x, v)).collect();
        let tangents: Vec<f64> = (check.dual)(&duals).iter().map(|d| d.tangent).collect();
        let cotangents = (check.adjoint)(&x, &w);
        let (forward, backward) = (dot(&tangents, &w), dot(&cotangents, &v));
        let scale = magnitude(&tangents, &w) + magnitude(&cotangents, &v);
        let error = (forward - backward).abs();
        if !error.is_finite() || error > 1e-12 * scale {
            return Err(format!(
                "forward mode says {forward:e}, the adjoint {backward:e} at {x:?}"
            ));
        }
    }
    Ok(())
}

/// The derivative along a random direction against central differences of two step sizes.
fn against_differences(check: &Check) -> Result<(), String> {
    let mut random = Random::new(check.name);
    let mut compared = 0;
    for _ in 0..SAMPLES {
        let (x, v, w) = random.sample(check);
        let at = |h: f64| {
            let moved: Vec<f64> = x.iter().zip(&v).map(|(x, v)| x + h * v).collect();
            dot(&(check.primal)(&moved), &w)
        };
        let difference = |h: f64| (at(h) - at(-h)) / (2.0 * h);
        let (wide, narrow) = (difference(2e-5), difference(1e-5));
        let cotangents = (check.adjoint)(&x, &w);
        let got = dot(&cotangents, &v);
        let scale = magnitude(&cotangents, &v) + at(0.0).abs() + 1e-3;
        if !got.is_finite() || !wide.is_finite() {
            return Err(format!(
                "not finite at {x:?}: the adjoint says {got}, differences {wide}; does it need an `inputs:` line?"
            ));
        }
        // A kink between the two steps, or too much curvature for either: no witness.
        if (wide - narrow).abs() > 1e-6 * scale {
            continue;
        }
        compared += 1;
        if (got - narrow).abs() > 1e-5 * scale {
            return Err(format!(
                "differences say {narrow:e}, the adjoint {got:e} at {x:?}"
            ));
        }
    }
    if compared < SAMPLES * 3 / 4 {
        return Err(format!(
            "only {compared} of {SAMPLES} samples are smooth enough for differences"
        ));
    }
    Ok(())
}

/// Packets of `f32`, each lane at its own point, against `f64`.
fn lanes_against_scalars(check: &Check) -> Result<(), String> {
    let mut random = Random::new(check.name);
    let mut errors = Vec::new();
    for _ in 0..SAMPLES.div_ceil(LANES) {
        // Both precisions start from the same, already rounded numbers.
        let samples: Vec<_> = (0..LANES)
            .map(|_| random.sample(check))
            .map(|(x, _, w)| (round(x), round(w)))
            .collect();
        let pack =
            |pick: &dyn Fn(usize) -> f64| Lane::new(std::array::from_fn(|lane| pick(lane) as f32));
        let x: Vec<Lane> = (0..check.ranges.len())
            .map(|i| pack(&|lane| samples[lane].0[i]))
            .collect();
        let w: Vec<Lane> = (0..check.outputs)
            .map(|i| pack(&|lane| samples[lane].1[i]))
            .collect();
        let (values, cotangents) = ((check.lanes)(&x), (check.adjoint_lanes)(&x, &w));
        for (lane, (x, w)) in samples.iter().enumerate() {
            for (packets, want) in [
                (&values, (check.primal)(x)),
                (&cotangents, (check.adjoint)(x, w)),
            ] {
                let scale = want.iter().fold(1e-3, |m: f64, v| m.max(v.abs()));
                let error = packets.iter().zip(&want).fold(0.0, |m: f64, (p, want)| {
                    let error = (f64::from(p.to_array()[lane]) - want).abs() / scale;
                    if error.is_nan() {
                        f64::INFINITY
                    } else {
                        m.max(error)
                    }
                });
                errors.push(error);
            }
        }
    }
    errors.sort_by(f64::total_cmp);
    // Single precision may lose digits to cancellation at a few points, not at most.
    let (median, high) = (errors[errors.len() / 2], errors[errors.len() * 95 / 100]);
    if median > 1e-6 || high > 1e-3 || errors[errors.len() - 1].is_infinite() {
        return Err(format!(
            "packets are off by {median:e} (median), {high:e} (95 %)"
        ));
    }
    Ok(())
}

fn round(x: Vec<f64>) -> Vec<f64> {
    x.into_iter().map(|x| f64::from(x as f32)).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn magnitude(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a * b).abs()).sum()
}

/// SplitMix64, seeded by the kernel's name: adding a kernel does not move another's points.
struct Random(u64);

impl Random {
    fn new(name: &str) -> Self {
        Random(
            name.bytes()
                .fold(7, |seed: u64, b| seed.wrapping_mul(31) + u64::from(b)),
        )
    }

    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A point, a direction, and a cotangent of the result.
    fn sample(&mut self, check: &Check) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let point = check.ranges.iter().map(|&(low, high, signed)| {
            let x = low + (high - low) * self.unit();
            if signed && self.unit() < 0.5 { -x } else { x }
        });
        let point = point.collect();
        let mut around = |count| (0..count).map(|_| 2.0 * self.unit() - 1.0).collect();
        (point, around(check.ranges.len()), around(check.outputs))
    }
}
