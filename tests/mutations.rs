//! A few of the cases that `make test-long` runs thousands of.

#[path = "long/mutations/mod.rs"]
mod mutations;

#[test]
fn promises_hold_whatever_is_given() {
    mutations::campaign(150);
}
