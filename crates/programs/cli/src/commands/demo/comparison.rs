//! The estimates of the demo beside the truth.

use std::path::Path;

use dynoid::WrittenStudy;
use page::{Align, Cell, Table, Tone};
use report::wording::number;
use rig::bench_parameters::BenchParameters;
use rig::results::{Notation, Parameter, Quantity, WrittenParameter};
use serde::Serialize;
use study::Study;

use crate::summary;

/// Relative difference of numbers that are the same but for rounding.
const ROUNDING: f64 = 1e-9;

/// One quantity, estimated or not, beside its true value.
#[derive(Debug, Serialize)]
pub(super) struct Row {
    quantity: &'static str,
    symbol: &'static str,
    unit: &'static str,
    truth: f64,
    estimate: Option<WrittenParameter>,
    contains_truth: Option<bool>,
}

/// The quantities whose truth is known, in the order of the report.
pub(super) fn rows(study: &Study, parameters: &BenchParameters) -> Vec<Row> {
    let truth = virtual_bench::Truth::of(parameters);
    let controller = |quantity| study.speed_controller.estimated().and_then(|part| part.estimate.parameter(quantity));
    let feed_forward = |quantity| study.feed_forward.estimated().and_then(|part| part.estimate.parameter(quantity));
    let shaft = |quantity| study.shaft.estimated().and_then(|part| part.estimate.parameter(quantity));
    let torque = |quantity| study.torque_control.estimated().and_then(|part| part.delay_and_lag.parameter(quantity));
    let resonance = study.whole.estimated().map(|part| &part.resonance_hz);
    let row = |quantity, of: Quantity, truth: f64, estimate: Option<&Parameter>| {
        let Notation { symbol, unit, per_si, .. } = of.notation();
        let contains_truth = estimate.map(|estimate| contains(estimate.interval, truth));
        let estimate = estimate.map(Parameter::written);
        Row { quantity, symbol, unit, truth: per_si * truth, estimate, contains_truth }
    };
    vec![
        row("shaft stiffness", Quantity::Stiffness, truth.stiffness_nm_per_rad, shaft(Quantity::Stiffness)),
        row("shaft damping", Quantity::Damping, truth.damping_nm_s_per_rad, shaft(Quantity::Damping)),
        row(
            "proportional gain",
            Quantity::ProportionalGain,
            truth.proportional_nm_s_per_rad,
            controller(Quantity::ProportionalGain),
        ),
        row("integral gain", Quantity::IntegralGain, truth.integral_nm_per_rad, controller(Quantity::IntegralGain)),
        row(
            "controller delay",
            Quantity::ControllerDelay,
            truth.controller_delay_s,
            controller(Quantity::ControllerDelay),
        ),
        row(
            "feed-forward of speed",
            Quantity::SpeedFeedForward,
            truth.speed_feed_forward_nm_s_per_rad,
            feed_forward(Quantity::SpeedFeedForward),
        ),
        row(
            "feed-forward of acceleration",
            Quantity::AccelerationFeedForward,
            truth.acceleration_feed_forward_nm_s2_per_rad,
            feed_forward(Quantity::AccelerationFeedForward),
        ),
        row(
            "torque control, total delay",
            Quantity::TorqueControlTotalDelay,
            truth.torque_control_delay_s,
            torque(Quantity::TorqueControlTotalDelay),
        ),
        row("resonance of T_d → T_shaft", Quantity::ResonanceFrequency, truth.resonance_hz, resonance),
    ]
}

/// Tells whether the interval contains the value, but for the rounding of computed numbers.
fn contains((low, high): (f64, f64), value: f64) -> bool {
    let rounding = ROUNDING * value.abs();
    low - rounding <= value && value <= high + rounding
}

/// The rows as a table.
pub(super) fn table(rows: &[Row]) -> Table {
    let headings = ["", "", "estimated", "95 % interval", "true value", "inside"];
    let mut table = Table::new(&headings.map(|heading| (heading, Align::Left)));
    for row in rows {
        let (estimated, interval) = match row.estimate {
            Some(parameter) => (number::parameter(parameter), number::interval(parameter)),
            None => ("not estimated".to_owned(), String::new()),
        };
        table.row([
            row.quantity.into(),
            row.symbol.into(),
            estimated.into(),
            interval.into(),
            number::significant_with_unit(row.truth, 5, row.unit).into(),
            match row.contains_truth {
                Some(true) => Cell::toned("yes", Tone::Good),
                Some(false) => Cell::toned("NO", Tone::Bad),
                None => Cell::from("–"),
            },
        ]);
    }
    table
}

/// Remark on the table.
pub(super) fn remark(rows: &[Row]) -> String {
    let judged = rows.iter().filter(|row| row.contains_truth.is_some()).count();
    let inside = rows.iter().filter(|row| row.contains_truth == Some(true)).count();
    format!(
        "{inside} of {judged} intervals contain the true value. Of 95 % intervals, one in twenty may miss it; try other \
         seeds with --seed."
    )
}

/// The demo as JSON.
#[derive(Serialize)]
pub(super) struct Document<'a> {
    seed: u64,
    bench_file: &'a Path,
    comparison: &'a [Row],
    study: summary::Short<'a>,
}

impl<'a> Document<'a> {
    pub(super) fn new(seed: u64, written: &'a WrittenStudy, bench_file: &'a Path, rows: &'a [Row]) -> Self {
        Document { seed, bench_file, comparison: rows, study: summary::short(written) }
    }
}
