//! Recordings in another format.

use std::ops::Range;

use dataset::on_one_clock;
use dynoid::{Error, Read, paths};
use ident::Intersample;
use page::{Figure, Page};
use recording::{Recording, Selection};
use report::recording::{figures, not_carried_over};
use serde::Serialize;

use super::choice::choices;
use super::targets::{Target, plan};
use crate::cli::convert::ConvertArguments;
use crate::cli::identify::Between;
use crate::commands::result::{Sorted, check_plot, show};
use crate::error::{CliError, Outcome};
use crate::terminal::Terminal;
use toolbox_report::one_clock;
use toolbox_report::words::counted;

/// Most notes that are shown of one file; all are in the JSON.
const MOST_NOTES: usize = 12;

/// Outcome of a recording.
#[derive(Debug, Serialize)]
#[serde(untagged)]
enum Row<'a> {
    Written(Written),
    /// It has none of the channels.
    Left {
        file: &'a str,
        notes: [String; 1],
    },
    Failed {
        file: &'a str,
        error: String,
    },
}

/// A recording that was written.
#[derive(Debug, Serialize)]
struct Written {
    file: String,
    /// Of the whole file, which is read for it; only where it is shown.
    sha256: Option<String>,
    out: String,
    rasters: Vec<RasterFacts>,
    channels: Vec<ChannelFacts>,
    /// Steps on the way, and losses.
    notes: Vec<String>,
}

#[derive(Debug, Serialize)]
struct RasterFacts {
    name: Option<String>,
    samples: usize,
    from_s: Option<f64>,
    to_s: Option<f64>,
}

#[derive(Debug, Serialize)]
struct ChannelFacts {
    name: String,
    unit: String,
    raster: usize,
}

/// `dynoid convert`
pub(crate) fn run(arguments: &ConvertArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    check(arguments)?;
    let targets = plan(terminal.files().named(&arguments.files)?, arguments, &terminal.files())?;
    check_plot(&arguments.result, &terminal.files())?;
    let chosen = choices(&targets, &arguments.channels, &terminal.files())?;
    let (mut rows, mut drawn, mut unreadable) = (Vec::new(), Vec::new(), 0);
    for (target, choice) in targets.iter().zip(chosen) {
        let without = choice.without;
        let Some(selection) = choice.selection else {
            let note = format!("{}; it is not converted", without.unwrap_or_default());
            if !arguments.result.json {
                terminal.warning(&format!("{}: {note}", target.input.name));
            }
            rows.push(Row::Left { file: &target.input.name, notes: [note] });
            continue;
        };
        match one(target, &selection, without, arguments, terminal) {
            Ok((written, figures)) => {
                drawn.extend(figures);
                say(&written, targets.len() > 1, arguments.result.json, terminal);
                rows.push(Row::Written(written));
            }
            // One that cannot be converted leaves the others their conversion; a full disk does not.
            Err(error) if targets.len() > 1 && error.is_of_input() => {
                unreadable += 1;
                terminal.error(&error.to_string());
                rows.push(Row::Failed { file: &target.input.name, error: error.to_string() });
            }
            Err(error) => return Err(error),
        }
    }
    show(&arguments.result, || Page::of_figures("Converted", drawn), || Sorted(rows), terminal)?;
    Ok(if unreadable > 0 { Outcome::SomeUnreadable } else { Outcome::Done })
}

fn check(arguments: &ConvertArguments) -> Result<(), CliError> {
    let usage = |what: String| Err(CliError::Usage { what });
    if let (Some(start_s), Some(end_s)) = (arguments.start, arguments.end)
        && start_s > end_s
    {
        return usage(format!("--start {start_s} lies after --end {end_s}; give the earlier time first"));
    }
    if arguments.between.is_some() && arguments.sample_time.is_none() && arguments.rate.is_none() {
        return usage(
            "--between says how channels come onto another clock; give one with --sample-time or --rate".into(),
        );
    }
    Ok(())
}

fn say(written: &Written, is_one_of_many: bool, json: bool, terminal: &mut Terminal) {
    if json {
        return;
    }
    let prefix = if is_one_of_many { format!("{}: ", written.file) } else { String::new() };
    for note in written.notes.iter().take(MOST_NOTES) {
        terminal.warning(&format!("{prefix}{note}"));
    }
    if written.notes.len() > MOST_NOTES {
        terminal.warning(&format!("{prefix}and {} more; see --json", written.notes.len() - MOST_NOTES));
    }
    if !terminal.is_quiet() {
        let (channels, rasters) = (written.channels.len(), written.rasters.len());
        terminal.line(&format!(
            "written: {} ({}, {})",
            written.out,
            counted(channels, "channel"),
            counted(rasters, "raster")
        ));
    }
}

/// Reads, cuts, resamples and writes one recording; draws what was written where a picture is asked for.
fn one(
    target: &Target,
    selection: &Selection,
    without: Option<String>,
    arguments: &ConvertArguments,
    terminal: &Terminal,
) -> Result<(Written, Vec<Figure>), CliError> {
    let step = terminal.work().step(format!("converting {}", target.input.name), 0);
    let Read { mut recording, is_untimed } =
        terminal.files().read_recording(&target.input, selection, arguments.sample_time, &step)?;
    let mut notes: Vec<String> = without.into_iter().collect();
    notes.extend(recording.findings.iter().map(ToString::to_string));
    notes.extend(not_carried_over(&terminal.files().extras(&target.input)?));
    if arguments.start.is_some() || arguments.end.is_some() {
        let window = (arguments.start.unwrap_or(f64::NEG_INFINITY), arguments.end.unwrap_or(f64::INFINITY));
        notes.extend(cut(&mut recording, window));
    }
    if recording.channels.is_empty() {
        return Err(CliError::NothingToConvert { file: target.input.name.clone(), reasons: notes });
    }
    if arguments.sample_time.is_some() && arguments.rate.is_some() && !is_untimed {
        return Err(CliError::Usage {
            what: format!("{}: it has time stamps, so give --sample-time or --rate, not both", target.input.name),
        });
    }
    // Where time is counted from row to row, that is what --sample-time said.
    let clock_s = arguments.sample_time.filter(|_| !is_untimed);
    let sample_time_s = arguments.rate.map(|rate_hz| 1.0 / rate_hz).or(clock_s);
    if let Some(sample_time_s) = sample_time_s {
        let between = between(arguments.between);
        let brought = on_one_clock(&target.input.name, recording, sample_time_s, between).map_err(Error::from)?;
        notes.extend(one_clock::adjustments(&brought.adjustments));
        notes.extend(one_clock::left_out(&brought.left_out));
        recording = brought.recording;
    }
    notes.extend(target.format.fit(&mut recording));
    if let Some(folder) = target.out.parent().filter(|_| arguments.to.is_some()) {
        std::fs::create_dir_all(folder).map_err(|source| Error::write(folder, source))?;
    }
    let sha256 = arguments.result.json.then(|| terminal.files().sha256(&target.input)).transpose()?;
    target.format.write(&recording, &target.out, &terminal.files())?;
    let drawn = arguments.result.plot.as_ref().map(|_| figures(&paths::with_slashes(&target.out), &recording));
    Ok((facts(target, sha256, &recording, notes), drawn.unwrap_or_default()))
}

fn between(between: Option<Between>) -> Intersample {
    match between.unwrap_or(Between::Held) {
        Between::Held => Intersample::ZeroOrderHold,
        Between::Straight => Intersample::FirstOrderHold,
        Between::BandLimited => Intersample::BandLimited,
    }
}

/// Leaves out what lies outside the window, in s, and rasters of which nothing is left.
fn cut(recording: &mut Recording, (start_s, end_s): (f64, f64)) -> Option<String> {
    let wanted = |t: &[f64]| signal::runs(t.len(), |i| (start_s..=end_s).contains(&t[i])).collect();
    let runs: Vec<Vec<Range<usize>>> = recording.rasters.iter().map(|raster| wanted(&raster.time_s)).collect();
    for channel in &mut recording.channels {
        keep(&mut channel.samples, &runs[channel.raster]);
    }
    for (raster, runs) in recording.rasters.iter_mut().zip(&runs) {
        keep(&mut raster.time_s, runs);
    }
    let (before, rasters) = (recording.channels.len(), std::mem::take(&mut recording.rasters));
    let mut places = Vec::new();
    for raster in rasters {
        places.push((!raster.time_s.is_empty()).then_some(recording.rasters.len()));
        if !raster.time_s.is_empty() {
            recording.rasters.push(raster);
        }
    }
    recording.channels.retain(|channel| places[channel.raster].is_some());
    for channel in &mut recording.channels {
        channel.raster = places[channel.raster].unwrap_or_default();
    }
    let lost = before - recording.channels.len();
    (lost > 0).then(|| format!("{lost} of {before} channels have no sample in the time asked for, and were left out"))
}

fn keep(values: &mut Vec<f64>, runs: &[Range<usize>]) {
    let mut kept = 0;
    for run in runs {
        values.copy_within(run.clone(), kept);
        kept += run.len();
    }
    values.truncate(kept);
    values.shrink_to_fit();
}

fn facts(target: &Target, sha256: Option<String>, recording: &Recording, notes: Vec<String>) -> Written {
    let raster = |raster: &recording::Raster| {
        let finite = || raster.time_s.iter().copied().filter(|t| t.is_finite());
        RasterFacts {
            name: raster.name.clone(),
            samples: raster.time_s.len(),
            from_s: finite().reduce(f64::min),
            to_s: finite().reduce(f64::max),
        }
    };
    let channel = |channel: &recording::Channel| ChannelFacts {
        name: channel.name.clone(),
        unit: channel.unit.clone(),
        raster: channel.raster,
    };
    Written {
        file: target.input.name.clone(),
        sha256,
        out: paths::with_slashes(&target.out),
        rasters: recording.rasters.iter().map(raster).collect(),
        channels: recording.channels.iter().map(channel).collect(),
        notes,
    }
}
