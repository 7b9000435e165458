//! The tests of the report. A name's prefix says what it proves.

#![allow(clippy::unwrap_used)] // a test that cannot unwrap has failed

mod fixture;
mod page;
mod prop;
mod snap;
mod verdicts;
