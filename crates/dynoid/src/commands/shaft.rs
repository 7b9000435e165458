//! `dynoid shaft`: the shaft of every recording and of all together.

use bench::shaft_study::{ShaftRecording, ShaftStudy, Together, shaft_study};
use bench::study::Estimate;
use bench::torque_signals::Told;
use page::{Align, Table, Tone};
use report::shaft::{
    beyond, dual_mass, figures, route_remarks, routes, routes_not_taken, term, term_interval, term_value, term_verdict,
    together,
};
use report::torque::untold;
use report::wording::number;
use serde_json::json;

use super::experiments::{self, Campaign, print_parameters};
use super::identify::judge::{picture, written};
use crate::cli::shaft::ShaftArguments;
use crate::error::{CliError, Outcome};
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
        terminal.heading(&format!("{}, {}", recording.file, recording.label), Tone::Strong);
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
    routes_not_taken(study).iter().for_each(|why| terminal.paragraph(why));
}

fn print_rest(recording: &ShaftRecording, ignoring_timing: &Estimate, terminal: &mut Terminal) {
    bands(recording, ignoring_timing, terminal);
    by_route(recording, terminal);
    match &recording.inertias {
        Some(Told::Found(estimate)) => {
            terminal.line("As if nothing were known of the inertias:");
            let told = ["K", "B", "J_d", "J_e"];
            print_parameters(told.iter().filter_map(|s| estimate.parameter(s)), terminal);
        }
        Some(Told::Untold(why)) => terminal.line(&format!("inertias: {}", untold(why))),
        None if recording.routes.black_box.is_some() => {}
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
fn by_route(recording: &ShaftRecording, terminal: &mut Terminal) {
    let columns = [
        ("by different routes", Align::Left),
        ("K", Align::Right),
        ("B", Align::Right),
        ("J_d", Align::Right),
        ("J_e", Align::Right),
    ];
    let mut table = Table::new(&columns);
    let mut reasons = Vec::new();
    let routes = routes(recording);
    for route in &routes {
        match route.told {
            Ok(estimate) => {
                let shown = |symbol| estimate.parameter(symbol).map_or_else(|| "–".to_owned(), number::parameter);
                let [k, b, dyno, engine] = ["K", "B", "J_d", "J_e"].map(shown);
                table.row([route.name.into(), k.into(), b.into(), dyno.into(), engine.into()]);
            }
            Err(why) => reasons.push(format!("{}: {}", route.name, untold(why))),
        }
    }
    if routes.len() > 1 {
        terminal.table(&table);
    }
    reasons.iter().chain(&route_remarks(recording)).for_each(|remark| terminal.paragraph(remark));
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
    terminal.heading("All recordings together", Tone::Strong);
    print_parameters([&all.stiffness.parameter, &all.damping.parameter], terminal);
    terminal.paragraph(&together(all));
}
