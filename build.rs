//! Links Embree and OpenImageIO if they are asked for, and derives the adjoint kernels: nothing
//! else.

#[path = "src/adjoint/build_step.rs"]
mod adjoint;
#[cfg(feature = "embree")]
#[path = "build/embree.rs"]
mod embree;
#[cfg(feature = "oiio")]
#[path = "build/oiio.rs"]
mod oiio;
#[cfg(any(feature = "embree", feature = "oiio"))]
#[path = "build/shim.rs"]
mod shim;

fn main() {
    println!("cargo::rerun-if-changed=build/shim.rs");
    #[cfg(feature = "embree")]
    embree::build();
    #[cfg(feature = "oiio")]
    oiio::build();
    adjoint::derive_adjoints();
}
