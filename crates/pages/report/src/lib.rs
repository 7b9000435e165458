//! Turns a [`study::Study`] into what people and programs read: one self-contained HTML file, one JSON document, and
//! the plain words both the report and the command line use.
//!
//! This crate may know the bench's data types and nothing of how they were estimated: it computes no estimate, reads
//! and writes no file, and returns strings. Every text that comes from outside (file names, channel names, the bench
//! file, a reader's own words) is escaped on its way into the page; a number that is not finite becomes "not known" in
//! text and `null` in JSON.

mod assumptions;
mod blocks;
pub mod brief;
pub mod can;
pub mod catalogue;
pub mod comparison;
pub mod controller;
pub mod design;
mod effects;
pub mod engine;
mod estimates;
mod figures;
pub mod friction;
pub mod inspection;
pub mod known;
pub mod lines;
pub mod next;
pub mod pages;
mod plots;
pub mod proposal;
pub mod recording;
pub mod replayed;
pub mod safety;
mod sections;
pub mod shaft;
pub mod summary;
pub mod torque;
pub mod torque_control;
pub mod wording;

pub use effects::page as effects;
pub use sections::{full_study, study, summary_page};
