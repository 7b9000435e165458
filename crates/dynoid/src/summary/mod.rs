//! A study on the terminal: verdict, key numbers, what is missing and why, doubts, where the report is.

mod short;

use std::path::Path;

use bench::study::{Need, Parameter, Part, Study};
use bench::{Diagnostic, Severity};
use page::{Align, Cell, Table, Tone};
use report::verdict::{Level, Rule, verdict};
use report::wording::{self, number};

use crate::commands::study::Written;
use crate::error::Outcome;
use crate::terminal::Terminal;

pub(crate) use short::{Short, short};

/// Doubts shown before the rest is left to the report.
const MOST_FINDINGS: usize = 20;

/// How the command ends.
pub(crate) fn outcome(study: &Study) -> Outcome {
    match verdict(study).level {
        Level::Insufficient => Outcome::Insufficient,
        Level::Good | Level::Reservations => Outcome::Done,
    }
}

/// Prints a study.
pub(crate) fn print(written: &Written, terminal: &mut Terminal) {
    let study = &written.study;
    let used = study.recordings.iter().filter(|recording| !recording.used_for.is_empty()).count();
    terminal.line(&format!("{}: {} recordings, {used} used for estimates", study.bench.name, study.recordings.len()));
    terminal.gap();
    print_verdict(study, terminal);
    print_estimates(study, terminal);
    print_missing(study, terminal);
    print_findings(&study.diagnostics, terminal);
    print_places(written, terminal);
}

/// Prints what a study says about itself, without its numbers.
pub(crate) fn print_judgement(written: &Written, terminal: &mut Terminal) {
    print_verdict(&written.study, terminal);
    print_missing(&written.study, terminal);
    print_findings(&written.study.diagnostics, terminal);
    print_places(written, terminal);
}

fn print_verdict(study: &Study, terminal: &mut Terminal) {
    let verdict = verdict(study);
    terminal.heading(&format!("Verdict: {}", verdict.level.headline()), style_of(verdict.level));
    let mut table = Table::new(&[("", Align::Left), ("", Align::Left)]);
    for Rule { asks, found, level } in verdict.rules.iter().filter(|rule| rule.level != Level::Good) {
        table.row([Cell::toned(level.outcome(), style_of(*level)), format!("{asks} Here: {found}.").into()]);
    }
    terminal.table(&table);
    let met = verdict.rules.iter().filter(|rule| rule.level == Level::Good).count();
    terminal.line(&format!("  {met} of {} rules are met.", verdict.rules.len()));
    terminal.gap();
}

fn style_of(level: Level) -> Tone {
    match level {
        Level::Good => Tone::Good,
        Level::Reservations => Tone::Caution,
        Level::Insufficient => Tone::Bad,
    }
}

fn print_estimates(study: &Study, terminal: &mut Terminal) {
    let mut table = Table::new(&[("", Align::Left), ("", Align::Left), ("", Align::Left), ("", Align::Left)]);
    let mut last = "";
    for (part, parameter) in key_numbers(study) {
        let shown = if part == last { "" } else { part };
        last = part;
        table.row([
            Cell::toned(shown, Tone::Faint),
            (&parameter.symbol).into(),
            number::parameter(parameter).into(),
            Cell::toned(&parameter.name, Tone::Faint),
        ]);
    }
    if !table.is_empty() {
        terminal.heading("Estimates, with 95 % intervals", Tone::Strong);
        terminal.table(&table);
        terminal.gap();
    }
}

/// The numbers people ask for first, each with the part it belongs to.
fn key_numbers<'a>(study: &'a Study) -> Vec<(&'static str, &'a Parameter)> {
    let mut numbers = Vec::new();
    let mut add = |part: &'static str, parameters: Vec<Option<&'a Parameter>>| {
        numbers.extend(parameters.into_iter().flatten().map(|parameter| (part, parameter)));
    };
    if let Some(part) = study.speed_controller.estimated() {
        add("speed control", ["K_p", "K_i", "τ"].map(|symbol| part.estimate.parameter(symbol)).into());
    }
    if let Some(part) = study.feed_forward.estimated() {
        add("feed-forward", ["k", "k_a"].map(|symbol| part.estimate.parameter(symbol)).into());
    }
    if let Some(part) = study.torque_control.estimated() {
        add("torque control", part.delay_and_lag.parameters.iter().map(Some).collect());
    }
    if let Some(part) = study.shaft.estimated() {
        let mut parameters: Vec<_> = ["K", "B"].map(|symbol| part.estimate.parameter(symbol)).into();
        parameters.push(Some(&part.zero));
        add("shaft", parameters);
    }
    if let Some(part) = study.whole.estimated() {
        let resonance = [&part.resonance_hz, &part.resonance_gain, &part.damping_ratio];
        add("whole model", resonance.into_iter().chain([&part.firing_meets_resonance_rpm]).map(Some).collect());
    }
    numbers
}

/// Every part that is not estimated, in plain words, with what it needs.
fn missing(study: &Study) -> Vec<(&'static str, &[Need])> {
    fn needs<T>(part: &Part<T>) -> Option<&[Need]> {
        match part {
            Part::Estimated(_) => None,
            Part::NotEstimated { needs } => Some(needs),
        }
    }
    let parts = [
        ("timing", needs(&study.timing)),
        ("speed_controller", needs(&study.speed_controller)),
        ("feed_forward", needs(&study.feed_forward)),
        ("torque_control", needs(&study.torque_control)),
        ("shaft", needs(&study.shaft)),
        ("whole", needs(&study.whole)),
    ];
    parts.into_iter().filter_map(|(name, needs)| Some((wording::part(name), needs?))).collect()
}

fn print_missing(study: &Study, terminal: &mut Terminal) {
    let missing = missing(study);
    if missing.is_empty() {
        return;
    }
    terminal.heading("Not estimated", Tone::Strong);
    let mut table = Table::new(&[("", Align::Left), ("", Align::Left)]);
    for (part, needs) in missing {
        table.row([Cell::toned(part, Tone::Caution), format!("needs {}", wording::needs(needs)).into()]);
    }
    terminal.table(&table);
    terminal.gap();
}

fn print_findings(diagnostics: &[Diagnostic], terminal: &mut Terminal) {
    let doubts: Vec<&Diagnostic> = diagnostics.iter().filter(|found| found.severity > Severity::Note).collect();
    let notes = diagnostics.len() - doubts.len();
    if diagnostics.is_empty() {
        return;
    }
    terminal.heading("Findings", Tone::Strong);
    for found in doubts.iter().take(MOST_FINDINGS) {
        let style = if found.severity == Severity::Error { Tone::Bad } else { Tone::Caution };
        let place = wording::place(&found.place).map(|place| format!("{place}: ")).unwrap_or_default();
        let text = format!("{place}{} {}", wording::finding(&found.finding), wording::advice(&found.finding));
        terminal.item((&format!("{}:", wording::severity(found.severity)), style), &text);
    }
    let rest = doubts.len().saturating_sub(MOST_FINDINGS);
    if rest > 0 {
        terminal.line(&format!("  {rest} more are in the report."));
    }
    if notes > 0 {
        let notes = if notes == 1 {
            "1 note that asks for nothing is".to_owned()
        } else {
            format!("{notes} notes that ask for nothing are")
        };
        terminal.line(&format!("  {notes} in the report."));
    }
    terminal.gap();
}

fn print_places(written: &Written, terminal: &mut Terminal) {
    let mut table = Table::new(&[("", Align::Left), ("", Align::Left)]);
    table.row(["report".into(), shown(&written.report).into()]);
    table.row(["data".into(), shown(&written.data).into()]);
    terminal.heading("Written", Tone::Strong);
    terminal.table(&table);
}

/// A path from where the user is, if it lies below.
pub(crate) fn shown(path: &Path) -> String {
    let here = std::env::current_dir().ok();
    let short = here.and_then(|here| path.strip_prefix(here).ok().map(Path::to_owned));
    short.unwrap_or_else(|| path.to_owned()).display().to_string()
}
