//! Case files: what they may say, what it comes to, and the exact message about each fault.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, reason = "a test fails by panicking")]

#[path = "../common/mod.rs"]
mod common;

/// A test each, of a case `bar.toml` with one thing spoiled: the constant of its text, and then `name: "old" => "new"
/// set "KEY=VALUE" "line of the message"… ;`
macro_rules! spoiled {
    ($text:ident $($name:ident: $old:literal => $new:literal $(set $set:literal)* $($line:literal)+;)*) => {
        $(#[test]
        fn $name() {
            let source = amontons::case::Source::new("bar.toml", crate::common::spoil($text, $old, $new));
            let found = crate::common::told(&source, &[$($set),*]);
            assert_eq!(found, [$($line),+].join("\n"));
        })*
    };
}

mod acting;
mod bodies;
mod boundary;
mod conditions;
mod constants;
mod faults;
mod files;
mod graded_faults;
mod materials;
mod phases;
mod quantities;
mod reference;
mod refine_where;
mod sides;
mod thermal_faults;
mod valid;
