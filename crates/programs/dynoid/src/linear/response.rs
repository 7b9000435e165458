//! Responses of models as recordings.

use std::path::Path;

use dataset::instant_s;
use faer::Mat;
use ident::{IdentError, Label, ModelDocument};
use recording::{Channel, Format, Raster, Recording};

use super::loaded::Loaded;
use crate::error::Error;
use crate::files::Files;
use crate::formats::FileFormat;
use crate::mark::Mark;
use crate::output::check_file;

/// Words for the other courses beside a response.
pub(crate) const MEASURED: &str = "measured";
pub(crate) const RESIDUAL: &str = "residual";

/// Responses with the trend put back, one raster a recording; what lies in a gap is missing.
pub(super) fn recording_of(
    document: &ModelDocument,
    loaded: &Loaded,
    outputs: &[Mat<f64>],
    what: &str,
) -> Result<Recording, IdentError> {
    let (mut rasters, mut channels) = (Vec::new(), Vec::new());
    for (number, source) in loaded.sources.iter().enumerate() {
        let parts: Vec<usize> = (0..loaded.recording.len()).filter(|n| loaded.recording[*n] == number).collect();
        let Some((start_s, values)) = whole(loaded, outputs, number, &parts)? else { continue };
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

/// The recorded outputs, the response, and the first less the second, each under the name of its output. Samples that
/// were not recorded are left out, so that an output on a slower clock is a line.
pub(super) fn beside_measured(
    document: &ModelDocument,
    loaded: &Loaded,
    outputs: &[Mat<f64>],
    what: &str,
) -> Result<Recording, IdentError> {
    let recorded: Vec<Mat<f64>> = loaded.data.experiments().iter().map(|e| e.outputs.clone()).collect();
    let measured = recording_of(document, loaded, &recorded, MEASURED)?;
    let modelled = recording_of(document, loaded, outputs, what)?;
    let names = || modelled.rasters.iter().flat_map(|_| &document.outputs).map(|label| label.name.as_str());
    let pairs = measured.channels.iter().zip(&modelled.channels).zip(names());
    let pairs: Vec<_> = pairs.map(|((one, other), name)| (name, one, other, &measured.rasters[one.raster])).collect();
    let (mut rasters, mut channels) = (modelled.rasters.clone(), modelled.channels.clone());
    for (name, measured, modelled, raster) in pairs {
        let there: Vec<usize> = (0..measured.samples.len()).filter(|k| !measured.samples[*k].is_nan()).collect();
        let taken = |of: &[f64]| there.iter().map(|k| of[*k]).collect::<Vec<f64>>();
        let residual: Vec<f64> = there.iter().map(|k| measured.samples[*k] - modelled.samples[*k]).collect();
        for (what, samples) in [(MEASURED, taken(&measured.samples)), (RESIDUAL, residual)] {
            channels.push(Channel {
                name: format!("{name}_{what}"),
                raster: rasters.len(),
                samples,
                ..measured.clone()
            });
        }
        rasters.push(Raster { time_s: taken(&raster.time_s), name: raster.name.clone() });
    }
    Ok(Recording { rasters, channels, ..modelled })
}

/// The parts of one recording put together: when it starts, and its outputs; nothing where it has no part.
fn whole(
    loaded: &Loaded,
    outputs: &[Mat<f64>],
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
        let values = outputs[*part].as_ref();
        let values = match &loaded.trend {
            Some(trend) => trend.restore_outputs(values, recording, experiments[*part].start_s, sample_time_s)?,
            None => values.to_owned(),
        };
        all.subrows_mut(place(*part), values.nrows()).copy_from(&values);
    }
    Ok(Some((start_s, all)))
}

/// Checks that recordings can be written to a file, and that its ending says a format that has room for so many: text
/// has it for one.
///
/// # Errors
/// Another ending, several recordings as text, and a file that must stay.
pub fn check_recordings_file(path: &Path, recordings: usize, files: &Files) -> Result<(), Error> {
    match FileFormat::of_output(path)? {
        format if format.is_text() && recordings > 1 => {
            Err(Error::OneRecordingFile { path: path.to_owned(), ending: format.ending(), count: recordings })
        }
        _ => check_file(path, &Mark::of_run(files), files),
    }
}
