#[path = "src/adjoint/build_step.rs"]
mod adjoint;

fn main() {
    adjoint::derive_adjoints();
}
