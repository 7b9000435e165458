//! The demonstration: a bench whose every parameter is known, the campaign that is recorded on it, the effects that it
//! shows before any model is made of it, and the estimates of a study beside the truth.

pub mod campaign;
pub mod comparison;
pub mod effects;
