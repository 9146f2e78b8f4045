//! Links Embree and derives the adjoint kernels: nothing else.

#[path = "src/adjoint/build_step.rs"]
mod adjoint;
#[path = "build/embree.rs"]
mod embree;
#[path = "build/shim.rs"]
mod shim;

fn main() {
    println!("cargo::rerun-if-changed=build/shim.rs");
    embree::build();
    adjoint::derive_adjoints();
}
