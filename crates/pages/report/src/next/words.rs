//! Gain from a further experiment, in words.

use rig::results::Quantity;
use study::{Candidate, Gain, NextExperiments};

use crate::wording::{self, number};

/// Candidates that stand side by side.
const SIDE_BY_SIDE: usize = 3;

/// An experiment: with the demand that buys most and, where it was tried with two, with the other.
#[derive(Debug, Clone, Copy)]
pub struct Choice<'a> {
    /// With the better demand.
    pub candidate: &'a Candidate,
    /// With the other one: that of the method beside a designed one, or the designed one beside it.
    pub other: Option<&'a Candidate>,
}

impl<'a> Choice<'a> {
    /// The same with the other demand, if that is worth while, in place of one that would reach a limit; `None` if none
    /// is left.
    fn that_is_safe(self) -> Option<Choice<'a>> {
        let can_be = |candidate: &Candidate| candidate.is_worth_while() && !candidate.is_unsafe();
        match self.other {
            _ if can_be(self.candidate) => Some(self),
            Some(other) if can_be(other) => Some(Choice { candidate: other, other: Some(self.candidate) }),
            _ => None,
        }
    }
}

/// The experiments that were tried, each once, the best first.
pub fn choices(found: &NextExperiments) -> Vec<Choice<'_>> {
    let mut all: Vec<Choice<'_>> = Vec::new();
    for candidate in &found.candidates {
        match all.iter_mut().find(|choice| choice.candidate.label == candidate.label) {
            Some(choice) => choice.other = Some(candidate),
            None => all.push(Choice { candidate, other: None }),
        }
    }
    all
}

/// The experiments worth comparing, the best first; none that would reach a limit of the bench.
pub fn best(found: &NextExperiments) -> Vec<Choice<'_>> {
    let all = choices(found).into_iter();
    let worth_while = all.take_while(|choice| choice.candidate.is_worth_while());
    let mut safe: Vec<Choice<'_>> = worth_while.filter_map(Choice::that_is_safe).collect();
    // Another demand of an experiment may gain less than the next experiment.
    let place = |choice: &Choice<'_>| found.candidates.iter().position(|one| std::ptr::eq(one, choice.candidate));
    safe.sort_by_key(place);
    safe.truncate(SIDE_BY_SIDE);
    safe
}

/// Experiment to record next and why, in a sentence or two.
pub fn recommendation(found: &NextExperiments) -> String {
    let left_out = left_out(found);
    let Some(first) = best(found).first().copied() else {
        return if left_out.is_empty() { nothing_to_gain(found) } else { left_out.trim_start().to_owned() };
    };
    let other = first.other.map(|other| format!(" {}.", wording::capitalised(&instead(other)))).unwrap_or_default();
    let spoiled = spoiled(first.candidate, found.enough);
    format!("Record {} next: {}.{spoiled}{other}{left_out}", what(first.candidate), reasons(first.candidate))
}

/// Experiments that would gain, but reach a limit of the bench.
fn left_out(found: &NextExperiments) -> String {
    let is_left_out = |one: &&Candidate| one.is_worth_while() && one.is_unsafe();
    let all: Vec<String> = found.candidates.iter().filter(is_left_out).map(what).collect();
    if all.is_empty() {
        return String::new();
    }
    format!(
        " Not recommended: {}. They would gain, but benches like yours reach a limit in them. Take a smaller amplitude or another speed; \
         `dynoid experiment check` names the limit.",
        wording::join(&all, "and")
    )
}

/// Gain from the other demand of an experiment.
pub fn instead(other: &Candidate) -> String {
    let demand = if other.is_designed { "designed for this shaft" } else { "with the demand of the method" };
    match other.is_worth_while() {
        true if other.is_unsafe() => format!("{demand}, the same experiment reaches a limit of the bench"),
        true => format!("{demand}, the same experiment gains: {}", reasons(other)),
        false => format!("{demand}, the same experiment gains nothing"),
    }
}

/// Gain from an experiment; empty where it gains nothing.
pub fn reasons(candidate: &Candidate) -> String {
    let gains =
        |known: bool| candidate.gains.iter().filter(move |gain| gain.is_worth_while() && gain.now.is_some() == known);
    let new: Vec<String> = gains(false).map(|gain| gain.quantity.symbol().to_owned()).collect();
    let narrower: Vec<String> = gains(true).map(narrowed).collect();
    let mut buys = Vec::new();
    if !new.is_empty() {
        buys.push(format!("it shows {}, which no recording shows", listed(&new)));
    }
    if !narrower.is_empty() {
        buys.push(listed(&narrower));
    }
    buys.join("; ")
}

/// Numbers for which a study would take it in place of a better recording.
fn spoiled(candidate: &Candidate, enough: f64) -> String {
    let all: Vec<String> = candidate.gains.iter().filter(|gain| gain.is_spoiled(enough)).map(narrowed).collect();
    match all.is_empty() {
        true => String::new(),
        false => format!(" In a study with it {}: keep a study without it.", listed(&all)),
    }
}

/// Why no experiment is recommended.
fn nothing_to_gain(found: &NextExperiments) -> String {
    let gains = found.candidates.first().map_or(&[][..], |candidate| &candidate.gains);
    let wide: Vec<String> = gains
        .iter()
        .filter(|gain| !gain.is_enough_now)
        .map(|gain| format!("{} ({})", gain.quantity.symbol(), relative(gain.now, gain.value)))
        .collect();
    match wide.is_empty() {
        true => format!("Nothing: every number below is known within {}.", number::share(found.enough)),
        false => format!(
            "None of these experiments narrows the interval of {} by a fifth. A longer one may. The uncertainty of \
             time stamps and of the stated inertias does not fall with the length.",
            listed(&wide)
        ),
    }
}

fn narrowed(gain: &Gain) -> String {
    let (now, then) = (relative(gain.now, gain.value), relative(Some(gain.then), gain.value));
    format!("{} becomes known within {then} instead of {now}", gain.quantity.symbol())
}

/// Half an interval as a part of the value, `± 3.5 %`.
fn relative(half_width: Option<f64>, value: f64) -> String {
    match half_width {
        Some(half) => format!("± {} %", number::significant(100.0 * half / value.abs(), 2)),
        None => "not known".to_owned(),
    }
}

/// The experiment with length and speed: `Multisine_T_TN (designed for this shaft), 60 s at 1200 rpm`.
pub fn what(candidate: &Candidate) -> String {
    let designed = if candidate.is_designed { " (designed for this shaft)" } else { "" };
    let (length, speed) = (number::duration(candidate.duration_s), number::significant(candidate.speed_rpm, 4));
    format!("{}{designed}, {length} at {speed} rpm", candidate.label)
}

/// The command that makes its demands, with the model of a study if there is one.
pub fn command(candidate: &Candidate, bench: &str, study: Option<&str>) -> String {
    let which = if candidate.is_designed { "--optimal K,B".to_owned() } else { candidate.label.to_string() };
    let (length, speed) = (number::significant(candidate.duration_s, 6), number::significant(candidate.speed_rpm, 6));
    let model = study.map(|study| format!(" --model {study}")).unwrap_or_default();
    format!("dynoid experiment design {bench} {which} --speed {speed} --duration {length}{model}")
}

/// A number, and how well it is known.
pub struct Row {
    /// Which.
    pub quantity: Quantity,
    /// Its value.
    pub value: String,
    /// Half its 95 % interval now, as a part of the value.
    pub now: String,
    /// The same after each of the best candidates, and whether that is worth while.
    pub then: Vec<(String, bool)>,
}

/// The table of what is known now and after the best candidates.
pub fn rows(found: &NextExperiments) -> Vec<Row> {
    let best = best(found);
    let mut all: Vec<&Gain> = Vec::new();
    let shown = || best.iter().map(|choice| choice.candidate);
    for gain in shown().chain(found.candidates.first()).flat_map(|candidate| &candidate.gains) {
        if !all.iter().any(|known| known.quantity == gain.quantity) {
            all.push(gain);
        }
    }
    let row = |gain: &&Gain| {
        let after = |candidate: &Candidate| match candidate.gains.iter().find(|other| other.quantity == gain.quantity) {
            Some(other) => (relative(Some(other.then), gain.value), other.is_worth_while()),
            None => (relative(None, gain.value), false),
        };
        let notation = gain.quantity.notation();
        Row {
            quantity: gain.quantity,
            value: number::measure(notation.per_si * gain.value, notation.unit),
            now: relative(gain.now, gain.value),
            then: shown().map(after).collect(),
        }
    };
    all.iter().map(row).collect()
}

/// `a`, `a and b`, `a, b and c`.
fn listed(all: &[String]) -> String {
    match all {
        [] => String::new(),
        [one] => one.clone(),
        [most @ .., last] => format!("{} and {last}", most.join(", ")),
    }
}
