//! Where a result goes: the file that a name or a link stands for, or a pipe or device.

use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::mpsc;
use std::time::Duration;

use crate::files::Files;
use crate::paths;

/// Links that may follow one another, as on Linux (path_resolution(7)).
const MOST_LINKS: usize = 40;
/// The reader of a pipe that starts together with this program needs less time.
const PATIENCE: Duration = Duration::from_secs(3);

/// The file that a path stands for: what its links lead to, even where there is no file yet.
pub(super) fn behind_links(path: &Path) -> io::Result<PathBuf> {
    let mut place = path.to_owned();
    for _ in 0..MOST_LINKS {
        match std::fs::read_link(&place) {
            Ok(target) => place = paths::folder_of(&place).join(target),
            Err(_) => return Ok(place),
        }
    }
    Err(io::Error::other("the link leads back to itself"))
}

/// Opens a pipe or device, and keeps it open until [`stream`] takes it: the reader of a pipe that is closed sees its
/// end.
pub(super) fn open_stream(path: &Path, files: &Files) -> io::Result<()> {
    let stream = stream(path, files)?;
    files.streams().insert(path.to_owned(), stream);
    Ok(())
}

/// A pipe or device to write to. The system opens a pipe when another program reads it; what nobody reads is an error
/// after a few seconds.
pub(super) fn stream(path: &Path, files: &Files) -> io::Result<File> {
    if let Some(stream) = files.streams().remove(path) {
        return Ok(stream);
    }
    let (send, receive) = mpsc::channel();
    let owned = path.to_owned();
    std::thread::spawn(move || send.send(File::options().write(true).open(owned)));
    receive.recv_timeout(PATIENCE).unwrap_or_else(|_| Err(io::ErrorKind::TimedOut.into()))
}
