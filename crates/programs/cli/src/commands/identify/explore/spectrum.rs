//! `dynoid data spectrum`: power spectra and frequency responses.

use dataset::CommonClock;
use dynoid::linear::{Gaps, Loaded, check_movement};
use ident::Dataset;
use signal::SignalError;
use toolbox_report::spectrum::{Periods, SpectrumMethod, SpectrumOptions, facts, page, spectra};

use super::super::data::{load_on, say_one};
use crate::cli::identify::{Period, SpectrumArguments, SpectrumMethod as Method};
use crate::commands::result::{Sorted, check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;

/// `dynoid data spectrum`
pub(crate) fn spectrum(arguments: &SpectrumArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check_plot(&arguments.result, &terminal.files())?;
    let loaded = load_on(CommonClock::Slowest, &arguments.data, terminal)?;
    // Of a single channel there is a spectrum whatever it does; a response needs both to move.
    if loaded.data.inputs() > 0 {
        check_movement(&loaded)?;
    }
    let data = without_gaps(loaded, terminal)?;
    check_window(arguments, &data)?;
    check_method(arguments, data.inputs())?;
    let periods = match arguments.period {
        None => Periods::Found,
        Some(Period::None) => Periods::Ignored,
        Some(Period::Seconds(period_s)) => Periods::Given(period_s),
    };
    let options = SpectrumOptions { method: arguments.method.map(method), periods, window: arguments.window };
    let failed = |source: SignalError| wrong_period(arguments, &source).unwrap_or_else(|| not_found(source));
    let found = spectra(&data, &options).map_err(failed)?;
    show(&arguments.result, || page(&found), || Sorted(facts(&found)), terminal)?;
    Ok(Outcome::Done)
}

fn not_found(source: SignalError) -> CliError {
    CliError::identify("the spectrum", source.into())
}

/// Refuses a period given after which the inputs do not repeat, or that does not fit into the recording twice.
fn wrong_period(arguments: &SpectrumArguments, source: &SignalError) -> Option<CliError> {
    let Some(Period::Seconds(period_s)) = arguments.period else { return None };
    let why = match source {
        SignalError::NotRepeated { .. } => "the inputs do not repeat after this time",
        SignalError::Parameter { name: "period in samples", .. } => "the data do not hold two such periods",
        _ => return None,
    };
    Some(CliError::Usage { what: format!("--period {period_s}: {why}; leave it out, and the period is found") })
}

/// Of each recording the longest stretch in which nothing is missing.
fn without_gaps(loaded: Loaded, terminal: &mut Terminal) -> Result<Dataset, CliError> {
    let known = loaded.notes.len();
    let cut = loaded.cut_at(Gaps::OfAll)?;
    for note in &cut.notes[known..] {
        say_one(&note.clone().with("; of each recording the longest is shown"), terminal);
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
        Some(Method::Welch | Method::Etfe) if inputs > 1 => Err(CliError::Usage {
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
