//! Responses of models as recordings.

use std::path::Path;

use faer::Mat;
use ident::prediction::Response;
use ident::{IdentError, Label, ModelDocument};
use recording::{Channel, Format, Raster, Recording};

use super::data::Loaded;
use crate::error::CliError;

/// Instants are written with as few decimals as leave them this close to the clock, in samples.
const CLOCK_SHARE: f64 = 1e-9;

/// Responses with the trend put back, one raster a recording; what lies in a gap is missing.
pub(super) fn recording_of(
    document: &ModelDocument,
    loaded: &Loaded,
    response: &Response,
    what: &str,
) -> Result<Recording, IdentError> {
    let (mut rasters, mut channels) = (Vec::new(), Vec::new());
    for (number, source) in loaded.sources.iter().enumerate() {
        let parts: Vec<usize> = (0..loaded.recording.len()).filter(|n| loaded.recording[*n] == number).collect();
        let Some((start_s, values)) = whole(loaded, response, number, &parts)? else { continue };
        let sample_time_s = loaded.data.sample_time_s();
        let time_s = (0..values.nrows()).map(|tick| instant_s(start_s, tick, sample_time_s)).collect();
        let channel = |(output, label): (usize, &Label)| Channel {
            name: format!("{}_{what}", label.name),
            unit: label.unit.clone(),
            comment: String::new(),
            raster: rasters.len(),
            samples: values.col_as_slice(output).to_vec(),
        };
        channels.extend(document.outputs.iter().enumerate().map(channel));
        rasters.push(Raster { time_s, name: Some(source.file.clone()) });
    }
    let format = Format::Csv { delimiter: ',', decimal_comma: false };
    Ok(Recording { format, comment: None, start_time: None, rasters, channels, findings: Vec::new() })
}

/// The parts of one recording put together: when it starts, and its outputs; nothing where it has no part.
fn whole(
    loaded: &Loaded,
    response: &Response,
    recording: usize,
    parts: &[usize],
) -> Result<Option<(f64, Mat<f64>)>, IdentError> {
    let (experiments, sample_time_s) = (loaded.data.experiments(), loaded.data.sample_time_s());
    let (Some(first), Some(last)) = (parts.first(), parts.last()) else { return Ok(None) };
    let start_s = experiments[*first].start_s;
    let place = |part: usize| ((experiments[part].start_s - start_s) / sample_time_s).round() as usize;
    let rows = place(*last) + experiments[*last].len();
    let mut all = Mat::full(rows, loaded.data.outputs(), f64::NAN);
    for part in parts {
        let values = response.outputs[*part].as_ref();
        let values = match &loaded.trend {
            Some(trend) => trend.restore_outputs(values, recording, experiments[*part].start_s, sample_time_s)?,
            None => values.to_owned(),
        };
        all.subrows_mut(place(*part), values.nrows()).copy_from(&values);
    }
    Ok(Some((start_s, all)))
}

/// The instant of a tick, as a decimal number that is short and still on the clock.
fn instant_s(start_s: f64, tick: usize, sample_time_s: f64) -> f64 {
    let exact_s = start_s + tick as f64 * sample_time_s;
    let tolerance_s = (CLOCK_SHARE * sample_time_s).max(4.0 * f64::EPSILON * exact_s.abs());
    let rounded = (0..=15).map(|decimals| {
        let scale = 10_f64.powi(decimals);
        (exact_s * scale).round() / scale
    });
    rounded.into_iter().find(|short_s| (short_s - exact_s).abs() <= tolerance_s).unwrap_or(exact_s)
}

/// Text has room for one recording.
pub(super) fn check_output(path: &Path, recordings: usize) -> Result<(), CliError> {
    match crate::input::ending(path).map(str::to_lowercase).as_deref() {
        Some("csv") if recordings > 1 => Err(CliError::Usage {
            what: format!(
                "{}: .csv holds one recording, and {recordings} are given; write .mf4, or one after the other",
                path.display()
            ),
        }),
        Some("csv" | "mf4") => Ok(()),
        _ => Err(unknown_ending(path)),
    }
}

fn unknown_ending(path: &Path) -> CliError {
    CliError::Usage { what: format!("{}: the ending of the output says what it is: .csv or .mf4", path.display()) }
}

/// A recording in the format that the file's ending says.
pub(super) fn encoded(path: &Path, recording: &Recording) -> Result<Vec<u8>, CliError> {
    let encoded = match crate::input::ending(path).map(str::to_lowercase).as_deref() {
        Some("csv") => recording::encode_csv(recording),
        Some("mf4") => recording::encode_mdf4(recording),
        _ => return Err(unknown_ending(path)),
    };
    encoded.map_err(|source| CliError::Recording { source, untimed: false })
}
