//! `cargo xtask release`: all files of a release, the same bytes from the same commit.

mod archive;
mod build;
mod content;
mod deb;
mod files;
mod licences;
mod linked;
mod manifests;
mod sbom;
mod start;
mod targets;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use sha2::{Digest, Sha256};

use crate::folder;
use crate::steps::{output, step};
use content::Content;
use files::{REPOSITORY, VERSION, read, write};
use linked::Linked;
use targets::{ALL, Target};

/// The file of checksums.
const SUMS: &str = "SHA256SUMS";
/// The largest archive, bytes.
const LARGEST: usize = 50_000_000;

/// Arguments of the task.
#[derive(Default)]
struct Request {
    targets: Vec<&'static Target>,
    /// A finished program, which is packed in place of a build.
    program: Option<PathBuf>,
    /// True where wheels are left out.
    without_wheels: bool,
    /// True where nothing is built, and the files that are there get sums and manifests.
    only_sums: bool,
}

impl Request {
    fn read(arguments: &[String]) -> Result<Self, String> {
        let mut request = Request::default();
        let mut words = arguments.iter();
        while let Some(word) = words.next() {
            match word.as_str() {
                "--sums" => request.only_sums = true,
                "--program" => {
                    let file = words.next().ok_or("--program needs the path of a finished program of this machine")?;
                    request.program = Some(std::path::absolute(file).map_err(|error| format!("{file}: {error}"))?);
                    request.without_wheels = true;
                }
                triple => request.targets.push(Target::named(triple)?),
            }
        }
        if request.targets.is_empty() && !request.only_sums {
            request.targets = ALL.iter().collect();
        }
        Ok(request)
    }
}

/// Makes what the arguments ask for.
pub(crate) fn make(arguments: &[String]) -> Result<(), String> {
    let request = Request::read(arguments)?;
    if !request.only_sums {
        packages(&request, &folder()?)?;
    }
    finish()
}

/// Makes the archives and packages that can be built here, and starts their programs. It counts the others.
pub(crate) fn deep() -> Result<(), String> {
    let mut request = Request { without_wheels: true, ..Request::default() };
    for target in &ALL {
        match build::obstacle(target)? {
            None => request.targets.push(target),
            Some(obstacle) => eprintln!("!! NOT BUILT: the program for {}: {obstacle}", target.triple),
        }
    }
    if request.targets.is_empty() {
        println!("release: 0 of {} targets built", ALL.len());
        return Ok(());
    }
    let mut started = 0;
    for (target, program) in packages(&request, &folder()?)? {
        match step(&format!("demonstration on {}", target.triple), || start::demonstrate(target, &program))? {
            true => started += 1,
            false => eprintln!("!! NOT STARTED: the program for {}: nothing here runs it", target.triple),
        }
    }
    println!("release: {} of {} targets built, {started} started", request.targets.len(), ALL.len());
    finish()
}

/// Writes the sums and manifests of all files.
fn finish() -> Result<(), String> {
    let folder = folder()?;
    let sums = step("checksums", || sums(&folder))?;
    let text: String = sums.iter().map(|(name, sum)| format!("{sum}  {name}\n")).collect();
    write(&folder.join(SUMS), text.as_bytes())?;
    step("manifests", || manifests::write_all(&folder, &sums, &commit("%cs")?))?;
    print!("{}:\n{text}", folder.display());
    Ok(())
}

/// A program that is built.
type Built = (&'static Target, PathBuf);

/// Makes archives, packages and wheels for the targets, and returns the programs in them.
fn packages(request: &Request, folder: &Path) -> Result<Vec<Built>, String> {
    let time_s: u64 = commit("%ct")?.parse().map_err(|error| format!("git log: {error}"))?;
    let mut programs: Vec<Built> = Vec::new();
    for target in &request.targets {
        let built = || request.program.clone().map_or_else(|| build::program(target, time_s), Ok);
        programs.push((*target, step(&format!("program for {}", target.triple), built)?));
    }
    let here = request
        .program
        .clone()
        .or_else(|| programs.iter().find(|(target, _)| target.runs_here()).map(|(_, program)| program.clone()));
    let here = here.map_or_else(|| build::program_of_host(time_s), Ok)?;
    let linked = step("crates in the program", Linked::find)?;
    let content = step("completions, manual, licences", || Content::gather(&here, &linked, time_s))?;
    for (target, program) in &programs {
        step(&format!("files for {}", target.triple), || pack(folder, &content, target, read(program)?))?;
        let wheels = target.wheels.iter().filter(|_| !request.without_wheels);
        for wheel in wheels {
            step(&format!("wheel for {}", wheel.triple), || build::wheel(wheel, folder, time_s))?;
        }
    }
    let list = sbom::text(&linked, REPOSITORY, &commit("%cd")?)?;
    write(&folder.join(format!("dynoid-{VERSION}.cdx.json")), list.as_bytes())?;
    write(&folder.join(licences::FILE), content.file(licences::FILE)?)?;
    source(folder)?;
    Ok(programs)
}

/// Writes the archive, the package and the program alone, as far as a target has them.
fn pack(folder: &Path, content: &Content, target: &Target, program: Vec<u8>) -> Result<(), String> {
    if let Some(end) = target.portable {
        write(&folder.join(format!("dynoid-{VERSION}-{end}")), &program)?;
    }
    if let Some(debian) = target.debian {
        let package = deb::package(content, program.clone(), debian)?;
        write(&folder.join(format!("dynoid_{VERSION}_{debian}.deb")), &package)?;
    }
    let (name, archive) = content.archive(target, program)?;
    match archive.len() > LARGEST {
        true => Err(format!("{name}: it has more than {} MB", LARGEST / 1_000_000)),
        false => write(&folder.join(name), &archive),
    }
}

/// Writes the sources of the commit, from which others build.
fn source(folder: &Path) -> Result<(), String> {
    let name = format!("dynoid-{VERSION}-source.tar");
    let tar = folder.join(&name);
    let mut git = Command::new("git");
    git.current_dir(folder::root()).args(["archive", "--format=tar"]).arg(format!("--prefix=dynoid-{VERSION}/"));
    output(git.arg("--output").arg(&tar).arg("HEAD"))?;
    write(&folder.join(format!("{name}.gz")), &archive::gzip(&read(&tar)?)?)?;
    fs::remove_file(&tar).map_err(|error| format!("{}: {error}", tar.display()))
}

/// SHA-256 of all files of this version, by their names.
fn sums(folder: &Path) -> Result<BTreeMap<String, String>, String> {
    let mut sums = BTreeMap::new();
    for entry in fs::read_dir(folder).map_err(|error| format!("{}: {error}", folder.display()))? {
        let path = entry.map_err(|error| format!("{}: {error}", folder.display()))?.path();
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_file() && (name.contains(VERSION) || name == licences::FILE) {
            let sum = Sha256::digest(read(&path)?);
            sums.insert(name, sum.iter().map(|byte| format!("{byte:02x}")).collect());
        }
    }
    Ok(sums)
}

/// Where the files are.
fn folder() -> Result<PathBuf, String> {
    let folder = folder::target()?.join("release-files");
    fs::create_dir_all(&folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    Ok(folder)
}

/// Something of the commit, in the format of `git log`; its day and time are in UTC.
fn commit(format: &str) -> Result<String, String> {
    let mut git = Command::new("git");
    git.current_dir(folder::root()).env("TZ", "UTC").args(["log", "-1", "--date=format-local:%Y-%m-%dT%H:%M:%SZ"]);
    Ok(output(git.arg(format!("--format={format}")))?.trim().to_owned())
}
