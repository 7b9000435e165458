//! First needs of a reader: where the model is valid, and the one thing to do next.

use bench_model::document::{Range, Validity};
use page::Prose;
use rig::Severity;
use rig::results::Reason;
use study::Study;
use study::verdict::{Level, Verdict};
use units::RPM_RAD_S;

use crate::wording::{self, number};

/// Digits of a range that is read at a glance, and those of whole revolutions a minute.
const DIGITS: i32 = 3;
const WHOLE_RPM: i32 = 5;

/// Where a model is valid: speeds, torques and frequencies of the recordings that it was estimated from.
pub fn range(validity: &Validity) -> Option<String> {
    let between = |(low, high): Range, digits: i32, unit: &str| {
        format!("{} to {}", number::significant(low, digits), number::significant_with_unit(high, digits, unit))
    };
    let rpm = |(low, high): Range| ((low / RPM_RAD_S).round(), (high / RPM_RAD_S).round());
    let known = [
        validity.dyno_speed_rad_s.map(|range| format!("speeds of {}", between(rpm(range), WHOLE_RPM, "rpm"))),
        validity.air_gap_torque_nm.map(|range| format!("torques of {}", between(range, DIGITS, "Nm"))),
        validity.frequency_hz.map(|range| format!("frequencies of {}", between(range, DIGITS, "Hz"))),
    ];
    let known: Vec<String> = known.into_iter().flatten().collect();
    (!known.is_empty()).then(|| wording::join(&known, "and"))
}

/// The one thing to do next: what a finding asks for, then what a missing part needs, then a recording that tests the
/// model.
pub fn next_step(study: &Study, verdict: &Verdict) -> Prose {
    let error = study.diagnostics.iter().find(|found| found.severity == Severity::Error);
    let missing = study.not_estimated();
    let cause = study.diagnostics.iter().find(|found| found.severity > Severity::Note);
    if let Some(found) = error.or(cause.filter(|_| !missing.is_empty())) {
        return wording::advice(&found.finding).into();
    }
    let of_recordings = |needs: &[Reason]| needs.iter().any(|need| matches!(need, Reason::Recording { .. }));
    let first = missing.iter().find(|(_, needs)| of_recordings(needs)).or(missing.first());
    if let Some((part, needs)) = first {
        return format!("give what the {} needs: {}.", wording::part(*part), wording::needs(needs)).into();
    }
    if !study.replays.iter().any(|replay| !replay.seen_in_estimation) {
        return "record a further run of another kind, so that a replay tests the model on data it has not seen."
            .into();
    }
    if let Some(found) = cause.filter(|_| verdict.level != Level::Good) {
        return wording::advice(&found.finding).into();
    }
    match verdict.level {
        Level::Good => "use the model. “dynoid can” states whether the bench can run a test; “dynoid export” writes the model for a \
                        simulation."
            .into(),
        _ => "“dynoid experiment next” names the recording that improves the model most.".into(),
    }
}
