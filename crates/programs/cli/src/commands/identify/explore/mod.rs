//! `dynoid data spectrum`, `delay`, `order`: what data say before a model is chosen.

mod delay;
mod order;
mod spectrum;

pub(crate) use delay::delay;
pub(crate) use order::order;
pub(crate) use spectrum::spectrum;
