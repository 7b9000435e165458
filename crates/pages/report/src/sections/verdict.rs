//! The first page: can the model be used and for what, what are its numbers, how well it replays, what to do next.

use rig::results::{Parameter, Quantity, Reason};
use rig::{Diagnostic, Severity};
use study::verdict::{Level, Rule, Verdict};
use study::{Study, verdict};

use page::{Block, Blocks, Card, Cell, Prose, Table, Tone};

use super::diagnostics::{alike, entry};
use super::foundation;
use super::replays;
use crate::summary;
use crate::wording::{self, number};

/// Findings shown on the first page.
const SHOWN_FINDINGS: usize = 4;

/// The section that comes first.
pub(crate) fn section(study: &Study) -> Blocks {
    let mut all = answer(study);
    all.push(foundation::signatures(study));
    all.push(missing(study));
    all.push(findings(study));
    all.push(rules(study));
    all
}

/// The verdict, where the model is valid, what to do next, six numbers, a replay, and what all of it rests on.
pub(crate) fn answer(study: &Study) -> Blocks {
    let verdict = verdict(study);
    let mut all = Blocks::from(Block::Callout {
        tone: tone(verdict.level),
        kicker: "Verdict".to_owned(),
        title: title(&verdict),
        blocks: judged(study, &verdict),
    });
    // Numbers of a model that is not to be used are not printed large.
    if verdict.level != Level::Insufficient {
        all.push(key_numbers(study));
    }
    all.push(replay(study));
    if study.whole.estimated().is_some() {
        all.push(foundation::limits_and_assumptions(study));
    }
    all
}

/// The headline; of a model that is not to be used, its cause comes first.
pub(crate) fn title(verdict: &Verdict) -> String {
    let headline = wording::headline(verdict.level);
    match verdict.rules.iter().find(|rule| rule.level == Level::Insufficient) {
        Some(rule) => format!("{}. {headline}", wording::capitalised(&wording::found(rule))),
        None => headline.to_owned(),
    }
}

/// Why, for what the model is valid, and what to do.
fn judged(study: &Study, verdict: &Verdict) -> Vec<Block> {
    let mut blocks = because(&verdict.rules);
    let is_usable = study.whole.estimated().is_some() && verdict.level != Level::Insufficient;
    let range = summary::range(&study.validity).filter(|_| is_usable);
    blocks.extend(range.map(|range| Block::paragraph(Prose::strong("Valid for ").then(range).then("."))));
    blocks.push(Block::paragraph(Prose::strong("Next: ").then(summary::next_step(study, verdict))));
    blocks
}

/// The worst replay of a recording that no part was estimated from; where there is none, the worst of all.
fn replay(study: &Study) -> Blocks {
    let worst = |is_seen: bool| {
        let replays = study.replays.iter().filter(|replay| replay.seen_in_estimation == is_seen);
        replays.min_by(|a, b| replays::lowest_fit(a).total_cmp(&replays::lowest_fit(b)))
    };
    worst(false).or_else(|| worst(true)).and_then(replays::headline).map(Blocks::from).unwrap_or_default()
}

/// Colour of a level.
pub(crate) fn tone(level: Level) -> Tone {
    match level {
        Level::Good => Tone::Good,
        Level::Reservations => Tone::Caution,
        Level::Insufficient => Tone::Bad,
    }
}

/// The rules that are not met, the gravest first.
fn because(rules: &[Rule]) -> Vec<Block> {
    let mut decisive: Vec<&Rule> = rules.iter().filter(|rule| rule.level != Level::Good).collect();
    decisive.sort_by_key(|rule| std::cmp::Reverse(rule.level));
    if decisive.is_empty() {
        return vec![Block::paragraph(format!("All {} rules of the verdict are met.", rules.len()))];
    }
    let item = |rule: &Rule| {
        Prose::strong(format!("{}.", wording::capitalised(&wording::found(rule))))
            .then(" Rule: ")
            .then(wording::asks(rule))
    };
    vec![
        Block::paragraph("These rules of the verdict are not met, or not fully:"),
        Block::List { items: decisive.into_iter().map(item).collect() },
    ]
}

/// Every rule of the verdict with its outcome.
pub(super) fn rules(study: &Study) -> Blocks {
    let rules = verdict(study).rules;
    let row = |rule: &Rule| -> Vec<Cell> {
        let outcome = Prose::tag(tone(rule.level), wording::outcome(rule.level));
        vec![outcome.into(), wording::asks(rule).into(), wording::found(rule).into()]
    };
    Block::Fold {
        summary: "How the verdict was reached".into(),
        blocks: vec![
            Block::paragraph("The verdict is the worst outcome of these rules."),
            Block::Table(Table::of_text(&["", "Rule", "This study"]).with_rows(rules.iter().map(row))),
        ],
    }
    .into()
}

/// One number on the first page.
struct KeyNumber<'a> {
    symbol: &'a str,
    name: &'a str,
    parameter: Option<&'a Parameter>,
    needs: &'a [Reason],
}

fn key_numbers(study: &Study) -> Blocks {
    vec![
        Block::Cards { items: collect_key_numbers(study).iter().map(card).collect() },
        Block::note("± is half of the 95 % interval. All digits are in the sections of the report."),
    ]
    .into()
}

fn collect_key_numbers(study: &Study) -> Vec<KeyNumber<'_>> {
    let whole = study.whole.estimated();
    let shaft = |quantity| study.shaft.estimated().and_then(|part| part.estimate.parameter(quantity));
    let controller = |quantity| study.speed_controller.estimated().and_then(|part| part.estimate.parameter(quantity));
    let torque = |quantity| study.torque_control.estimated().and_then(|part| part.delay_and_lag.parameter(quantity));
    let number = |symbol, name, parameter, needs| KeyNumber { symbol, name, parameter, needs };
    let (of_whole, of_shaft) = (study.whole.needs(), study.shaft.needs());
    let (of_controller, of_torque) = (study.speed_controller.needs(), study.torque_control.needs());
    vec![
        number("", "resonance", whole.map(|w| &w.resonance_hz), of_whole),
        number("", "engine speed where firing meets it", whole.map(|w| &w.firing_meets_resonance), of_whole),
        number("K", "shaft stiffness", shaft(Quantity::Stiffness), of_shaft),
        number("B", "shaft damping", shaft(Quantity::Damping), of_shaft),
        number("K_p", "speed control, proportional", controller(Quantity::ProportionalGain), of_controller),
        number("τ + 1/a", "torque control, total delay", torque(Quantity::TorqueControlTotalDelay), of_torque),
    ]
}

fn card(number: &KeyNumber<'_>) -> Card {
    let label = match number.symbol {
        "" => number.name.into(),
        known => Prose::symbol(known).then(" ").then(number.name),
    };
    Card { label, value: number.parameter.map(number::quantity).ok_or_else(|| short_needs(number.needs).into()) }
}

/// The labels of the recordings that are needed, or a pointer to the list below.
fn short_needs(needs: &[Reason]) -> String {
    let labels: Vec<String> = needs
        .iter()
        .filter_map(|need| match need {
            Reason::Recording { any_of } => Some(wording::join(&wording::listed(any_of), "or")),
            _ => None,
        })
        .collect();
    if labels.is_empty() { "see below".to_owned() } else { format!("needs {}", wording::join(&labels, "and")) }
}

fn missing(study: &Study) -> Blocks {
    let rows: Vec<Vec<Cell>> = study
        .not_estimated()
        .into_iter()
        .map(|(part, needs)| vec![Prose::strong(wording::part(part)).into(), wording::needs(needs).into()])
        .collect();
    if rows.is_empty() {
        return Blocks::default();
    }
    vec![
        Block::heading("What could not be estimated, and what would give it"),
        Block::Table(Table::of_text(&["Part", "Needs"]).with_rows(rows)),
    ]
    .into()
}

fn findings(study: &Study) -> Blocks {
    let mut grave: Vec<&Diagnostic> = study.diagnostics.iter().filter(|d| d.severity > Severity::Note).collect();
    if grave.is_empty() {
        return Block::note("There is no finding beyond notes.").into();
    }
    grave.sort_by_key(|found| std::cmp::Reverse(found.severity));
    let groups = alike(&grave);
    let mut all = Blocks::from(Block::heading("Most important findings"));
    groups.iter().take(SHOWN_FINDINGS).for_each(|same| all.push(entry(same)));
    let count: usize = groups.iter().take(SHOWN_FINDINGS).map(Vec::len).sum();
    match study.diagnostics.len().saturating_sub(count) {
        0 => {}
        n => all.push(Block::note(Prose::link(format!("All findings ({n} more)"), "#findings"))),
    }
    all
}
