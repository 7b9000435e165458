//! The bench model of a study as a file of its own: built, and read from the text of a model.json or a study.json.

mod build;
mod read;

pub use build::{Origin, Words, bench_model, parameters};
pub use read::{BenchModelError, model, model_with_validity};
