//! Reading files.

use std::fmt::Write as _;
use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::Path;
use std::sync::Arc;

use recording::{
    Catalogue, CsvProblem, Extras, Handle, Recording, RecordingError, Selection, catalogue_from, decode_from,
    extras_from,
};
use rig::BenchFile;
use sha2::{Digest, Sha256};
use study::Source;
use work::Context;

use crate::error::Error;
use crate::files::Files;
use crate::find::InputFile;
use crate::paths;

/// Bytes of a pipe or a device that are read at most, which may have no end: more than a bench file or a model has.
const MOST_OF_STREAM: u64 = 1 << 26;

impl Files {
    /// The bytes of a file.
    pub fn read_bytes(&self, path: &Path) -> Result<Vec<u8>, Error> {
        refuse_folder(path)?;
        self.reads(path);
        let failed = |source| Error::read(path, source);
        if !paths::is_stream(path) {
            return std::fs::read(path).map_err(failed);
        }
        let mut bytes = Vec::new();
        File::open(path).and_then(|stream| stream.take(MOST_OF_STREAM + 1).read_to_end(&mut bytes)).map_err(failed)?;
        if bytes.len() as u64 > MOST_OF_STREAM { Err(Error::IsStream { path: path.to_owned() }) } else { Ok(bytes) }
    }

    /// The text of a file, without a byte order mark. The error for a file that is not text names what is `wanted`.
    pub fn read_text(&self, path: &Path, wanted: &'static str) -> Result<String, Error> {
        let text =
            String::from_utf8(self.read_bytes(path)?).map_err(|_| Error::NotText { path: path.to_owned(), wanted })?;
        Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
    }

    /// Reads the channels of a bench from a recording. If decoding fails, the source holds the reason.
    ///
    /// The whole file is in memory only if its format requires it.
    pub fn read_source(&self, file: &InputFile, bench: &BenchFile, context: &Context) -> Result<Source, Error> {
        let names = Selection::names(bench.channels.values().map(|mapping| mapping.name.as_str()));
        let recording = match self.decode(file, &names, context)? {
            // For names like the one that is missing, and for what else is missing.
            Err(RecordingError::NoSuchChannel { .. }) => self.decode(file, &Selection::All, context)?,
            read => read,
        };
        Ok(Source { file: file.name.clone(), sha256: self.sha256(file)?, recording })
    }

    /// Decodes channels of a recording.
    pub fn decode(
        &self,
        file: &InputFile,
        channels: &Selection,
        context: &Context,
    ) -> Result<Result<Recording, RecordingError>, Error> {
        Ok(decode_from(&file.name, self.opened(file)?, channels, None, context))
    }

    /// The channels of a recording; without reading samples, if the format allows.
    pub fn catalogue(&self, file: &InputFile) -> Result<Catalogue, Error> {
        refuse_model(file)?;
        catalogue_from(&file.name, self.opened(file)?).map_err(|source| Error::Recording { source, untimed: false })
    }

    /// Opens a recording, of which ranges and overviews are read.
    pub fn open(&self, file: &InputFile, context: &Context) -> Result<Handle, Error> {
        refuse_model(file)?;
        let opened = recording::open(&file.name, self.opened(file)?, None, context);
        opened.map_err(|source| Error::Recording { untimed: lacks_time(&source), source })
    }

    /// Reads and decodes a recording, or text without a time column if the time from row to row is given.
    pub fn read_recording(
        &self,
        file: &InputFile,
        selection: &Selection,
        row_time_s: Option<f64>,
        context: &Context,
    ) -> Result<Read, Error> {
        refuse_model(file)?;
        let content = self.opened(file)?;
        let strictly = decode_from(&file.name, content.clone(), selection, None, context);
        let is_usable = match &strictly {
            Ok(recording) => !recording.channels.is_empty(),
            Err(RecordingError::NoSuchChannel { .. }) => true,
            Err(_) => false,
        };
        let is_untimed = row_time_s.is_some() && !is_usable;
        let recording =
            if is_untimed { decode_from(&file.name, content, selection, row_time_s, context) } else { strictly };
        let untimed = |error: &RecordingError| row_time_s.is_none() && lacks_time(error);
        let recording = recording.map_err(|source| Error::Recording { untimed: untimed(&source), source })?;
        Ok(Read { recording, is_untimed })
    }

    /// The content of a recording besides its channels.
    pub fn extras(&self, file: &InputFile) -> Result<Extras, Error> {
        extras_from(&file.name, &*self.opened(file)?).map_err(|source| Error::Recording { source, untimed: false })
    }

    /// The SHA-256 of a file's content, hexadecimal.
    pub fn sha256(&self, file: &InputFile) -> Result<String, Error> {
        sha256_of(&mut &*self.opened(file)?).map_err(|source| Error::read(&file.path, source))
    }

    fn opened(&self, file: &InputFile) -> Result<Arc<File>, Error> {
        refuse_folder(&file.path)?;
        if paths::is_stream(&file.path) {
            return Err(Error::IsStream { path: file.path.clone() });
        }
        self.reads(&file.path);
        File::open(&file.path).map(Arc::new).map_err(|source| Error::read(&file.path, source))
    }
}

fn refuse_folder(path: &Path) -> Result<(), Error> {
    match path.is_dir() {
        true => Err(Error::IsFolder { path: path.to_owned(), remedy: "name a file in it".into() }),
        false => Ok(()),
    }
}

/// The first bytes of a file, without a byte order mark; none where it cannot be read.
fn beginning(path: &Path) -> Vec<u8> {
    if paths::is_stream(path) {
        return Vec::new();
    }
    let mut head = [0; 64];
    let read = File::open(path).and_then(|mut file| file.read(&mut head)).unwrap_or(0);
    let text = head[..read].strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&head[..read]);
    text.trim_ascii_start().to_vec()
}

/// Tells whether a file begins like JSON, as model files do and no recording does.
pub fn is_json(path: &Path) -> bool {
    beginning(path).starts_with(b"{")
}

/// Refuses a model file where a recording is wanted.
pub fn refuse_model(file: &InputFile) -> Result<(), Error> {
    let head = beginning(&file.path);
    let text = String::from_utf8_lossy(&head);
    let is_model = ["\"dynoid model\"", "\"dynoid bench model\""].iter().any(|format| text.contains(format));
    match head.starts_with(b"{") && is_model {
        true => Err(Error::IsModel { path: file.path.clone() }),
        false => Ok(()),
    }
}

/// The channels of these names or patterns; all channels without any.
pub fn selection(names: &[String]) -> Selection {
    match names {
        [] => Selection::All,
        patterns => Selection::Patterns(patterns.iter().map(|p| p.trim().to_owned()).collect()),
    }
}

/// A recording that was read.
pub struct Read {
    /// Its content.
    pub recording: Recording,
    /// True where its time was counted, from row to row.
    pub is_untimed: bool,
}

/// Tells whether a table could not be read because no column is its time.
fn lacks_time(error: &RecordingError) -> bool {
    match error {
        RecordingError::NoTimeColumn { .. } => true,
        RecordingError::Csv { problem, .. } => {
            matches!(problem, CsvProblem::NoTime { .. } | CsvProblem::NoHeader | CsvProblem::NoDelimiter)
        }
        _ => false,
    }
}

/// The SHA-256 of a text, hexadecimal.
pub fn sha256_of_text(text: &str) -> String {
    sha256_of_bytes(text.as_bytes())
}

/// The SHA-256 of a file's bytes, hexadecimal.
pub(crate) fn sha256_of_bytes(bytes: &[u8]) -> String {
    hexadecimal(&Sha256::digest(bytes))
}

fn sha256_of(content: &mut impl std::io::Read) -> std::io::Result<String> {
    let mut hash = Sha256::new();
    let mut buffer = vec![0; 1 << 20];
    loop {
        match content.read(&mut buffer) {
            Ok(0) => return Ok(hexadecimal(&hash.finalize())),
            Ok(count) => hash.update(&buffer[..count]),
            Err(error) if error.kind() == ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        let _ = write!(text, "{byte:02x}");
        text
    })
}
