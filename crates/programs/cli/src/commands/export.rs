//! `dynoid export`: a model as the files of another program.

use std::path::{Path, PathBuf};

use bench_model::document::BenchModelDocument;
use dynoid::{Files, Mark, OutputFolder, check_replaceable, paths, replace_file};
use export::fmu::FmiVersion;
use export::names::Names;
use export::{ExportError, ExportedFile};
use ident::ModelDocument;
use serde_json::json;

use super::identify::model_file::{self, AnyModelFile as Source};
use crate::cli::export::{ExportArguments, ExportTarget};
use crate::commands::bench_model::is_reported;
use crate::commands::study::REPORT;
use crate::error::{CliError, Outcome};
use crate::summary::shown;
use crate::terminal::Terminal;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Endings of files, which are no names of folders.
const OTHER_ENDINGS: [&str; 13] = ["c", "csv", "fmu", "h", "html", "json", "m", "mat", "mo", "py", "ssp", "ssv", "txt"];

/// `dynoid export`
pub(crate) fn run(arguments: &ExportArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    if arguments.draws > 0 && arguments.to != ExportTarget::Ssv {
        return Err(CliError::Usage { what: "--draws belongs to --to ssv; give both".to_owned() });
    }
    let source = Source::read(&arguments.model, &terminal.files())?;
    let place = Place::of(arguments, &source)?;
    let failed = |source| CliError::Export { path: arguments.model.clone(), source };
    let report = report(&source, arguments, terminal);
    let files =
        place.named(exported(&source, arguments, report.as_deref(), &place.names).map_err(failed)?, arguments.to);
    if let Some(device) = &place.device {
        return write_to_device(device, &files, &terminal.files());
    }
    place.check(&files, arguments, &terminal.files())?;
    let folder = OutputFolder::check(&place.folder, &terminal.files())?;
    let replaced: Vec<PathBuf> = files.iter().filter_map(|file| place.replaced_by(file)).collect();
    let contents: Vec<(&str, &[u8])> = files.iter().map(|file| (file.name.as_str(), &file.content[..])).collect();
    let written = folder.write(&contents)?;
    if arguments.json {
        terminal.json(&json!({ "model": arguments.model, "files": written, "replaced": replaced }))?;
    } else if !terminal.is_quiet() {
        for path in &written {
            let is_replaced = replaced.iter().any(|other| other.file_name() == path.file_name());
            terminal.line(&format!("{}: {}", if is_replaced { "replaced" } else { "written" }, shown(path)));
        }
    }
    if arguments.to == ExportTarget::Ssv {
        place.older_draws(arguments.draws as usize).into_iter().for_each(|warning| terminal.warning(&warning));
    }
    Ok(Outcome::Done)
}

/// Writes the one file of a target to what is no file, such as standard output.
fn write_to_device(device: &Path, files: &[ExportedFile], run: &Files) -> Result<Outcome, CliError> {
    let [file] = files else {
        let what = format!("{}: this target writes {} files; give a folder", device.display(), files.len());
        return Err(CliError::Usage { what });
    };
    replace_file(device, &file.content, run)?;
    Ok(Outcome::Done)
}

fn exported(
    source: &Source,
    arguments: &ExportArguments,
    report: Option<&[u8]>,
    names: &Names,
) -> Result<Vec<ExportedFile>, ExportError> {
    match (source, arguments.to) {
        (Source::Bench(document), ExportTarget::Mat) => export::matlab::bench(document, names),
        (Source::Bench(document), ExportTarget::Modelica) => Ok(vec![export::modelica::bench(document, names)]),
        (Source::Bench(document), ExportTarget::Python) => Ok(vec![export::python::bench(document, names)]),
        (Source::Bench(document), ExportTarget::Ssv) => export::ssv::bench(document, names, arguments.draws as usize),
        (Source::Bench(document), ExportTarget::Linear) => linear(document, names),
        (Source::Bench(document), ExportTarget::Fmu2) => fmu(document, FmiVersion::V2, report, names),
        (Source::Bench(document), ExportTarget::Fmu3) => fmu(document, FmiVersion::V3, report, names),
        (Source::Bench(document), ExportTarget::Ssp) => Ok(vec![export::fmu::ssp(document, names, report)?]),
        (Source::Bench(document), ExportTarget::C) => export::fmu::c_files(document, names),
        (Source::Linear(document), ExportTarget::Mat) => export::matlab::linear(document, names, VERSION),
        (Source::Linear(document), ExportTarget::Modelica) => {
            Ok(vec![export::modelica::linear(document, names, VERSION)?])
        }
        (Source::Linear(document), ExportTarget::Python) => Ok(vec![export::python::linear(document, names, VERSION)?]),
        (Source::Linear(document), ExportTarget::Fmu2) => linear_fmu(document, FmiVersion::V2, names),
        (Source::Linear(document), ExportTarget::Fmu3) => linear_fmu(document, FmiVersion::V3, names),
        (Source::Linear(document), ExportTarget::C) => export::fmu::linear_c_files(document, names, VERSION),
        (Source::Linear(document), ExportTarget::Ssv) => export::ssv::linear(document, names, VERSION),
        (Source::Linear(_), ExportTarget::Linear) => Err(ExportError::BenchOnly { target: "linear" }),
        (Source::Linear(_), ExportTarget::Ssp) => Err(ExportError::BenchOnly { target: "ssp" }),
    }
}

/// An FMU, with the report.
fn fmu(
    document: &BenchModelDocument,
    version: FmiVersion,
    report: Option<&[u8]>,
    names: &Names,
) -> Result<Vec<ExportedFile>, ExportError> {
    Ok(vec![export::fmu::fmu(document, names, version, report)?])
}

/// The report that is in the folder of the model, for targets that take it along. One of another study is left out.
fn report(source: &Source, arguments: &ExportArguments, terminal: &mut Terminal) -> Option<Vec<u8>> {
    let Source::Bench(document) = source else { return None };
    if !matches!(arguments.to, ExportTarget::Fmu2 | ExportTarget::Fmu3 | ExportTarget::Ssp) {
        return None;
    }
    let path = arguments.model.with_file_name(REPORT);
    let report = std::fs::read(&path).ok()?;
    if is_reported(document, &report) {
        return Some(report);
    }
    terminal.warning(&format!(
        "{}: this report is of another study than the model, and is left out; run `dynoid study bench.toml` again",
        path.display()
    ));
    None
}

fn linear_fmu(document: &ModelDocument, fmi: FmiVersion, names: &Names) -> Result<Vec<ExportedFile>, ExportError> {
    Ok(vec![export::fmu::linear_fmu(document, names, fmi, VERSION)?])
}

/// Model files of the bench in each control mode.
fn linear(document: &BenchModelDocument, names: &Names) -> Result<Vec<ExportedFile>, ExportError> {
    let file = |(mode, model): (&str, ModelDocument)| {
        let text =
            serde_json::to_string_pretty(&model).map_err(|error| ExportError::Text { reason: error.to_string() })?;
        Ok(ExportedFile::text(format!("{}_{}.json", names.file, mode.to_lowercase().replace(' ', "_")), text))
    };
    export::toolbox_models(document)?.into_iter().map(file).collect()
}

/// Where the files go, and what the model is called there.
struct Place {
    folder: PathBuf,
    names: Names,
    /// The name of the first file, where the command line states it.
    file: Option<String>,
    /// Device that the command line names, neither a file nor a folder.
    device: Option<PathBuf>,
}

impl Place {
    fn of(arguments: &ExportArguments, source: &Source) -> Result<Self, CliError> {
        let own = match source {
            Source::Bench(document) => Names::of(&document.bench.name),
            Source::Linear(_) => Names::of(&model_file::name(&arguments.model)),
        };
        let in_folder = |folder: PathBuf| Place { folder, names: own.clone(), file: None, device: None };
        let Some(out) = &arguments.out else { return Ok(in_folder(PathBuf::from("."))) };
        if paths::is_stream(out) {
            return Ok(Place { device: Some(out.clone()), ..in_folder(PathBuf::from(".")) });
        }
        let ending = paths::ending(out).filter(|_| !out.is_dir());
        if !ending.is_some_and(|ending| ending.eq_ignore_ascii_case(arguments.to.ending())) {
            if let Some(other) =
                ending.filter(|ending| OTHER_ENDINGS.iter().any(|one| ending.eq_ignore_ascii_case(one)))
            {
                let what = format!("{}: this target writes .{}, not .{other}", out.display(), arguments.to.ending());
                return Err(CliError::Usage { what });
            }
            return Ok(in_folder(out.clone()));
        }
        if arguments.to == ExportTarget::Linear {
            let what = format!("{}: --to linear writes a file for each control mode; give a folder", out.display());
            return Err(CliError::Usage { what });
        }
        let file = out.file_name().map(|name| name.to_string_lossy().into_owned());
        let stem = model_file::name(out);
        let mut names = Names::of(&stem);
        if arguments.to.takes_name(&stem) {
            names.file = stem;
        }
        Ok(Place { folder: paths::folder_of(out), names, file, device: None })
    }

    /// The files, an FMU by the name that the command line states.
    fn named(&self, mut files: Vec<ExportedFile>, to: ExportTarget) -> Vec<ExportedFile> {
        if let (Some(asked), ExportTarget::Fmu2 | ExportTarget::Fmu3, [fmu]) = (&self.file, to, &mut files[..]) {
            asked.clone_into(&mut fmu.name);
        }
        files
    }

    /// Refuses, before anything is written, names that the target cannot take, and files that must stay.
    fn check(&self, files: &[ExportedFile], arguments: &ExportArguments, run: &Files) -> Result<(), CliError> {
        if let (Some(asked), Some(first)) = (&self.file, files.first())
            && *asked != first.name
        {
            let what =
                format!("{asked}: the file names what is in it, which cannot have this name; {} can", first.name);
            return Err(CliError::Usage { what });
        }
        for file in files {
            let path = self.folder.join(&file.name);
            check_replaceable(&path, Mark::of_content(&file.content).as_ref(), run)?;
            if !run.overwrites() {
                self.check_version(file, arguments.to)?;
            }
        }
        Ok(())
    }

    /// Refuses to replace an FMU of another version of FMI, and sources of another version of dynoid that other models
    /// use.
    fn check_version(&self, file: &ExportedFile, to: ExportTarget) -> Result<(), CliError> {
        let Some(path) = self.replaced_by(file) else { return Ok(()) };
        if to == ExportTarget::C && export::fmu::is_shared_source(&file.name) {
            return Err(CliError::OtherSource { path });
        }
        let Some(wanted) = to.fmi_version() else { return Ok(()) };
        match std::fs::read(&path).ok().and_then(|bytes| export::fmu::version_of(&bytes)) {
            Some(found) if found != wanted => {
                Err(CliError::OtherFmi { path, found: found.number(), wanted: wanted.number() })
            }
            _ => Ok(()),
        }
    }

    /// The file that is there with other content.
    fn replaced_by(&self, file: &ExportedFile) -> Option<PathBuf> {
        let path = self.folder.join(&file.name);
        let is_other = path.is_file() && std::fs::read(&path).map_or(true, |content| content != file.content);
        is_other.then_some(path)
    }

    /// That draws of an earlier export are among those that were written.
    fn older_draws(&self, count: usize) -> Option<String> {
        let next = self.folder.join(format!("{}_draw_{}.ssv", self.names.file, count + 1));
        next.is_file().then(|| {
            format!(
                "{}: this draw and those after it are of an earlier export; remove them before you use the draws",
                next.display()
            )
        })
    }
}
