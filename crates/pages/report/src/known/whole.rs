//! Resonance and replays.

use bench_model::analysis::{Influence, WholeModel};
use bench_model::model::{AssembledModel, ModelParameter};
use rig::results::{Outcome, Parameter};
use study::Study;

use super::grade::{Grade, Known, WIDTHS, grade};
use crate::wording::{self, number};

/// Fits of replays that are good, %.
const GOOD_FIT: f64 = 90.0;
/// Fits of replays that are fair, %.
const FAIR_FIT: f64 = 70.0;

/// Frequency, gain and damping of the resonance.
pub(super) fn resonance(study: &Study) -> Vec<Known> {
    let whole = match &study.whole {
        Outcome::Estimated(whole) => whole,
        Outcome::NotEstimated { needs } => return vec![Known::missing("", "resonance of the bench", needs)],
    };
    let sines = sine_tests(whole);
    let known = |own: &Parameter, is_gain: bool| {
        let mut why: Vec<String> =
            whole.influences.iter().find(|i| i.quantity == own.quantity).and_then(uncertain_by).into_iter().collect();
        why.push(sines.1.clone());
        why.extend(of_inertias(study));
        let contradicted = is_gain && sines.0.is_some_and(|off| off > WIDTHS.roughly);
        let by_width = grade(study, own);
        Known::of(own, if contradicted { by_width.contradicted() } else { by_width }, why)
    };
    vec![known(&whole.resonance_hz, false), known(&whole.resonance_gain, true), known(&whole.damping_ratio, false)]
}

/// Uncertainty of the inertias that the intervals contain.
fn of_inertias(study: &Study) -> Option<String> {
    let AssembledModel { model, uncertainty, .. } = study.model.as_ref()?;
    let of = |which: ModelParameter| {
        let error = uncertainty.standard_error(which).map_or(0.0, |(error, _)| error);
        let (symbol, value) = (which.symbol(), model.value(which)?);
        Some(match error > 0.0 {
            true => format!("{symbol} by {} %", number::significant(100.0 * error / value, 2)),
            false => format!("{symbol} as exact"),
        })
    };
    Some(format!(
        "The interval contains the standard uncertainty of the model’s inertias: {} and {}.",
        of(ModelParameter::DynoInertia)?,
        of(ModelParameter::EngineInertia)?
    ))
}

/// The parameter that most of the uncertainty is owed to.
fn uncertain_by(influence: &Influence) -> Option<String> {
    let shares = influence.parameters.iter().filter_map(|one| Some((one, one.variance_share?)));
    let (most, share) = shares.max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some(format!(
        "The largest part of its uncertainty, {}, comes from {}.",
        number::share(share),
        most.parameter.symbol()
    ))
}

/// How far measured gains are from the model on average, and in words.
fn sine_tests(whole: &WholeModel) -> (Option<f64>, String) {
    let off = |p: &bench_model::analysis::SinePoint| {
        (p.gain_corrected_for_engine.unwrap_or(p.gain) / p.model_gain - 1.0).abs()
    };
    let clear: Vec<f64> =
        whole.sine_points.iter().filter(|p| !p.at_engine_order).map(off).filter(|o| o.is_finite()).collect();
    if clear.is_empty() {
        return (None, "No sine test checks it; Sine_T_TN would.".to_owned());
    }
    let mean = clear.iter().sum::<f64>() / clear.len() as f64;
    let words = format!(
        "{} sine tests away from engine orders differ from it by {} on average. The model was not estimated from them.",
        clear.len(),
        number::share(mean)
    );
    (Some(mean), words)
}

/// Knowledge of the whole model, from recordings that no part was estimated from.
pub(super) fn replays(study: &Study) -> Known {
    let known = |grade, value: String, why| Known::new("", "what the bench does as a whole", grade, value, why);
    let unseen: Vec<_> = study.replays.iter().filter(|replay| !replay.seen_in_estimation).collect();
    let fits: Vec<f64> = unseen.iter().flat_map(|replay| &replay.signals).map(|signal| signal.fit_percent).collect();
    let Some(lowest) = fits.iter().copied().reduce(f64::min) else {
        let why =
            vec!["No recording was replayed that the estimates have not seen; record another experiment.".to_owned()];
        return known(Grade::NotAtAll, "–".to_owned(), why);
    };
    let median = number::median(&fits);
    let by_fit = match median {
        fit if fit >= GOOD_FIT => Grade::Well,
        fit if fit >= FAIR_FIT => Grade::Roughly,
        _ => Grade::Poorly,
    };
    let words = unseen.iter().map(|replay| {
        let signals: Vec<String> = replay
            .signals
            .iter()
            .map(|signal| format!("{} {}", signal.quantity, number::fit(signal.fit_percent)))
            .collect();
        format!("Replayed on {}: {}.", replay.stretch.file, wording::join(&signals, "and"))
    });
    let below = lowest < FAIR_FIT;
    let mut why: Vec<String> = words.collect();
    why.push("T_e, which drives the replay, is reconstructed from the same recording: a replay tests the dynamometer’s side and the shaft more than the engine’s.".to_owned());
    known(if below { by_fit.contradicted() } else { by_fit }, format!("median fit {}", number::fit(median)), why)
}
