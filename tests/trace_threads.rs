//! How many threads a build starts: alone in its process, so that nobody else's are counted.
#![cfg(target_os = "linux")]

use glam::Vec3;
use warpath::trace::{Accel, AccelOptions, MeshView};

#[path = "common/shapes.rs"]
mod shapes;

fn threads() -> usize {
    std::fs::read_dir("/proc/self/task")
        .expect("Linux lists threads")
        .count()
}

#[test]
fn builds_start_as_many_threads_as_they_are_told() {
    let (positions, triangles) = shapes::icosphere(6, Vec3::ZERO, 1.0);
    let view = MeshView {
        positions: &positions,
        triangles: &triangles,
    };
    let before = threads();
    let mut accel = Accel::build(&[view], AccelOptions::new(true, 1)).unwrap();
    accel.refit(&[view]).unwrap();
    assert_eq!(threads(), before, "a build on one thread started others");
    Accel::build(&[view], AccelOptions::new(true, 2)).unwrap();
    let started = threads() - before;
    assert!(
        started <= 1,
        "a build on two threads started {started} more"
    );
}
