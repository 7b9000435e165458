//! `cargo xtask fmu`: the runtimes of the FMUs as binaries for every platform, which the program embeds.
//!
//! The compiler is Zig, which comes as one package for Python and builds for all platforms on each. The same sources
//! give the same bytes; the checks build them again and compare.

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

/// A runtime: what its binaries are called, where they lie, and the sources that the other one does not have.
struct Runtime {
    name: &'static str,
    folder: &'static str,
    own: &'static [&'static str],
}

/// The bench, and linear models. All other sources belong to both.
const RUNTIMES: [Runtime; 2] = [
    Runtime {
        name: "dynoid_bench",
        folder: "binaries",
        own: &[
            "bench.c",
            "derivatives.c",
            "exchange.c",
            "instance.c",
            "matrix.c",
            "model_file.c",
            "states.c",
            "variables.c",
        ],
    },
    Runtime {
        name: "dynoid_linear",
        folder: "binaries/linear",
        own: &["linear.c", "linear_file.c", "linear_instance.c"],
    },
];

/// Small code, nothing of the machine that builds it, and the same rounding on all processors.
const FLAGS: [&str; 9] =
    ["-shared", "-fPIC", "-Os", "-std=c99", "-fvisibility=hidden", "-ffp-contract=off", "-Wall", "-g0", "-s"];

/// Builds all binaries into the repository.
pub(crate) fn build() -> Result<(), String> {
    let compiler = compiler()?;
    for (runtime, target, name) in binaries(&TARGETS) {
        let path = stored(runtime, name);
        fs::copy(built(&compiler, runtime, target, name)?, &path)
            .map_err(|error| format!("{}: {error}", path.display()))?;
        println!("{}: {} bytes", path.display(), length(&path)?);
    }
    Ok(())
}

/// Tells whether the binaries in the repository are those of its sources. Without the compiler nothing is compared, and
/// `false` says so.
pub(crate) fn check() -> Result<bool, String> {
    compare(&TARGETS)
}

/// The same for Linux alone: the compiler takes half a minute for the libraries of each platform, and [`build`] builds
/// all at once.
pub(crate) fn check_one() -> Result<bool, String> {
    compare(&TARGETS[..1])
}

fn compare(targets: &'static [(&str, &str)]) -> Result<bool, String> {
    let compiler = match compiler() {
        Ok(compiler) => compiler,
        Err(error) => {
            eprintln!("{error}");
            return Ok(false);
        }
    };
    for (runtime, target, name) in binaries(targets) {
        let read = |path: PathBuf| fs::read(&path).map_err(|error| format!("{}: {error}", path.display()));
        if read(built(&compiler, runtime, target, name)?)? != read(stored(runtime, name))? {
            return Err(format!(
                "{} of {name} is not what its sources give; `cargo xtask fmu` builds it",
                runtime.name
            ));
        }
    }
    Ok(true)
}

/// Every runtime with each of these platforms and the name of its file.
fn binaries(targets: &'static [(&str, &str)]) -> impl Iterator<Item = (&'static Runtime, &'static str, &'static str)> {
    RUNTIMES.iter().flat_map(|runtime| targets.iter().map(move |(target, name)| (runtime, *target, *name)))
}

/// Where a binary is in the repository.
fn stored(of: &Runtime, name: &str) -> PathBuf {
    runtime().join(of.folder).join(name)
}

fn runtime() -> PathBuf {
    folder::root().join("crates/bench/export/runtime")
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
fn built(python: &Path, of: &Runtime, target: &str, name: &str) -> Result<PathBuf, String> {
    let folder = folder::target()?.join("fmu");
    let place = folder.join(of.name);
    fs::create_dir_all(&place).map_err(|error| format!("{}: {error}", folder.display()))?;
    let cache = folder.join("cache");
    let path = place.join(name);
    let mut command = Command::new(python);
    // Sources by their names alone, so that no path of this machine gets into the binary.
    command.current_dir(runtime()).args(["-m", "ziglang", "cc", "-target", target]).args(FLAGS);
    command.arg("-o").arg(&path).args(sources(of)?).args(of_platform(of, target));
    command.env("ZIG_LOCAL_CACHE_DIR", &cache).env("ZIG_GLOBAL_CACHE_DIR", &cache);
    output(&mut command)?;
    Ok(path)
}

/// The library of mathematics; a name without the path of the build, and no identifier of it.
fn of_platform(of: &Runtime, target: &str) -> Vec<String> {
    if target.contains("linux") {
        vec!["-lm".to_owned(), "-Wl,--build-id=none".to_owned(), format!("-Wl,-soname,{}.so", of.name)]
    } else if target.contains("macos") {
        vec![format!("-Wl,-install_name,@rpath/{}.dylib", of.name)]
    } else {
        Vec::new()
    }
}

/// The sources of a runtime in the order of their names.
fn sources(of: &Runtime) -> Result<Vec<String>, String> {
    let folder = runtime();
    let entries = fs::read_dir(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    let names = entries.filter_map(|entry| Some(entry.ok()?.file_name().to_string_lossy().into_owned()));
    let of_others = |name: &str| RUNTIMES.iter().any(|other| other.name != of.name && other.own.contains(&name));
    let mut names: Vec<String> = names.filter(|name| name.ends_with(".c") && !of_others(name)).collect();
    names.sort();
    Ok(names)
}

fn length(path: &Path) -> Result<u64, String> {
    fs::metadata(path).map(|data| data.len()).map_err(|error| format!("{}: {error}", path.display()))
}
