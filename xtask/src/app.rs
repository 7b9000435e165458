//! The app: the types of its scripts, and its pages in a browser.

use std::env;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::steps::{output, run};
use crate::{folder, npm};

const TYPESCRIPT: &str = "typescript@7.0.2";
/// Names the browser to the tests. Where it is set, that program is taken.
const BROWSER: &str = "CHROMIUM";
const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];

/// Checks types and pages, and returns what could not be checked, in words.
pub(crate) fn check(python: Option<&Path>, axe: Option<&Path>) -> Result<Vec<String>, String> {
    let mut left = Vec::new();
    let compiler = if cfg!(windows) { ".bin/tsc.cmd" } else { ".bin/tsc" };
    match npm::file(TYPESCRIPT, compiler) {
        Some(compiler) => run("the types of the app", Command::new(compiler).args(["-p", "crates/programs/app/web"]))?,
        None => left.push("the types of the app's scripts, since npm is not there".to_owned()),
    }
    match (python.filter(|python| drives(python)), browser()?) {
        (Some(python), Some(browser)) => pages(python, &browser, axe)?,
        _ => left.push("the app in a browser, which needs Chromium and the packages of xtask/python.txt".to_owned()),
    }
    Ok(left)
}

fn drives(python: &Path) -> bool {
    output(Command::new(python).args(["-c", "import playwright, pytest"])).is_ok()
}

/// The browser. A machine of continuous integration installs it, since a test that is left out there would go unseen.
fn browser() -> Result<Option<PathBuf>, String> {
    if let Some(chosen) = env::var_os(BROWSER) {
        return Ok(Some(chosen.into()));
    }
    let found = || BROWSERS.iter().map(PathBuf::from).find(|name| output(Command::new(name).arg("--version")).is_ok());
    if found().is_some() || env::var_os("CI").is_none() {
        return Ok(found());
    }
    run("apt-get update", Command::new("apt-get").args(["update", "-qq"]))?;
    let install = ["install", "-y", "-qq", "--no-install-recommends", "chromium", "fonts-dejavu-core"];
    run(
        "the installation of Chromium",
        Command::new("apt-get").args(install).env("DEBIAN_FRONTEND", "noninteractive"),
    )?;
    found().map(Some).ok_or_else(|| "Chromium was installed and does not start".to_owned())
}

/// The tests of the pages, on the program that the other tests were built with.
fn pages(python: &Path, browser: &Path, axe: Option<&Path>) -> Result<(), String> {
    let program = folder::target()?.join("release").join(if cfg!(windows) { "dynoid.exe" } else { "dynoid" });
    let mut tests = Command::new(python);
    tests.args(["-m", "pytest", "-q", "-p", "no:cacheprovider", "crates/programs/app/browser"]);
    tests.current_dir(folder::root()).env("DYNOID", program).env(BROWSER, browser);
    tests.envs(axe.map(|script| (crate::axe::VARIABLE, script)));
    run("the app in a browser", &mut tests)
}
