//! Every shipped case gives the values of its `[expected]` block.
#![allow(clippy::panic, clippy::expect_used, reason = "a test fails by panicking")]

mod common;

#[test]
fn shipped_cases_give_their_expected_values() {
    assert!(common::verified(&common::file("cases")) > 0);
}
