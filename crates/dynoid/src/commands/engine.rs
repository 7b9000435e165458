//! `dynoid engine`: the engine's torque, rebuilt.

use std::path::Path;

use bench::engine_torque::{Cycles, EngineRecording, EngineTorque, engine_torque};
use bench::torque_signals::Told;
use page::{Align, Table, Tone};
use report::engine::{CUT, cycles, cylinder_rows, cylinders, figures, masses};
use report::torque::untold;
use serde_json::json;

use super::experiments::{self, Campaign};
use super::identify::judge::{picture, written};
use super::rebuilt::{self, Rebuilt};
use crate::cli::engine::EngineArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &EngineArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    rebuilt::check(arguments.out.as_deref(), &arguments.given)?;
    let Campaign { bench, experiments, refused } = experiments::all((&arguments.given, &arguments.result), terminal)?;
    let progress = terminal.progress(experiments.len() as u64);
    progress.say("estimating the shaft");
    let found = engine_torque(&experiments.iter().collect::<Vec<_>>(), &bench, &|file| {
        progress.say(&format!("rebuilding the engine torque of {file}"));
        progress.step();
    });
    drop(progress);
    picture(&arguments.result, "Engine torque", || figures(&found))?;
    if let Some(out) = &arguments.out {
        write(&found, out, terminal)?;
    }
    if arguments.result.json {
        let recordings: Vec<_> = found.recordings.iter().map(short).collect();
        terminal.json(&json!({"masses": found.masses, "recordings": recordings, "refused": refused}))?;
    } else if !terminal.is_quiet() {
        match &found.masses {
            Told::Found(found) => terminal.paragraph(&masses(found)),
            Told::Untold(why) => terminal.paragraph(&format!("no recording tells the shaft: {}", untold(why))),
        }
        found.recordings.iter().for_each(|recording| print(recording, terminal));
        [&arguments.out, &arguments.result.plot].into_iter().for_each(|path| written(path, terminal));
    }
    let tells = found.recordings.iter().any(|recording| recording.engine.found().is_some());
    Ok(Outcome::of(tells, &refused))
}

/// A recording's results without the samples.
fn short(recording: &EngineRecording) -> serde_json::Value {
    let engine = match &recording.engine {
        Told::Found(engine) => json!({"found": {
            "start_s": engine.start_s, "sample_time_s": engine.sample_time_s, "samples": engine.smoothed_nm.len(),
            "torque": engine.torque, "noise": engine.noise, "once_a_turn_nm": engine.once_a_turn_nm,
        }}),
        Told::Untold(why) => json!({"untold": why}),
    };
    json!({"file": recording.file, "label": recording.label, "engine": engine, "cycles": recording.cycles})
}

fn print(recording: &EngineRecording, terminal: &mut Terminal) {
    terminal.gap();
    terminal.heading(&format!("{}, {}", recording.file, recording.label), Tone::Strong);
    match &recording.engine {
        Told::Found(engine) => terminal.paragraph(&format!("T_e rebuilt: {}.", report::engine::rebuilt(engine))),
        Told::Untold(why) => {
            terminal.line(&format!("T_e: {}", untold(why)));
            return;
        }
    }
    match &recording.cycles {
        Told::Found(found) => print_cycles(found, terminal),
        Told::Untold(why) => terminal.paragraph(&format!("Cycles and cylinders: {}.", untold(why))),
    }
}

fn print_cycles(found: &Cycles, terminal: &mut Terminal) {
    terminal.paragraph(&format!("{}; {}.", cycles(found), cylinders(&found.cylinders)));
    let columns = [
        ("fires as", Align::Right),
        ("T_e less the cycle's mean", Align::Right),
        ("varies from cycle to cycle by", Align::Right),
    ];
    let mut table = Table::new(&columns);
    for row in cylinder_rows(&found.cylinders) {
        table.row(row.map(Into::into));
    }
    terminal.table(&table);
    terminal.paragraph(&format!("{CUT}."));
}

/// Writes the engine torque of the one recording there is.
fn write(found: &EngineTorque, out: &Path, terminal: &mut Terminal) -> Result<(), CliError> {
    let recording = rebuilt::only(&found.recordings, "the engine torque", out)?;
    let engine = match &recording.engine {
        Told::Found(engine) => engine,
        Told::Untold(why) => {
            return Err(CliError::Usage { what: format!("{}: no engine torque: {}", recording.file, untold(why)) });
        }
    };
    let rebuilt = Rebuilt {
        comment: format!("engine torque rebuilt from {}", recording.file),
        start_s: engine.start_s,
        sample_time_s: engine.sample_time_s,
        channels: vec![
            ("engine_torque", "by a fixed-interval smoother", &engine.smoothed_nm),
            (
                "engine_torque_standard_deviation_without_encoder_error",
                "of noise, masses and shaft, without what a once-a-turn error of the encoder adds",
                &engine.standard_deviation_nm,
            ),
            ("engine_torque_zero_phase", "by a filter without phase shift", &engine.zero_phase_nm),
        ],
    };
    rebuilt::write(&rebuilt, out, terminal)
}
