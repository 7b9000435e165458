//! Temporary files: results that have no name of their own yet, in the folder where they belong.
//!
//! A program that ends by a signal removes its temporary files first. One that is killed cannot. So every temporary
//! file is locked while its program runs, and a program that writes into the folder later removes those of the same
//! user that nobody has locked.

use std::collections::BTreeSet;
use std::fs::{File, Metadata, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use tempfile::{Builder, NamedTempFile};

const PREFIX: &str = ".dynoid-";
const SUFFIX: &str = ".tmp";
/// Random characters of a name: more than a name that a person gives has by chance.
const RANDOM: usize = 20;
/// Another program that writes into the same folder needs less time to name its files.
const PATIENCE: Duration = Duration::from_secs(2);

/// Temporary files of this run.
#[derive(Debug, Default)]
struct Made {
    files: BTreeSet<PathBuf>,
    /// Folders in which what others left behind was looked for.
    folders: BTreeSet<PathBuf>,
}

static MADE: Mutex<Made> = Mutex::new(Made { files: BTreeSet::new(), folders: BTreeSet::new() });

fn made() -> MutexGuard<'static, Made> {
    MADE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// An empty temporary file in a folder.
pub(super) fn in_folder(folder: &Path) -> io::Result<NamedTempFile> {
    let mut made = made();
    let file = locked(folder)?;
    made.files.insert(file.path().to_owned());
    if made.folders.insert(folder.to_owned()) {
        remove_strays(folder, &file.as_file().metadata()?, &made.files);
    }
    Ok(file)
}

/// An empty temporary file in the place of a file, with its mode, and with its owner and group where the system allows.
pub(super) fn in_place_of(place: &Path) -> io::Result<NamedTempFile> {
    let file = in_folder(&crate::paths::folder_of(place))?;
    if let Ok(earlier) = place.metadata() {
        take_after(file.as_file(), &earlier)?;
    }
    Ok(file)
}

/// A new temporary file that this run has locked, unless the file system knows no locks.
fn locked(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX).rand_bytes(RANDOM);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What the user's mask leaves of it, as for any other file.
        builder.permissions(std::fs::Permissions::from_mode(0o666));
    }
    loop {
        let file = builder.tempfile_in(folder)?;
        let _ = file.as_file().try_lock();
        // Another program may have taken it for left behind before it was locked.
        if is_named(&file.as_file().metadata()?) {
            return Ok(file);
        }
    }
}

#[cfg(unix)]
fn is_named(file: &Metadata) -> bool {
    std::os::unix::fs::MetadataExt::nlink(file) > 0
}

#[cfg(not(unix))]
fn is_named(_: &Metadata) -> bool {
    true
}

#[cfg(unix)]
fn take_after(file: &File, earlier: &Metadata) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, fchown};
    // Only the administrator gives files away; others may keep a group of theirs.
    let group = Some(earlier.gid());
    let _ = fchown(file, Some(earlier.uid()), group).or_else(|_| fchown(file, None, group));
    file.set_permissions(earlier.permissions())
}

#[cfg(not(unix))]
fn take_after(_: &File, _: &Metadata) -> io::Result<()> {
    Ok(())
}

/// Removes temporary files that a killed program left in a folder. What cannot be removed stays.
fn remove_strays(folder: &Path, own: &Metadata, made: &BTreeSet<PathBuf>) {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let is_temporary = |name: &str| {
        let random = name.strip_prefix(PREFIX).and_then(|rest| rest.strip_suffix(SUFFIX));
        random.is_some_and(|random| random.len() == RANDOM && random.bytes().all(|byte| byte.is_ascii_alphanumeric()))
    };
    let strays = entries.filter(|entry| {
        entry.file_name().to_str().is_some_and(is_temporary)
            && entry.metadata().is_ok_and(|found| found.is_file() && has_owner_of(&found, own))
            && !made.contains(&entry.path())
    });
    for path in strays.map(|entry| entry.path()) {
        let file = File::options().write(true).open(&path);
        if file.is_ok_and(|file| file.try_lock().is_ok()) {
            let _ = std::fs::remove_file(path);
        }
    }
}

#[cfg(unix)]
fn has_owner_of(found: &Metadata, own: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    found.uid() == own.uid()
}

#[cfg(not(unix))]
fn has_owner_of(_: &Metadata, _: &Metadata) -> bool {
    true
}

/// Gives files their names: no signal ends the program meanwhile, and no other run of it names files in the same
/// folders.
pub(super) fn name<T>(folders: &BTreeSet<PathBuf>, rename: impl FnOnce() -> T) -> T {
    let _made = made();
    let _folders: Vec<File> = folders.iter().filter_map(|folder| locked_folder(folder)).collect();
    rename()
}

/// A folder that this run has locked; none where the system locks no folders, or another program does not let go.
fn locked_folder(folder: &Path) -> Option<File> {
    let folder = File::open(folder).ok()?;
    let since = Instant::now();
    loop {
        match folder.try_lock() {
            Ok(()) => return Some(folder),
            Err(TryLockError::WouldBlock) if since.elapsed() < PATIENCE => {
                std::thread::sleep(Duration::from_millis(5));
            }
            Err(_) => return None,
        }
    }
}

/// From now on, signals that end the program remove its temporary files first. A file that grows beyond the limit of
/// the shell is an error of writing.
#[cfg(unix)]
pub fn remove_when_ended() {
    use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM, SIGXFSZ};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    let _ = signal_hook::flag::register(SIGXFSZ, std::sync::Arc::default());
    let ignored = ignored_signals();
    let is_ignored = |signal: &i32| ignored >> (signal - 1) & 1 == 1;
    let ends = [SIGHUP, SIGINT, SIGTERM].into_iter().filter(|signal| !is_ignored(signal));
    let Ok(mut signals) = Signals::new(ends) else { return };
    std::thread::spawn(move || {
        for signal in signals.forever() {
            // Nothing is made or named any more.
            let made = made();
            made.files.iter().for_each(|path| drop(std::fs::remove_file(path)));
            let _ = emulate_default_handler(signal);
            drop(made);
        }
    });
}

#[cfg(not(unix))]
pub fn remove_when_ended() {}

/// The signals that whoever started the program lets it ignore, as `nohup` does: bit n - 1 is signal n
/// (proc_pid_status(5)). None are known where the system has no such file.
#[cfg(unix)]
fn ignored_signals() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok()).unwrap_or(0)
}
