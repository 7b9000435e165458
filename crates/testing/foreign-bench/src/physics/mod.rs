//! Moving parts: engine, drive, shaft.

mod cycle_table;
mod drive;
mod engine;
mod slider_crank;
mod train;

pub(crate) use drive::Drive;
pub(crate) use engine::Engine;
pub(crate) use train::{State, Train};
