//! Tests of `mdf`; the prefix of a name says what a test proves.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr)]

mod against_asammdf;
mod damage;
mod features;
mod made;
mod version3;
