//! Grades by intervals, and the data that an estimate is from.

use rig::results::{Estimate, Outcome, Parameter, Part, Stretch};

use super::grade::{Grade, TIME_WIDTHS, WIDTHS};
use super::result::Known;
use super::why::{Source, Why};
use crate::verdict::relative_half_width;
use crate::{RecordingSummary, Study};

/// The grade by the interval; times are graded by the fastest sample time.
pub(super) fn grade(study: &Study, parameter: &Parameter) -> Grade {
    let (low, high) = parameter.interval;
    match parameter.quantity.notation().unit {
        "s" => Grade::of_width((high - low) / 2.0 / fastest_sample_s(study), TIME_WIDTHS),
        _ => Grade::of_width(relative_half_width(parameter), WIDTHS),
    }
}

fn fastest_sample_s(study: &Study) -> f64 {
    let times = study.recordings.iter().flat_map(|recording| &recording.sample_times_s).map(|(_, time)| *time);
    times.fold(f64::INFINITY, f64::min)
}

/// The parameters of a part that was estimated, or that the part was not.
pub(super) fn of_part<T>(part: Part, found: &Outcome<T>, known: impl FnOnce(&T) -> Vec<Known>) -> Vec<Known> {
    match found {
        Outcome::Estimated(found) => known(found),
        Outcome::NotEstimated { needs } => vec![Known::missing(part, needs)],
    }
}

/// From which recordings an estimate is, for how long, and what was done in them.
pub(super) fn sources(study: &Study, estimate: &Estimate) -> Why {
    Why::From(estimate.stretches.iter().map(|stretch| source(study, stretch)).collect())
}

/// The same of one stretch.
pub(super) fn source(study: &Study, stretch: &Stretch) -> Source {
    let label = recording(study, &stretch.file).and_then(|recording| recording.label.clone());
    Source { duration_s: stretch.end_s - stretch.start_s, file: stretch.file.clone(), label }
}

pub(super) fn recording<'a>(study: &'a Study, file: &str) -> Option<&'a RecordingSummary> {
    study.recordings.iter().find(|recording| recording.file == file)
}

/// Tells whether two intervals have anything in common.
pub(super) fn overlap(a: &Parameter, b: &Parameter) -> bool {
    a.interval.0 <= b.interval.1 && b.interval.0 <= a.interval.1
}
