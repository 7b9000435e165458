//! Finding and reading files.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

use recording::{
    Catalogue, CsvProblem, Extras, Recording, RecordingError, Selection, catalogue_from, decode_from, extras_from,
};
use rig::BenchFile;
use sha2::{Digest, Sha256};
use study::Source;
use work::Context;

use crate::error::CliError;
use crate::mark::Mark;
use crate::paths;
use crate::patterns::{self, PatternFault};
use crate::this_run::{self, Listing};

/// Endings of files that are taken for recordings in a folder.
const ENDINGS: [&str; 11] = ["mf4", "mdf", "dat", "csv", "tsv", "mat", "h5", "hdf5", "parquet", "arrow", "feather"];

/// Bytes of a pipe or a device that are read at most, which may have no end: more than a bench file or a model has.
const MOST_OF_STREAM: u64 = 1 << 26;

/// A recording that was found.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct InputFile {
    /// Where it is.
    pub(crate) path: PathBuf,
    /// Name that the user gives it.
    pub(crate) name: String,
}

/// The bytes of a file.
pub(crate) fn read_bytes(path: &Path) -> Result<Vec<u8>, CliError> {
    refuse_folder(path)?;
    this_run::reads(path);
    let failed = |source| CliError::read(path, source);
    if !paths::is_stream(path) {
        return std::fs::read(path).map_err(failed);
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|stream| stream.take(MOST_OF_STREAM + 1).read_to_end(&mut bytes)).map_err(failed)?;
    if bytes.len() as u64 > MOST_OF_STREAM { Err(CliError::IsStream { path: path.to_owned() }) } else { Ok(bytes) }
}

fn refuse_folder(path: &Path) -> Result<(), CliError> {
    match path.is_dir() {
        true => Err(CliError::IsFolder { path: path.to_owned(), remedy: "name a file in it".into() }),
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
pub(crate) fn is_json(path: &Path) -> bool {
    beginning(path).starts_with(b"{")
}

/// Refuses a model file where a recording is wanted.
pub(crate) fn refuse_model(file: &InputFile) -> Result<(), CliError> {
    let head = beginning(&file.path);
    let text = String::from_utf8_lossy(&head);
    let is_model = ["\"dynoid model\"", "\"dynoid bench model\""].iter().any(|format| text.contains(format));
    match head.starts_with(b"{") && is_model {
        true => Err(CliError::IsModel { path: file.path.clone() }),
        false => Ok(()),
    }
}

/// The text of a file, without a byte order mark. The error for a file that is not text names what is `wanted`.
pub(crate) fn read_text(path: &Path, wanted: &'static str) -> Result<String, CliError> {
    let text = String::from_utf8(read_bytes(path)?).map_err(|_| CliError::NotText { path: path.to_owned(), wanted })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Reads the channels of a bench from a recording. If decoding fails, the source holds the reason.
///
/// The whole file is in memory only if its format requires it.
pub(crate) fn read_source(file: &InputFile, bench: &BenchFile, context: &Context) -> Result<Source, CliError> {
    let names = Selection::names(bench.channels.values().map(|mapping| mapping.name.as_str()));
    let recording = match decode(file, &names, context)? {
        // For names like the one that is missing, and for what else is missing.
        Err(RecordingError::NoSuchChannel { .. }) => decode(file, &Selection::All, context)?,
        read => read,
    };
    Ok(Source { file: file.name.clone(), sha256: sha256(file)?, recording })
}

/// Decodes channels of a recording.
pub(crate) fn decode(
    file: &InputFile,
    channels: &Selection,
    context: &Context,
) -> Result<Result<Recording, RecordingError>, CliError> {
    Ok(decode_from(&file.name, opened(file)?, channels, None, context))
}

/// The channels of these names or patterns; all channels without any.
pub(crate) fn selection(names: &[String]) -> Selection {
    match names {
        [] => Selection::All,
        patterns => Selection::Patterns(patterns.iter().map(|p| p.trim().to_owned()).collect()),
    }
}

/// The channels of a recording; without reading samples, if the format allows.
pub(crate) fn catalogue(file: &InputFile) -> Result<Catalogue, CliError> {
    refuse_model(file)?;
    catalogue_from(&file.name, opened(file)?).map_err(|source| CliError::Recording { source, untimed: false })
}

/// A recording that was read.
pub(crate) struct Read {
    pub(crate) recording: Recording,
    /// True where its time was counted, from row to row.
    pub(crate) is_untimed: bool,
}

/// Reads and decodes a recording, or text without a time column if the time from row to row is given.
pub(crate) fn read_recording(
    file: &InputFile,
    selection: &Selection,
    row_time_s: Option<f64>,
    context: &Context,
) -> Result<Read, CliError> {
    refuse_model(file)?;
    let content = opened(file)?;
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
    let recording = recording.map_err(|source| CliError::Recording { untimed: untimed(&source), source })?;
    Ok(Read { recording, is_untimed })
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

/// The content of a recording besides its channels.
pub(crate) fn extras(file: &InputFile) -> Result<Extras, CliError> {
    extras_from(&file.name, &*opened(file)?).map_err(|source| CliError::Recording { source, untimed: false })
}

fn opened(file: &InputFile) -> Result<Arc<File>, CliError> {
    refuse_folder(&file.path)?;
    if paths::is_stream(&file.path) {
        return Err(CliError::IsStream { path: file.path.clone() });
    }
    this_run::reads(&file.path);
    File::open(&file.path).map(Arc::new).map_err(|source| CliError::read(&file.path, source))
}

/// The SHA-256 of a text, hexadecimal.
pub(crate) fn sha256_of_text(text: &str) -> String {
    hexadecimal(&Sha256::digest(text.as_bytes()))
}

/// The SHA-256 of a file's content, hexadecimal.
pub(crate) fn sha256(file: &InputFile) -> Result<String, CliError> {
    sha256_of(&mut &*opened(file)?).map_err(|source| CliError::read(&file.path, source))
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

/// The recordings a bench file lists, each once, in the order of its patterns; names are relative to the bench file.
pub(crate) fn listed(bench: &Path, patterns: &[String]) -> Result<Vec<InputFile>, CliError> {
    if patterns.is_empty() {
        return Err(CliError::NoRecordingsListed { path: bench.to_owned() });
    }
    let folder = paths::folder_of(bench);
    let mut seen = BTreeSet::new();
    let mut files = Vec::new();
    for pattern in patterns {
        let found = matches(bench, &folder, pattern)?;
        if found.is_empty() {
            let folder = folder.join(fixed_part(pattern));
            return Err(CliError::NothingMatches { bench: bench.to_owned(), pattern: pattern.clone(), folder });
        }
        for path in found {
            if seen.insert(path.canonicalize().unwrap_or_else(|_| path.clone())) {
                let name = paths::with_slashes(path.strip_prefix(&folder).unwrap_or(&path));
                files.push(InputFile { path, name });
            }
        }
    }
    Ok(files)
}

/// The files a pattern of a bench file stands for: a file of exactly this name, the recordings of a folder, or else
/// what the pattern matches.
fn matches(bench: &Path, folder: &Path, pattern: &str) -> Result<Vec<PathBuf>, CliError> {
    let literal = folder.join(pattern);
    if literal.is_file() {
        return Ok(vec![literal]);
    }
    if literal.is_dir() {
        return recordings_in(&literal);
    }
    patterns::files(folder, pattern).map_err(|fault| match fault {
        PatternFault::Pattern(error) => {
            CliError::BadPattern { bench: bench.to_owned(), pattern: pattern.to_owned(), reason: error.msg }
        }
        PatternFault::Unreadable { path, source } => CliError::Read { path, source },
    })
}

/// A pattern of a bench file in this folder, with its folders.
fn full_pattern(folder: &Path, pattern: &str) -> String {
    match Path::new(pattern).is_absolute() {
        true => pattern.to_owned(),
        false => format!("{}/{pattern}", glob::Pattern::escape(&folder.to_string_lossy())),
    }
}

/// The bench file of this run, if it would list a file of this name, or lists one that leads to the same.
pub(crate) fn bench_that_lists(file: &Path) -> Option<PathBuf> {
    let Listing { bench, patterns } = this_run::listing()?;
    let folder = std::path::absolute(paths::folder_of(&bench)).ok()?;
    let real = file.canonicalize().ok();
    let file = std::path::absolute(file).ok()?;
    let is_listed = |real: &PathBuf| {
        let files = listed(&bench, &patterns).unwrap_or_default();
        files.iter().any(|listed| listed.path.canonicalize().is_ok_and(|path| path == *real))
    };
    let lists = |pattern: &String| {
        let place = folder.join(pattern);
        place == file
            || file.parent() == Some(&place)
            || glob::Pattern::new(&full_pattern(&folder, pattern))
                .is_ok_and(|full| full.matches(&file.to_string_lossy()))
    };
    (patterns.iter().any(lists) || real.as_ref().is_some_and(is_listed)).then_some(bench)
}

/// As [`bench_that_lists`], if it lists a measured recording already: one that no other command of this program made.
pub(crate) fn bench_with_measured(file: &Path) -> Option<PathBuf> {
    let bench = bench_that_lists(file)?;
    let is_measured = |mark: Option<Mark>| mark.is_none_or(|mark| mark == Mark::Command("convert".to_owned()));
    let files = listed(&bench, &this_run::listing()?.patterns).ok()?;
    files.iter().any(|input| is_measured(Mark::of_file(&input.path))).then_some(bench)
}

/// The folders of a pattern that hold no wildcard.
fn fixed_part(pattern: &str) -> PathBuf {
    let is_fixed = |part: &Component<'_>| !part.as_os_str().to_string_lossy().contains(['*', '?', '[']);
    let mut parts: Vec<Component<'_>> = Path::new(pattern).components().collect();
    parts.pop();
    parts.iter().take_while(|part| is_fixed(part)).collect()
}

/// The recordings named on the command line: files as they are, folders for the recordings in them.
pub(crate) fn named(arguments: &[PathBuf]) -> Result<Vec<InputFile>, CliError> {
    let mut files = Vec::new();
    for argument in arguments {
        let found = match std::fs::metadata(argument) {
            Ok(kind) if kind.is_dir() => recordings_in(argument)?,
            Ok(_) => vec![argument.clone()],
            Err(source) => return Err(CliError::read(argument, source)),
        };
        found.iter().for_each(|path| this_run::reads(path));
        files.extend(found.into_iter().map(|path| InputFile { name: paths::with_slashes(&path), path }));
    }
    Ok(files)
}

/// Tells whether a file has an ending of recordings.
pub(crate) fn is_recording(path: &Path) -> bool {
    paths::ending(path).is_some_and(|ending| ENDINGS.contains(&ending.to_lowercase().as_str()))
}

/// The recordings in a folder, by their endings, in order; an error if there is none.
pub(crate) fn recordings_in(folder: &Path) -> Result<Vec<PathBuf>, CliError> {
    let unreadable = |source| CliError::read(folder, source);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if is_recording(&path) && path.is_file() {
            files.push(path);
        }
    }
    if files.is_empty() {
        let endings = ENDINGS.map(|ending| format!("*.{ending}")).join(", ");
        return Err(CliError::EmptyFolder { path: folder.to_owned(), endings });
    }
    files.sort();
    Ok(files)
}
