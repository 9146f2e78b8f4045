//! Rays on one thread: `cargo bench --bench backends`, for watching one change. `warpath bench`
//! compares at length.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use warpath::bench::cases::Case;
use warpath::bench::meshes::Class;
use warpath::bench::rays::{RAYS, workloads};
use warpath::trace::{Accel, AccelOptions, Backend};

const TRIANGLES: usize = 20_000;

fn rays(criterion: &mut Criterion) {
    for (class, name) in Class::ALL {
        let case = Case::generated(class, TRIANGLES).expect("a generated scene");
        let build = |backend| {
            let options = AccelOptions::default().on(backend);
            Accel::build(&case.views(), options).expect("a built scene")
        };
        let accels: Vec<Accel> = Backend::built_in().into_iter().map(build).collect();
        for load in workloads(&case, &accels[0]).expect("a scene in view") {
            let mut group = criterion.benchmark_group(format!("{name}, {}", load.name));
            group.throughput(Throughput::Elements(RAYS as u64));
            group.sample_size(10);
            for accel in &accels {
                let id = BenchmarkId::from_parameter(accel.backend());
                group.bench_function(id, |b| b.iter(|| load.trace(accel, &load.packets)));
            }
            group.finish();
        }
    }
}

fn builds(criterion: &mut Criterion) {
    let case = Case::generated(Class::Smooth, TRIANGLES).expect("a generated scene");
    let mut group = criterion.benchmark_group("build, smooth");
    group.sample_size(10);
    for backend in Backend::built_in() {
        let options = AccelOptions::default().on(backend);
        group.bench_function(BenchmarkId::from_parameter(backend), |b| {
            b.iter(|| Accel::build(&case.views(), options))
        });
    }
    group.finish();
}

criterion_group!(benches, rays, builds);
criterion_main!(benches);
