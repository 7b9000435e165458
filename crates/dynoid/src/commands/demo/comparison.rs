//! The estimates of the demo beside the truth.

use std::path::Path;

use page::{Align, Cell, Table, Tone};
use report::wording::number;
use rig::bench_parameters::BenchParameters;
use rig::results::Parameter;
use serde::Serialize;
use study::Study;

use crate::summary::{self, Written};

/// Relative difference of numbers that are the same but for rounding.
const ROUNDING: f64 = 1e-9;

/// One quantity, estimated or not, beside its true value.
#[derive(Debug, Serialize)]
pub(super) struct Row<'a> {
    quantity: &'static str,
    symbol: &'static str,
    unit: &'static str,
    truth: f64,
    estimate: Option<&'a Parameter>,
    contains_truth: Option<bool>,
}

/// The quantities whose truth is known, in the order of the report.
pub(super) fn rows<'a>(study: &'a Study, parameters: &BenchParameters) -> Vec<Row<'a>> {
    let truth = virtual_bench::Truth::of(parameters);
    let controller = |symbol| study.speed_controller.estimated().and_then(|part| part.estimate.parameter(symbol));
    let feed_forward = |symbol| study.feed_forward.estimated().and_then(|part| part.estimate.parameter(symbol));
    let shaft = |symbol| study.shaft.estimated().and_then(|part| part.estimate.parameter(symbol));
    let torque_delay = study.torque_control.estimated().and_then(|part| part.delay_and_lag.parameter("τ + 1/a"));
    let resonance = study.whole.estimated().map(|part| &part.resonance_hz);
    let row = |quantity, symbol, unit, truth: f64, estimate: Option<&'a Parameter>| {
        let contains_truth = estimate.map(|estimate| contains(estimate.interval, truth));
        Row { quantity, symbol, unit, truth, estimate, contains_truth }
    };
    vec![
        row("shaft stiffness", "K", "Nm/rad", truth.stiffness_nm_per_rad, shaft("K")),
        row("shaft damping", "B", "Nm s/rad", truth.damping_nm_s_per_rad, shaft("B")),
        row("proportional gain", "K_p", "Nm/rpm", truth.proportional_nm_per_rpm, controller("K_p")),
        row("integral gain", "K_i", "Nm/(rpm s)", truth.integral_nm_per_rpm_s, controller("K_i")),
        row("controller delay", "τ", "s", truth.controller_delay_s, controller("τ")),
        row("feed-forward of speed", "k", "Nm/rpm", truth.speed_feed_forward_nm_per_rpm, feed_forward("k")),
        row(
            "feed-forward of acceleration",
            "k_a",
            "Nm/(rpm/s)",
            truth.acceleration_feed_forward_nm_s_per_rpm,
            feed_forward("k_a"),
        ),
        row("torque control, total delay", "τ + 1/a", "s", truth.torque_control_delay_s, torque_delay),
        row("resonance of T_d → T_shaft", "f_r", "Hz", truth.resonance_hz, resonance),
    ]
}

/// Whether the interval contains the value, but for the rounding of computed numbers.
fn contains((low, high): (f64, f64), value: f64) -> bool {
    let rounding = ROUNDING * value.abs();
    low - rounding <= value && value <= high + rounding
}

/// The rows as a table.
pub(super) fn table(rows: &[Row<'_>]) -> Table {
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

/// What to make of the table.
pub(super) fn remark(rows: &[Row<'_>]) -> String {
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
    comparison: &'a [Row<'a>],
    study: summary::Short<'a>,
}

impl<'a> Document<'a> {
    pub(super) fn new(seed: u64, written: &'a Written, bench_file: &'a Path, rows: &'a [Row<'a>]) -> Self {
        Document { seed, bench_file, comparison: rows, study: summary::short(written) }
    }
}
