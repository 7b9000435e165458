//! `dynoid look`: what recordings show before any model.

use bench::look::{Look, LookedPart, LookedSignal, look};
use bench::model::Engine;
use bench::units::si_spelling;
use report::look::{cause, figure, unit};
use report::wording::number;
use serde_json::json;

use super::experiments;
use super::identify::judge::{picture, written};
use crate::cli::look::LookArguments;
use crate::error::{CliError, Outcome};
use crate::table::{Align, Style, Table};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &LookArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let mut looks = Vec::new();
    let refused =
        experiments::each((&arguments.given, &arguments.result), "looking at", terminal, |bench, experiment| {
            looks.push(look(&experiment, Engine { cylinders: bench.cylinders, strokes: bench.strokes }));
        })?;
    picture(&arguments.result, "Lines of the recordings", || {
        looks.iter().flat_map(|look| look.parts.iter().map(|part| figure(&look.file, part))).collect()
    })?;
    if arguments.result.json {
        terminal.json(&json!({"recordings": looks.iter().map(short).collect::<Vec<_>>(), "refused": refused}))?;
    } else if !terminal.is_quiet() {
        looks.iter().for_each(|look| print(look, arguments.lines, terminal));
        written(&arguments.result.plot, terminal);
    }
    Ok(if refused.is_empty() { Outcome::Done } else { Outcome::SomeUnreadable })
}

/// The lines without the spectra they stand in.
fn short(look: &Look) -> serde_json::Value {
    let signal = |signal: &LookedSignal| {
        json!({"role": signal.role, "unit": si_spelling(signal.role.quantity()),
            "sample_time_s": signal.sample_time_s, "lines": signal.lines})
    };
    let part = |part: &LookedPart| {
        json!({"start_s": part.start_s, "end_s": part.end_s, "speed_rad_s": part.speed_rad_s,
            "demanded_hz": part.demanded_hz, "signals": part.signals.iter().map(signal).collect::<Vec<_>>()})
    };
    json!({"file": look.file, "label": look.label, "parts": look.parts.iter().map(part).collect::<Vec<_>>()})
}

fn print(look: &Look, most: usize, terminal: &mut Terminal) {
    for part in &look.parts {
        let over = format!("{} to {} s", number::significant(part.start_s, 4), number::significant(part.end_s, 4));
        terminal.heading(&format!("{}, {over}, {}", look.file, number::rpm(part.speed_rad_s)), Style::Bold);
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
