//! The fuzz targets.

use std::process::Command;

use crate::folder;
use crate::steps::run;

/// The fuzz targets, which are a workspace of their own, compile.
pub(crate) fn check() -> Result<(), String> {
    let (root, target) = (folder::root(), folder::target()?);
    // The versions that everything else is checked with.
    let (lock, copy) = (root.join("Cargo.lock"), root.join("fuzz/Cargo.lock"));
    std::fs::copy(&lock, &copy).map_err(|error| format!("{}: {error}", copy.display()))?;
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["check", "--release", "--quiet", "--manifest-path"]).arg(root.join("fuzz/Cargo.toml"));
    // Nothing is linked, so that the fuzzer's own library in C++ need not be built.
    cargo.arg("--target-dir").arg(target.join("fuzz")).env("CUSTOM_LIBFUZZER_PATH", "not/linked/libfuzzer.a");
    run("the check of the fuzz targets", &mut cargo)
}
