//! How many threads a build starts: alone in its process, so that nobody else's are counted.
#![cfg(target_os = "linux")]

use common::shapes;
use glam::Vec3;
use std::time::{Duration, Instant};
use warpath::trace::{Accel, AccelOptions, Backend, MeshView};

fn threads() -> usize {
    std::fs::read_dir("/proc/self/task")
        .expect("Linux lists threads")
        .count()
}

/// The most threads there were at once beside those there are now, and how many stay a second
/// later.
fn started_by(work: impl FnOnce() -> Accel) -> (usize, usize) {
    let before = threads();
    let watch = std::thread::scope(|scope| {
        let (done, is_done) = std::sync::mpsc::channel::<()>();
        let watcher = scope.spawn(move || {
            let mut most = 0;
            // This thread is one more.
            while is_done.recv_timeout(Duration::from_micros(200)).is_err() {
                most = most.max(threads() - before - 1);
            }
            most
        });
        let accel = work();
        let _ = done.send(());
        (watcher.join().expect("a watcher"), accel)
    });
    let (most, _accel) = watch;
    let end = Instant::now() + Duration::from_secs(1);
    while threads() > before && Instant::now() < end {
        std::thread::yield_now();
    }
    (most, threads() - before)
}

#[test]
fn builds_start_as_many_threads_as_they_are_told() {
    let (positions, triangles) = shapes::icosphere(6, Vec3::ZERO, 1.0);
    let view = MeshView {
        positions: &positions,
        triangles: &triangles,
    };
    for backend in Backend::built_in() {
        let build = |threads| {
            let options = AccelOptions::new(true, threads).on(backend);
            let mut accel = Accel::build(&[view], options).expect("a built scene");
            accel.refit(&[view]).expect("the same mesh");
            accel
        };
        // obvhs builds in a pool of its own, in which even one thread is another than the caller's,
        // which waits.
        let helpers = usize::from(matches!(backend, Backend::Obvhs(..)));
        let (most, stay) = started_by(|| build(1));
        assert!(
            most <= helpers && stay == 0,
            "{backend}: {most}, {stay} stay"
        );
        let (most, stay) = started_by(|| build(2));
        assert!(
            most <= 1 + helpers && stay <= 1,
            "{backend}: {most}, {stay} stay"
        );
    }
}
