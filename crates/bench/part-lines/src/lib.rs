//! Lines in the spectra of recordings: their causes, their law over speed, and gains at sines that are demanded.

pub mod lines;
pub mod segments;
pub mod sine;
