//! `dynoid lines`: what recordings show before any model.

use part_lines::lines::{
    BANDWIDTH_ORDERS, FEWEST_SAMPLES, OverSpeed, PartLines, RecordingLines, SignalLines, find_lines, on_one_mains,
    over_speed,
};
use serde_json::json;
use units::si_spelling;

use super::experiments;
use super::result::show;
use crate::cli::lines::LinesArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &LinesArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let mut looks = Vec::new();
    let refused =
        experiments::each(&arguments.given, &arguments.result, "looking at", terminal, |bench, experiment| {
            looks.push(find_lines(&experiment, bench));
        })?;
    let looks = on_one_mains(looks);
    looks.iter().filter_map(nothing_seen).for_each(|reason| terminal.warning(&reason));
    let signals = over_speed(&looks);
    let page = || report::pages::lines(&looks, &signals, (arguments.lines, arguments.each));
    let json = || {
        json!({
            "recordings": looks.iter().map(short).collect::<Vec<_>>(),
            "over_speed": signals.iter().map(orders).collect::<Vec<_>>(),
            "refused": refused,
        })
    };
    show(&arguments.result, page, json, terminal)?;
    Ok(Outcome::of(looks.iter().any(|look| nothing_seen(look).is_none()), &refused))
}

/// Why a recording shows nothing at all.
fn nothing_seen(look: &RecordingLines) -> Option<String> {
    if look.parts.is_empty() {
        let remedy = "name the channel of N_e or N_d in the bench file";
        return Some(format!("{}: no speed is recorded, and the causes of lines follow from it; {remedy}", look.file));
    }
    let is_empty = look.parts.iter().all(|part| part.signals.is_empty());
    let needs = format!("a signal needs {FEWEST_SAMPLES} samples in a row, and has to change");
    is_empty.then(|| format!("{}: nothing in it makes a spectrum; {needs}", look.file))
}

/// The lines without their spectra.
fn short(look: &RecordingLines) -> serde_json::Value {
    let signal = |signal: &SignalLines| {
        json!({"role": signal.role, "unit": si_spelling(signal.role.quantity()),
            "sample_time_s": signal.sample_time_s, "lines": signal.lines, "tracks": signal.tracks})
    };
    let part = |part: &PartLines| {
        json!({"start_s": part.start_s, "end_s": part.end_s, "speed_rad_s": part.speed_rad_s,
            "speed_range_rad_s": part.speed_range_rad_s, "demanded_hz": part.demanded_hz, "signals": part.signals.iter().map(signal).collect::<Vec<_>>()})
    };
    json!({"file": look.file, "label": look.label, "parts": look.parts.iter().map(part).collect::<Vec<_>>()})
}

/// The orders over the speed without their map.
fn orders(signal: &OverSpeed) -> serde_json::Value {
    json!({"role": signal.role, "unit": si_spelling(signal.role.quantity()), "speed_rad_s": signal.speed_rad_s,
        "bandwidth_orders": BANDWIDTH_ORDERS, "orders": signal.orders, "staying": signal.staying})
}
