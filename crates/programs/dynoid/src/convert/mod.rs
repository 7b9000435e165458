//! Recordings in another format: which file each becomes, which channels are taken, and what is lost on the way.

mod choice;
mod cut;
mod facts;
mod targets;

use std::path::Path;

use ident::Intersample;
use page::Figure;
use recording::{Recording, Selection};
use report::recording::{figures, not_carried_over};
use toolbox_report::one_clock;
use work::Context;

use crate::error::Error;
use crate::files::Files;
use crate::find::InputFile;
use crate::formats::FileFormat;
use crate::paths;
use crate::read::Read;
use choice::choices;
use targets::{Target, in_folder, one_file};

pub use facts::{ChannelFacts, ConvertedFacts, RasterFacts, WrittenFacts};

/// Channels, time and clock of recordings that are converted.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ConvertOptions {
    /// Names of the channels, with `*` and `?` as wildcards; all without any. Each has to be in one recording at least.
    pub channels: Vec<String>,
    /// Everything before this time is left out, s.
    pub start_s: Option<f64>,
    /// Everything after this time is left out, s.
    pub end_s: Option<f64>,
    /// Sample time of one clock for all channels, s. Of text without a time column it is the time from row to row.
    pub sample_time_s: Option<f64>,
    /// Sample rate of one clock for all channels, Hz.
    pub rate_hz: Option<f64>,
    /// Course of slower channels between their samples on another clock; held without it.
    pub between: Option<Intersample>,
    /// True where [`WrittenFacts`] state the SHA-256 of each recording, for which the whole file is read.
    pub with_hashes: bool,
}

/// Recordings with the files that they become. Nothing is written before [`Conversion::run`].
#[derive(Debug)]
pub struct Conversion {
    targets: Vec<Target>,
    options: ConvertOptions,
    /// True where the folder of the results may be missing yet.
    makes_folder: bool,
}

impl Conversion {
    /// One recording, which becomes a file of the format that its ending says.
    ///
    /// # Errors
    /// Several recordings, and a file that must stay.
    pub fn into_file(
        recordings: Vec<InputFile>,
        out: &Path,
        options: ConvertOptions,
        files: &Files,
    ) -> Result<Self, Error> {
        options.check()?;
        let targets = vec![one_file(recordings, out, files)?];
        Ok(Conversion { targets, options, makes_folder: false })
    }

    /// Recordings, each of which becomes a file of the same name in a folder.
    ///
    /// # Errors
    /// Two recordings of one name, and files that must stay.
    pub fn into_folder(
        recordings: Vec<InputFile>,
        out: &Path,
        format: FileFormat,
        options: ConvertOptions,
        files: &Files,
    ) -> Result<Self, Error> {
        options.check()?;
        let targets = in_folder(recordings, out, format, files)?;
        Ok(Conversion { targets, options, makes_folder: true })
    }

    /// Number of recordings.
    pub fn count(&self) -> usize {
        self.targets.len()
    }

    /// Converts one recording after the other, and hands on what became of each. One of several that cannot be read
    /// leaves the others their conversion; a full disk does not. Each file is written whole or not at all.
    ///
    /// # Errors
    /// A channel that no recording has, a recording that cannot be converted if it is the only one, and a file that
    /// cannot be written.
    pub fn run(&self, files: &Files, context: &Context, mut each: impl FnMut(Converted)) -> Result<(), Error> {
        let chosen = choices(&self.targets, &self.options.channels, files)?;
        for (target, choice) in self.targets.iter().zip(chosen) {
            let file = || target.input.name.clone();
            let Some(selection) = choice.selection else {
                let note = format!("{}; it is not converted", choice.without.unwrap_or_default());
                each(Converted::Left { file: file(), note });
                continue;
            };
            match self.one(target, &selection, choice.without, files, context) {
                Ok(written) => each(Converted::Written(Box::new(written))),
                Err(error) if self.count() > 1 && error.is_of_input() => {
                    each(Converted::Failed { file: file(), error });
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// Reads, cuts, resamples and writes one recording.
    fn one(
        &self,
        target: &Target,
        selection: &Selection,
        without: Option<String>,
        files: &Files,
        context: &Context,
    ) -> Result<WrittenRecording, Error> {
        let (options, name) = (&self.options, &target.input.name);
        let step = context.step(format!("converting {name}"), 0);
        let Read { mut recording, is_untimed } =
            files.read_recording(&target.input, selection, options.sample_time_s, &step)?;
        let mut notes: Vec<String> = without.into_iter().collect();
        notes.extend(recording.findings.iter().map(ToString::to_string));
        notes.extend(not_carried_over(&files.extras(&target.input)?));
        if options.start_s.is_some() || options.end_s.is_some() {
            notes.extend(cut::cut(&mut recording, options.window_s()));
        }
        if recording.channels.is_empty() {
            return Err(Error::NothingToConvert { file: name.clone(), reasons: notes });
        }
        if let Some(sample_time_s) = options.clock_s(is_untimed, name)? {
            let between = options.between.unwrap_or(Intersample::ZeroOrderHold);
            let brought = dataset::on_one_clock(name, recording, sample_time_s, between)?;
            notes.extend(one_clock::adjustments(&brought.adjustments));
            notes.extend(one_clock::left_out(&brought.left_out));
            recording = brought.recording;
        }
        notes.extend(target.format.fit(&mut recording));
        if let Some(folder) = target.out.parent().filter(|_| self.makes_folder) {
            std::fs::create_dir_all(folder).map_err(|source| Error::write(folder, source))?;
        }
        let sha256 = options.with_hashes.then(|| files.sha256(&target.input)).transpose()?;
        target.format.write(&recording, &target.out, files)?;
        let out = paths::with_slashes(&target.out);
        let facts = WrittenFacts::of(name, sha256, out, &recording, notes);
        Ok(WrittenRecording { facts, recording })
    }
}

impl ConvertOptions {
    /// Checks the times, as a conversion does before any work.
    ///
    /// # Errors
    /// A time that ends before it begins.
    pub fn check(&self) -> Result<(), Error> {
        match (self.start_s, self.end_s) {
            (Some(from_s), Some(to_s)) if from_s > to_s => Err(Error::EmptyWindow { from_s, to_s }),
            _ => Ok(()),
        }
    }

    fn window_s(&self) -> std::ops::RangeInclusive<f64> {
        self.start_s.unwrap_or(f64::NEG_INFINITY)..=self.end_s.unwrap_or(f64::INFINITY)
    }

    /// Sample time of the one clock that is asked for; none where every raster keeps its own.
    fn clock_s(&self, is_untimed: bool, file: &str) -> Result<Option<f64>, Error> {
        // Where time is counted from row to row, the sample time was that from row to row.
        let own_s = self.sample_time_s.filter(|_| !is_untimed);
        match (self.rate_hz, own_s) {
            (Some(_), Some(_)) => Err(Error::TwoClocks { file: file.to_owned() }),
            (rate_hz, own_s) => Ok(rate_hz.map(|rate_hz| 1.0 / rate_hz).or(own_s)),
        }
    }
}

/// Result for one recording.
#[derive(Debug)]
pub enum Converted {
    /// It was written.
    Written(Box<WrittenRecording>),
    /// It has none of the channels.
    Left {
        /// Name of the recording.
        file: String,
        /// The reason.
        note: String,
    },
    /// It cannot be converted.
    Failed {
        /// Name of the recording.
        file: String,
        /// The reason.
        error: Error,
    },
}

impl Converted {
    /// The result in numbers.
    pub fn facts(&self) -> ConvertedFacts {
        match self {
            Converted::Written(written) => ConvertedFacts::Written(written.facts.clone()),
            Converted::Left { file, note } => ConvertedFacts::Left { file: file.clone(), notes: vec![note.clone()] },
            Converted::Failed { file, error } => {
                ConvertedFacts::Failed { file: file.clone(), error: error.to_string() }
            }
        }
    }
}

/// A recording as it was written.
#[derive(Debug)]
pub struct WrittenRecording {
    facts: WrittenFacts,
    recording: Recording,
}

impl WrittenRecording {
    /// The recording in numbers, with notes on what was done and lost on the way.
    pub fn facts(&self) -> &WrittenFacts {
        &self.facts
    }

    /// The recording.
    pub fn recording(&self) -> &Recording {
        &self.recording
    }

    /// Pictures of the channels.
    pub fn figures(&self) -> Vec<Figure> {
        figures(&self.facts.out, &self.recording)
    }
}
