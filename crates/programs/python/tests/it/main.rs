//! The tests of the module, which are in Python, on the library that cargo built for this one.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Packages without which the tests cannot run.
const PACKAGES: &str = "import control, mypy, pandas, polars, pyarrow, pytest, scipy";

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../..")
}

/// The library of this crate, beside this test.
fn library() -> PathBuf {
    let name = format!("{}dynoid_python{}", std::env::consts::DLL_PREFIX, std::env::consts::DLL_SUFFIX);
    std::env::current_exe().expect("this test has a path").with_file_name(name)
}

/// A folder with the package, as an installed wheel has it.
fn installed() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let package = folder.path().join("dynoid");
    std::fs::create_dir(&package).expect("a folder");
    for file in std::fs::read_dir(root().join("python/dynoid")).expect("the package") {
        let file = file.expect("a file").path();
        if file.is_file() {
            std::fs::copy(&file, package.join(file.file_name().expect("a name"))).expect("a copy");
        }
    }
    let module = if cfg!(windows) { "_dynoid.pyd" } else { "_dynoid.abi3.so" };
    std::fs::copy(library(), package.join(module)).expect("the library, which cargo builds with this test");
    folder
}

fn has_packages(python: &OsStr) -> bool {
    Command::new(python).args(["-c", PACKAGES]).output().is_ok_and(|ran| ran.status.success())
}

/// The tests in `python/tests`, with the comparisons with numpy, scipy and python-control.
#[test]
fn ref_tests_in_python() {
    let Some(python) = testdata::python() else { return };
    if !has_packages(&python) {
        return testdata::skip("no Python packages for the tests of the module dynoid");
    }
    let folder = installed();
    let options = ["-m", "pytest", "--quiet", "-p", "no:cacheprovider", "--override-ini", "addopts="];
    let ran = Command::new(&python)
        .args(options)
        .arg(root().join("python/tests"))
        .env("PYTHONPATH", folder.path())
        .env("PYTHONDONTWRITEBYTECODE", "1")
        .output()
        .expect("Python starts");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    assert!(ran.status.success(), "{}{}", text(&ran.stdout), text(&ran.stderr));
}
