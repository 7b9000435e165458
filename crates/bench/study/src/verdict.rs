//! The verdict on a study, by rules that are stated and shown with their outcome.
//!
//! Nothing is estimated here: every rule compares numbers of the study with a threshold. The verdict is the worst
//! outcome of all rules.

use std::ops::RangeInclusive;

use numerics::null::nan_if_null;
use numerics::order::median;
use rig::results::{Outcome, Parameter, Part, Quantity, Validation};
use rig::{Finding, Severity};
use serde::{Deserialize, Serialize};

use crate::Study;

/// Half widths of the intervals of stiffness and resonance, as parts of the values: a narrower one is good, a wider one
/// is insufficient.
pub const HALF_WIDTHS: RangeInclusive<f64> = 0.10..=0.30;
/// Fits on held-out stretches, %: a better one is good, a worse one is insufficient.
pub const HELD_OUT_FITS: RangeInclusive<f64> = 50.0..=80.0;
/// Fits of replays, %: half of the signals have the better one and all of them the worse one where they are good. Where
/// not even half of them have the worse one, they are insufficient.
pub const REPLAY_FITS: RangeInclusive<f64> = 40.0..=70.0;

/// How far the model can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Level {
    /// Good for use.
    Good,
    /// Usable, with the reservations the rules name.
    Reservations,
    /// Not to be used for decisions.
    Insufficient,
}

impl Level {
    /// The level in a word, for programs.
    pub fn key(self) -> &'static str {
        match self {
            Level::Good => "good",
            Level::Reservations => "reservations",
            Level::Insufficient => "insufficient",
        }
    }
}

/// One rule with what the study says to it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Rule {
    /// The rule, and the finding of the study.
    pub found: Found,
    /// How the rule came out.
    pub level: Level,
}

/// The rules, each with what it found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "rule", rename_all = "snake_case")]
pub enum Found {
    /// Every part is estimated; shaft, torque control and whole model must be.
    Parts {
        /// Those that are not.
        missing: Vec<Part>,
    },
    /// The intervals of stiffness and resonance are within [`HALF_WIDTHS`].
    Uncertainty {
        /// Those that are estimated.
        widths: Vec<HalfWidth>,
    },
    /// Each part fits its held-out stretch, which the estimate has not seen: [`HELD_OUT_FITS`].
    HeldOut {
        /// The lowest fit; none without a held-out stretch.
        lowest: Option<HeldOutFit>,
    },
    /// Recordings that no part was estimated from are replayed: [`REPLAY_FITS`].
    Replays {
        /// The fits; none without such a recording.
        fits: Option<ReplayFits>,
    },
    /// No part failed to converge, disagrees with a second method, or has residuals correlated with its input.
    Residuals {
        /// Parts and quantities that are in doubt.
        doubted: Vec<Doubted>,
    },
    /// No finding is an error. Of warnings only a doubtful inertia and a late signal count.
    Findings {
        /// Errors.
        errors: usize,
        /// Warnings, those that do not count too.
        warnings: usize,
    },
}

/// Half of a 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HalfWidth {
    /// Of which quantity.
    pub quantity: Quantity,
    /// As a part of the value.
    #[serde(deserialize_with = "nan_if_null")]
    pub share: f64,
}

/// Fit of a part on the stretch that was held out.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HeldOutFit {
    /// The part.
    pub part: Part,
    /// The fit, %.
    #[serde(deserialize_with = "nan_if_null")]
    pub fit_percent: f64,
}

/// Fits of the signals of all replays of recordings that no part was estimated from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ReplayFits {
    /// Signals.
    pub signals: usize,
    /// The median of their fits, %.
    #[serde(deserialize_with = "nan_if_null")]
    pub median_percent: f64,
    /// The lowest of their fits, %.
    #[serde(deserialize_with = "nan_if_null")]
    pub lowest_percent: f64,
    /// The signal that has the lowest fit.
    pub signal: String,
    /// The recording of that signal.
    pub file: String,
}

/// A part or a quantity that a finding puts in doubt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Doubted {
    /// A part that did not converge, or whose residuals depend on its input.
    Part(Part),
    /// A quantity for which two methods disagree.
    Quantity(Quantity),
}

/// The verdict with the rules it rests on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    /// The worst outcome of all rules.
    pub level: Level,
    /// Every rule, in the order they are asked.
    pub rules: Vec<Rule>,
}

/// Judges a study.
pub fn verdict(study: &Study) -> Verdict {
    let rules =
        vec![parts(study), uncertainty(study), held_out(study), replays(study), residuals(study), findings(study)];
    let level = rules.iter().map(|rule| rule.level).max().unwrap_or(Level::Insufficient);
    Verdict { level, rules }
}

fn parts(study: &Study) -> Rule {
    let missing: Vec<Part> = study.not_estimated().into_iter().map(|(part, _)| part).collect();
    let core_missing = missing.iter().any(|part| matches!(part, Part::Shaft | Part::TorqueControl | Part::Whole));
    let level = match (core_missing, missing.is_empty()) {
        (true, _) => Level::Insufficient,
        (false, false) => Level::Reservations,
        (false, true) => Level::Good,
    };
    Rule { found: Found::Parts { missing }, level }
}

fn uncertainty(study: &Study) -> Rule {
    let stiffness = study.shaft.estimated().and_then(|shaft| shaft.estimate.parameter(Quantity::Stiffness));
    let resonance = study.whole.estimated().map(|whole| &whole.resonance_hz);
    let of = |one: &Parameter| HalfWidth { quantity: one.quantity, share: relative_half_width(one) };
    let widths: Vec<HalfWidth> = [stiffness, resonance].into_iter().flatten().map(of).collect();
    let level = match widths.iter().map(|one| one.share).reduce(worse_width) {
        Some(worst) if worst <= *HALF_WIDTHS.start() => Level::Good,
        Some(worst) if worst <= *HALF_WIDTHS.end() => Level::Reservations,
        _ => Level::Insufficient,
    };
    Rule { found: Found::Uncertainty { widths }, level }
}

/// Half of the 95 % interval over the value.
pub(crate) fn relative_half_width(parameter: &Parameter) -> f64 {
    let (low, high) = parameter.interval;
    ((high - low) / 2.0 / parameter.value).abs()
}

/// The larger of two widths, where one that is not a number is the largest of all.
fn worse_width(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

fn held_out(study: &Study) -> Rule {
    let lowest = held_out_fits(study).into_iter().reduce(worse_fit);
    let level = match lowest {
        Some(HeldOutFit { fit_percent, .. }) if fit_percent >= *HELD_OUT_FITS.end() => Level::Good,
        Some(HeldOutFit { fit_percent, .. }) if fit_percent >= *HELD_OUT_FITS.start() => Level::Reservations,
        _ => Level::Insufficient,
    };
    Rule { found: Found::HeldOut { lowest }, level }
}

/// Fit of each estimated part on its held-out stretch.
fn held_out_fits(study: &Study) -> Vec<HeldOutFit> {
    fn fit<'a, T>(part: &'a Outcome<T>, validation: impl Fn(&'a T) -> &'a Validation) -> Option<f64> {
        part.estimated().map(|estimated| validation(estimated).fit_percent)
    }
    [
        (Part::SpeedController, fit(&study.speed_controller, |part| &part.validation)),
        (Part::FeedForward, fit(&study.feed_forward, |part| &part.validation)),
        (Part::TorqueControl, fit(&study.torque_control, |part| &part.delay_and_lag_validation)),
        (Part::Shaft, fit(&study.shaft, |part| &part.validation)),
    ]
    .into_iter()
    .filter_map(|(part, fit)| Some(HeldOutFit { part, fit_percent: fit? }))
    .collect()
}

fn worse_fit(a: HeldOutFit, b: HeldOutFit) -> HeldOutFit {
    if a.fit_percent.is_nan() || a.fit_percent <= b.fit_percent { a } else { b }
}

fn replays(study: &Study) -> Rule {
    let fits = replay_fits(study);
    let (fair, good) = (*REPLAY_FITS.start(), *REPLAY_FITS.end());
    let level = match &fits {
        Some(fits) if fits.median_percent >= good && fits.lowest_percent >= fair => Level::Good,
        Some(fits) if fits.median_percent >= fair => Level::Reservations,
        Some(_) => Level::Insufficient,
        None => Level::Reservations,
    };
    Rule { found: Found::Replays { fits }, level }
}

/// Fits of all signals that are replayed on data that no part was estimated from. One that is not known is the lowest.
fn replay_fits(study: &Study) -> Option<ReplayFits> {
    let unseen = study.replays.iter().filter(|replay| !replay.seen_in_estimation);
    let signals = unseen.flat_map(|replay| replay.signals.iter().map(move |signal| (signal, &replay.stretch.file)));
    let known = |fit: f64| if fit.is_nan() { f64::NEG_INFINITY } else { fit };
    let fits: Vec<(f64, &Validation, &String)> =
        signals.map(|(signal, file)| (known(signal.fit_percent), signal, file)).collect();
    let (lowest_percent, signal, file) = *fits.iter().min_by(|a, b| a.0.total_cmp(&b.0))?;
    let median_percent = median(&mut fits.iter().map(|(fit, ..)| *fit).collect::<Vec<_>>())?;
    let (signal, file) = (signal.quantity.clone(), file.clone());
    Some(ReplayFits { signals: fits.len(), median_percent, lowest_percent, signal, file })
}

fn residuals(study: &Study) -> Rule {
    let mut doubted: Vec<Doubted> = Vec::new();
    for one in study.diagnostics.iter().filter_map(|found| doubted_by(&found.finding)) {
        if !doubted.contains(&one) {
            doubted.push(one);
        }
    }
    let level = if doubted.is_empty() { Level::Good } else { Level::Reservations };
    Rule { found: Found::Residuals { doubted }, level }
}

fn doubted_by(finding: &Finding) -> Option<Doubted> {
    match finding {
        Finding::ResidualsCorrelated { submodel, .. } | Finding::NotConverged { submodel } => {
            Some(Doubted::Part(*submodel))
        }
        Finding::RoutesDisagree { quantity, .. } => Some(Doubted::Quantity(*quantity)),
        _ => None,
    }
}

fn findings(study: &Study) -> Rule {
    let count = |severity: Severity| study.diagnostics.iter().filter(|found| found.severity == severity).count();
    let counts = |finding: &Finding| matches!(finding, Finding::ImplausibleInertia { .. } | Finding::LateSignal { .. });
    let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
    let level = match errors {
        0 if !study.diagnostics.iter().any(|found| counts(&found.finding)) => Level::Good,
        _ => Level::Reservations,
    };
    Rule { found: Found::Findings { errors, warnings }, level }
}
