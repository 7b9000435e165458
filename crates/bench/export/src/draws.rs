//! Benches that the uncertainty of a model allows.

use bench_model::document::BenchModelDocument;
use bench_model::model::BenchModel;
use numerics::random::Stream;

/// Seed of the draws in files: the same model gives the same files.
pub(crate) const SEED: u64 = 1;

/// Models drawn from the uncertainty of a bench model, for Monte Carlo studies in other programs. The same seed gives
/// the same draws, and more draws begin with the same ones. None where hardly any draw is a bench that can be.
#[must_use]
pub fn draws(document: &BenchModelDocument, count: usize, seed: u64) -> Vec<BenchModel> {
    let draw = |number: u64| document.uncertainty.draw(&document.model, &mut Stream::new(seed, number));
    (0..count as u64).map_while(draw).collect()
}
