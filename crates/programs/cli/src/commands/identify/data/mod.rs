//! From recordings and channel names to data without trend.

mod faults;
mod files;
mod gaps;
mod loaded;
mod note;

use dataset::{Adjustment, CommonClock, DatasetOptions, dataset};
use dynoid::Error;
use ident::{Advice, Dataset, IdentError, Intersample, Source, Trend, TrendScope, TrendShape, advise};
use recording::Recording;
use toolbox_report::data::{self as words, Purpose};

pub(super) use faults::{check_movement, check_variation};
pub(super) use files::RecordedFiles;
pub(super) use gaps::Gaps;
pub(super) use loaded::{Loaded, named};
pub(super) use note::{Note, say};

use crate::cli::identify::{Between, DataArguments, Detrend, Window};
use crate::error::CliError;
use crate::terminal::Terminal;

/// Most names listed in a message.
const MOST_NAMES: usize = 20;

/// Reads the recordings, takes the channels out of them and their trend off, and says what was done on the way; on a
/// clock of its own unless one is asked for.
pub(super) fn load_on(
    usual: CommonClock,
    arguments: &DataArguments,
    terminal: &mut Terminal,
) -> Result<Loaded, CliError> {
    let files = read(arguments, terminal)?;
    let loaded = take(&files, usual, arguments)?;
    say(&loaded.notes, &mut Vec::new(), terminal);
    Ok(loaded)
}

/// Reads the recordings named.
pub(super) fn read(arguments: &DataArguments, terminal: &Terminal) -> Result<RecordedFiles, CliError> {
    let all: Vec<&String> = arguments.inputs.iter().chain(&arguments.outputs).collect();
    if let Some(twice) = all.iter().enumerate().find(|(index, name)| all[..*index].contains(name)) {
        let what = format!("the channel \"{}\" is named twice among --input and --output; name it once", twice.1);
        return Err(CliError::Usage { what });
    }
    // Without outputs nothing is estimated, but what there is will be listed.
    let names: Vec<&str> =
        if arguments.outputs.is_empty() { Vec::new() } else { all.iter().map(|n| n.as_str()).collect() };
    RecordedFiles::read(&arguments.recordings, &names, arguments.sample_time_s, terminal)
}

/// As [`load_on`], cut at gaps, which is said too.
pub(super) fn load_between_gaps(
    usual: CommonClock,
    gaps: Gaps,
    arguments: &DataArguments,
    terminal: &mut Terminal,
) -> Result<Loaded, CliError> {
    let whole = load_on(usual, arguments, terminal)?;
    let mut said = whole.notes.clone();
    let cut = whole.cut_at(gaps)?;
    say(&cut.notes, &mut said, terminal);
    Ok(cut)
}

/// The channels of recordings that were read, trend taken off.
pub(super) fn take(files: &RecordedFiles, usual: CommonClock, arguments: &DataArguments) -> Result<Loaded, CliError> {
    let shape = shape(arguments.detrend);
    take_about(files, usual, arguments, Purpose::Estimate(shape), |data, _| trend(data, shape))
}

/// As [`take`], with the trend that is found in the data and where they come from.
pub(super) fn take_about(
    files: &RecordedFiles,
    usual: CommonClock,
    arguments: &DataArguments,
    purpose: Purpose,
    trend: impl FnOnce(&Dataset, &[Source]) -> Result<Option<Trend>, IdentError>,
) -> Result<Loaded, CliError> {
    check_window(arguments.window)?;
    let recordings = files.recordings();
    let options = DatasetOptions {
        inputs: arguments.inputs.clone(),
        outputs: chosen_outputs(arguments, &recordings)?,
        from_s: arguments.window.from_s,
        to_s: arguments.window.to_s,
        clock: arguments.sample_time_s.map_or(usual, CommonClock::Every),
        intersample: intersample(arguments.between.unwrap_or(Between::Held)),
    };
    let (data, adjustments) = dataset(&recordings, &options).map_err(Error::from)?;
    faults::check_sizes(&data, &files.named(&data))?;
    let mut notes: Vec<Note> = files.doubles().into_iter().map(Note::Warning).collect();
    notes.extend(files.clocks().into_iter().map(Note::Done));
    // Inputs that stand in for outputs have their own adjustments.
    let is_stand_in = arguments.outputs.iter().all(|name| arguments.inputs.contains(name));
    let is_news = |a: &&Adjustment| !(is_stand_in && matches!(a, Adjustment::Sparse { .. }));
    let given = arguments.sample_time_s.is_some();
    notes.extend(adjustments.iter().filter(is_news).map(|a| Note::Done(words::adjustment(a, purpose, given))));
    let advice = if is_stand_in { Vec::new() } else { advise(&data) };
    let is_explained = |advice: &&Advice| words::is_explained(advice, &adjustments, &data);
    let advice = advice.iter().filter(|advice| words::matters(advice, purpose)).filter(|a| !is_explained(a));
    notes.extend(advice.map(|advice| Note::Warning(words::advice(advice, &data))));
    let sources = files.sources(&data);
    let trend = trend(&data, &sources).map_err(|source| CliError::identify("the trend", source))?;
    let data = match &trend {
        Some(trend) => trend.remove(&data).map_err(|source| CliError::identify("the trend", source))?,
        None => data,
    };
    let recording = (0..data.experiments().len()).collect();
    let between = options.intersample;
    Ok(Loaded { data, between, trend, sources, recording, adjustments, notes })
}

fn check_window(window: Window) -> Result<(), CliError> {
    match (window.from_s, window.to_s) {
        (Some(from_s), Some(to_s)) if from_s >= to_s => Err(CliError::Usage {
            what: format!("--from {from_s} lies at or after --to {to_s}; give the earlier time first"),
        }),
        _ => Ok(()),
    }
}

/// The outputs named, or an error that lists what there is.
fn chosen_outputs(arguments: &DataArguments, recordings: &[(&str, &Recording)]) -> Result<Vec<String>, CliError> {
    if !arguments.outputs.is_empty() {
        return Ok(arguments.outputs.clone());
    }
    let (file, recording) = recordings.first().copied().unzip();
    let channels = recording.map(|r| r.channels.as_slice()).unwrap_or_default();
    let mut names: Vec<&str> = channels.iter().map(|c| c.name.as_str()).take(MOST_NAMES).collect();
    if channels.len() > MOST_NAMES {
        names.push("…");
    }
    Err(CliError::NoOutputNamed { file: file.unwrap_or_default().to_owned(), channels: names.join(", ") })
}

fn intersample(between: Between) -> Intersample {
    match between {
        Between::Held => Intersample::ZeroOrderHold,
        Between::Straight => Intersample::FirstOrderHold,
        Between::BandLimited => Intersample::BandLimited,
    }
}

fn shape(detrend: Detrend) -> Option<TrendShape> {
    match detrend {
        Detrend::Mean => Some(TrendShape::Mean),
        Detrend::Line => Some(TrendShape::Line),
        Detrend::None => None,
    }
}

/// The trend of data themselves.
pub(super) fn trend(data: &Dataset, shape: Option<TrendShape>) -> Result<Option<Trend>, IdentError> {
    shape.map(|shape| Trend::estimate(data, shape, TrendScope::PerExperiment)).transpose()
}
