//! `dynoid shaft`: the shaft of every recording and of all together.

use bench::shaft_study::{Routes, ShaftRecording, ShaftStudy, Together, shaft_study};
use bench::study::Estimate;
use bench::torque_signals::Told;
use report::shaft::{beyond, doubts, dual_mass, figures, term, term_interval, term_value, term_verdict, together};
use report::torque::untold;
use report::wording::number;
use serde_json::json;

use super::experiments::{self, Campaign, print_parameters};
use super::identify::judge::{picture, written};
use crate::cli::shaft::ShaftArguments;
use crate::error::{CliError, Outcome};
use crate::table::{Align, Style, Table};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &ShaftArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let Campaign { bench, experiments, refused } = experiments::all((&arguments.given, &arguments.result), terminal)?;
    let progress = terminal.progress(experiments.len() as u64);
    let study = shaft_study(&experiments.iter().collect::<Vec<_>>(), &bench, &|file| {
        progress.say(&format!("looking at the shaft in {file}"));
        progress.step();
    });
    drop(progress);
    picture(&arguments.result, "Shaft", || figures(&study))?;
    if arguments.result.json {
        terminal.json(&json!({"recordings": study.recordings, "together": study.together, "refused": refused}))?;
    } else if !terminal.is_quiet() {
        print(&study, terminal);
        written(&arguments.result.plot, terminal);
    }
    Ok(if refused.is_empty() { Outcome::Done } else { Outcome::SomeUnreadable })
}

fn print(study: &ShaftStudy, terminal: &mut Terminal) {
    if study.recordings.is_empty() {
        terminal.line("none of these recordings has a shaft: run BS_T_NT or WhiteNoise_T_TN with the shaft on");
    }
    for recording in &study.recordings {
        terminal.heading(&format!("{}, {}", recording.file, recording.label), Style::Bold);
        match &recording.shaft {
            Told::Found(shaft) => {
                print_parameters(shaft.estimate.parameters.iter().chain([&shaft.zero]), terminal);
                print_rest(recording, &shaft.ignoring_timing, terminal);
            }
            Told::Untold(why) => terminal.line(&format!("shaft: {}", untold(why))),
        }
        terminal.gap();
    }
    if let Some(all) = &study.together {
        print_together(all, terminal);
    }
}

fn print_rest(recording: &ShaftRecording, ignoring_timing: &Estimate, terminal: &mut Terminal) {
    bands(recording, ignoring_timing, terminal);
    routes(recording, terminal);
    match &recording.inertias {
        Some(Told::Found(estimate)) => {
            terminal.line("As if nothing were known of the inertias:");
            let told = ["K", "B", "J_d", "J_e"];
            print_parameters(told.iter().filter_map(|s| estimate.parameter(s)), terminal);
        }
        Some(Told::Untold(why)) => terminal.line(&format!("inertias: {}", untold(why))),
        None => terminal.line("J_e is not told here: run WhiteNoise_T_TN or Multisine_T_TN on a bench with load cell"),
    }
    match &recording.beyond {
        Told::Found(found) => {
            let columns = [
                ("beyond K and B", Align::Left),
                ("estimate", Align::Right),
                ("95 % interval", Align::Right),
                ("verdict", Align::Left),
            ];
            let mut table = Table::new(&columns);
            for test in &found.tests {
                table.row([
                    term(test.term).into(),
                    term_value(test).into(),
                    term_interval(test).into(),
                    term_verdict(test).into(),
                ]);
            }
            terminal.table(&table);
            terminal.paragraph(&beyond(found));
        }
        Told::Untold(why) => terminal.line(&format!("beyond K and B: {}", untold(why))),
    }
    match &recording.dual_mass {
        Some(Told::Found(found)) => {
            terminal.line("As a shaft with a dual-mass flywheel:");
            print_parameters(&found.estimate.parameters, terminal);
            terminal.paragraph(&dual_mass(found, recording.beyond.found().map(|beyond| beyond.simple_misfit)));
        }
        Some(Told::Untold(why)) => terminal.line(&format!("dual-mass flywheel: {}", untold(why))),
        None => {}
    }
}

/// K, B and, where a route tells them, both inertias.
fn routes(recording: &ShaftRecording, terminal: &mut Terminal) {
    let Routes { state_space, black_box, multisine } = &recording.routes;
    let estimates = [
        ("state space (T_d, ω_e) → ω_d", state_space.as_ref().map(|told| told.as_ref().map(|r| &r.estimate))),
        ("black box T_d → ω_d", black_box.as_ref().map(|told| told.as_ref().map(|r| &r.estimate))),
        ("means over periods", multisine.as_ref().map(|told| told.as_ref().map(|r| &r.estimate))),
    ];
    let columns = [
        ("other routes", Align::Left),
        ("K", Align::Right),
        ("B", Align::Right),
        ("J_d", Align::Right),
        ("J_e", Align::Right),
    ];
    let mut table = Table::new(&columns);
    let mut reasons = Vec::new();
    for (route, told) in estimates.iter().filter_map(|(route, told)| Some((*route, told.as_ref()?))) {
        match told {
            Ok(estimate) => {
                let shown = |symbol| estimate.parameter(symbol).map_or_else(|| "–".to_owned(), number::parameter);
                table.row([
                    route.into(),
                    shown("K").into(),
                    shown("B").into(),
                    shown("J_d").into(),
                    shown("J_e").into(),
                ]);
            }
            Err(why) => reasons.push(format!("{route}: {}", untold(why))),
        }
    }
    terminal.table(&table);
    reasons.iter().for_each(|reason| terminal.line(reason));
    if let Some(Told::Found(found)) = black_box {
        doubts(found).iter().for_each(|doubt| terminal.paragraph(doubt));
    }
}

fn bands(recording: &ShaftRecording, ignoring_timing: &Estimate, terminal: &mut Terminal) {
    let columns = ["band, Hz", "K", "B", "K, time stamps taken as exact", "B, so"].map(|name| (name, Align::Right));
    let mut table = Table::new(&columns);
    // At zero, where it can go no further, a parameter is without uncertainty and tells nothing.
    let shown = |estimate: &Estimate, symbol| {
        let told = estimate.parameter(symbol).filter(|p| p.standard_error > 0.0);
        told.map_or_else(|| "–".to_owned(), number::parameter)
    };
    let mut row = |name: String, own: &Estimate, naive: &Estimate| {
        table.row([
            name.into(),
            shown(own, "K").into(),
            shown(own, "B").into(),
            shown(naive, "K").into(),
            shown(naive, "B").into(),
        ]);
    };
    for band in &recording.bands {
        row(format!("{} … {}", band.band_hz.0, band.band_hz.1), &band.estimate, &band.ignoring_timing);
    }
    if let Told::Found(shaft) = &recording.shaft {
        row("all".to_owned(), &shaft.estimate, ignoring_timing);
    }
    terminal.table(&table);
}

fn print_together(all: &Together, terminal: &mut Terminal) {
    terminal.heading("All recordings together", Style::Bold);
    print_parameters([&all.stiffness.parameter, &all.damping.parameter], terminal);
    terminal.paragraph(&together(all));
}
