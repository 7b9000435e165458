//! One run a bench, on all processors.

use bench_model::prediction::{PredictionError, PredictionInputs, predict};
use numerics::parallel;
use work::Context;

use super::allowed::allowed_nm;
use super::quantity::{self, Quantity};
use super::spread::Drawn;
use crate::safety::ladder::Ladder;

/// Outcome of one bench.
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
    context: &Context,
) -> Result<Vec<Outcome>, PredictionError> {
    let run = |bench: &Drawn| {
        let firing_seed = inputs.firing_seed.map(|_| bench.firing_seed);
        let Drawn { model, engine, friction, disturbances, .. } = bench;
        let (friction, disturbances) = (*friction, *disturbances);
        outcome(&PredictionInputs { model, engine, friction, disturbances, firing_seed, ..*inputs })
    };
    parallel::map_as_step(context, "running the experiment on benches", benches, run).into_iter().collect()
}

fn outcome(inputs: &PredictionInputs<'_>) -> Result<Outcome, PredictionError> {
    let resonance_hz = inputs.model.mechanics.resonance().frequency_hz;
    let ladder = Ladder::of(inputs.plan);
    match predict(inputs) {
        Ok(prediction) => {
            let values = quantity::values(inputs, inputs.model, &prediction);
            let allowed_nm = match ladder {
                Some(ladder) => allowed_nm(inputs, &ladder, &prediction)?,
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
