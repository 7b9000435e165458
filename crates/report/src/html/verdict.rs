//! The first page: can the model be used, what are its numbers, what is missing, what to look at.

use bench::study::{Need, Parameter, Part, Study};
use bench::{Diagnostic, Severity};

use super::diagnostics::{alike, entry};
use super::parts::{table, unbroken};
use super::typeset::{prose, symbol};
use crate::verdict::{Level, Rule, verdict};
use crate::wording::{self, number};
use page::markup;
use page::markup::Markup;

/// Findings shown on the first page.
const SHOWN_FINDINGS: usize = 4;

/// The section that comes first.
pub(crate) fn section(study: &Study) -> Markup {
    let verdict = verdict(study);
    let mut all = markup!(
        "<div class=\"verdict {}\"><p class=\"kicker\">Verdict</p><h2>{}</h2>{}</div>\n",
        class(verdict.level),
        verdict.level.headline(),
        because(&verdict.rules),
    );
    all.push(key_numbers(study));
    all.push(missing(study));
    all.push(findings(study));
    all.push(rules(&verdict.rules));
    all
}

fn class(level: Level) -> &'static str {
    match level {
        Level::Good => "good",
        Level::Reservations => "reservations",
        Level::Insufficient => "insufficient",
    }
}

/// The rules that are not met, the gravest first.
fn because(rules: &[Rule]) -> Markup {
    let mut decisive: Vec<&Rule> = rules.iter().filter(|rule| rule.level != Level::Good).collect();
    decisive.sort_by_key(|rule| std::cmp::Reverse(rule.level));
    let decisive: Markup = decisive
        .into_iter()
        .map(|rule| {
            let found = wording::capitalised(&rule.found);
            markup!("<li><em>{}.</em> <span class=\"asked\">Asked: {}</span></li>", prose(&found), prose(rule.asks))
        })
        .collect();
    match decisive.is_empty() {
        true => markup!("<p>All {} rules of the verdict are met.</p>", rules.len()),
        false => markup!("<p>These rules of the verdict are not, or not fully, met:</p><ul>{}</ul>", decisive),
    }
}

fn rules(rules: &[Rule]) -> Markup {
    let rows = rules.iter().map(|rule| {
        vec![
            markup!("<span class=\"tag {}\">{}</span>", class(rule.level), rule.level.outcome()),
            prose(rule.asks),
            prose(&rule.found),
        ]
    });
    markup!(
        "<h3>How the verdict was reached</h3>\n<p>The verdict is the worst outcome of these rules.</p>\n{}",
        table("rules", &["", "Rule", "This study"], rows)
    )
}

/// One number on the first page.
struct KeyNumber<'a> {
    symbol: &'a str,
    name: &'a str,
    parameter: Option<&'a Parameter>,
    needs: &'a [Need],
}

fn key_numbers(study: &Study) -> Markup {
    let cards: Markup = collect_key_numbers(study).iter().map(card).collect();
    markup!(
        "<h3>Key numbers</h3>\n<div class=\"cards\">{}</div>\n<p class=\"note\">± is half of the 95 % interval, here and \
         everywhere below.</p>\n",
        cards
    )
}

fn collect_key_numbers(study: &Study) -> Vec<KeyNumber<'_>> {
    let whole = study.whole.estimated();
    let shaft = |symbol| study.shaft.estimated().and_then(|part| part.estimate.parameter(symbol));
    let controller = |symbol| study.speed_controller.estimated().and_then(|part| part.estimate.parameter(symbol));
    let torque = |symbol| study.torque_control.estimated().and_then(|part| part.delay_and_lag.parameter(symbol));
    let number = |symbol, name, parameter, needs| KeyNumber { symbol, name, parameter, needs };
    let (of_whole, of_shaft) = (needs(&study.whole), needs(&study.shaft));
    let (of_controller, of_torque) = (needs(&study.speed_controller), needs(&study.torque_control));
    vec![
        number("", "resonance", whole.map(|w| &w.resonance_hz), of_whole),
        number("", "engine speed where firing meets it", whole.map(|w| &w.firing_meets_resonance_rpm), of_whole),
        number("K", "shaft stiffness", shaft("K"), of_shaft),
        number("B", "shaft damping", shaft("B"), of_shaft),
        number("K_p", "speed control, proportional", controller("K_p"), of_controller),
        number("K_i", "speed control, integral", controller("K_i"), of_controller),
        number("τ", "speed control, delay", controller("τ"), of_controller),
        number("τ + 1/a", "torque control, total delay", torque("τ + 1/a"), of_torque),
    ]
}

fn needs<T>(part: &Part<T>) -> &[Need] {
    match part {
        Part::Estimated(_) => &[],
        Part::NotEstimated { needs } => needs,
    }
}

fn card(number: &KeyNumber<'_>) -> Markup {
    let name = match number.symbol {
        "" => markup!("{}", number.name),
        known => markup!("<b>{}</b> {}", symbol(known), number.name),
    };
    match number.parameter {
        Some(parameter) => {
            markup!("<div class=\"card\"><p class=\"name\">{}</p>{}</div>", name, big_number(parameter))
        }
        None => markup!(
            "<div class=\"card absent\"><p class=\"name\">{}</p><p class=\"value\">not estimated</p><p class=\"range\">{}</p></div>",
            name,
            short_needs(number.needs)
        ),
    }
}

/// Value and unit large, the uncertainty small below.
fn big_number(parameter: &Parameter) -> Markup {
    let Some(digits) = number::digits(parameter) else {
        return markup!("<p class=\"value\">{}</p>", number::parameter(parameter));
    };
    markup!(
        "<p class=\"value\">{} <small>{}</small></p><p class=\"range\">{} &ensp;{}</p>",
        digits.value,
        digits.unit,
        unbroken(&digits.spread),
        unbroken(&digits.interval)
    )
}

/// The labels of the recordings that are needed, or a pointer to the list below.
fn short_needs(needs: &[Need]) -> String {
    let labels: Vec<String> = needs
        .iter()
        .filter_map(|need| match need {
            Need::Recording { any_of } => Some(wording::join(any_of, "or")),
            _ => None,
        })
        .collect();
    if labels.is_empty() { "see below".to_owned() } else { format!("needs {}", wording::join(&labels, "and")) }
}

fn missing(study: &Study) -> Markup {
    let parts = [
        ("timing", needs(&study.timing), study.timing.estimated().is_some()),
        ("speed_controller", needs(&study.speed_controller), study.speed_controller.estimated().is_some()),
        ("feed_forward", needs(&study.feed_forward), study.feed_forward.estimated().is_some()),
        ("torque_control", needs(&study.torque_control), study.torque_control.estimated().is_some()),
        ("shaft", needs(&study.shaft), study.shaft.estimated().is_some()),
        ("whole", needs(&study.whole), study.whole.estimated().is_some()),
    ];
    let rows: Vec<Vec<Markup>> = parts
        .iter()
        .filter(|(_, _, there)| !there)
        .map(|(name, needs, _)| {
            vec![markup!("<strong>{}</strong>", wording::part(name)), prose(&wording::needs(needs))]
        })
        .collect();
    if rows.is_empty() {
        return Markup::default();
    }
    markup!(
        "<h3>What could not be estimated, and what would give it</h3>\n{}",
        table("needs", &["Part", "Needs"], rows)
    )
}

fn findings(study: &Study) -> Markup {
    let mut grave: Vec<&Diagnostic> = study.diagnostics.iter().filter(|d| d.severity > Severity::Note).collect();
    if grave.is_empty() {
        return markup!("<p class=\"note\">There is no finding beyond notes.</p>\n");
    }
    grave.sort_by_key(|found| std::cmp::Reverse(found.severity));
    let groups = alike(&grave);
    let shown: Markup = groups.iter().take(SHOWN_FINDINGS).map(|same| entry(same)).collect();
    let count: usize = groups.iter().take(SHOWN_FINDINGS).map(Vec::len).sum();
    let rest = match study.diagnostics.len().saturating_sub(count) {
        0 => Markup::default(),
        n => {
            markup!("<p class=\"note\"><a href=\"#findings\">All findings ({} more)</a></p>", unbroken(&n.to_string()))
        }
    };
    markup!("<h3>Most important findings</h3>\n<ul class=\"findings\">{}</ul>\n{}\n", shown, rest)
}
