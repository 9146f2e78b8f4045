//! Links Embree and generates the adjoint kernels: nothing else.

#[path = "build/embree.rs"]
mod embree;

fn main() {
    embree::build();
}
