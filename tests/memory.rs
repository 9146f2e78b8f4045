//! Peak memory of the real program: bounded for a big mesh, and the same however many samples are taken.

mod common;

#[test]
fn a_gradient_stays_small_however_many_samples() {
    common::memory::stays_small(&[16, 256], 2);
}
