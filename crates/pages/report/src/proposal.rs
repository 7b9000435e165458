//! A proposed bench file: the channels that were found, and what is left to fill in.

use page::{Align, Block, Blocks, Cell, Finding, Page, Prose, Table, Tone};
use rig::bench_file::PLACEHOLDER;
use rig::channels::{Choice, Guess};

use crate::wording;

/// A guess below this is worth a second look.
const DOUBTFUL: f64 = 0.8;

/// The proposal that was written to a file. Gaps are the keys that still have to be filled in, with their lines.
pub fn page(guess: &Guess, file: &str, gaps: &[(usize, String)]) -> Page {
    let mut all = Blocks::from(Block::heading("Channels"));
    all.push(channels(guess));
    let ambiguous = guess.ambiguous.iter().map(|ambiguity| {
        let others = wording::join(&ambiguity.channels[1..], "and");
        let text = format!("{}: {others} would fit about as well.", wording::role(ambiguity.role));
        finding(Tone::Caution, "please check", text)
    });
    all.push(ambiguous.collect::<Blocks>());
    if !guess.missing.is_empty() {
        let roles: Vec<String> = guess.missing.iter().map(|role| wording::role(*role)).collect();
        all.push(finding(Tone::Faint, "no channel found", format!("{}.", wording::join(&roles, "and"))));
    }
    all.push(Block::heading(Prose::verbatim(format!("Written: {file}"))));
    all.push(to_fill_in(gaps));
    all.push(Block::heading("Next"));
    all.push(Block::paragraph(Prose::verbatim(format!("Look the file over, then `dynoid study {file}`"))));
    Page::new("Proposed bench file", all.into_vec())
}

fn finding(tone: Tone, what: &str, text: String) -> Block {
    Block::Finding(Finding::new(tone, what, text))
}

/// Each key once, with all its lines.
fn to_fill_in(gaps: &[(usize, String)]) -> Blocks {
    let mut all = Blocks::default();
    if !gaps.is_empty() {
        all.push(Block::paragraph(format!("To be filled in, where it says \"{PLACEHOLDER}\":")));
    }
    for (index, (_, key)) in gaps.iter().enumerate() {
        let same = || gaps.iter().enumerate().filter(|(_, (_, other))| other == key);
        if same().next().is_some_and(|(first, _)| first == index) {
            let lines: Vec<String> = same().map(|(_, (line, _))| line.to_string()).collect();
            let word = if lines.len() == 1 { "line" } else { "lines" };
            let place = format!("{key} ({word} {})", wording::join(&lines, "and"));
            all.push(finding(Tone::Strong, &place, hint(key).to_owned()));
        }
    }
    all
}

fn hint(key: &str) -> &'static str {
    match key {
        "cylinders" => "a number, e.g. 4",
        "dynamometer_inertia" => "of all that turns on the dynamometer's side of the shaft, e.g. \"0.6 kg m²\"",
        "engine_inertia" => "flywheel included, e.g. \"0.2 kg m²\"",
        "label" => "which experiment the recording above it is, e.g. \"BS_T_NT\"",
        _ => "the channel's name in the recordings",
    }
}

fn channels(guess: &Guess) -> Table {
    use Align::{Left, Right};
    let mut table = Table::new(&[("role", Left), ("", Left), ("channel", Left), ("unit", Left), ("sure", Right)]);
    for (role, choice) in &guess.choices {
        let style = if choice.confidence < DOUBTFUL { Tone::Caution } else { Tone::Good };
        table.row([
            role.symbol().into(),
            Cell::toned(wording::role_name(*role), Tone::Faint),
            Prose::verbatim(&choice.channel).into(),
            Prose::verbatim(unit(choice)).into(),
            Cell::toned(format!("{} %", percent(choice.confidence)), style),
        ]);
        table.note(&reasons(choice).join("; "));
    }
    table
}

/// The unit of a channel, as the bench file has it.
pub fn unit(choice: &Choice) -> &str {
    choice.unit.map_or(&choice.recorded_unit, |unit| unit.spelling)
}

/// Whole per cent, never 100: it is a guess.
fn percent(confidence: f64) -> u32 {
    (100.0 * confidence).round().clamp(0.0, 99.0) as u32
}

/// Why a channel was chosen.
pub fn reasons(choice: &Choice) -> Vec<String> {
    choice.reasons.iter().map(ToString::to_string).collect()
}
