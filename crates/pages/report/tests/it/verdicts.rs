//! The verdict's rules.

use rig::results::{Outcome, Part, Quantity};
use rig::{Diagnostic, Finding, Place, Severity};
use study::verdict;
use study::verdict::Level;

use crate::fixture;

fn without_errors() -> study::Study {
    let mut study = fixture::complete();
    study.diagnostics.retain(|found| found.severity != Severity::Error);
    study
}

#[test]
fn exact_a_study_without_errors_is_good() {
    let verdict = verdict(&without_errors());
    assert_eq!(verdict.level, Level::Good, "{verdict:#?}");
}

/// The verdict as a document has it, read again.
fn read_again(study: &study::Study) -> study::verdict::Verdict {
    let text = serde_json::to_string(&verdict(study)).unwrap();
    serde_json::from_str(&text).unwrap()
}

#[test]
fn exact_a_verdict_is_read_as_it_was_written() {
    let mut doubted = without_errors();
    doubted.diagnostics[0].finding = Finding::NotConverged { submodel: Part::Shaft };
    let routes = Finding::RoutesDisagree { quantity: Quantity::Stiffness, first: (1.0, 0.1), second: (2.0, 0.1) };
    doubted.diagnostics[1].finding = routes;
    for study in [fixture::complete(), fixture::bare(), without_errors(), doubted] {
        assert_eq!(read_again(&study), verdict(&study));
    }
}

#[test]
fn exact_an_error_is_a_reservation() {
    assert_eq!(verdict(&fixture::complete()).level, Level::Reservations);
}

#[test]
fn exact_a_late_signal_is_a_reservation() {
    let mut study = without_errors();
    let finding = Finding::LateSignal { role: rig::Role::EngineSpeed, late_s: 3e-3, standard_error_s: 1e-5 };
    study.diagnostics.push(Diagnostic { severity: Severity::Warning, place: Place::default(), finding });
    assert_eq!(verdict(&study).level, Level::Reservations);
}

#[test]
fn exact_no_shaft_is_insufficient_and_no_feed_forward_a_reservation() {
    let mut study = without_errors();
    study.feed_forward = Outcome::NotEstimated { needs: Vec::new() };
    assert_eq!(verdict(&study).level, Level::Reservations);
    study.shaft = Outcome::NotEstimated { needs: Vec::new() };
    assert_eq!(verdict(&study).level, Level::Insufficient);
}

#[test]
fn exact_poor_or_unknown_fits_lower_the_verdict() {
    for (fit, level) in [(79.9, Level::Reservations), (49.0, Level::Insufficient), (f64::NAN, Level::Insufficient)] {
        let mut study = without_errors();
        if let Outcome::Estimated(shaft) = &mut study.shaft {
            shaft.validation.fit_percent = fit;
        }
        assert_eq!(verdict(&study).level, level, "{fit}");
    }
}

#[test]
fn exact_wide_or_unknown_intervals_lower_the_verdict() {
    for (half, level) in [(0.2, Level::Reservations), (0.5, Level::Insufficient), (f64::NAN, Level::Insufficient)] {
        let mut study = without_errors();
        if let Outcome::Estimated(whole) = &mut study.whole {
            let value = whole.resonance_hz.value;
            whole.resonance_hz.interval = (value * (1.0 - half), value * (1.0 + half));
        }
        assert_eq!(verdict(&study).level, level, "{half}");
    }
}

#[test]
fn exact_only_unseen_replays_count() {
    let mut study = without_errors();
    study.replays.iter_mut().for_each(|replay| replay.seen_in_estimation = true);
    assert_eq!(verdict(&study).level, Level::Reservations);
}

#[test]
fn exact_correlated_residuals_are_a_reservation() {
    let mut study = without_errors();
    study.diagnostics[0].finding = Finding::ResidualsCorrelated { submodel: Part::Shaft, share_outside: 0.3 };
    assert_eq!(verdict(&study).level, Level::Reservations);
}
