//! The kernels that gradients spend their time in, and their adjoints, a number or a packet at a
//! time: `cargo bench --bench kernels`.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use warpath::lanes::{LANES, Lane, Mask, Real, V3};
use warpath::{adjoint, kernels};

/// A vector that the compiler does not know.
fn vector<F: Real>(x: f64, y: f64, z: f64) -> V3<F> {
    let [x, y, z] = black_box([x, y, z]).map(F::splat);
    V3 { x, y, z }
}

fn all<F: Real>(criterion: &mut Criterion, lanes: usize) {
    let mut group = criterion.benchmark_group(format!("{lanes} at a time"));
    group.throughput(Throughput::Elements(lanes as u64));
    let (o, d) = (vector::<F>(0.1, 0.2, -3.0), vector::<F>(0.05, -0.1, 1.0));
    let [a, b, c] = [(-1.0, -1.0, 0.2), (1.5, -0.8, 0.1), (0.1, 1.2, -0.3)]
        .map(|(x, y, z)| vector::<F>(x, y, z));
    let one = F::splat(1.0);
    let one_each = || {
        black_box(V3 {
            x: one,
            y: one,
            z: one,
        })
    };
    group.bench_function("triangle_hit", |bench| {
        bench.iter(|| kernels::triangle::triangle_hit(black_box(o), d, a, b, c))
    });
    group.bench_function("triangle_hit_adjoint", |bench| {
        bench.iter(|| {
            adjoint::triangle::triangle_hit_adjoint(black_box(o), d, a, b, c, (one, one, one))
        })
    });
    group.bench_function("edge_side", |bench| {
        bench.iter(|| kernels::silhouette::edge_side(black_box(o), d, a, b))
    });
    group.bench_function("edge_side_adjoint", |bench| {
        bench.iter(|| adjoint::silhouette::edge_side_adjoint(black_box(o), d, a, b, one))
    });
    group.bench_function("point_irradiance", |bench| {
        bench.iter(|| kernels::light::point_irradiance(black_box(o), one_each(), a))
    });
    group.bench_function("point_irradiance_adjoint", |bench| {
        bench.iter(|| adjoint::light::point_irradiance_adjoint(black_box(o), one_each(), a, one))
    });
    let ggx = <F::Mask as Mask>::splat(true);
    let [cos2, sin2, alpha] = [0.7, 0.3, 0.2].map(|x| F::splat(black_box(x)));
    group.bench_function("ndf", |bench| {
        bench.iter(|| kernels::microfacet::ndf(black_box(cos2), sin2, alpha, ggx))
    });
    group.bench_function("ndf_adjoint", |bench| {
        bench.iter(|| adjoint::microfacet::ndf_adjoint(black_box(cos2), sin2, alpha, ggx, one))
    });
    group.finish();
}

fn one(criterion: &mut Criterion) {
    all::<f32>(criterion, 1);
}

fn packet(criterion: &mut Criterion) {
    all::<Lane>(criterion, LANES);
}

criterion_group!(benches, one, packet);
criterion_main!(benches);
