//! One run a bench, on all processors.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};

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
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let run = |bench: &Drawn| {
        let outcome = outcome(&PredictionInputs { model: &bench.model, engine: &bench.engine, ..*inputs });
        told(done.fetch_add(1, Ordering::Relaxed) as u64 + 1, benches.len() as u64);
        outcome
    };
    // Each thread takes the next bench that nobody has taken.
    let work = || {
        let mine = std::iter::from_fn(|| {
            let place = next.fetch_add(1, Ordering::Relaxed);
            Some((place, run(benches.get(place)?)))
        });
        mine.collect::<Vec<_>>()
    };
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let mut all: Vec<(usize, Result<Outcome, PredictionError>)> = std::thread::scope(|scope| {
        let workers: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let mine = work();
        let others = workers.into_iter().flat_map(|worker| worker.join().unwrap_or_else(|panic| resume_unwind(panic)));
        mine.into_iter().chain(others).collect()
    });
    all.sort_by_key(|(place, _)| *place);
    all.into_iter().map(|(_, outcome)| outcome).collect()
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
