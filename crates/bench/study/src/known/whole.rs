//! Resonance and replays.

use std::ops::RangeInclusive;

use bench_model::analysis::{Influence, SinePoint, WholeModel};
use bench_model::model::{AssembledModel, ModelParameter};
use numerics::order::median;
use rig::results::{Outcome, Parameter, Part};

use super::grade::{Grade, WIDTHS};
use super::graded::grade;
use super::result::{Known, Subject, Value};
use super::why::{SineTests, Why};
use crate::Study;

/// Fits of replays that are fair, and that are good, %.
pub const REPLAY_FITS: RangeInclusive<f64> = 70.0..=90.0;

/// Frequency, gain and damping of the resonance.
pub(super) fn resonance(study: &Study) -> Vec<Known> {
    let whole = match &study.whole {
        Outcome::Estimated(whole) => whole,
        Outcome::NotEstimated { needs } => return vec![Known::missing(Part::Whole, needs)],
    };
    let sines = sine_tests(whole);
    let known = |own: &Parameter, is_gain: bool| {
        let influence = whole.influences.iter().find(|one| one.quantity == own.quantity);
        let mut why: Vec<Why> = influence.and_then(uncertain_by).into_iter().collect();
        why.push(Why::SineTests(sines));
        why.extend(of_inertias(study));
        let contradicted = is_gain && sines.is_some_and(|tests| tests.mean_deviation > WIDTHS.roughly);
        let by_width = grade(study, own);
        Known::of(own, if contradicted { by_width.contradicted() } else { by_width }, why)
    };
    vec![known(&whole.resonance_hz, false), known(&whole.resonance_gain, true), known(&whole.damping_ratio, false)]
}

/// Uncertainty of the inertias that the intervals contain.
fn of_inertias(study: &Study) -> Option<Why> {
    let AssembledModel { model, uncertainty, .. } = study.model.as_ref()?;
    let share = |which: ModelParameter| {
        let error = uncertainty.standard_error(which).map_or(0.0, |(error, _)| error);
        Some((error > 0.0).then_some(error / model.value(which)?))
    };
    Some(Why::Inertias { dyno: share(ModelParameter::DynoInertia)?, engine: share(ModelParameter::EngineInertia)? })
}

/// The parameter that most of the uncertainty is owed to.
fn uncertain_by(influence: &Influence) -> Option<Why> {
    let shares = influence.parameters.iter().filter_map(|one| Some((one, one.variance_share?)));
    let (most, share) = shares.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(Why::UncertainBy { parameter: most.parameter, share })
}

/// How far measured gains are from the model on average.
fn sine_tests(whole: &WholeModel) -> Option<SineTests> {
    let off = |p: &SinePoint| (p.gain_corrected_for_engine.unwrap_or(p.gain) / p.model_gain - 1.0).abs();
    let clear = whole.sine_points.iter().filter(|p| !p.at_engine_order);
    let clear: Vec<f64> = clear.map(off).filter(|o| o.is_finite()).collect();
    let count = clear.len();
    (count > 0).then(|| SineTests { count, mean_deviation: clear.iter().sum::<f64>() / count as f64 })
}

/// Knowledge of the whole model, from recordings that no part was estimated from.
pub(super) fn replays(study: &Study) -> Known {
    let unseen: Vec<_> = study.replays.iter().filter(|replay| !replay.seen_in_estimation).collect();
    let signals = unseen.iter().flat_map(|replay| &replay.signals);
    let mut fits: Vec<f64> = signals.map(|signal| signal.fit_percent).collect();
    let lowest = fits.iter().copied().reduce(f64::min);
    let (Some(lowest), Some(median)) = (lowest, median(&mut fits)) else {
        return Known::not_at_all(Subject::Replays, Why::NothingUnseen);
    };
    let (fair, good) = (*REPLAY_FITS.start(), *REPLAY_FITS.end());
    let by_fit = match median {
        fit if fit >= good => Grade::Well,
        fit if fit >= fair => Grade::Roughly,
        _ => Grade::Poorly,
    };
    let grade = if lowest < fair { by_fit.contradicted() } else { by_fit };
    let replayed = unseen.iter().map(|replay| Why::Replayed {
        file: replay.stretch.file.clone(),
        fits: replay.signals.iter().map(|signal| (signal.quantity.clone(), signal.fit_percent)).collect(),
    });
    let why = replayed.chain([Why::ReplayHasItsEngine]).collect();
    Known::new(Subject::Replays, grade, Value::MedianFit(median), why)
}
