//! From recordings and channel names to data without trend.

use std::path::{Path, PathBuf};

use bench::dataset::{Adjustment, DatasetOptions, dataset};
use ident::{Advice, Dataset, Intersample, Source, Trend, TrendScope, TrendShape, advise};
use recording::{Recording, Selection};

use crate::cli::identify::{Between, DataArguments, Detrend};
use crate::error::CliError;
use crate::input::{self, InputFile};
use crate::terminal::Terminal;

/// Most names listed in a message.
const MOST_NAMES: usize = 20;

/// Data as an estimator gets them.
pub(super) struct Loaded {
    /// The data, trend taken off.
    pub(super) data: Dataset,
    /// What was taken off.
    pub(super) trend: Option<Trend>,
    /// The recordings they come from.
    pub(super) sources: Vec<Source>,
}

/// Reads the recordings, takes the channels out of them and their trend off, and says what was done on the way.
pub(super) fn load(arguments: &DataArguments, terminal: &mut Terminal) -> Result<Loaded, CliError> {
    let all: Vec<&String> = arguments.inputs.iter().chain(&arguments.outputs).collect();
    if let Some(twice) = all.iter().enumerate().find(|(index, name)| all[..*index].contains(name)) {
        let what = format!("the channel \"{}\" is named twice among --input and --output; name it once", twice.1);
        return Err(CliError::Usage { what });
    }
    load_files(&arguments.recordings, arguments, terminal)
}

/// The same channels of other recordings.
pub(super) fn load_files(
    files: &[PathBuf],
    arguments: &DataArguments,
    terminal: &mut Terminal,
) -> Result<Loaded, CliError> {
    if let (Some(from_s), Some(to_s)) = (arguments.from_s, arguments.to_s)
        && from_s >= to_s
    {
        return Err(CliError::Usage {
            what: format!("--from {from_s} lies at or after --to {to_s}; give the earlier time first"),
        });
    }
    let files = input::named(files)?;
    let progress = terminal.progress(files.len() as u64);
    let mut read = Vec::new();
    for file in &files {
        progress.say(&format!("reading {}", file.name));
        read.push(decode(file, arguments.sample_time_s)?);
        progress.step();
    }
    drop(progress);
    let names = short_names(&files);
    let recordings: Vec<(&str, &Recording)> =
        names.iter().zip(&read).map(|(name, (recording, _))| (name.as_str(), recording)).collect();
    let options = DatasetOptions {
        inputs: arguments.inputs.clone(),
        outputs: chosen_outputs(arguments, &recordings)?,
        from_s: arguments.from_s,
        to_s: arguments.to_s,
        sample_time_s: arguments.sample_time_s,
    };
    let (data, adjustments) = dataset(&recordings, &options).map_err(CliError::from)?;
    let data = data.with_intersample(intersample(arguments.between));
    adjustments.iter().for_each(|adjustment| terminal.warning(&words(adjustment)));
    let is_stand_in = arguments.outputs.iter().all(|name| arguments.inputs.contains(name));
    let advice = if is_stand_in { Vec::new() } else { advise(&data) };
    for advice in advice.iter().filter(|advice| matters(advice, arguments.detrend)) {
        terminal.warning(&with_names(&advice.to_string(), &data));
    }
    let trend = trend(&data, arguments.detrend).map_err(|source| CliError::identify("the trend", source))?;
    let sources = sources(&files, &read, &data);
    let data = match &trend {
        Some(trend) => trend.remove(&data).map_err(|source| CliError::identify("the trend", source))?,
        None => data,
    };
    Ok(Loaded { data, trend, sources })
}

/// What recordings are called: by their file's name alone where that tells them apart.
fn short_names(files: &[InputFile]) -> Vec<String> {
    let short = |file: &InputFile| file.path.file_name().map(|n| n.to_string_lossy().into_owned());
    let names: Vec<Option<String>> = files.iter().map(short).collect();
    let is_unique = |name: &Option<String>| names.iter().filter(|n| *n == name).count() == 1;
    let all_unique = names.iter().all(is_unique);
    let name = |(file, name): (&InputFile, &Option<String>)| match name {
        Some(name) if all_unique => name.clone(),
        _ => file.name.clone(),
    };
    files.iter().zip(&names).map(name).collect()
}

/// A recording and the hash of its bytes. Text without a time column is read where the sample time is given.
fn decode(file: &InputFile, sample_time_s: Option<f64>) -> Result<(Recording, String), CliError> {
    let bytes = input::read_bytes(&file.path)?;
    let strictly = recording::decode(&file.name, &bytes, &Selection::All);
    let recording = match (strictly, sample_time_s) {
        (Ok(recording), _) if !recording.channels.is_empty() => Ok(recording),
        (_, Some(sample_time_s)) => recording::decode_untimed(&file.name, &bytes, sample_time_s),
        (other, None) => other,
    };
    let recording = recording.map_err(|source| CliError::Recording { source, untimed: sample_time_s.is_none() })?;
    Ok((recording, input::sha256(&bytes)))
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

fn trend(data: &Dataset, detrend: Detrend) -> Result<Option<Trend>, ident::IdentError> {
    let shape = match detrend {
        Detrend::Mean => TrendShape::Mean,
        Detrend::Line => TrendShape::Line,
        Detrend::None => return Ok(None),
    };
    Trend::estimate(data, shape, TrendScope::PerExperiment).map(Some)
}

/// Advice counts channels and experiments; people know them by name.
fn with_names(text: &str, data: &Dataset) -> String {
    let mut named = text.to_owned();
    // From the last on, so that "input 1" is not found in "input 12".
    for (kind, labels) in [("input", data.input_labels()), ("output", data.output_labels())] {
        for (index, label) in labels.iter().enumerate().rev() {
            named = named.replace(&format!("{kind} {}", index + 1), &format!("\"{}\"", label.name));
        }
    }
    for (index, experiment) in data.experiments().iter().enumerate().rev() {
        named = named.replace(&format!("experiment {}", index + 1), &experiment.name);
    }
    named
}

/// Refuses to write over a file that is read.
pub(super) fn check_targets(targets: &[&Option<PathBuf>], read: &[&[PathBuf]]) -> Result<(), CliError> {
    let same = |a: &Path, b: &Path| matches!((a.canonicalize(), b.canonicalize()), (Ok(a), Ok(b)) if a == b);
    for target in targets.iter().filter_map(|target| target.as_ref()) {
        if read.iter().flat_map(|list| list.iter()).any(|file| same(file, target)) {
            let what = format!("{}: this file is read; give the result another name", target.display());
            return Err(CliError::Usage { what });
        }
    }
    Ok(())
}

/// Offsets are no news where they are taken off.
fn matters(advice: &Advice, detrend: Detrend) -> bool {
    match advice {
        Advice::Offset { .. } => detrend == Detrend::None,
        Advice::Drift { .. } => detrend != Detrend::Line,
        _ => true,
    }
}

fn words(adjustment: &Adjustment) -> String {
    match adjustment {
        Adjustment::Jitter { channel, largest_s } => format!(
            "\"{channel}\": its time stamps are up to {largest_s:.3e} s off an even clock; values were found on straight lines between the samples"
        ),
        Adjustment::Resampled { channel, from_s, to_s } => format!(
            "\"{channel}\" was brought from a sample time of {from_s:.6} s to {to_s:.6} s{}",
            if to_s > from_s {
                ", through a low-pass filter without phase shift; for fast dynamics give the faster clock with --sample-time"
            } else {
                ""
            }
        ),
        Adjustment::Sparse { channel, sample_time_s } => format!(
            "\"{channel}\" has a sample only every {sample_time_s:.6} s and counts as missing between; methods that look at the simulated output (oe, tf, process, greybox) can use it so"
        ),
        Adjustment::Missing { channel, count } => {
            format!("\"{channel}\": {count} samples are missing")
        }
    }
}

fn sources(files: &[InputFile], read: &[(Recording, String)], data: &Dataset) -> Vec<Source> {
    let source = |((file, (_, sha256)), experiment): ((&InputFile, &(Recording, String)), &ident::Experiment)| Source {
        file: file.name.clone(),
        sha256: sha256.clone(),
        from_s: experiment.start_s,
        to_s: experiment.start_s + experiment.len().saturating_sub(1) as f64 * data.sample_time_s(),
    };
    files.iter().zip(read).zip(data.experiments()).map(source).collect()
}

/// The kind of picture a file's ending asks for.
pub(super) fn draw(path: &Path, title: &str, figures: &[plot::Figure]) -> Result<Vec<u8>, CliError> {
    match input::ending(path).map(str::to_lowercase).as_deref() {
        Some("html" | "htm") => Ok(plot::page(title, figures).into_bytes()),
        Some("svg") => Ok(plot::svg(figures).into_bytes()),
        Some("png") => plot::png(figures).map_err(CliError::internal),
        _ => Err(CliError::PlotEnding { path: path.to_owned() }),
    }
}
