//! Links Embree and derives the adjoint kernels: nothing else.

#[path = "src/adjoint/build_step.rs"]
mod adjoint;
#[path = "build/embree.rs"]
mod embree;

fn main() {
    embree::build();
    adjoint::derive_adjoints();
}
