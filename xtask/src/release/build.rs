//! Programs and wheels for all machines, without paths of the machine that builds them.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::targets::{Target, Wheel};
use crate::folder;
use crate::steps::{output, run};

/// The remedy where a build for another machine cannot be started.
const NEEDED: &str = "it needs `pip install cargo-zigbuild ziglang maturin`, and `rustup target add`";

/// Says why the program for a target cannot be built here, if it cannot.
pub(super) fn obstacle(target: &Target) -> Result<Option<&'static str>, String> {
    if !needs_zig(target.triple)? {
        return Ok(None);
    }
    if target.triple.contains("apple") {
        return Ok(Some("it needs the libraries of a Mac"));
    }
    let library = ["--print", "target-libdir", "--target", target.triple];
    let is_known = output(Command::new("rustc").args(library)).is_ok_and(|path| Path::new(path.trim()).is_dir());
    let has_linker = output(Command::new(env!("CARGO")).args(["zigbuild", "--help"])).is_ok();
    Ok((!is_known || !has_linker).then_some(NEEDED))
}

/// Builds the program for a target.
pub(super) fn program(target: &Target, time_s: u64) -> Result<PathBuf, String> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.arg(if needs_zig(target.triple)? { "zigbuild" } else { "build" });
    cargo.args(["--release", "--locked", "--package", "dynoid-cli", "--target", target.triple]);
    surroundings(&mut cargo, time_s)?;
    run(&format!("the build ({NEEDED})"), &mut cargo)?;
    Ok(built()?.join(target.triple).join("release").join(target.program()))
}

/// Builds the program for the machine that makes the release.
pub(super) fn program_of_host(time_s: u64) -> Result<PathBuf, String> {
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["build", "--release", "--locked", "--package", "dynoid-cli"]);
    surroundings(&mut cargo, time_s)?;
    run("the build for this machine", &mut cargo)?;
    Ok(built()?.join("release").join(format!("dynoid{}", std::env::consts::EXE_SUFFIX)))
}

/// Builds a wheel into a folder, under the name that maturin gives it.
pub(super) fn wheel(wheel: &Wheel, out: &Path, time_s: u64) -> Result<(), String> {
    let mut maturin = Command::new("maturin");
    maturin.args(["build", "--release", "--locked", "--target", wheel.triple, "--out"]).arg(out);
    // Only Zig links for an older C library than the one of this machine, which the name of the wheel promises.
    if needs_zig(wheel.triple)? || wheel.compatibility.is_some() {
        maturin.arg("--zig");
    }
    if let Some(compatibility) = wheel.compatibility {
        maturin.args(["--compatibility", compatibility]);
    }
    maturin.current_dir(folder::root());
    surroundings(&mut maturin, time_s)?;
    run(&format!("the wheel ({NEEDED})"), &mut maturin)
}

/// Where cargo puts what it builds for a release.
fn built() -> Result<PathBuf, String> {
    Ok(folder::target()?.join("release-build"))
}

fn surroundings(command: &mut Command, time_s: u64) -> Result<(), String> {
    command.env("CARGO_TARGET_DIR", built()?).env("RUSTFLAGS", flags()?).env("SOURCE_DATE_EPOCH", time_s.to_string());
    Ok(())
}

/// Tells whether Zig has to link: for any other machine but between two Macs, whose own linker knows both.
fn needs_zig(triple: &str) -> Result<bool, String> {
    let host = host()?;
    Ok(triple != host && !(triple.contains("apple") && host.contains("apple")))
}

/// The target that cargo builds for here.
fn host() -> Result<String, String> {
    let version = output(Command::new(env!("CARGO")).args(["version", "--verbose"]))?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or_else(|| "cargo does not name its host".into())
}

/// Maps folders of this machine to names that are the same on all.
fn flags() -> Result<String, String> {
    let home = |variable: &str, below: &str| {
        let named = std::env::var(variable).ok();
        named.or_else(|| std::env::home_dir().map(|home| home.join(below).display().to_string()))
    };
    let cargo = home("CARGO_HOME", ".cargo").ok_or("there is no home folder; set CARGO_HOME")?;
    let root = folder::root();
    Ok(format!("--remap-path-prefix={}=dynoid --remap-path-prefix={cargo}=cargo", root.display()))
}
