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
fn one_thread_builds_alone() {
    let (positions, triangles) = shapes::icosphere(6, Vec3::ZERO, 1.0);
    let view = MeshView {
        positions: &positions,
        triangles: &triangles,
    };
    let before = threads();
    let mut accel = Accel::build(&[view], AccelOptions::new(true, 1)).unwrap();
    accel.refit(&[view]).unwrap();
    assert_eq!(threads(), before, "a build on one thread started others");
}
