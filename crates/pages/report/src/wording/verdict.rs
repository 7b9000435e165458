//! The verdict's rules and what they found, in words.

use std::ops::RangeInclusive;

use page::decimal::fixed;
use rig::results::Quantity;
use study::verdict::{Doubted, Found, HALF_WIDTHS, HELD_OUT_FITS, HalfWidth, Level, REPLAY_FITS, ReplayFits, Rule};

use super::{capitalised, join, needs, number, part, twice_estimated};

/// The words of model.json.
pub const MODEL_WORDS: study::Words = study::Words { headline, reservation: |rule| capitalised(&found(rule)), needs };

/// A level as a headline.
pub fn headline(level: Level) -> &'static str {
    match level {
        Level::Good => "The model is good",
        Level::Reservations => "The model is usable, with reservations",
        Level::Insufficient => "Insufficient for a model to rely on",
    }
}

/// The outcome of one rule in a word.
pub fn outcome(level: Level) -> &'static str {
    match level {
        Level::Good => "met",
        Level::Reservations => "reservation",
        Level::Insufficient => "not met",
    }
}

/// Request of a rule, with its thresholds.
pub fn asks(rule: &Rule) -> String {
    match &rule.found {
        Found::Parts { .. } => "Every part is estimated; shaft, torque control and whole model must be.".to_owned(),
        Found::Uncertainty { .. } => {
            let [good, worst] = ends(&HALF_WIDTHS).map(|share| 100.0 * share).map(whole);
            format!(
                "95 % intervals of shaft stiffness and resonance are within ±{good} %; beyond ±{worst} % is not met."
            )
        }
        Found::HeldOut { .. } => {
            let [worst, good] = ends(&HELD_OUT_FITS).map(whole);
            format!(
                "Each part has a fit of {good} % or more on its held-out stretch, which the estimate has not seen; below {worst} % is \
                 not met."
            )
        }
        Found::Replays { .. } => {
            let [worst, good] = ends(&REPLAY_FITS).map(whole);
            format!(
                "Replays of recordings that no part was estimated from: half of the signals fit with {good} % or more and none below \
                 {worst} %; if half of them are below {worst} %, not met."
            )
        }
        Found::Residuals { .. } => {
            "No part failed to converge, disagrees with a second method, or has residuals correlated with its input. Counted are \
             lags outside the 99 % region: more than 5 % of them, with a correlation above 0.1."
                .to_owned()
        }
        Found::Findings { .. } => {
            "No finding is an error; the parts that an error concerns are struck. Of warnings only a doubtful inertia and a late \
             signal count here."
                .to_owned()
        }
    }
}

fn ends(range: &RangeInclusive<f64>) -> [f64; 2] {
    [*range.start(), *range.end()]
}

fn whole(value: f64) -> String {
    fixed(value, 0)
}

/// Finding of the study on a rule.
pub fn found(rule: &Rule) -> String {
    match &rule.found {
        Found::Parts { missing } => match missing.as_slice() {
            [] => "all six are estimated".to_owned(),
            missing => {
                let missing: Vec<&str> = missing.iter().copied().map(part).collect();
                format!("not estimated: {}", join(&missing, "and"))
            }
        },
        Found::Uncertainty { widths } => match widths.as_slice() {
            [] => "neither stiffness nor resonance is estimated".to_owned(),
            widths => widths.iter().map(half_width).collect::<Vec<_>>().join(", "),
        },
        Found::HeldOut { lowest: None } => "there is no held-out stretch".to_owned(),
        Found::HeldOut { lowest: Some(worst) } => {
            format!("lowest fit: {}, {}", part(worst.part), number::fit(worst.fit_percent))
        }
        Found::Replays { fits: None } => "no recording was replayed that the estimates have not seen".to_owned(),
        Found::Replays { fits: Some(fits) } => replayed(fits),
        Found::Residuals { doubted } => in_doubt(doubted),
        Found::Findings { errors, warnings } => {
            format!("{}, {}", counted(*errors, "error"), counted(*warnings, "warning"))
        }
    }
}

fn half_width(one: &HalfWidth) -> String {
    let name = if one.quantity == Quantity::Stiffness { "K" } else { "resonance" };
    format!("{name} ±{}", number::share(one.share))
}

fn replayed(ReplayFits { signals, median_percent, lowest_percent, signal, file }: &ReplayFits) -> String {
    let (median, lowest) = (number::fit(*median_percent), number::fit(*lowest_percent));
    format!("median fit of {signals} signals {median}, lowest {lowest}: {signal} of {file}")
}

fn in_doubt(doubted: &[Doubted]) -> String {
    let word = |one: &Doubted| match one {
        Doubted::Part(of) => part(*of),
        Doubted::Quantity(quantity) => twice_estimated(*quantity),
    };
    let mut words: Vec<&str> = doubted.iter().map(word).collect();
    words.sort_unstable();
    words.dedup();
    match words.as_slice() {
        [] => "no such part was found".to_owned(),
        words => format!("in doubt: {}", join(words, "and")),
    }
}

fn counted(count: usize, word: &str) -> String {
    if count == 1 { format!("1 {word}") } else { format!("{count} {word}s") }
}
