//! Delays from inputs to an output, in samples: how much later the output answers.
//!
//! All take data whose means have been taken off, and one output; a positive delay means *later*, and a delay of `n`
//! is what models call `nk = n`: the output of an instant depends on the input `n` samples before, and on no later one.
//! A discrete system without feedthrough that is sampled with a hold has a delay of one.
//!
//! | estimate | right for | wrong for |
//! | --- | --- | --- |
//! | [`ArxDelay`]: compares ARX models of every `nk` | any system that ARX of these orders describes; several inputs; loops with a delay | strongly coloured measurement noise with small `na` (takes the delay too long where the response starts slowly); `nb` larger than needed leaves shorter delays as likely |
//! | [`ImpulseDelay`]: first lag that matters in a long regression | systems of any order, several inputs | responses that start below the noise (too long, by the slow start); a false alarm at an early lag with the probability of the level |
//! | [`PeakDelay`]: peak of the correlation with the whitened input | the same signal measured twice, a pure delay and gain | anything with a lag: it finds the lag of the *largest* response, later than the first; feedback (finds the way back as well) |
//! | [`PhaseDelay`]: slope of the phase of the cross-spectrum | as before, to a small part of a sample, with noise of any colour on the output | anything with phase of its own; noise on the input costs nothing but certainty; feedback |
//! | [`FractionalDelay`]: ARX with a continuously delayed input | delays of a broken number of samples beside known dynamics | more numerator coefficients than needed, whose coefficients make up for a fraction of a sample: the standard error then says so; held inputs, whose values between samples are none that it could find |
//! | [`ModelledDelay`]: dead time of the best of several continuous models | held inputs, to a fraction of a sample; outputs slower than the inputs; coloured noise, ripple | feedback, and dynamics beyond four poles: it claims nothing then |
//!
//! # Source
//! Björklund & Ljung, *A review of time-delay estimation techniques*, 42nd IEEE Conference on Decision and Control,
//! 2003; Ljung 1999, §14.6 and §16.5.

mod arx;
mod fraction;
mod impulse;
mod modelled;
mod peak;
mod phase;

pub use arx::{ArxDelay, DelayCandidate, DelayRanking};
pub use fraction::FractionalDelay;
pub use impulse::{ImpulseDelay, ImpulseResponseStart};
pub use modelled::{DelayFault, DelayModel, DelayModels, ModelledDelay, single_line};
pub use peak::{CorrelationPeak, PeakDelay};
pub use phase::PhaseDelay;

use crate::data::regression::Lagged;
use crate::{Dataset, IdentError};
use fitting::{Count, StructureError};

/// A delay to a fraction of a sample.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct DelayEstimate {
    /// The delay, in samples.
    pub samples: f64,
    /// Its standard error, in samples; infinite where the data do not show it.
    pub standard_error: f64,
}

/// The signals of each experiment: the output, then the inputs.
fn signals(data: &Dataset) -> Result<Vec<Vec<&[f64]>>, IdentError> {
    if data.outputs() != 1 {
        return Err(StructureError::outputs("the estimate of a delay", Count::Exactly(1), data.outputs()).into());
    }
    if data.inputs() == 0 {
        return Err(StructureError::inputs("the estimate of a delay", Count::AtLeast(1), 0).into());
    }
    let varies = |x: &[f64]| {
        let mut known = x.iter().filter(|v| !v.is_nan());
        known.next().is_some_and(|first| known.any(|v| v != first))
    };
    if !data.experiments().iter().any(|e| varies(e.output(0))) {
        return Err(IdentError::Constant { what: "the output" });
    }
    if (0..data.inputs()).any(|k| !data.experiments().iter().any(|e| varies(e.input(k)))) {
        return Err(IdentError::Constant { what: "an input" });
    }
    let (experiments, inputs) = (data.experiments().iter(), data.inputs());
    Ok(experiments.map(|e| std::iter::once(e.output(0)).chain((0..inputs).map(|k| e.input(k))).collect()).collect())
}

/// Past outputs, `spacing` samples from one to the next.
fn past_outputs(count: usize, spacing: usize) -> impl Iterator<Item = Lagged> {
    Lagged::each(0, (1..=count).map(move |i| (i * spacing) as isize))
}

/// Refuses data of more than one input.
fn check_one_input(data: &Dataset) -> Result<(), IdentError> {
    if data.inputs() == 1 {
        return Ok(());
    }
    Err(StructureError::inputs("this estimate of a delay", Count::Exactly(1), data.inputs()).into())
}
