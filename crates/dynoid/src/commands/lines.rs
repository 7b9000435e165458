//! `dynoid lines`: what recordings show before any model.

use bench::look::{
    BANDWIDTH_ORDERS, FEWEST_SAMPLES, Look, LookedPart, LookedSignal, OverSpeed, TURNS, look, on_one_mains, over_speed,
};
use bench::units::si_spelling;
use page::{Align, Table, Tone};
use report::look::{cause, figure, over_speed_figures, unit};
use report::wording::number;
use serde_json::json;

use super::experiments;
use super::identify::judge::{picture, written};
use crate::cli::lines::LinesArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &LinesArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let mut looks = Vec::new();
    let refused =
        experiments::each((&arguments.given, &arguments.result), "looking at", terminal, |bench, experiment| {
            looks.push(look(&experiment, bench.engine()));
        })?;
    let looks = on_one_mains(looks);
    looks.iter().filter_map(nothing_seen).for_each(|reason| terminal.warning(&reason));
    let signals = over_speed(&looks);
    let over = match &looks[..] {
        [one] => one.file.clone(),
        _ => "All recordings".to_owned(),
    };
    picture(&arguments.result, "Lines of the recordings", || {
        let spectra = looks.iter().flat_map(|look| look.parts.iter().map(move |part| figure(look, part)));
        over_speed_figures(&over, &signals).into_iter().chain(spectra).collect()
    })?;
    if arguments.result.json {
        terminal.json(&json!({
            "recordings": looks.iter().map(short).collect::<Vec<_>>(),
            "over_speed": signals.iter().map(orders).collect::<Vec<_>>(),
            "refused": refused,
        }))?;
    } else if !terminal.is_quiet() {
        looks.iter().for_each(|look| print(look, arguments.lines, terminal));
        print_orders(&over, &signals, terminal);
        written(&arguments.result.plot, terminal);
    }
    Ok(Outcome::of(looks.iter().any(|look| nothing_seen(look).is_none()), &refused))
}

/// Why a recording shows nothing at all.
fn nothing_seen(look: &Look) -> Option<String> {
    if look.parts.is_empty() {
        let remedy = "name the channel of N_e or N_d in the bench file";
        return Some(format!("{}: no speed is recorded, and lines are told by what follows it; {remedy}", look.file));
    }
    let is_empty = look.parts.iter().all(|part| part.signals.is_empty());
    let needs = format!("a signal needs {FEWEST_SAMPLES} samples in a row, and has to change");
    is_empty.then(|| format!("{}: nothing in it makes a spectrum; {needs}", look.file))
}

/// The lines without the spectra they stand in.
fn short(look: &Look) -> serde_json::Value {
    let signal = |signal: &LookedSignal| {
        json!({"role": signal.role, "unit": si_spelling(signal.role.quantity()),
            "sample_time_s": signal.sample_time_s, "lines": signal.lines, "tracks": signal.tracks})
    };
    let part = |part: &LookedPart| {
        json!({"start_s": part.start_s, "end_s": part.end_s, "speed_rad_s": part.speed_rad_s,
            "speed_range_rad_s": part.speed_range_rad_s, "demanded_hz": part.demanded_hz, "signals": part.signals.iter().map(signal).collect::<Vec<_>>()})
    };
    json!({"file": look.file, "label": look.label, "parts": look.parts.iter().map(part).collect::<Vec<_>>()})
}

/// The orders over the speed without the map they stand in.
fn orders(signal: &OverSpeed) -> serde_json::Value {
    json!({"role": signal.role, "unit": si_spelling(signal.role.quantity()), "speed_rad_s": signal.speed_rad_s,
        "bandwidth_orders": BANDWIDTH_ORDERS, "orders": signal.orders, "staying": signal.staying})
}

/// Each order with where it is largest.
fn print_orders(over: &str, signals: &[OverSpeed], terminal: &mut Terminal) {
    let Some(first) = signals.first() else { return };
    let [low, high] = first.speed_rad_s.map(number::rpm);
    terminal.heading(&format!("{over}: orders over the speed, {low} to {high}"), Tone::Strong);
    let columns = [
        ("signal", Align::Left),
        ("order", Align::Left),
        ("largest", Align::Right),
        ("standard error", Align::Right),
        ("at", Align::Right),
        ("Hz", Align::Right),
    ];
    let mut table = Table::new(&columns);
    for signal in signals {
        let (unit, per_si) = unit(signal.role);
        for (index, curve) in signal.orders.iter().enumerate() {
            let Some(peak) = curve.peak() else { continue };
            let name = if index == 0 { signal.role.symbol().to_owned() } else { String::new() };
            let firing = if curve.is_firing { ", firing" } else { "" };
            table.row([
                name.into(),
                format!("{}{firing}", curve.order).into(),
                number::significant_with_unit(per_si * peak.amplitude, 3, unit).into(),
                number::significant_with_unit(per_si * peak.standard_error, 2, unit).into(),
                number::rpm(peak.speed_rad_s).into(),
                format!("{:.1}", curve.at_hz(peak.speed_rad_s)).into(),
            ]);
        }
    }
    terminal.table(&table);
    terminal.line(&format!("Least squares in windows of {TURNS} turns: a bandwidth of {BANDWIDTH_ORDERS} orders."));
    terminal.gap();
}

fn print(look: &Look, most: usize, terminal: &mut Terminal) {
    for part in &look.parts {
        let over = format!("{} to {} s", number::significant(part.start_s, 4), number::significant(part.end_s, 4));
        terminal.heading(&format!("{}, {over}, {}", look.file, number::rpm(part.speed_rad_s)), Tone::Strong);
        let columns =
            [("signal", Align::Left), ("Hz", Align::Right), ("amplitude", Align::Right), ("what it is", Align::Left)];
        let mut table = Table::new(&columns);
        for signal in &part.signals {
            let (unit, per_si) = unit(signal.role);
            let shown = if most == 0 { signal.lines.len() } else { most };
            for (index, line) in signal.lines.iter().take(shown).enumerate() {
                let name = if index == 0 { signal.role.symbol().to_owned() } else { String::new() };
                let amplitude = number::significant_with_unit(per_si * line.amplitude, 3, unit);
                let hz = format!("{:.2}", line.frequency_hz);
                table.row([name.into(), hz.into(), amplitude.into(), cause(&line.cause).into()]);
            }
            if signal.lines.len() > shown {
                let more = format!("{} weaker ones; --lines 0 shows them", signal.lines.len() - shown);
                table.row(["".into(), "".into(), "".into(), more.into()]);
            }
        }
        terminal.table(&table);
        terminal.gap();
    }
}
