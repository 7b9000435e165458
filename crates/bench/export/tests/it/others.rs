//! Other programs at work on exported files.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use export::ExportedFile;

/// A folder with exported files.
pub(crate) fn folder_with(name: &str, files: &[ExportedFile]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    for file in files {
        std::fs::write(folder.join(&file.name), &file.content).unwrap();
    }
    folder
}

/// Runs a script of Python in a folder; `None` where no Python is named.
pub(crate) fn python(script: &str, folder: &Path) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it").join(script);
    Some(run(testdata::python()?, &[path.into_os_string(), folder.into()]))
}

/// Runs a script of Octave in a folder; `None` where no Octave is named.
pub(crate) fn octave(script: &str, folder: &Path) -> Option<String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/it").join(script);
    let quiet = ["--no-gui", "--norc", "--quiet"].map(OsString::from);
    let arguments = [&quiet[..], &[path.into_os_string(), folder.into()]].concat();
    Some(run(testdata::octave()?, &arguments))
}

fn run(program: OsString, arguments: &[OsString]) -> String {
    let output = Command::new(program).args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(output.status.success(), "{}\n{}", text(&output.stdout), text(&output.stderr));
    text(&output.stdout)
}

/// The largest difference in lines `NAME DIFFERENCE`.
pub(crate) fn largest(lines: &str) -> f64 {
    let differences: Vec<f64> = lines.lines().filter_map(|line| line.rsplit(' ').next()?.parse().ok()).collect();
    assert!(!differences.is_empty(), "no differences in {lines:?}");
    differences.into_iter().fold(0.0, |most, value| if value.is_nan() { f64::NAN } else { most.max(value) })
}
