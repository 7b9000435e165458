//! Grades, and what they are given by.

use rig::results::{Estimate, Outcome, Parameter, Reason, Stretch};
use study::{RecordingSummary, Study};

use crate::wording::{self, number};

/// Widest intervals, to either side, as parts of the value.
pub(super) const WIDTHS: Widths = Widths { well: 0.05, roughly: 0.20 };
/// The same of a time, as parts of the fastest sample time of the recordings.
const TIME_WIDTHS: Widths = Widths { well: 0.1, roughly: 0.5 };

/// Widest interval, to either side, of what is known well, and of what is known roughly.
pub(super) struct Widths {
    pub(super) well: f64,
    pub(super) roughly: f64,
}

/// How well something is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Grade {
    /// Well.
    Well,
    /// Roughly.
    Roughly,
    /// Poorly.
    Poorly,
    /// Stated in the bench file; no recording says whether it is true.
    OnTrust,
    /// Not at all.
    NotAtAll,
}

impl Grade {
    /// All of them, the best first.
    pub const ALL: [Grade; 5] = [Grade::Well, Grade::Roughly, Grade::Poorly, Grade::OnTrust, Grade::NotAtAll];

    /// The grade as a headline.
    pub fn headline(self) -> &'static str {
        match self {
            Grade::Well => "Known well",
            Grade::Roughly => "Known roughly",
            Grade::Poorly => "Known poorly",
            Grade::OnTrust => "Taken on trust",
            Grade::NotAtAll => "Not known",
        }
    }

    /// Meaning of the grade.
    pub fn meaning(self) -> &'static str {
        match self {
            Grade::Well => {
                "The recordings determine it within ±5 %, and nothing else in them contradicts it. For a time the limit is a tenth \
                 of the fastest sample, for friction 1 Nm, for a replay a fit of 90 %."
            }
            Grade::Roughly => {
                "Within ±20 % (a time: half of the fastest sample; a replay: a fit of 70 %). Or within ±5 %, but something else contradicts it."
            }
            Grade::Poorly => "Less accurately than that: good for an order of magnitude.",
            Grade::OnTrust => "Stated in the bench file. No recording says whether it is true.",
            Grade::NotAtAll => "No recording shows it.",
        }
    }

    /// Grade that is left when something else contradicts it.
    pub(super) fn contradicted(self) -> Grade {
        match self {
            Grade::Well => Grade::Roughly,
            Grade::Roughly => Grade::Poorly,
            other => other,
        }
    }

    /// By an interval, and the widths that are well and roughly.
    pub(super) fn of_width(width: f64, widest: Widths) -> Grade {
        match width {
            w if w <= widest.well => Grade::Well,
            w if w <= widest.roughly => Grade::Roughly,
            _ => Grade::Poorly,
        }
    }
}

/// One quantity, how well it is known, and why.
#[derive(Debug, Clone, PartialEq)]
pub struct Known {
    /// The part of the model it belongs to, counted in the order of the report.
    pub part: usize,
    /// Its symbol, empty where it has none.
    pub symbol: String,
    /// Name of the quantity.
    pub name: String,
    /// How well it is known.
    pub grade: Grade,
    /// Its value with its uncertainty, or why there is none.
    pub value: String,
    /// Why, a sentence each.
    pub why: Vec<String>,
}

impl Known {
    pub(super) fn new(symbol: &str, name: &str, grade: Grade, value: String, why: Vec<String>) -> Self {
        Known { part: 0, symbol: symbol.to_owned(), name: name.to_owned(), grade, value, why }
    }

    pub(super) fn of(parameter: &Parameter, grade: Grade, why: Vec<String>) -> Self {
        Known::new(parameter.quantity.symbol(), parameter.quantity.name(), grade, number::parameter(parameter), why)
    }

    /// Something that was not estimated, for want of what it needs.
    pub(super) fn missing(symbol: &str, name: &str, needs: &[Reason]) -> Self {
        let why = vec![format!("It needs {}.", wording::needs(needs).trim_end_matches('.'))];
        Known::new(symbol, name, Grade::NotAtAll, "–".to_owned(), why)
    }
}

/// Half of the interval over the value.
pub(super) fn relative_width(parameter: &Parameter) -> f64 {
    let (low, high) = parameter.interval;
    ((high - low) / 2.0 / parameter.value).abs()
}

/// The grade by the interval; times are graded by the fastest sample time.
pub(super) fn grade(study: &Study, parameter: &Parameter) -> Grade {
    let (low, high) = parameter.interval;
    match parameter.quantity.notation().unit {
        "s" => Grade::of_width((high - low) / 2.0 / fastest_sample_s(study), TIME_WIDTHS),
        _ => Grade::of_width(relative_width(parameter), WIDTHS),
    }
}

fn fastest_sample_s(study: &Study) -> f64 {
    let times = study.recordings.iter().flat_map(|recording| &recording.sample_times_s).map(|(_, time)| *time);
    times.fold(f64::INFINITY, f64::min)
}

/// The parameters of a part that was estimated, or that the part was not.
pub(super) fn of_part<T>(
    part: &Outcome<T>,
    symbol: &str,
    name: &str,
    known: impl FnOnce(&T) -> Vec<Known>,
) -> Vec<Known> {
    match part {
        Outcome::Estimated(part) => known(part),
        Outcome::NotEstimated { needs } => vec![Known::missing(symbol, name, needs)],
    }
}

/// From which recording an estimate is, for how long, and what was done in it.
pub(super) fn source(study: &Study, estimate: &Estimate) -> String {
    let from: Vec<String> = estimate.stretches.iter().map(|stretch| stretch_words(study, stretch)).collect();
    match from.as_slice() {
        [] => "The study does not state from which data.".to_owned(),
        _ => format!("From {}.", wording::join(&from, "and")),
    }
}

pub(super) fn stretch_words(study: &Study, stretch: &Stretch) -> String {
    let label = recording(study, &stretch.file).and_then(|recording| recording.label.as_ref());
    let done = label.and_then(wording::experiment).map(|words| format!(" ({words})")).unwrap_or_default();
    format!("{} of {}{done}", number::duration(stretch.end_s - stretch.start_s), stretch.file)
}

pub(super) fn recording<'a>(study: &'a Study, file: &str) -> Option<&'a RecordingSummary> {
    study.recordings.iter().find(|recording| recording.file == file)
}

/// Tells whether two intervals have anything in common.
pub(super) fn overlap(a: &Parameter, b: &Parameter) -> bool {
    a.interval.0 <= b.interval.1 && b.interval.0 <= a.interval.1
}
