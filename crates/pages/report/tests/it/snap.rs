//! Wording and structure, word for word.
#![allow(clippy::unwrap_used)]

use recording::RecordingError;
use report::wording::{self, number};
use rig::estimation::EstimateError;
use rig::results::{Notation, Part, Quantity, Reason, WrittenParameter};
use rig::{Diagnostic, ExperimentLabel, Finding, LikelyUnit, NotReplayed, Place, Role, SeenInstead, Severity};
use signal::proportion::Proportion;

use crate::fixture;

fn no_shaft() -> ExperimentLabel {
    "NoShaft_N_NT".parse().unwrap()
}

fn findings() -> Vec<Finding> {
    vec![
        Finding::UnreadableRecording { error: RecordingError::Empty { file: "bs.mf4".into() }.into() },
        Finding::ReaderDoubt { doubt: recording::Finding::NotFinalised.into() },
        Finding::NoLabel,
        Finding::NotReplayed { reason: NotReplayed::Lacks(Reason::Part { part: Part::SpeedController }) },
        Finding::NotReplayed { reason: NotReplayed::Clock { demand_s: 1e-3, controller_s: 2e-3 } },
        Finding::NotReplayed { reason: NotReplayed::NotSimulated },
        Finding::DuplicateRecording { other: "bs.mf4".into() },
        Finding::MissingChannel { role: Role::DynoSpeed, closest: vec!["N_dyn".into(), "Ndyno".into()] },
        Finding::MissingChannel { role: Role::Throttle, closest: Vec::new() },
        Finding::UnfitUnit { role: Role::AirGapTorque, unit: "kg".into() },
        Finding::NotANumber { count: 1, mended: true },
        Finding::NotANumber { count: 300, mended: false },
        Finding::Gap { duration_s: 0.012, mended: true },
        Finding::Gap { duration_s: 3.5, mended: false },
        Finding::ShortGaps { count: 7, longest_s: 0.012, share: 0.0004 },
        Finding::Cut { kept_s: (4.0, 31.5), lost_s: 12.25 },
        Finding::LeftOut { stretches_s: vec![(1.0, 2.5), (30.0, 40.0)], used_s: (2.5, 30.0), unused_s: 5.0 },
        Finding::LeftOut { stretches_s: vec![(30.0, 40.0)], used_s: (0.0, 30.0), unused_s: 0.0 },
        Finding::StretchOutside { from_s: 50.0, to_s: 60.0, recorded_s: (0.0, 40.0) },
        Finding::StretchOfNoRecording,
        Finding::TimeNotIncreasing,
        Finding::Bursts { sample_time_s: 1e-6, mean_s: 0.001 },
        Finding::SamplesRaised { every: 2, interpolated: false },
        Finding::SamplesRaised { every: 4, interpolated: true },
        Finding::SamplesRepeated { share: 0.3, longest_s: 0.004 },
        Finding::SamplesStraightened { share: 0.4 },
        Finding::Spikes { count: 1, farthest: 400.0 },
        Finding::Spikes { count: 12, farthest: 0.0 },
        Finding::SamplesFiltered { ratio: 0.0012 },
        Finding::SpeedSmoothed { mean_s: 0.0069, sample_time_s: 0.001 },
        Finding::TorquesDisagree {
            role: Role::DynoTorqueDemand,
            gain: 0.25,
            offset_nm: 0.04,
            looks_like: Some((Role::DynoTorqueDemand, LikelyUnit::PercentOfLimit)),
        },
        Finding::TorquesDisagree { role: Role::LoadCellTorque, gain: 1.002, offset_nm: 10.1, looks_like: None },
        Finding::LabelContradicted { label: ExperimentLabel::BS_T_NT, seen: SeenInstead::TorqueControl },
        Finding::LabelContradicted { label: ExperimentLabel::WHITE_NOISE_T_TN, seen: SeenInstead::SpeedControl },
        Finding::LabelContradicted { label: ExperimentLabel::BS_T_NT, seen: SeenInstead::SpeedDemandChanges },
        Finding::LabelContradicted { label: no_shaft(), seen: SeenInstead::ShaftOn },
        Finding::LabelContradicted { label: no_shaft(), seen: SeenInstead::LargerInertia { ratio: 1.47 } },
        Finding::FiringOrderDisagrees { stated: 3.0, found: 2.0 },
        Finding::PulsesOffSpeed { ratio: 1.0 / 1.01 },
        Finding::PulsesOffSpeed { ratio: 1.005 },
        Finding::PulsesOffShaft { frequency_hz: 91.0, ratio: 1.62 },
        Finding::ClockRate { found_hz: 99.01, mains_hz: 100.0 },
        Finding::ClockRate { found_hz: 126.0, mains_hz: 120.0 },
        Finding::LateSignal { role: Role::AirGapTorque, late_s: 0.008, standard_error_s: 4e-5 },
        Finding::LateSignal { role: Role::EngineSpeed, late_s: -0.0035, standard_error_s: 2e-5 },
        Finding::SlowRaster { sample_time_s: 0.01, is_in_ms: false },
        Finding::SlowRaster { sample_time_s: 1.0, is_in_ms: true },
        Finding::CoarseResolution { role: Role::DynoSpeed, step: 0.1047 },
        Finding::Jitter { largest_s: 0.00031, sample_time_s: 0.001 },
        Finding::Constant { value: -0.0 },
        Finding::Clipped { value: 400.04, share: 0.0312 },
        Finding::ImplausibleMagnitude { role: Role::EngineSpeed, largest: 15_000.0, looks_like: Some("rpm".into()) },
        Finding::SpeedsDisagree { role: Role::EngineSpeed, ratio_to_dyno_speed: 9.549 },
        Finding::SpeedsExchanged { misfit_ratio: 2991.8 },
        Finding::TorquesExchanged { demand: "T_calc".into(), torque: "T_dyno_dmd".into(), later_s: 3e-3 },
        Finding::TooShort { duration_s: 0.4, needed_s: 12.0 },
        Finding::WrongTorqueSign { correlation: -0.934 },
        Finding::ImplausibleInertia {
            inertia: Quantity::DynoInertia,
            given_kg_m2: 0.3,
            estimated_kg_m2: 0.412,
            standard_error_kg_m2: 0.006,
        },
        Finding::NoCheckOfShaft { quantity: Quantity::DynoInertia, value: 0.656, standard_error: 0.006 },
        Finding::NoCheckOfShaft { quantity: Quantity::AirGapTorqueSkew, value: 0.0095, standard_error: 6e-5 },
        Finding::Saturated { share: 0.00004, limit_nm: 400.0 },
        Finding::EarlySignal { role: Role::AirGapTorque, advance_s: 0.0009 },
        Finding::EarlySignal { role: Role::AirGapTorque, advance_s: 0.0036 },
        Finding::ExcludedLines { frequencies_hz: vec![25.0, 50.0, 74.8] },
        Finding::PulsesFoldToRest { role: Role::EngineSpeed, rate_hz: 500.0, firing_hz: 100.003, multiple: 5 },
        Finding::ResidualsCorrelated { submodel: Part::SpeedController, share_outside: 0.21 },
        Finding::NotConverged { submodel: Part::Shaft },
        Finding::RoutesDisagree { quantity: Quantity::Stiffness, first: (2438.0, 6.0), second: (2391.0, 5.2) },
    ]
}

#[test]
fn snap_findings() {
    let place = Place { file: Some("bs.mf4".into()), channel: Some("T_loadcell".into()), time_s: Some(12.348) };
    let lines: Vec<String> = findings()
        .into_iter()
        .map(|finding| wording::diagnostic(&Diagnostic { severity: Severity::Warning, place: place.clone(), finding }))
        .collect();
    insta::assert_snapshot!(lines.join("\n"));
}

#[test]
fn snap_needs() {
    let label = |text: &str| text.parse::<ExperimentLabel>().unwrap();
    let needs = [
        Reason::Recording { any_of: ["BS_T_NT", "WhiteNoise_T_TN"].map(label).to_vec() },
        Reason::Recording { any_of: vec![label("Custom_T_NT")] },
        Reason::Recording { any_of: Vec::new() },
        Reason::Channel { file: "bs.mf4".into(), role: Role::AirGapTorque },
        Reason::Part { part: Part::SpeedController },
        Reason::Error { file: Some("bs.mf4".into()) },
        Reason::Error { file: None },
        EstimateError::TooShort { file: "bs.mf4".into(), duration_s: 0.5, needed_s: 2.0 }.into(),
    ];
    let lines: Vec<String> = needs.iter().map(|need| format!("needs {}", wording::need(need))).collect();
    insta::assert_snapshot!(lines.join("\n"));
}

fn parameter(unit: &'static str, value: f64, below: f64, above: f64) -> String {
    let parameter = WrittenParameter {
        key: Quantity::Stiffness,
        notation: Notation { unit, ..Quantity::Stiffness.notation() },
        value,
        standard_error: below / 1.96,
        degrees_of_freedom: 100.0,
        interval: (value - below, value + above),
    };
    format!("{} | {}", number::parameter(parameter), number::interval(parameter))
}

#[test]
fn snap_numbers() {
    let lines = [
        parameter("Nm/rad", 2438.3, 12.2, 12.2),
        parameter("Nm/rad", 24_383.0, 1234.0, 1234.0),
        parameter("Nm/rad", 2438.0, 28.0, 52.0),
        parameter("s", 0.001_021, 0.000_025, 0.000_025),
        parameter("s", 0.000_051, 0.000_009_96, 0.000_009_96),
        parameter("s", 1.25, 0.03, 0.03),
        parameter("Nm/(rpm/s)", 0.000_018_4, 0.000_003_1, 0.000_003_1),
        parameter("", -0.004, 0.099_6, 0.099_6),
        parameter("Nm", 3.2e7, 4.1e5, 4.1e5),
        parameter("Nm", f64::NAN, 1.0, 1.0),
        parameter("Nm", 12.345_67, f64::INFINITY, f64::INFINITY),
        parameter("Nm", 12.345_67, 0.0, 0.0),
        [0.0, 0.000_4, 0.0312, 0.5, f64::NAN].map(number::share).join(", "),
        [(0, 200), (94, 100), (5, 5)].map(|(count, of)| number::proportion(&Proportion::new(count, of))).join(", "),
        [99.412, 95.36, -12.0, f64::NAN].map(number::fit).join(", "),
        [0.000_000_25, 0.0004, 0.012, 12.34, 119.96, 725.2, f64::NAN].map(number::duration).join(", "),
        [157.0796, 0.0].map(number::rpm).join(", "),
    ];
    insta::assert_snapshot!(lines.join("\n"));
}

#[test]
fn snap_every_role_and_mode_has_words() {
    let mut lines: Vec<String> = Role::ALL.iter().map(|role| wording::role(*role)).collect();
    lines.extend([rig::ControlMode::Nt, rig::ControlMode::Tn].map(|mode| wording::mode(mode).to_owned()));
    insta::assert_snapshot!(lines.join("\n"));
}

/// The page as a reader hears it: text without tags, figures and the pieces that do not depend on the study.
fn plain_text(page: &str) -> String {
    let body = page.split("<main>").nth(1).and_then(|rest| rest.split("<section id=\"methods\">").next());
    let mut text = String::new();
    let mut rest = body.unwrap_or_default();
    while let Some((before, behind)) = rest.split_once('<') {
        text.push_str(before);
        if behind.starts_with("script") {
            rest = behind.split_once("</script>").map_or("", |(_, after)| after);
            continue;
        }
        if behind.starts_with("div class=\"stage\"") {
            rest = behind.split_once("</div>").map_or("", |(_, after)| after);
            continue;
        }
        let (tag, after) = behind.split_once('>').unwrap_or((behind, ""));
        let inline = ["span", "/span", "sub", "/sub", "b>", "i>", "tspan", "/tspan", "small", "strong", "/strong"];
        if !inline.iter().any(|name| tag.starts_with(name.trim_end_matches('>'))) {
            text.push('\n');
        }
        rest = after;
    }
    let lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    lines.collect::<Vec<_>>().join("\n").replace('\u{a0}', " ").replace('\u{200b}', "")
}

#[test]
fn snap_text_of_a_study_without_estimates() {
    insta::assert_snapshot!(plain_text(&fixture::html(&fixture::bare())));
}

#[test]
fn snap_first_page_of_a_complete_study() {
    let page = fixture::html(&fixture::complete());
    let text = plain_text(&page);
    insta::assert_snapshot!(text.split("Speed control\nThe controller").next().unwrap_or_default());
}
