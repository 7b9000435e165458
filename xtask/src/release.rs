//! `cargo xtask release`: archives of the program, the same bytes from the same commit.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::folder;
use crate::steps::{output, run, step};

/// Files in an archive beside the program.
const FILES: [&str; 4] = ["README.md", "CHANGELOG.md", "LICENSE-APACHE", "LICENSE-MIT"];

/// Makes an archive for this machine, or for each of `targets`, and a file of checksums.
pub(crate) fn make(targets: &[String]) -> Result<(), String> {
    let host = host()?;
    let targets = if targets.is_empty() { std::slice::from_ref(&host) } else { targets };
    let mut archives = Vec::new();
    for target in targets {
        let program = step(&format!("build for {target}"), || build(target, *target == host))?;
        archives.push(step(&format!("archive for {target}"), || archive(target, &program))?);
    }
    let folder = folder()?;
    let mut sums = Command::new("sha256sum");
    sums.current_dir(&folder).args(&archives);
    let sums = output(&mut sums)?;
    write(&folder.join("SHA256SUMS"), &sums)?;
    print!("{}:\n{sums}", folder.display());
    Ok(())
}

/// Where the archives are.
fn folder() -> Result<PathBuf, String> {
    let folder = folder::target()?.join("archives");
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    Ok(folder)
}

/// The target that cargo builds for here.
fn host() -> Result<String, String> {
    let version = output(Command::new(env!("CARGO")).args(["version", "--verbose"]))?;
    let host = version.lines().find_map(|line| line.strip_prefix("host: "));
    host.map(str::to_owned).ok_or_else(|| "cargo does not name its host".into())
}

/// Builds the program without paths of this machine in it. Other targets than this machine's need cargo-zigbuild.
fn build(target: &str, is_host: bool) -> Result<PathBuf, String> {
    let target_folder = folder::target()?.join("release-build");
    let mut cargo = Command::new(env!("CARGO"));
    cargo.arg(if is_host { "build" } else { "zigbuild" });
    cargo.args(["--release", "--locked", "--package", "dynoid-cli", "--target", target]);
    cargo.arg("--target-dir").arg(&target_folder).env("RUSTFLAGS", flags()?);
    run("the build (for other machines it needs cargo-zigbuild, and `rustup target add`)", &mut cargo)?;
    let name = if target.contains("windows") { "dynoid.exe" } else { "dynoid" };
    Ok(target_folder.join(target).join("release").join(name))
}

/// Maps folders of this machine to names that are the same on all.
fn flags() -> Result<String, String> {
    let home = |variable: &str, below: &str| {
        let named = std::env::var(variable).ok();
        named.or_else(|| std::env::home_dir().map(|home| home.join(below).display().to_string()))
    };
    let cargo = home("CARGO_HOME", ".cargo").ok_or("there is no home folder")?;
    let root = folder::root();
    Ok(format!("--remap-path-prefix={}=dynoid --remap-path-prefix={cargo}=cargo", root.display()))
}

/// Packs program, licences and words about it; every file has the time of the commit.
fn archive(target: &str, program: &Path) -> Result<String, String> {
    let root = folder::root();
    let name = format!("dynoid-{}-{target}", env!("CARGO_PKG_VERSION"));
    let folder = folder()?;
    let content = folder.join(&name);
    fs::create_dir_all(&content).map_err(|error| format!("{}: {error}", content.display()))?;
    let files = FILES.iter().map(|file| root.join(file)).filter(|file| file.exists());
    for file in files.chain([program.to_path_buf()]) {
        let copy = content.join(file.file_name().unwrap_or_default());
        fs::copy(&file, &copy).map_err(|error| format!("{}: {error}", file.display()))?;
    }
    let time = output(Command::new("git").current_dir(&root).args(["log", "-1", "--format=%ct"]))?;
    let tar = format!("{name}.tar");
    let mut pack = Command::new("tar");
    pack.current_dir(&folder).args(["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mode=go-w"]);
    pack.arg(format!("--mtime=@{}", time.trim())).args(["--create", "--file", &tar, &name]);
    run("tar (GNU tar is needed)", &mut pack)?;
    run("gzip", Command::new("gzip").current_dir(&folder).args(["--best", "--no-name", "--force", &tar]))?;
    fs::remove_dir_all(&content).map_err(|error| format!("{}: {error}", content.display()))?;
    Ok(format!("{tar}.gz"))
}

fn write(file: &Path, text: &str) -> Result<(), String> {
    fs::write(file, text).map_err(|error| format!("{}: {error}", file.display()))
}
