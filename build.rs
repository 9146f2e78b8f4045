//! Links Embree, and OpenImageIO if that is asked for, and derives the adjoint kernels: nothing else.

#[path = "src/adjoint/build_step.rs"]
mod adjoint;
#[path = "build/embree.rs"]
mod embree;
#[path = "build/oiio.rs"]
mod oiio;
#[path = "build/shim.rs"]
mod shim;

fn main() {
    println!("cargo::rerun-if-changed=build/shim.rs");
    embree::build();
    if cfg!(feature = "oiio") {
        oiio::build();
    }
    adjoint::derive_adjoints();
}
