//! The tests of the report. A name's prefix says what it proves.

#![allow(clippy::unwrap_used, clippy::panic)]

mod can;
mod counterparts;
mod document;
mod fixture;
mod known;
mod next;
mod page;
mod prop;
mod snap;
mod verdicts;
mod words;
