//! The verdict on a study, by rules that are stated and shown with their outcome.
//!
//! Nothing is estimated here: every rule compares numbers of the study with a threshold, and states that threshold.
//! The headline is the worst outcome of all rules.

use rig::results::{Outcome, Parameter, Part, Quantity, Validation};
use rig::{Diagnostic, Finding, Severity};
use study::Study;

use crate::estimated;
use crate::wording::{self, number};

/// How far the model can be trusted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Good for use.
    Good,
    /// Usable, with the reservations the rules name.
    Reservations,
    /// Not to be used for decisions.
    Insufficient,
}

impl Level {
    /// The level as a headline.
    pub fn headline(self) -> &'static str {
        match self {
            Level::Good => "The model is good",
            Level::Reservations => "The model is usable, with reservations",
            Level::Insufficient => "Insufficient for a model to rely on",
        }
    }

    /// The level in a word, for programs.
    pub fn key(self) -> &'static str {
        match self {
            Level::Good => "good",
            Level::Reservations => "reservations",
            Level::Insufficient => "insufficient",
        }
    }

    /// The outcome of one rule in a word.
    pub fn outcome(self) -> &'static str {
        match self {
            Level::Good => "met",
            Level::Reservations => "reservation",
            Level::Insufficient => "not met",
        }
    }
}

/// One rule with what the study says to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Rule {
    /// Request of the rule, with its thresholds.
    pub asks: &'static str,
    /// Finding of the study.
    pub found: String,
    /// How the rule came out.
    pub level: Level,
}

/// The verdict with the rules it rests on.
#[derive(Debug, Clone, PartialEq)]
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
    let missing: Vec<Part> =
        estimated::parts(study).iter().filter(|(_, needs)| needs.is_some()).map(|(part, _)| *part).collect();
    let core_missing = missing.iter().any(|part| matches!(part, Part::Shaft | Part::TorqueControl | Part::Whole));
    let missing: Vec<&str> = missing.into_iter().map(wording::part).collect();
    let level = match (core_missing, missing.is_empty()) {
        (true, _) => Level::Insufficient,
        (false, false) => Level::Reservations,
        (false, true) => Level::Good,
    };
    let found = match missing.as_slice() {
        [] => "all six are estimated".to_owned(),
        _ => format!("not estimated: {}", wording::join(&missing, "and")),
    };
    Rule { asks: "Every part is estimated; shaft, torque control and whole model must be.", found, level }
}

fn uncertainty(study: &Study) -> Rule {
    let shaft = study.shaft.estimated().and_then(|shaft| shaft.estimate.parameter(Quantity::Stiffness));
    let resonance = study.whole.estimated().map(|whole| &whole.resonance_hz);
    let relative = [("K", shaft), ("resonance", resonance)]
        .into_iter()
        .filter_map(|(name, parameter)| Some((name, relative_half_width(parameter?))))
        .collect::<Vec<_>>();
    let asks = "95 % intervals of shaft stiffness and resonance are within ±10 %; beyond ±30 % is not met.";
    let Some(worst) = relative.iter().map(|(_, width)| *width).reduce(worse_width) else {
        return Rule {
            asks,
            found: "neither stiffness nor resonance is estimated".to_owned(),
            level: Level::Insufficient,
        };
    };
    let level = match worst {
        w if w <= 0.10 => Level::Good,
        w if w <= 0.30 => Level::Reservations,
        _ => Level::Insufficient,
    };
    let found = relative.iter().map(|(name, width)| format!("{name} ±{}", number::share(*width))).collect::<Vec<_>>();
    Rule { asks, found: found.join(", "), level }
}

fn relative_half_width(parameter: &Parameter) -> f64 {
    let (low, high) = parameter.interval;
    ((high - low) / 2.0 / parameter.value).abs()
}

/// The larger of two widths, where one that is not a number is the largest of all.
fn worse_width(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) }
}

fn held_out(study: &Study) -> Rule {
    let fits = held_out_fits(study);
    let asks = "Each part has a fit of 80 % or more on its held-out stretch, which the estimate has not seen; below 50 % is not met.";
    let Some((name, worst)) = fits.iter().copied().reduce(worse_fit) else {
        return Rule { asks, found: "there is no held-out stretch".to_owned(), level: Level::Insufficient };
    };
    let level = match worst {
        f if f >= 80.0 => Level::Good,
        f if f >= 50.0 => Level::Reservations,
        _ => Level::Insufficient,
    };
    Rule { asks, found: format!("lowest fit: {}, {}", wording::part(name), number::fit(worst)), level }
}

/// Fit of each estimated part on its held-out stretch.
pub(crate) fn held_out_fits(study: &Study) -> Vec<(Part, f64)> {
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
    .filter_map(|(name, fit)| Some((name, fit?)))
    .collect()
}

fn worse_fit(a: (Part, f64), b: (Part, f64)) -> (Part, f64) {
    if a.1.is_nan() || a.1 <= b.1 { a } else { b }
}

fn replays(study: &Study) -> Rule {
    let asks = "Replays of recordings that no part was estimated from: half of the signals fit with 70 % or more and \
                none below 40 %; if half of them are below 40 %, not met.";
    let unseen = study.replays.iter().filter(|replay| !replay.seen_in_estimation);
    let fits: Vec<(f64, String)> = unseen
        .flat_map(|replay| replay.signals.iter().map(move |signal| (replay, signal)))
        .map(|(replay, signal)| {
            let fit = if signal.fit_percent.is_nan() { f64::NEG_INFINITY } else { signal.fit_percent };
            (fit, format!("{} of {}", signal.quantity, replay.stretch.file))
        })
        .collect();
    let Some((lowest, which)) = fits.iter().min_by(|a, b| a.0.total_cmp(&b.0)) else {
        return Rule {
            asks,
            found: "no recording was replayed that the estimates have not seen".to_owned(),
            level: Level::Reservations,
        };
    };
    let middle = number::median(&fits.iter().map(|(fit, _)| *fit).collect::<Vec<_>>());
    let level = match (middle, *lowest) {
        (m, l) if m >= 70.0 && l >= 40.0 => Level::Good,
        (m, _) if m >= 40.0 => Level::Reservations,
        _ => Level::Insufficient,
    };
    let (middle, lowest) = (number::fit(middle), number::fit(*lowest));
    let found = format!("median fit of {} signals {middle}, lowest {lowest}: {which}", fits.len());
    Rule { asks, found, level }
}

fn residuals(study: &Study) -> Rule {
    let mut doubted: Vec<String> = study.diagnostics.iter().filter_map(|found| doubted_part(&found.finding)).collect();
    doubted.sort();
    doubted.dedup();
    let level = if doubted.is_empty() { Level::Good } else { Level::Reservations };
    let found = match doubted.as_slice() {
        [] => "no such part was found".to_owned(),
        _ => format!("in doubt: {}", wording::join(&doubted, "and")),
    };
    let asks = "No part failed to converge, disagrees with a second method, or has residuals correlated with its input. Counted are \
                lags outside the 99 % region: more than 5 % of them, with a correlation above 0.1.";
    Rule { asks, found, level }
}

fn doubted_part(finding: &Finding) -> Option<String> {
    match finding {
        Finding::ResidualsCorrelated { submodel, .. } | Finding::NotConverged { submodel } => {
            Some(wording::part(*submodel).to_owned())
        }
        Finding::RoutesDisagree { quantity, .. } => Some(wording::twice_estimated(*quantity).to_owned()),
        _ => None,
    }
}

fn findings(study: &Study) -> Rule {
    let count = |severity: Severity| study.diagnostics.iter().filter(|found| found.severity == severity).count();
    let (errors, warnings) = (count(Severity::Error), count(Severity::Warning));
    let counts =
        |found: &Diagnostic| matches!(found.finding, Finding::ImplausibleInertia { .. } | Finding::LateSignal { .. });
    let level = match errors {
        0 if !study.diagnostics.iter().any(counts) => Level::Good,
        _ => Level::Reservations,
    };
    let plural = |n: usize, word: &str| if n == 1 { format!("1 {word}") } else { format!("{n} {word}s") };
    let found = format!("{}, {}", plural(errors, "error"), plural(warnings, "warning"));
    Rule {
        asks: "No finding is an error; the parts that an error concerns are struck. Of warnings only a doubtful inertia and a late \
               signal count here.",
        found,
        level,
    }
}
