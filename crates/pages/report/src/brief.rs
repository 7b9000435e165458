//! A study in short: verdict, key numbers, what is missing and why, doubts.

use page::{Align, Block, Blocks, Cell, Page, Prose, Table, Tone};
use rig::results::{Parameter, Part, Quantity, Reason};
use rig::{Diagnostic, Finding, Severity};
use study::verdict::{Level, Rule, Verdict};
use study::{Study, verdict};

use crate::sections::diagnostics::{alike, entry};
use crate::sections::verdict::{title, tone};
use crate::summary;
use crate::wording::{self, number};

/// Findings shown before the rest is left to the report.
const MOST_FINDINGS: usize = 20;

/// The study in short; `since` says what has changed since an earlier one.
pub fn summary(study: &Study, since: Option<String>) -> Page {
    let used = study.recordings.iter().filter(|recording| !recording.used_for.is_empty()).count();
    let all = match study.recordings.len() {
        1 => "1 recording".to_owned(),
        count => format!("{count} recordings"),
    };
    let subject = format!("{}: {all}, {used} used for estimates", study.bench.name);
    let mut all = Blocks::from(Block::paragraph(Prose::verbatim(subject)));
    all.push(causes(&study.diagnostics));
    all.push(judged(study));
    all.push(since.map(Block::paragraph).into_iter().collect::<Blocks>());
    all.push(estimates(study));
    all.push(missing(study));
    all.push(findings(&study.diagnostics));
    Page::new(study.bench.name.as_str(), all.into_vec())
}

/// Judgement of the study on itself, without its numbers.
pub fn judgement(study: &Study) -> Page {
    let mut all = causes(&study.diagnostics);
    all.push(judged(study));
    all.push(missing(study));
    all.push(findings(&study.diagnostics));
    Page::new(study.bench.name.as_str(), all.into_vec())
}

fn judged(study: &Study) -> Blocks {
    let verdict = verdict(study);
    let row = |rule: &Rule| -> Vec<Cell> {
        let found = wording::capitalised(&wording::found(rule));
        vec![
            Cell::toned(wording::outcome(rule.level), tone(rule.level)),
            format!("{found}. Rule: {}", wording::asks(rule)).into(),
        ]
    };
    let unmet = verdict.rules.iter().filter(|rule| rule.level != Level::Good);
    let table = Table::new(&[("", Align::Left), ("", Align::Left)]).with_rows(unmet.map(row));
    let met = verdict.rules.iter().filter(|rule| rule.level == Level::Good).count();
    let count = Block::paragraph(format!("{met} of {} rules are met.", verdict.rules.len()));
    Block::Callout {
        tone: tone(verdict.level),
        kicker: "Verdict".to_owned(),
        title: format!("Verdict: {}", title(&verdict)),
        blocks: [Block::Table(table), count].into_iter().chain(use_of_it(study, &verdict)).collect(),
    }
    .into()
}

/// Where the model is valid, and what to do next.
fn use_of_it(study: &Study, verdict: &Verdict) -> Vec<Block> {
    let is_usable = study.whole.estimated().is_some() && verdict.level != Level::Insufficient;
    let range = summary::range(&study.validity).filter(|_| is_usable);
    let valid = range.map(|range| Block::paragraph(format!("Valid for {range}.")));
    let next = Block::paragraph(Prose::from("Next: ").then(summary::next_step(study, verdict)));
    valid.into_iter().chain([next]).collect()
}

/// Tells whether a finding explains a bad verdict by itself: a channel that is not in the recordings.
fn is_cause(diagnostic: &Diagnostic) -> bool {
    diagnostic.severity > Severity::Note && matches!(diagnostic.finding, Finding::MissingChannel { .. })
}

/// Findings that explain the verdict, before it.
fn causes(diagnostics: &[Diagnostic]) -> Blocks {
    let causes: Vec<&Diagnostic> = diagnostics.iter().filter(|found| is_cause(found)).collect();
    alike(&causes).iter().map(|same| entry(same)).collect()
}

fn estimates(study: &Study) -> Blocks {
    let mut table = Table::new(&[("", Align::Left), ("", Align::Left), ("", Align::Left), ("", Align::Left)]);
    let mut last = "";
    for (part, parameter) in key_numbers(study) {
        let shown = if part == last { "" } else { part };
        last = part;
        table.row([
            Cell::toned(shown, Tone::Faint),
            Prose::symbol(parameter.quantity.symbol()).into(),
            number::quantity(parameter).into(),
            Cell::toned(parameter.quantity.name(), Tone::Faint),
        ]);
    }
    match table.is_empty() {
        true => Blocks::default(),
        false => {
            let heading = Block::heading("Estimates, with 95 % intervals");
            vec![heading, Block::Table(table), Block::note(wording::torque_scale(study))].into()
        }
    }
}

/// The numbers people ask for first, each with the part it belongs to.
pub fn key_numbers<'a>(study: &'a Study) -> Vec<(&'static str, &'a Parameter)> {
    let mut numbers = Vec::new();
    let mut add = |part: Part, parameters: Vec<Option<&'a Parameter>>| {
        numbers.extend(parameters.into_iter().flatten().map(|parameter| (wording::part(part), parameter)));
    };
    if let Some(part) = study.speed_controller.estimated() {
        add(
            Part::SpeedController,
            [Quantity::ProportionalGain, Quantity::IntegralGain, Quantity::ControllerDelay]
                .map(|quantity| part.estimate.parameter(quantity))
                .into(),
        );
    }
    if let Some(part) = study.feed_forward.estimated() {
        add(
            Part::FeedForward,
            [Quantity::SpeedFeedForward, Quantity::AccelerationFeedForward]
                .map(|quantity| part.estimate.parameter(quantity))
                .into(),
        );
    }
    if let Some(part) = study.torque_control.estimated() {
        add(Part::TorqueControl, part.delay_and_lag.parameters.iter().map(Some).collect());
    }
    if let Some(part) = study.shaft.estimated() {
        let mut parameters: Vec<_> =
            [Quantity::Stiffness, Quantity::Damping].map(|quantity| part.estimate.parameter(quantity)).into();
        parameters.push(Some(&part.zero));
        add(Part::Shaft, parameters);
    }
    if let Some(part) = study.whole.estimated() {
        let resonance = [&part.resonance_hz, &part.resonance_gain, &part.damping_ratio];
        add(Part::Whole, resonance.into_iter().chain([&part.firing_meets_resonance]).map(Some).collect());
    }
    numbers
}

fn missing(study: &Study) -> Blocks {
    let row = |(part, needs): (Part, &[Reason])| -> Vec<Cell> {
        vec![Cell::toned(wording::part(part), Tone::Caution), format!("needs {}", wording::needs(needs)).into()]
    };
    let table =
        Table::new(&[("", Align::Left), ("", Align::Left)]).with_rows(study.not_estimated().into_iter().map(row));
    match table.is_empty() {
        true => Blocks::default(),
        false => vec![Block::heading("Not estimated"), Block::Table(table)].into(),
    }
}

fn findings(diagnostics: &[Diagnostic]) -> Blocks {
    if diagnostics.is_empty() {
        return Blocks::default();
    }
    let above_note = |found: &&Diagnostic| found.severity > Severity::Note;
    let notes = diagnostics.iter().filter(|found| !above_note(found)).count();
    let doubts: Vec<&Diagnostic> = diagnostics.iter().filter(above_note).filter(|found| !is_cause(found)).collect();
    if doubts.is_empty() && notes == 0 {
        return Blocks::default();
    }
    let groups = alike(&doubts);
    let mut all = Blocks::from(Block::heading("Findings"));
    groups.iter().take(MOST_FINDINGS).for_each(|same| all.push(entry(same)));
    let rest: usize = groups.iter().skip(MOST_FINDINGS).map(Vec::len).sum();
    if rest > 0 {
        all.push(Block::paragraph(format!("{rest} more are in the report.")));
    }
    match notes {
        0 => {}
        1 => all.push(Block::paragraph("1 note that asks for nothing is in the report.")),
        _ => all.push(Block::paragraph(format!("{notes} notes that ask for nothing are in the report."))),
    }
    all
}
