//! One run a bench, on all processors.

use std::sync::atomic::{AtomicU64, Ordering};

use super::quantity::{self, Quantity};
use super::sines::{self, Ladder};
use super::spread::Drawn;
use crate::prediction::{PredictionError, PredictionInputs, predict};

/// What one bench did.
pub(super) struct Outcome {
    /// By [`Quantity`].
    pub(super) values: [f64; Quantity::COUNT],
    pub(super) resonance_hz: f64,
    pub(super) is_unstable: bool,
    /// The largest amplitude that each sine of a sine test may have, Nm; empty for other plans.
    pub(super) allowed_nm: Vec<f64>,
}

/// The outcomes of all benches, in their order.
pub(super) fn outcomes(
    inputs: &PredictionInputs<'_>,
    benches: &[Drawn],
    told: &(dyn Fn(u64, u64) + Sync),
) -> Result<Vec<Outcome>, PredictionError> {
    let done = AtomicU64::new(0);
    let run = |bench: &Drawn| {
        let outcome = outcome(&PredictionInputs { model: &bench.model, engine: &bench.engine, ..*inputs });
        told(done.fetch_add(1, Ordering::Relaxed) + 1, benches.len() as u64);
        outcome
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut results: Vec<Option<Result<Outcome, PredictionError>>> = benches.iter().map(|_| None).collect();
    let share = benches.len().div_ceil(threads).max(1);
    std::thread::scope(|scope| {
        for (results, benches) in results.chunks_mut(share).zip(benches.chunks(share)) {
            let run = &run;
            scope.spawn(move || {
                results.iter_mut().zip(benches).for_each(|(result, bench)| *result = Some(run(bench)));
            });
        }
    });
    results.into_iter().flatten().collect()
}

fn outcome(inputs: &PredictionInputs<'_>) -> Result<Outcome, PredictionError> {
    let resonance_hz = inputs.model.mechanics.resonance().frequency_hz;
    let ladder = Ladder::of(inputs.plan);
    match predict(inputs) {
        Ok(prediction) => {
            let values = quantity::values(inputs, inputs.model, &prediction);
            let allowed_nm = match ladder {
                Some(ladder) => sines::allowed_nm(inputs, &ladder, &prediction)?,
                None => Vec::new(),
            };
            Ok(Outcome { values, resonance_hz, is_unstable: false, allowed_nm })
        }
        Err(PredictionError::Unstable) => {
            let allowed_nm = ladder.map_or_else(Vec::new, |ladder| vec![0.0; ladder.frequencies_hz.len()]);
            Ok(Outcome { values: quantity::unbounded(), resonance_hz, is_unstable: true, allowed_nm })
        }
        Err(error) => Err(error),
    }
}
