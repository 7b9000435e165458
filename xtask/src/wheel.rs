//! The wheel of the module `dynoid`: built as `pip install .` builds it, and started in an environment that has nothing else.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::steps::{output, run};
use crate::{folder, python};

/// Calls of the installed module, which have to print nothing but the version.
const SMOKE: &str = "
import dynoid, numpy
random = numpy.random.default_rng(1)
u = random.standard_normal(500)
data = dynoid.Dataset(numpy.convolve(u, [0.0, 2.0])[:500] + 0.01 * random.standard_normal(500), u, sample_time=1.0)
low, high = dynoid.fit.arx(data, na=0, nb=1).intervals(0.9999)['b1']
assert low < 2.0 < high, (low, high)
print(dynoid.__version__)
";

/// Builds the wheel in `target/wheels`, installs it alone, and runs the module and the program of it.
pub(crate) fn check() -> Result<(), String> {
    let Some(python) = python::interpreter()? else { return Err("the wheel cannot be built without Python".to_owned()) };
    let target = folder::target()?;
    let wheel = build(&python, &target.join("wheels"))?;
    let size = fs::metadata(&wheel).map_err(|error| format!("{}: {error}", wheel.display()))?.len();
    println!("{}: {:.1} MB", wheel.display(), size as f64 / 1e6);
    let alone = target.join("wheel-alone");
    run("an empty environment", Command::new(&python).args(["-m", "venv", "--clear"]).arg(&alone))?;
    let programs = alone.join(if cfg!(windows) { "Scripts" } else { "bin" });
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    run("the installation", Command::new(programs.join("python")).args(install).arg(&wheel))?;
    let version = output(outside(&mut Command::new(programs.join("python")), &alone).args(["-c", SMOKE]))?;
    let named = output(outside(&mut Command::new(programs.join("dynoid")), &alone).arg("--version"))?;
    if named.trim() != format!("dynoid {}", version.trim()) {
        return Err(format!("the program is of {}, and the module of {}", named.trim(), version.trim()));
    }
    let demo = ["demo", "--quiet", "--overwrite", "--out", "demo"];
    run("the demonstration", outside(&mut Command::new(programs.join("dynoid")), &alone).args(demo))
}

fn build(python: &Path, out: &Path) -> Result<PathBuf, String> {
    if out.exists() {
        fs::remove_dir_all(out).map_err(|error| format!("{}: {error}", out.display()))?;
    }
    let arguments = ["-m", "maturin", "build", "--release", "--quiet", "--out"];
    run("maturin", Command::new(python).args(arguments).arg(out).current_dir(folder::root()))?;
    let made = fs::read_dir(out).map_err(|error| format!("{}: {error}", out.display()))?;
    let wheels: Vec<PathBuf> = made.flatten().map(|file| file.path()).collect();
    match wheels.as_slice() {
        [wheel] => Ok(wheel.clone()),
        other => Err(format!("{}: {} files, where one wheel is expected", out.display(), other.len())),
    }
}

/// A command that finds nothing of Rust.
fn outside<'a>(command: &'a mut Command, folder: &Path) -> &'a mut Command {
    command.current_dir(folder).env("PATH", "").env_remove("PYTHONPATH")
}
