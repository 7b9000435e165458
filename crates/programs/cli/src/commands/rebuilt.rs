//! A torque that was rebuilt, written as a recording.

use std::path::Path;

use dynoid::{FileFormat, Files, Mark, check_file};
use recording::{Channel, Format, Raster, Recording};

use crate::error::CliError;
use crate::terminal::Terminal;

/// A torque with what belongs to it: name, comment and samples of each, in Nm.
pub(super) struct Rebuilt<'a> {
    pub(super) comment: String,
    pub(super) start_s: f64,
    pub(super) sample_time_s: f64,
    pub(super) channels: Vec<(&'a str, &'a str, &'a [f64])>,
}

/// Checks before any work that a torque can be written there: by its ending, and that nothing that is read is lost.
pub(super) fn check(out: Option<&Path>, files: &Files) -> Result<(), CliError> {
    let Some(out) = out else { return Ok(()) };
    FileFormat::of_output(out)?;
    Ok(check_file(out, &Mark::of_run(files), files)?)
}

/// The one recording whose torque, `what`, is written.
///
/// # Errors
/// There are several, or none.
pub(super) fn only<'a, T>(recordings: &'a [T], what: &str, out: &Path) -> Result<&'a T, CliError> {
    match recordings {
        [one] => Ok(one),
        _ => Err(CliError::Usage {
            what: format!(
                "{}: {what} of one recording is written, and {} are given; name the one that is meant",
                out.display(),
                recordings.len()
            ),
        }),
    }
}

/// Writes it, its format by the ending.
pub(super) fn write(rebuilt: &Rebuilt<'_>, out: &Path, terminal: &mut Terminal) -> Result<(), CliError> {
    let count = rebuilt.channels.first().map_or(0, |(_, _, samples)| samples.len());
    let time_s = (0..count).map(|k| rebuilt.start_s + k as f64 * rebuilt.sample_time_s).collect();
    let channel = |(name, comment, samples): &(&str, &str, &[f64])| Channel {
        name: (*name).to_owned(),
        unit: "Nm".to_owned(),
        comment: (*comment).to_owned(),
        raster: 0,
        samples: samples.to_vec(),
    };
    let mut recording = Recording {
        format: Format::Mdf { version: 410 },
        comment: Some(rebuilt.comment.clone()),
        start_time: None,
        rasters: vec![Raster { time_s, name: None }],
        channels: rebuilt.channels.iter().map(channel).collect(),
        findings: Vec::new(),
    };
    let format = FileFormat::of_output(out)?;
    let renamed = format.fit(&mut recording).into_iter().filter(|note| !note.starts_with("text has no place"));
    renamed.for_each(|note| terminal.warning(&note));
    Ok(format.write(&recording, out, &terminal.files())?)
}
