//! Writing files whole or not at all, and none over a file that must stay.
//!
//! A file is written under a temporary name in the folder where it belongs, brought to the disk, and only then given
//! its name: whoever looks finds the old file or the new one, never a part.
//!
//! [`check_replaceable`] is the one rule for files that are there, and every function that writes asks it.

use std::fs::File;
use std::io::{self, BufWriter, Seek, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, NamedTempFile};

use crate::error::CliError;
use crate::input;
use crate::mark::Mark;
use crate::paths::is_stream;
use crate::this_run;

/// The rule for files that are there. A file is replaced if a command made it that makes files of this `mark`, or if
/// the user asks for it; a file that is read, and a recording of the bench, never. No result is written among measured
/// recordings.
pub(crate) fn check_replaceable(path: &Path, mark: Option<&Mark>) -> Result<(), CliError> {
    if input::is_recording(path)
        && let Some(bench) = input::bench_with_measured(path)
    {
        return Err(CliError::AmongRecordings { path: path.to_owned(), bench });
    }
    if !path.is_file() {
        return Ok(());
    }
    if this_run::is_read(path) {
        return Err(CliError::IsRead { path: path.to_owned() });
    }
    let found = Mark::of_file(path);
    if mark.is_some() && found.as_ref() == mark {
        return Ok(());
    }
    match input::bench_that_lists(path) {
        Some(bench) => Err(CliError::AmongRecordings { path: path.to_owned(), bench }),
        None if this_run::overwrites() => Ok(()),
        None => Err(CliError::Occupied { path: path.to_owned(), maker: found.map(|mark| mark.maker()) }),
    }
}

/// A folder for results.
#[derive(Debug)]
pub(crate) struct OutputFolder {
    path: PathBuf,
}

impl OutputFolder {
    /// Checks that results can be written to the folder, before any work is done. A folder that is not there is made
    /// only when there are results.
    pub(crate) fn check(path: &Path) -> Result<Self, CliError> {
        let path = std::path::absolute(path).map_err(|source| CliError::write(path, source))?;
        if is_stream(&path) {
            return Err(CliError::IsDevice { path });
        }
        if path.exists() && !path.is_dir() {
            return Err(CliError::InTheWay { path, what: "a file" });
        }
        let existing = path.ancestors().find(|folder| folder.exists()).unwrap_or(&path);
        stage(existing, &[]).map_err(|source| CliError::write(&path, source))?;
        Ok(OutputFolder { path })
    }

    /// Writes files into the folder: all of them, or, if one cannot be written, none. Returns their paths.
    pub(crate) fn write(&self, files: &[(&str, &[u8])]) -> Result<Vec<PathBuf>, CliError> {
        std::fs::create_dir_all(&self.path).map_err(|source| CliError::write(&self.path, source))?;
        let mut staged = Vec::new();
        for (name, content) in files {
            let target = self.path.join(name);
            if target.is_dir() {
                return Err(CliError::InTheWay { path: target, what: "a folder" });
            }
            // What has no end cannot be kept to be put back.
            if is_stream(&target) {
                return Err(CliError::InTheWay { path: target, what: "a device" });
            }
            check_replaceable(&target, Mark::of_content(content).as_ref())?;
            let failed = |source| CliError::write(&target, source);
            let backup = if target.exists() { Some(backup(&target).map_err(failed)?) } else { None };
            let file = stage(&self.path, content).map_err(failed)?;
            staged.push((file, backup, target));
        }
        let paths = staged.iter().map(|(_, _, target)| target.clone()).collect();
        put_in_place(staged)?;
        sync_folder(&self.path);
        Ok(paths)
    }

    /// Writes files as [`Self::write`] does, and then removes earlier results of those `names` that are not among them.
    pub(crate) fn replace(&self, files: &[(&str, &[u8])], names: &[&str]) -> Result<(), CliError> {
        self.write(files)?;
        let is_written = |name: &str| files.iter().any(|(written, _)| *written == name);
        names.iter().filter(|name| !is_written(name)).try_for_each(|name| self.remove(name))
    }

    /// Removes an earlier result, if there is one. What shows no mark of this program stays.
    fn remove(&self, name: &str) -> Result<(), CliError> {
        let path = self.path.join(name);
        if Mark::of_file(&path).is_none() {
            return Ok(());
        }
        match std::fs::remove_file(&path) {
            Err(source) if source.kind() != io::ErrorKind::NotFound => Err(CliError::write(&path, source)),
            _ => Ok(()),
        }
    }
}

/// Checks that a file of this mark can be written, before any work is done for it. Nothing is changed.
pub(crate) fn check_file(path: &Path, mark: &Mark) -> Result<(), CliError> {
    check_replaceable(path, Some(mark))?;
    let failed = |source| CliError::write(path, source);
    match std::fs::metadata(path) {
        Ok(there) if there.is_dir() => Err(CliError::InTheWay { path: path.to_owned(), what: "a folder" }),
        Ok(there) if !there.is_file() => File::options().write(true).open(path).map(|_| ()).map_err(failed),
        _ => stage(&crate::paths::folder_of(path), &[]).map(|_| ()).map_err(failed),
    }
}

/// Writes one file, replacing an existing one of the same mark. What is no file, such as a device, is written to and
/// stays what it is.
pub(crate) fn replace_file(path: &Path, content: &[u8]) -> Result<(), CliError> {
    let write = |file: &mut BufWriter<&File>| file.write_all(content).map_err(|source| CliError::write(path, source));
    replace_with(path, Mark::of_content(content).as_ref(), write)
}

/// Writes one file as [`replace_file`] does, with what `write` puts into it, piece by piece.
pub(crate) fn replace_with(
    path: &Path,
    mark: Option<&Mark>,
    write: impl FnOnce(&mut BufWriter<&File>) -> Result<(), CliError>,
) -> Result<(), CliError> {
    check_replaceable(path, mark)?;
    let failed = |source| CliError::write(path, source);
    let fill = |file: &File| {
        let mut buffered = BufWriter::with_capacity(1 << 16, file);
        write(&mut buffered)?;
        buffered.flush().map_err(failed)
    };
    match std::fs::metadata(path) {
        Ok(there) if there.is_dir() => return Err(CliError::InTheWay { path: path.to_owned(), what: "a folder" }),
        Ok(there) if !there.is_file() => {
            // Parts of a file are written again when others are known, which a device does not allow.
            let mut whole = tempfile::tempfile().map_err(failed)?;
            fill(&whole)?;
            let mut device = File::options().write(true).open(path).map_err(failed)?;
            whole.rewind().and_then(|()| io::copy(&mut whole, &mut device)).map_err(failed)?;
            return Ok(());
        }
        _ => {}
    }
    let folder = crate::paths::folder_of(path);
    let file = staged(&folder).map_err(failed)?;
    fill(file.as_file())?;
    file.as_file().sync_all().map_err(failed)?;
    file.persist(path).map_err(|error| failed(error.error))?;
    sync_folder(&folder);
    Ok(())
}

/// A temporary file with the content on the disk.
fn stage(folder: &Path, content: &[u8]) -> io::Result<NamedTempFile> {
    let mut file = staged(folder)?;
    file.write_all(content)?;
    file.as_file().sync_all()?;
    Ok(file)
}

/// An empty temporary file.
fn staged(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".dynoid-").suffix(".tmp");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What the user's mask leaves of it, as for any other file.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

fn backup(target: &Path) -> io::Result<NamedTempFile> {
    stage(target.parent().unwrap_or(Path::new(".")), &std::fs::read(target)?)
}

/// Gives every file its name; if that fails for one, gives the earlier ones their old content back.
fn put_in_place(staged: Vec<(NamedTempFile, Option<NamedTempFile>, PathBuf)>) -> Result<(), CliError> {
    let mut done: Vec<(Option<NamedTempFile>, PathBuf)> = Vec::new();
    for (file, backup, target) in staged {
        if let Err(error) = file.persist(&target) {
            for (backup, target) in done {
                let _ = match backup {
                    Some(backup) => backup.persist(&target).map(|_| ()).map_err(|error| error.error),
                    None => std::fs::remove_file(&target),
                };
            }
            return Err(CliError::write(&target, error.error));
        }
        done.push((backup, target));
    }
    Ok(())
}

/// Brings the names to the disk too, where the system can.
fn sync_folder(folder: &Path) {
    if cfg!(unix) {
        let _ = File::open(folder).and_then(|folder| folder.sync_all());
    }
}
