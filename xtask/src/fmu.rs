//! `cargo xtask fmu`: the runtime of the FMUs as binaries for every platform, which the program embeds.
//!
//! The compiler is Zig, which comes as one package for Python and builds for all platforms on each. The same sources give the same bytes;
//! the checks build them again and compare.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::folder;
use crate::steps::{output, run};

/// The compiler: another version gives other bytes.
const ZIG: &str = "ziglang==0.17.1";

/// A platform, as Zig names it and as the file is called.
const TARGETS: [(&str, &str); 5] = [
    ("x86_64-linux-gnu.2.17", "x86_64-linux.so"),
    ("aarch64-linux-gnu.2.17", "aarch64-linux.so"),
    ("x86_64-windows-gnu", "x86_64-windows.dll"),
    ("x86_64-macos", "x86_64-darwin.dylib"),
    ("aarch64-macos", "aarch64-darwin.dylib"),
];

/// Small code, nothing of the machine that builds it, and the same rounding on all processors.
const FLAGS: [&str; 9] =
    ["-shared", "-fPIC", "-Os", "-std=c99", "-fvisibility=hidden", "-ffp-contract=off", "-Wall", "-g0", "-s"];

/// Builds all binaries into the repository.
pub(crate) fn build() -> Result<(), String> {
    let compiler = compiler()?;
    let folder = runtime().join("binaries");
    for (target, name) in TARGETS {
        let binary = built(&compiler, target, name)?;
        let path = folder.join(name);
        fs::copy(&binary, &path).map_err(|error| format!("{}: {error}", path.display()))?;
        println!("{}: {} bytes", path.display(), length(&path)?);
    }
    Ok(())
}

/// Whether the binaries in the repository are those of its sources. Without the compiler nothing is compared, and `false` says so.
pub(crate) fn check() -> Result<bool, String> {
    compare(&TARGETS)
}

/// The same for Linux alone: the compiler takes half a minute for the libraries of each platform, and [`build`] builds all at once.
pub(crate) fn check_one() -> Result<bool, String> {
    compare(&TARGETS[..1])
}

fn compare(targets: &[(&str, &str)]) -> Result<bool, String> {
    let compiler = match compiler() {
        Ok(compiler) => compiler,
        Err(error) => {
            eprintln!("{error}");
            return Ok(false);
        }
    };
    for (target, name) in targets {
        let read = |path: PathBuf| fs::read(&path).map_err(|error| format!("{}: {error}", path.display()));
        if read(built(&compiler, target, name)?)? != read(runtime().join("binaries").join(name))? {
            return Err(format!("{name} is not what its sources give; `cargo xtask fmu` builds it"));
        }
    }
    Ok(true)
}

fn runtime() -> PathBuf {
    folder::root().join("crates/export/runtime")
}

/// Python with the compiler, installed once.
fn compiler() -> Result<PathBuf, String> {
    let folder = folder::target()?.join("zig");
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let stamp = folder.join("installed.txt");
    if fs::read_to_string(&stamp).is_ok_and(|installed| installed == ZIG) {
        return Ok(python);
    }
    run("python3 -m venv", Command::new("python3").args(["-m", "venv", "--clear"]).arg(&folder))?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", ZIG];
    run("the installation of Zig", Command::new(&python).args(install))?;
    fs::write(&stamp, ZIG).map_err(|error| format!("{}: {error}", stamp.display()))?;
    Ok(python)
}

/// Builds one binary below the target folder.
fn built(python: &Path, target: &str, name: &str) -> Result<PathBuf, String> {
    let folder = folder::target()?.join("fmu");
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let cache = folder.join("cache");
    let path = folder.join(name);
    let mut command = Command::new(python);
    // Sources by their names alone, so that no path of this machine gets into the binary.
    command.current_dir(runtime()).args(["-m", "ziglang", "cc", "-target", target]).args(FLAGS);
    command.arg("-o").arg(&path).args(sources()?).args(of_platform(target));
    command.env("ZIG_LOCAL_CACHE_DIR", &cache).env("ZIG_GLOBAL_CACHE_DIR", &cache);
    output(&mut command)?;
    Ok(path)
}

/// The library of mathematics; a name without the path of the build, and no identifier of it.
fn of_platform(target: &str) -> &'static [&'static str] {
    if target.contains("linux") {
        &["-lm", "-Wl,--build-id=none", "-Wl,-soname,dynoid_bench.so"]
    } else if target.contains("macos") {
        &["-Wl,-install_name,@rpath/dynoid_bench.dylib"]
    } else {
        &[]
    }
}

/// The sources in the order of their names.
fn sources() -> Result<Vec<String>, String> {
    let folder = runtime();
    let entries = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let names = entries.filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()));
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".c")).collect();
    names.sort();
    Ok(names)
}

fn length(path: &Path) -> Result<u64, String> {
    fs::metadata(path).map(|data| data.len()).map_err(|error| format!("{}: {error}", path.display()))
}
