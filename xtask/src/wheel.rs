//! The wheel of the module `dynoid`: built as `pip install .` builds it, started in an environment that has nothing
//! else, and tested.

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
/// Packages that build the wheel and test it.
const PACKAGES: &str =
    "import control, maturin, matplotlib, mypy, pandas, polars, pyarrow, pytest, scipy, sippy_unipi, statsmodels";
/// The largest wheel, bytes.
const LARGEST: u64 = 25_000_000;
/// Versions of numpy: the newest, and the oldest that the package names.
const NEWEST: &str = "numpy";
const OLDEST: &str = "numpy==1.26.*";
/// Packages that run the notebooks, and all that these packages need.
const NOTEBOOKS: &str = "xtask/notebooks.txt";
/// Other versions of Python, where they are.
const OTHERS: [&str; 2] = ["python3.12", "python3.13"];

/// Builds the wheel in `target/wheels`, runs module and program where there is nothing else, and runs the tests in
/// `python/tests` on it. Returns false where there is no Python to do so.
pub(crate) fn check(python: Option<&Path>) -> Result<bool, String> {
    let Some(python) = python.filter(|python| output(Command::new(python).args(["-c", PACKAGES])).is_ok()) else {
        eprintln!("!! NOT RUN: the wheel and its tests. They need the packages of xtask/python.txt.");
        return Ok(false);
    };
    let wheel = build(python)?;
    Alone::new(python, "wheel-alone", NEWEST)?.start(&wheel)?.demonstrate()?;
    test(python, &wheel)?;
    Ok(true)
}

/// The same, with the oldest numpy, other versions of Python, and the notebooks.
pub(crate) fn deep() -> Result<(), String> {
    let Some(python) = python::interpreter()? else {
        return Err("the wheel cannot be built without Python".to_owned());
    };
    if !check(Some(&python))? {
        return Err("the wheel was not built".to_owned());
    }
    let wheel = only_wheel()?;
    Alone::new(&python, "wheel-oldest-numpy", OLDEST)?.start(&wheel)?;
    for other in OTHERS {
        match output(Command::new(other).arg("--version")) {
            Ok(version) => {
                println!("{}", version.trim());
                Alone::new(Path::new(other), other, NEWEST)?.start(&wheel)?;
            }
            Err(_) => println!("not run: {other}, which is not there"),
        }
    }
    notebooks(&python, &wheel)
}

fn build(python: &Path) -> Result<PathBuf, String> {
    let out = folder::target()?.join("wheels");
    if out.exists() {
        fs::remove_dir_all(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    }
    let arguments = ["-m", "maturin", "build", "--release", "--quiet", "--out"];
    run("maturin", Command::new(python).args(arguments).arg(&out).current_dir(folder::root()))?;
    let wheel = only_wheel()?;
    let size = fs::metadata(&wheel).map_err(|error| format!("{}: {error}", wheel.display()))?.len();
    println!("{}: {:.1} MB", wheel.display(), size as f64 / 1e6);
    if size > LARGEST { Err(format!("the wheel has more than {:.0} MB", LARGEST as f64 / 1e6)) } else { Ok(wheel) }
}

fn only_wheel() -> Result<PathBuf, String> {
    let out = folder::target()?.join("wheels");
    let made = fs::read_dir(&out).map_err(|error| format!("{}: {error}", out.display()))?;
    let wheels: Vec<PathBuf> = made.flatten().map(|file| file.path()).collect();
    match wheels.as_slice() {
        [wheel] => Ok(wheel.clone()),
        other => Err(format!("{}: {} files, where one wheel is expected", out.display(), other.len())),
    }
}

/// An environment of Python with numpy and the wheel alone.
struct Alone {
    folder: PathBuf,
}

impl Alone {
    /// The environment of this name, which is made once: after that no network is needed.
    fn new(python: &Path, name: &str, numpy: &str) -> Result<Self, String> {
        let alone = Alone { folder: folder::target()?.join(name) };
        let stamp = alone.folder.join("installed.txt");
        if fs::read_to_string(&stamp).is_ok_and(|installed| installed == numpy) {
            return Ok(alone);
        }
        run("an empty environment", Command::new(python).args(["-m", "venv", "--clear"]).arg(&alone.folder))?;
        alone.install(&[], numpy.as_ref())?;
        fs::write(&stamp, numpy).map_err(|error| format!("{}: {error}", stamp.display()))?;
        Ok(alone)
    }

    /// A program of the environment, which finds nothing of Rust.
    fn program(&self, name: &str) -> Command {
        let mut command = Command::new(self.folder.join(if cfg!(windows) { "Scripts" } else { "bin" }).join(name));
        command.current_dir(&self.folder).env("PATH", "").env_remove("PYTHONPATH");
        command
    }

    fn install(&self, options: &[&str], what: &Path) -> Result<(), String> {
        let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
        run("the installation", self.program("python").args(install).args(options).arg(what))
    }

    /// Installs the wheel, and starts the module and the program of it.
    fn start(self, wheel: &Path) -> Result<Self, String> {
        self.install(&["--no-deps", "--force-reinstall"], wheel)?;
        let version = output(self.program("python").args(["-c", SMOKE]))?;
        let named = output(self.program("dynoid").arg("--version"))?;
        if named.trim() == format!("dynoid {}", version.trim()) {
            Ok(self)
        } else {
            Err(format!("the program is of {}, and the module of {}", named.trim(), version.trim()))
        }
    }

    fn demonstrate(&self) -> Result<(), String> {
        let demo = ["demo", "--quiet", "--overwrite", "--out", "demo"];
        run("the demonstration", self.program("dynoid").args(demo))
    }
}

/// Runs the notebooks on the wheel, and writes their pages of the book.
fn notebooks(python: &Path, wheel: &Path) -> Result<(), String> {
    let alone = Alone::new(python, "notebooks", NEWEST)?;
    // Without further dependencies: all of them are pinned.
    alone.install(&["--no-deps", "--requirement"], &folder::root().join(NOTEBOOKS))?;
    let alone = alone.start(wheel)?;
    run("the notebooks", alone.program("python").arg(folder::root().join("docs/notebooks/run.py")))
}

/// Runs the tests in `python/tests` on the wheel, beside the packages that they compare with.
fn test(python: &Path, wheel: &Path) -> Result<(), String> {
    let unpacked = folder::target()?.join("wheel-tests");
    if unpacked.exists() {
        fs::remove_dir_all(&unpacked).map_err(|error| format!("{}: {error}", unpacked.display()))?;
    }
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--no-deps", "--target"];
    run("the installation", Command::new(python).args(install).arg(&unpacked).arg(wheel))?;
    let tests = ["-m", "pytest", "--quiet", "-p", "no:cacheprovider"];
    let mut pytest = Command::new(python);
    pytest.args(tests).arg(folder::root().join("python/tests")).current_dir(&unpacked);
    run("the tests", pytest.env("PYTHONPATH", &unpacked).env("PYTHONDONTWRITEBYTECODE", "1"))
}
