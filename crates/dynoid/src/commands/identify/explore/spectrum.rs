//! `dynoid data spectrum`: power spectra and frequency responses.

use dataset::CommonClock;
use ident::Dataset;
use toolbox_report::spectrum::{SpectrumMethod, SpectrumOptions, json, page, spectra};

use super::super::data::{Gaps, Loaded, check_movement, load_on};
use crate::cli::identify::{SpectrumArguments, SpectrumMethod as Method};
use crate::commands::result::{check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid data spectrum`
pub(crate) fn spectrum(arguments: &SpectrumArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &[&arguments.data.recordings])?;
    let loaded = load_on(CommonClock::Slowest, &arguments.data, terminal)?;
    // Of a single channel there is a spectrum whatever it does; a response needs both to move.
    if loaded.data.inputs() > 0 {
        check_movement(&loaded)?;
    }
    let data = without_gaps(loaded, terminal)?;
    check_window(arguments, &data)?;
    check_method(arguments, data.inputs())?;
    let options = SpectrumOptions { method: method(arguments.method), window: arguments.window };
    let failed = |source: signal::SignalError| CliError::identify("the spectrum", source.into());
    let found = spectra(&data, &options).map_err(failed)?;
    show(&arguments.result, || page(&found), || json(&found), terminal)?;
    Ok(Outcome::Done)
}

/// Of each recording the longest stretch in which nothing is missing.
fn without_gaps(loaded: Loaded, terminal: &mut Terminal) -> Result<Dataset, CliError> {
    let known = loaded.notes.len();
    let cut = loaded.cut_at(Gaps::OfAll)?;
    for note in &cut.notes[known..] {
        note.clone().with("; of each recording the longest is shown").say(terminal);
    }
    let experiments = cut.data.experiments();
    let mut longest: Vec<usize> = Vec::new();
    for (index, of) in cut.recording.iter().enumerate() {
        match longest.last_mut().filter(|last| cut.recording[**last] == *of) {
            Some(last) if experiments[index].len() > experiments[*last].len() => *last = index,
            Some(_) => {}
            None => longest.push(index),
        }
    }
    cut.data.only_experiments(&longest).map_err(|source| CliError::identify("the spectrum", source))
}

/// Refuses several inputs where a method knows but one: it would take what the others do for noise.
fn check_method(arguments: &SpectrumArguments, inputs: usize) -> Result<(), CliError> {
    match arguments.method {
        Method::Welch | Method::Etfe if inputs > 1 => Err(CliError::Usage {
            what: "--method welch and etfe take one input; lpm, lrm and blackman-tukey take several".into(),
        }),
        _ => Ok(()),
    }
}

/// Refuses windows that no recording is long enough for.
fn check_window(arguments: &SpectrumArguments, data: &Dataset) -> Result<(), CliError> {
    let shortest = data.experiments().iter().map(|e| e.len()).min().unwrap_or(0);
    match arguments.window {
        Some(window) if window < 2 || window > shortest => Err(CliError::Usage {
            what: format!("--window {window}: give at least 2, and at most the {shortest} samples on end"),
        }),
        _ => Ok(()),
    }
}

fn method(of: Method) -> SpectrumMethod {
    match of {
        Method::Welch => SpectrumMethod::Welch,
        Method::BlackmanTukey => SpectrumMethod::BlackmanTukey,
        Method::Lpm => SpectrumMethod::Lpm,
        Method::Lrm => SpectrumMethod::Lrm,
        Method::Etfe => SpectrumMethod::Etfe,
    }
}
