//! `dynoid torque-signals`: the torque signals held against each other, and the shaft torque rebuilt.

use std::path::Path;

use bench::study::SignalDelay;
use bench::torque_signals::{Told, TorqueRecording, TorqueSignals, torque_signals};
use page::{Align, Table, Tone};
use report::torque::{NO_TRUST, agreement, early_signals, figures, lateness, routes, shaft_filter, trust, untold};
use report::wording::number;
use serde_json::json;

use super::experiments::{self, Campaign, print_parameters};
use super::identify::judge::{picture, written};
use super::rebuilt::{self, Rebuilt};
use crate::cli::torque_signals::TorqueSignalsArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &TorqueSignalsArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    rebuilt::check(arguments.out.as_deref(), &arguments.given)?;
    let Campaign { bench, experiments, refused } = experiments::all((&arguments.given, &arguments.result), terminal)?;
    let progress = terminal.progress(experiments.len() as u64);
    let signals = torque_signals(&experiments.iter().collect::<Vec<_>>(), &bench, &mut |file| {
        progress.say(&format!("looking at the torques of {file}"));
        progress.step();
    });
    drop(progress);
    picture(&arguments.result, "Torque signals", || figures(&signals))?;
    if let Some(out) = &arguments.out {
        write(&signals, out, terminal)?;
    }
    if arguments.result.json {
        let recordings: Vec<_> = signals.recordings.iter().map(short).collect();
        terminal.json(&json!({"recordings": recordings, "trust": signals.trust, "refused": refused}))?;
    } else if !terminal.is_quiet() {
        signals.recordings.iter().for_each(|recording| print(recording, terminal));
        print_all(&signals, terminal);
        [&arguments.out, &arguments.result.plot].into_iter().for_each(|path| written(path, terminal));
    }
    Ok(Outcome::of(signals.recordings.iter().any(tells) || signals.trust.is_some(), &refused))
}

/// Whether a recording tells anything at all.
fn tells(recording: &TorqueRecording) -> bool {
    let filter = recording.filter.as_ref().is_some_and(|told| told.found().is_some());
    let shaft = recording.shaft.as_ref().is_some_and(|told| told.found().is_some());
    recording.delays.found().is_some() || filter || shaft
}

/// A recording's results without the samples of the shaft torque.
fn short(recording: &TorqueRecording) -> serde_json::Value {
    let shaft = recording.shaft.as_ref().map(|told| match told {
        Told::Found(shaft) => json!({"found": {
            "start_s": shaft.start_s, "sample_time_s": shaft.sample_time_s, "samples": shaft.smoothed_nm.len(),
            "torque": shaft.torque, "noise": shaft.noise, "once_a_turn": shaft.once_a_turn,
        }}),
        Told::Untold(why) => json!({"untold": why}),
    });
    json!({"file": recording.file, "label": recording.label, "delays": recording.delays, "filter": recording.filter,
        "shaft": shaft})
}

fn print(recording: &TorqueRecording, terminal: &mut Terminal) {
    terminal.heading(&format!("{}, {}", recording.file, recording.label), Tone::Strong);
    match &recording.delays {
        Told::Found(delays) => print_delays(delays, terminal),
        Told::Untold(why) => terminal.line(&format!("delays: {}", untold(why))),
    }
    match &recording.filter {
        Some(Told::Found(filter)) => terminal.line(&format!("T_d,shaft,calc: {}", shaft_filter(filter))),
        Some(Told::Untold(why)) => terminal.line(&format!("T_d,shaft,calc: {}", untold(why))),
        None => {}
    }
    match &recording.shaft {
        Some(Told::Found(shaft)) => terminal.line(&format!("T_shaft rebuilt: {}", report::torque::rebuilt(shaft))),
        Some(Told::Untold(why)) => terminal.line(&format!("T_shaft: {}", untold(why))),
        None => {}
    }
    terminal.gap();
}

fn print_delays(delays: &[SignalDelay], terminal: &mut Terminal) {
    let columns = [
        ("signal", Align::Left),
        ("behind T_d*", Align::Right),
        ("behind the bend of N_d", Align::Right),
        ("agree", Align::Left),
        ("behind T_d* by each route, 95 % intervals", Align::Left),
    ];
    let mut table = Table::new(&columns);
    for delay in delays {
        let shown = |p: &Option<bench::study::Parameter>| p.as_ref().map_or_else(|| "–".to_owned(), number::parameter);
        table.row([
            delay.role.symbol().into(),
            shown(&delay.against_demand).into(),
            shown(&delay.against_speed_bend).into(),
            agreement(delay).into(),
            routes(delay).join("; ").into(),
        ]);
    }
    terminal.table(&table);
    lateness(delays).into_iter().for_each(|text| terminal.line(&text));
    early_signals(delays).iter().for_each(|text| terminal.paragraph(text));
}

/// What all recordings tell together.
fn print_all(signals: &TorqueSignals, terminal: &mut Terminal) {
    if let Some((file, parameters)) = signals.load_cell() {
        terminal.heading(&format!("Load cell, from {file}"), Tone::Strong);
        print_parameters(parameters, terminal);
        terminal.gap();
    }
    match &signals.trust {
        Some(check) => terminal.paragraph(&trust(check)),
        None => terminal.paragraph(&format!("T_d,calc is not held against the load cell: {NO_TRUST}")),
    }
}

/// Writes the shaft torque of the one recording there is.
fn write(signals: &TorqueSignals, out: &Path, terminal: &mut Terminal) -> Result<(), CliError> {
    let recording = rebuilt::only(&signals.recordings, "the shaft torque", out)?;
    let shaft = match &recording.shaft {
        Some(Told::Found(shaft)) => shaft,
        Some(Told::Untold(why)) => {
            return Err(CliError::Usage { what: format!("{}: no shaft torque: {}", recording.file, untold(why)) });
        }
        None => {
            return Err(CliError::Usage {
                what: format!("{}: the shaft is off, so there is no shaft torque", recording.file),
            });
        }
    };
    let rebuilt = Rebuilt {
        comment: format!("shaft torque rebuilt from {}", recording.file),
        start_s: shaft.start_s,
        sample_time_s: shaft.sample_time_s,
        channels: vec![
            ("shaft_torque", "by a fixed-interval smoother", &shaft.smoothed_nm),
            (
                "shaft_torque_standard_deviation_without_encoder_error",
                "of the smoother, without what a once-a-turn error of the encoder adds",
                &shaft.standard_deviation_nm,
            ),
            ("shaft_torque_zero_phase", "by a filter without phase shift", &shaft.zero_phase_nm),
        ],
    };
    rebuilt::write(&rebuilt, out, terminal)
}
