//! Writing files whole or not at all, and none over a file that must stay.
//!
//! A file is written under a temporary name in the folder where it belongs, brought to the disk, and only then given
//! its name: whoever looks finds the old file or the new one, never a part. Files that belong together get their names
//! together. A link stays, and the file behind it is the one that is replaced.
//!
//! [`check_replaceable`] is the one rule for files that are there, and every function that writes asks it.

mod place;
mod temporary;

use std::collections::BTreeSet;
use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

pub use self::temporary::remove_when_ended;
use crate::error::Error;
use crate::files::Files;
use crate::find;
use crate::mark::Mark;
use crate::paths::{folder_of, is_stream};

/// The rule for files that are there. A file is replaced if a command made it that makes files of this `mark`, or if
/// the user asks for it; a file that is read, and a recording of the bench, never. No result is written among measured
/// recordings, and a file that the user may not write to stays.
pub fn check_replaceable(path: &Path, mark: Option<&Mark>, files: &Files) -> Result<(), Error> {
    let place = place::behind_links(path).map_err(|source| Error::write(path, source))?;
    let among = |bench| Err(Error::AmongRecordings { path: path.to_owned(), bench });
    if let Some(bench) = [path, &place]
        .into_iter()
        .filter(|path| find::is_recording(path))
        .find_map(|path| files.bench_with_measured(path))
    {
        return among(bench);
    }
    if !path.is_file() {
        return Ok(());
    }
    if files.is_read(path) {
        return Err(Error::IsRead { path: path.to_owned() });
    }
    let found = Mark::of_file(path);
    let is_own = mark.is_some() && found.as_ref() == mark;
    if !is_own && let Some(bench) = [path, &place].into_iter().find_map(|path| files.bench_that_lists(path)) {
        return among(bench);
    }
    if files.overwrites() {
        return Ok(());
    }
    if !is_own {
        return Err(Error::Occupied { path: path.to_owned(), maker: found.map(|mark| mark.maker()) });
    }
    if is_read_only(path) { Err(Error::IsReadOnly { path: path.to_owned() }) } else { Ok(()) }
}

/// Tells whether a file may not be written to: by its mode, which does not bind the administrator, or by what the
/// system says.
fn is_read_only(path: &Path) -> bool {
    let refuses = |error: io::Error| error.kind() == io::ErrorKind::PermissionDenied;
    path.metadata().is_ok_and(|file| file.permissions().readonly())
        || File::options().write(true).open(path).is_err_and(refuses)
}

/// A folder for results.
#[derive(Debug)]
pub struct OutputFolder {
    path: PathBuf,
    files: Files,
}

impl OutputFolder {
    /// Checks that results can be written to the folder, before any work is done. A folder that is not there is made
    /// only when there are results.
    pub fn check(path: &Path, files: &Files) -> Result<Self, Error> {
        let path = std::path::absolute(path).map_err(|source| Error::write(path, source))?;
        if is_stream(&path) {
            return Err(Error::IsDevice { path });
        }
        if path.exists() && !path.is_dir() {
            return Err(Error::InTheWay { path, what: "a file" });
        }
        let existing = path.ancestors().find(|folder| folder.exists()).unwrap_or(&path);
        temporary::in_folder(existing).map_err(|source| Error::write(&path, source))?;
        Ok(OutputFolder { path, files: files.clone() })
    }

    /// Writes files into the folder: all of them, or, if one cannot be written, none. Returns their paths.
    pub fn write(&self, files: &[(&str, &[u8])]) -> Result<Vec<PathBuf>, Error> {
        let staging = self.staged(files)?;
        staging.finish()?;
        Ok(files.iter().map(|(name, _)| self.path.join(name)).collect())
    }

    /// Writes files as [`Self::write`] does, and removes earlier results of those `names` that are not among them. What
    /// shows no mark of this program stays.
    pub fn replace(&self, files: &[(&str, &[u8])], names: &[&str]) -> Result<(), Error> {
        let mut staging = self.staged(files)?;
        let is_written = |name: &str| files.iter().any(|(written, _)| *written == name);
        let others = names.iter().filter(|name| !is_written(name)).map(|name| self.path.join(name));
        staging.removed = others.filter(|path| Mark::of_file(path).is_some()).collect();
        staging.finish()
    }

    fn staged(&self, files: &[(&str, &[u8])]) -> Result<Staging, Error> {
        std::fs::create_dir_all(&self.path).map_err(|source| Error::write(&self.path, source))?;
        let mut staging = Staging::of(&self.files);
        for (name, content) in files {
            let target = self.path.join(name);
            // What has no end cannot be kept to be put back.
            if is_stream(&target) {
                return Err(Error::InTheWay { path: target, what: "a device" });
            }
            staging.add_content(&target, content)?;
        }
        Ok(staging)
    }
}

/// Checks that a file of this mark can be written, before any work is done for it. Nothing is changed.
pub fn check_file(path: &Path, mark: &Mark, files: &Files) -> Result<(), Error> {
    check_replaceable(path, Some(mark), files)?;
    match Place::of(path)? {
        Place::Stream(path) => place::open_stream(&path, files).map_err(|source| Error::write(&path, source)),
        Place::File(path) => temporary::in_place_of(&path).map(|_| ()).map_err(|source| Error::write(&path, source)),
    }
}

/// Writes one file, replacing an existing one of the same mark. What is no file, such as a device, is written to and
/// stays what it is.
pub fn replace_file(path: &Path, content: &[u8], files: &Files) -> Result<(), Error> {
    let mut staging = Staging::of(files);
    staging.add_content(path, content)?;
    staging.finish()
}

/// Writes one file as [`replace_file`] does, with what `write` puts into it, piece by piece.
pub fn replace_with(
    path: &Path,
    mark: Option<&Mark>,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), Error>,
    files: &Files,
) -> Result<(), Error> {
    let mut staging = Staging::of(files);
    staging.add(path, mark, write)?;
    staging.finish()
}

/// Where a result goes.
enum Place {
    /// A pipe or a device.
    Stream(PathBuf),
    /// A file, behind all links.
    File(PathBuf),
}

impl Place {
    fn of(path: &Path) -> Result<Self, Error> {
        if is_stream(path) {
            return Ok(Place::Stream(path.to_owned()));
        }
        if path.is_dir() {
            return Err(Error::InTheWay { path: path.to_owned(), what: "a folder" });
        }
        place::behind_links(path).map(Place::File).map_err(|source| Error::write(path, source))
    }
}

/// Files that belong together, complete under temporary names.
#[derive(Debug)]
pub struct Staging {
    run: Files,
    files: Vec<(NamedTempFile, PathBuf)>,
    /// Results for pipes and devices.
    streams: Vec<(File, PathBuf)>,
    /// Earlier results that are removed when the files have their names.
    removed: Vec<PathBuf>,
}

impl Staging {
    /// No files yet, of this run.
    pub fn of(files: &Files) -> Self {
        Staging { run: files.clone(), files: Vec::new(), streams: Vec::new(), removed: Vec::new() }
    }

    /// The run that the files belong to.
    pub fn files(&self) -> &Files {
        &self.run
    }

    /// Adds a file with this content, and with the mark that it shows.
    pub fn add_content(&mut self, path: &Path, content: &[u8]) -> Result<(), Error> {
        let write = |file: &mut BufWriter<&File>| file.write_all(content).map_err(|source| Error::write(path, source));
        self.add(path, Mark::of_content(content).as_ref(), write)
    }

    /// Adds a file of this mark, with what `write` puts into it.
    pub fn add(
        &mut self,
        path: &Path,
        mark: Option<&Mark>,
        write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        check_replaceable(path, mark, &self.run)?;
        let failed = |source| Error::write(path, source);
        let fill = |file: &File| {
            let mut buffered = BufWriter::with_capacity(1 << 16, file);
            write(&mut buffered)?;
            buffered.flush().map_err(failed)
        };
        match Place::of(path)? {
            Place::Stream(path) => {
                // Parts of a file are written again when others are known, which a device does not allow.
                let whole = tempfile::tempfile().map_err(failed)?;
                fill(&whole)?;
                self.streams.push((whole, path));
            }
            Place::File(place) => {
                let file = temporary::in_place_of(&place).map_err(|source| Error::write(&place, source))?;
                fill(file.as_file())?;
                file.as_file().sync_all().map_err(failed)?;
                self.files.push((file, place));
            }
        }
        Ok(())
    }

    /// Gives every file its name; if that fails for one, no file is changed.
    pub fn finish(self) -> Result<(), Error> {
        for (mut whole, path) in self.streams {
            let written = place::stream(&path, &self.run).and_then(|mut stream| {
                whole.rewind()?;
                io::copy(&mut whole, &mut stream)
            });
            written.map_err(|source| Error::write(&path, source))?;
        }
        let files = with_backups(self.files)?;
        let folders: BTreeSet<PathBuf> = files.iter().map(|file| folder_of(&file.place)).collect();
        temporary::name(&folders, || {
            put_in_place(files)?;
            self.removed.iter().try_for_each(|path| remove(path))
        })?;
        folders.iter().for_each(|folder| sync_folder(folder));
        Ok(())
    }
}

/// A file under a temporary name, and what has its place.
struct Staged {
    file: NamedTempFile,
    backup: Option<NamedTempFile>,
    place: PathBuf,
}

/// Files with copies of what they replace. A single file needs none.
fn with_backups(files: Vec<(NamedTempFile, PathBuf)>) -> Result<Vec<Staged>, Error> {
    let is_alone = files.len() == 1;
    let staged = |(file, place): (NamedTempFile, PathBuf)| {
        let backup = if is_alone || !place.exists() { None } else { Some(backup(&place)?) };
        Ok(Staged { file, backup, place })
    };
    files.into_iter().map(staged).collect()
}

fn backup(place: &Path) -> Result<NamedTempFile, Error> {
    let copied = || {
        let mut file = temporary::in_place_of(place)?;
        io::copy(&mut File::open(place)?, &mut file)?;
        file.as_file().sync_all()?;
        Ok(file)
    };
    copied().map_err(|source| Error::write(place, source))
}

/// Gives every file its name; if that fails for one, gives the earlier ones their old content back.
fn put_in_place(staged: Vec<Staged>) -> Result<(), Error> {
    let mut done: Vec<(Option<NamedTempFile>, PathBuf)> = Vec::new();
    for Staged { file, backup, place } in staged {
        if let Err(error) = file.persist(&place) {
            for (backup, place) in done {
                let _ = match backup {
                    Some(backup) => backup.persist(&place).map(|_| ()).map_err(|error| error.error),
                    None => std::fs::remove_file(&place),
                };
            }
            return Err(Error::write(&place, error.error));
        }
        done.push((backup, place));
    }
    Ok(())
}

fn remove(path: &Path) -> Result<(), Error> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != io::ErrorKind::NotFound => Err(Error::write(path, source)),
        _ => Ok(()),
    }
}

/// Brings the names to the disk too, where the system can.
fn sync_folder(folder: &Path) {
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}
