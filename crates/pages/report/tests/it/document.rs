//! The study as a document: what was written is read back.

use bench_model::document::JsonFault;
use rig::results::{Estimate, Quantity};
use study::Study;
use study::document::{DocumentError, SeriesFile, json, read};

use crate::fixture;

const SERIES: SeriesFile<'_> = SeriesFile { name: "series.parquet", sha256: "0123" };

/// The study that its document gives, with the values of its traces.
fn read_back(study: &Study) -> Study {
    let document = read(&json(study, Some(SERIES))).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(document.series_file.as_deref(), Some(SERIES.name));
    assert_eq!(document.series_sha256.as_deref(), Some(SERIES.sha256));
    let mut read = document.study;
    if let Some(table) = study::series(study) {
        read.take_series(&table);
    }
    read
}

#[test]
fn exact_a_study_that_is_read_is_written_the_same() {
    for study in [fixture::complete(), fixture::bare()] {
        assert_eq!(json(&read_back(&study), None), json(&study, None));
    }
}

#[test]
fn exact_a_study_is_read_as_it_was_written() {
    for study in [fixture::complete(), fixture::bare()] {
        let read = read_back(&study);
        // Numbers in the unit people read are rounded when they are written; all else is the same.
        assert_eq!(read_back(&read), read);
        assert_eq!(
            (&read.provenance, &read.bench, &read.recordings, &read.choices, &read.model),
            (&study.provenance, &study.bench, &study.recordings, &study.choices, &study.model)
        );
        assert_eq!(
            (&read.validity, &read.skews, &read.recorded_torque, &read.replays, &read.diagnostics),
            (&study.validity, &study.skews, &study.recorded_torque, &study.replays, &study.diagnostics)
        );
    }
}

#[test]
fn exact_numbers_in_the_unit_people_read_come_back_in_si() {
    let estimate = |study: &Study| study.speed_controller.estimated().unwrap().estimate.clone();
    let study = fixture::complete();
    let (read, written): (Estimate, Estimate) = (estimate(&read_back(&study)), estimate(&study));
    for (one, other) in read.parameters.iter().zip(&written.parameters) {
        assert_eq!(one.quantity, other.quantity);
        assert!((one.value - other.value).abs() <= 4.0 * f64::EPSILON * other.value.abs(), "{one:?}, {other:?}");
    }
    for (one, other) in read.covariance.iter().flatten().zip(written.covariance.iter().flatten()) {
        assert!((one - other).abs() <= 8.0 * f64::EPSILON * other.abs(), "{one}, {other}");
    }
}

#[test]
fn exact_each_quantity_is_known_by_symbol_and_name() {
    // serde lists every variant where it meets an unknown one.
    let listed = serde_json::from_str::<Quantity>("\"none\"").unwrap_err().to_string();
    assert_eq!(listed.matches('`').count() / 2 - 1, Quantity::ALL.len());
    let mut names: Vec<(&str, &str)> = Quantity::ALL.iter().map(|one| (one.symbol(), one.name())).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), Quantity::ALL.len());
}

#[test]
fn regress_a_damaged_study_is_refused_with_the_place() {
    let text = json(&fixture::complete(), None);
    let fault = |text: &str| match read(text) {
        Err(DocumentError::Damaged { fault }) => fault,
        other => panic!("{other:?}"),
    };
    assert!(matches!(fault(&text[..text.len() / 2]), JsonFault::Cut { .. }));
    let words = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        fault(&text.replacen(from, to, 1)).to_string()
    };
    let speed = words("\"duration_s\":", "\"duration_s\":true,\"was\":");
    assert!(speed.contains("study.recordings[0].duration_s") && speed.contains("true"), "{speed}");
    let status = words("\"status\":\"estimated\"", "\"status\":\"guessed\"");
    assert!(status.contains("guessed") && status.contains("study."), "{status}");
    let samples = words("\"samples\":", "\"samples\":99999999999,\"were\":");
    assert!(samples.contains("`study.") && samples.contains("99999999999"), "{samples}");
    let symbol = words("\"symbol\":\"K_p\"", "\"symbol\":\"K_q\"");
    assert!(symbol.contains("`study.") && symbol.contains("K_q"), "{symbol}");
}

#[test]
fn exact_another_version_and_another_format_are_refused() {
    let text = json(&fixture::bare(), None);
    let other = text.replace("\"format_version\":3", "\"format_version\":2");
    assert_eq!(read(&other), Err(DocumentError::OtherVersion { found: 2 }));
    assert_eq!(read(&text.replace("dynoid-study", "dynoid-model")), Err(DocumentError::NotAStudy));
    assert_eq!(read("{}"), Err(DocumentError::NotAStudy));
}
