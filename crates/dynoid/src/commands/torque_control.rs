//! `dynoid torque-control`: what the torque control can be told to be.

use bench::study::Parameter;
use bench::torque_control_study::{
    BlackBox, ChosenBy, Judgement, Model, OrdersTried, StudiedRecording, TorqueControlStudy, Visibility, study,
};
use bench::{BenchFile, Experiment};
use page::{Align, Table, Tone};
use report::inverter::{
    against_bar, belief, beyond, circular, closed, early, figures, first_visible, model, mover, recording_needed,
    structure, verdict,
};
use report::torque::untold;
use report::wording::number;
use serde_json::json;

use super::experiments::{self, Campaign};
use super::identify::judge::{picture, written};
use crate::cli::torque_control::TorqueControlArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// Steps of the progress.
const STEPS: u64 = 100;

pub(crate) fn run(arguments: &TorqueControlArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let Campaign { bench, experiments, refused } = experiments::all((&arguments.given, &arguments.result), terminal)?;
    let orders = OrdersTried { highest: arguments.highest_order, longest_delay: arguments.longest_delay };
    let studied = studied(&experiments, &bench, orders, terminal)?;
    picture(&arguments.result, "Torque control", || figures(&studied))?;
    if arguments.result.json {
        terminal.json(&json!({
            "recordings": studied.recordings, "judgements": studied.judgements, "visibility": studied.visibility,
            "untold": studied.untold, "refused": refused,
        }))?;
    } else if !terminal.is_quiet() {
        studied.recordings.iter().for_each(|recording| print(&studied, recording, terminal));
        studied.visibility.iter().for_each(|visibility| print_visibility(visibility, terminal));
        studied.untold.iter().for_each(|(file, why)| terminal.note(&format!("{file}: {}", untold(why))));
        written(&arguments.result.plot, terminal);
    }
    Ok(if refused.is_empty() { Outcome::Done } else { Outcome::SomeUnreadable })
}

fn studied(
    experiments: &[Experiment],
    bench: &BenchFile,
    orders: OrdersTried,
    terminal: &Terminal,
) -> Result<TorqueControlStudy, CliError> {
    let progress = terminal.progress(STEPS);
    let mut done = 0;
    let mut told = |file: &str, share: f64| {
        progress.say(&format!("trying orders on {file}"));
        let now = (share * STEPS as f64) as u64;
        (done..now.min(STEPS)).for_each(|_| progress.step());
        done = done.max(now);
    };
    let all: Vec<&Experiment> = experiments.iter().collect();
    study(&all, bench, orders, &mut told).map_err(|source| CliError::TorqueControl { source })
}

fn print(studied: &TorqueControlStudy, recording: &StudiedRecording, terminal: &mut Terminal) {
    let StudiedRecording { file, label, .. } = recording;
    terminal.heading(&format!("{file}, {label}: T_d* moved by {}", mover(recording.excited)), Tone::Strong);
    let ends = [recording.estimation.end_s, recording.held_out.end_s].map(|s| number::significant(s, 4));
    let ripple = match recording.ripple_hz.as_slice() {
        [] => "no ripple was found".to_owned(),
        all => {
            let lines: Vec<String> = all.iter().map(|f| number::significant_with_unit(*f, 4, "Hz")).collect();
            format!("ripple at {} was taken out", lines.join(", "))
        }
    };
    terminal.line(&format!("estimated up to {} s, judged from there to {} s; {ripple}", ends[0], ends[1]));
    parameters(recording, terminal);
    early(recording).iter().for_each(|text| terminal.paragraph(text));
    judgements(studied, recording, terminal);
    terminal.paragraph(&against_bar(studied, recording));
    let all = recording.black_boxes.iter();
    let by_fit = all.clone().filter(|black_box| black_box.chosen_by.contains(&ChosenBy::Fit));
    for black_box in by_fit {
        if let Some(text) = belief(recording, black_box) {
            terminal.paragraph(&text);
        }
    }
    for black_box in all {
        if let Some(why) = closed(black_box.closed) {
            terminal.paragraph(&format!("{} {why}", structure(&black_box.structure)));
        }
    }
    circular(recording).iter().for_each(|text| terminal.paragraph(text));
    terminal.paragraph(&beyond(recording));
    terminal.gap();
}

fn parameters(recording: &StudiedRecording, terminal: &mut Terminal) {
    let columns = [
        ("model", Align::Left),
        ("symbol", Align::Left),
        ("estimate", Align::Right),
        ("95 % interval", Align::Right),
        ("residuals that depend on T_d*", Align::Right),
    ];
    let mut table = Table::new(&columns);
    let outside = |test: &Option<bench::study::ResidualTest>| {
        test.as_ref().map_or_else(|| "–".to_owned(), |test| number::share(test.share_outside()))
    };
    let mut row = |name: &str, p: &Parameter, outside: String| {
        table.row([
            name.into(),
            p.symbol.clone().into(),
            number::parameter(p).into(),
            number::interval(p).into(),
            outside.into(),
        ]);
    };
    row("delay", &recording.pure_delay, outside(&recording.pure_delay_residuals));
    for (n, p) in recording.delay_and_lag.iter().enumerate() {
        let (name, test) =
            if n == 0 { ("delay and lag", outside(&recording.delay_and_lag_residuals)) } else { ("", String::new()) };
        row(name, p, test);
    }
    terminal.table(&table);
}

fn judgements(studied: &TorqueControlStudy, recording: &StudiedRecording, terminal: &mut Terminal) {
    let columns = [
        ("model", Align::Left),
        ("estimated on", Align::Left),
        ("chosen by", Align::Left),
        ("fit", Align::Right),
        ("rms error", Align::Right),
        ("over the bar's", Align::Right),
        ("against the bar", Align::Left),
    ];
    let mut table = Table::new(&columns);
    table.row([
        "T_d* one sample ago (the bar)".into(),
        "–".into(),
        "".into(),
        number::fit(recording.bar_fit_percent).into(),
        nm(Some(recording.bar_rms_nm)).into(),
        "1".into(),
        "".into(),
    ]);
    for judged in studied.judged_on(recording.excited) {
        let blank = || "–".to_owned();
        table.row([
            model(&judged.model).into(),
            mover(judged.estimated_on).trim_start_matches("the ").into(),
            chosen_by(studied, judged).into(),
            judged.fit_percent.map_or_else(blank, number::fit).into(),
            nm(judged.rms_nm).into(),
            judged.ratio.map_or_else(blank, |r| number::significant(r, 3)).into(),
            verdict(judged.verdict).into(),
        ]);
    }
    terminal.table(&table);
}

fn nm(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |v| number::significant_with_unit(v, 3, "Nm"))
}

fn chosen_by(studied: &TorqueControlStudy, judged: &Judgement) -> String {
    let Model::BlackBox { structure } = judged.model else { return String::new() };
    let of = |black_box: &&BlackBox| black_box.structure == structure;
    let found = studied.recording(judged.estimated_on).and_then(|r| r.black_boxes.iter().find(of));
    let word = |by: &ChosenBy| match by {
        ChosenBy::Fit => "fit",
        ChosenBy::Bic => "BIC",
    };
    found.map_or_else(String::new, |b| b.chosen_by.iter().map(word).collect::<Vec<_>>().join(", "))
}

fn print_visibility(visibility: &Visibility, terminal: &mut Terminal) {
    let heading = format!("What {} of other rates and demands would tell", number::duration(visibility.recording_s));
    terminal.heading(&heading, Tone::Strong);
    let columns = [
        ("T_d,calc at", Align::Right),
        ("T_d* held", Align::Right),
        ("error of τ", Align::Right),
        ("error of a", Align::Right),
        ("least κ told", Align::Right),
        ("κ = 0.25 told in", Align::Right),
    ];
    let mut table = Table::new(&columns);
    for case in &visibility.cases {
        table.row([
            format!("{} Hz", number::significant(case.rate_hz, 4)).into(),
            number::duration(case.hold_s).into(),
            number::significant_with_unit(case.delay_s, 2, "s").into(),
            number::significant_with_unit(case.lag_rad_s, 2, "rad/s").into(),
            if case.least_term.is_finite() { number::significant(case.least_term, 2) } else { "none".to_owned() }
                .into(),
            recording_needed(case.needed_s).into(),
        ]);
    }
    terminal.table(&table);
    terminal.paragraph(&first_visible(visibility));
}
