//! The tests of the report. A name's prefix says what it proves.

mod fixture;
mod page;
mod prop;
mod snap;
mod verdicts;
