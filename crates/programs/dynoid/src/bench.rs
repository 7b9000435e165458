//! A bench: its file, with its text and its place.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use page::Logo;
use rig::BenchFile;
use study::Origin;

use crate::error::Error;
use crate::files::Files;
use crate::{date, paths, read};

/// A bench, as its file describes it.
#[derive(Debug, Clone)]
pub struct Bench {
    file: BenchFile,
    text: String,
    path: PathBuf,
}

impl Bench {
    /// Reads a bench file. The run remembers it, and which recordings it lists.
    ///
    /// # Errors
    /// A file that cannot be read, or has faults.
    pub fn load(path: &Path, files: &Files) -> Result<Self, Error> {
        let bench = Self::parse(path, &bench_text(path, files)?)?;
        files.is_on(path, &bench.file.recordings.files);
        Ok(bench)
    }

    /// The bench that a text describes. Recordings are listed as seen from the folder of `path`.
    ///
    /// # Errors
    /// A text with faults.
    pub fn parse(path: &Path, text: &str) -> Result<Self, Error> {
        let file = text.parse().map_err(|source| Error::BenchFile { path: path.to_owned(), source })?;
        Ok(Bench { file, text: text.to_owned(), path: path.to_owned() })
    }

    /// A bench that a program describes. Recordings are listed as seen from the folder of `path`.
    pub fn of(path: &Path, file: BenchFile) -> Self {
        Bench { text: file.to_toml(), file, path: path.to_owned() }
    }

    /// The bench.
    pub fn file(&self) -> &BenchFile {
        &self.file
    }

    /// The text of its file, word for word.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Place of its file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Name of its file.
    pub fn name(&self) -> String {
        self.path.file_name().unwrap_or(self.path.as_os_str()).to_string_lossy().into_owned()
    }

    /// Folder of its file.
    pub fn folder(&self) -> PathBuf {
        paths::folder_of(&self.path)
    }

    /// The logo that the bench file names.
    ///
    /// # Errors
    /// A file that is missing, or is no picture.
    pub fn logo(&self, files: &Files) -> Result<Option<Logo>, Error> {
        let Some(name) = &self.file.report.logo else { return Ok(None) };
        let path = self.folder().join(name);
        let failed = |reason: String| Error::Logo { logo: path.clone(), bench: self.path.clone(), reason };
        if !path.is_file() {
            return Err(failed("there is no such file; correct the path".to_owned()));
        }
        files.reads(&path);
        let mut bytes = Vec::new();
        // What is longer is refused, however long it is.
        let most = Logo::MOST_BYTES as u64 + 1;
        File::open(&path)
            .and_then(|file| file.take(most).read_to_end(&mut bytes))
            .map_err(|error| failed(error.to_string()))?;
        Logo::read(bytes).map(Some).map_err(|error| failed(error.to_string()))
    }

    /// The bench without its text.
    pub fn into_file(self) -> BenchFile {
        self.file
    }

    /// Statement of a model that is made today of this bench.
    pub fn origin(&self) -> Origin {
        Origin { date: date::today(), bench_file_sha256: read::sha256_of_text(&self.text) }
    }
}

/// The text of a bench file.
///
/// # Errors
/// A file that cannot be read, or a folder in its place.
pub fn bench_text(path: &Path, files: &Files) -> Result<String, Error> {
    if path.is_dir() {
        let inside = path.join("bench.toml");
        let remedy = match inside.is_file() {
            true => format!("did you mean {}?", inside.display()),
            false => "name a bench file, or have one proposed with `dynoid init`".into(),
        };
        return Err(Error::IsFolder { path: path.to_owned(), remedy });
    }
    files.read_text(path, "a bench file such as `dynoid init` writes")
}
