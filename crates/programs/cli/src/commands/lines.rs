//! `dynoid lines`: what recordings show before any model.

use dynoid::facts::LinesFacts;
use part_lines::lines::{FEWEST_SAMPLES, RecordingLines, find_lines, on_one_mains, over_speed};

use super::experiments::{self, WithRefused};
use super::result::show;
use crate::cli::lines::LinesArguments;
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

pub(crate) fn run(arguments: &LinesArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let recordings = experiments::find(&arguments.given, &arguments.result, terminal)?;
    let mut looks = Vec::new();
    let refused = experiments::each(&recordings, "looking at", terminal, |experiment| {
        looks.push(find_lines(&experiment, recordings.bench()));
    })?;
    let looks = on_one_mains(looks);
    looks.iter().filter_map(nothing_seen).for_each(|reason| terminal.warning(&reason));
    let signals = over_speed(&looks);
    let page = || report::pages::lines(&looks, &signals, (arguments.lines, arguments.each));
    let json = || WithRefused::sorted(LinesFacts::of(&looks, &signals), &refused);
    show(&arguments.result, page, json, terminal)?;
    Ok(Outcome::of(looks.iter().any(|look| nothing_seen(look).is_none()), &refused))
}

/// Why a recording shows nothing at all.
fn nothing_seen(look: &RecordingLines) -> Option<String> {
    if look.parts.is_empty() {
        let remedy = "name the channel of N_e or N_d in the bench file";
        return Some(format!("{}: no speed is recorded, and the causes of lines follow from it; {remedy}", look.file));
    }
    let is_empty = look.parts.iter().all(|part| part.signals.is_empty());
    let needs = format!("a signal needs {FEWEST_SAMPLES} samples in a row, and has to change");
    is_empty.then(|| format!("{}: nothing in it makes a spectrum; {needs}", look.file))
}
