//! Lines in the spectra of recordings: their causes, their course over speed, and gains at sines that are demanded.

pub mod look;
pub mod segments;
pub mod sine;
