//! `dynoid export`: a model as the files of another program.

use std::path::{Path, PathBuf};

use ::bench_model::document::{BenchModelDocument, format_of};
use export::fmu::FmiVersion;
use export::names::Names;
use export::{ExportError, ExportedFile};
use ident::ModelDocument;
use serde_json::json;

use super::bench_model;
use super::identify::model_file;
use crate::cli::export::{ExportArguments, ExportTarget};
use crate::commands::study::REPORT;
use crate::error::{CliError, Outcome};
use crate::formats::check_replaceable;
use crate::output::OutputFolder;
use crate::paths;
use crate::summary::shown;
use crate::terminal::Terminal;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Endings of files, which are no names of folders.
const OTHER_ENDINGS: [&str; 12] = ["c", "csv", "fmu", "h", "html", "json", "m", "mat", "mo", "py", "ssv", "txt"];

/// A model of either kind.
enum Source {
    Bench(Box<BenchModelDocument>),
    Linear(Box<ModelDocument>),
}

/// `dynoid export`
pub(crate) fn run(arguments: &ExportArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    if arguments.draws > 0 && arguments.to != ExportTarget::Ssv {
        return Err(CliError::Usage { what: "--draws belongs to --to ssv; give both".to_owned() });
    }
    let source = read(&arguments.model)?;
    let place = Place::of(arguments, &source)?;
    let failed = |source| CliError::Export { path: arguments.model.clone(), source };
    let files = exported(&source, arguments, &place.names).map_err(failed)?;
    place.check(&files, arguments)?;
    let contents: Vec<(&str, &[u8])> = files.iter().map(|file| (file.name.as_str(), &file.content[..])).collect();
    let written = OutputFolder::check(&place.folder)?.write(&contents)?;
    if arguments.json {
        terminal.json(&json!({ "model": arguments.model, "files": written }))?;
    } else if !terminal.is_quiet() {
        written.iter().for_each(|path| terminal.line(&format!("written: {}", shown(path))));
    }
    Ok(Outcome::Done)
}

/// The model in a file, whichever kind it is.
fn read(path: &Path) -> Result<Source, CliError> {
    let text = bench_model::text(path, "a model.json as `dynoid study` or `dynoid fit` writes, or an FMU of dynoid")?;
    match format_of(&text) {
        Some(format) if BenchModelDocument::is_format(&format) => {
            Ok(Source::Bench(Box::new(bench_model::of_text(path, &text)?)))
        }
        _ => Ok(Source::Linear(Box::new(model_file::of_text(path, &text)?))),
    }
}

fn exported(source: &Source, arguments: &ExportArguments, names: &Names) -> Result<Vec<ExportedFile>, ExportError> {
    match (source, arguments.to) {
        (Source::Bench(document), ExportTarget::Mat) => export::matlab::bench(document, names),
        (Source::Bench(document), ExportTarget::Modelica) => Ok(vec![export::modelica::bench(document, names)]),
        (Source::Bench(document), ExportTarget::Python) => Ok(vec![export::python::bench(document, names)]),
        (Source::Bench(document), ExportTarget::Ssv) => export::ssv::bench(document, names, arguments.draws),
        (Source::Bench(document), ExportTarget::Linear) => linear(document, names),
        (Source::Bench(document), ExportTarget::Fmu2) => fmu(document, FmiVersion::V2, arguments, names),
        (Source::Bench(document), ExportTarget::Fmu3) => fmu(document, FmiVersion::V3, arguments, names),
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
    }
}

/// An FMU, with the report that is in the folder of the model.
fn fmu(
    document: &BenchModelDocument,
    version: FmiVersion,
    arguments: &ExportArguments,
    names: &Names,
) -> Result<Vec<ExportedFile>, ExportError> {
    let report = std::fs::read(arguments.model.with_file_name(REPORT)).ok();
    Ok(vec![export::fmu::fmu(document, names, version, report.as_deref())?])
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
}

impl Place {
    fn of(arguments: &ExportArguments, source: &Source) -> Result<Self, CliError> {
        let own = match source {
            Source::Bench(document) => document.bench.name.clone(),
            Source::Linear(_) => model_file::name(&arguments.model),
        };
        let here = || PathBuf::from(".");
        let Some(out) = &arguments.out else { return Ok(Place { folder: here(), names: Names::of(&own), file: None }) };
        let ending = paths::ending(out).filter(|_| !out.is_dir());
        if !ending.is_some_and(|ending| ending.eq_ignore_ascii_case(arguments.to.ending())) {
            if let Some(other) =
                ending.filter(|ending| OTHER_ENDINGS.iter().any(|one| ending.eq_ignore_ascii_case(one)))
            {
                let what = format!("{}: this target writes .{}, not .{other}", out.display(), arguments.to.ending());
                return Err(CliError::Usage { what });
            }
            return Ok(Place { folder: out.clone(), names: Names::of(&own), file: None });
        }
        if arguments.to == ExportTarget::Linear {
            let what = format!("{}: --to linear writes a file for each control mode; give a folder", out.display());
            return Err(CliError::Usage { what });
        }
        let file = out.file_name().map(|name| name.to_string_lossy().into_owned());
        Ok(Place { folder: paths::folder_of(out), names: Names::of(&model_file::name(out)), file })
    }

    /// Refuses, before anything is written, names that the target cannot take, and files that dynoid did not write.
    fn check(&self, files: &[ExportedFile], arguments: &ExportArguments) -> Result<(), CliError> {
        if let (Some(asked), Some(first)) = (&self.file, files.first())
            && *asked != first.name
        {
            let what =
                format!("{asked}: the file names what is in it, which cannot have this name; {} can", first.name);
            return Err(CliError::Usage { what });
        }
        for file in files {
            let path = self.folder.join(&file.name);
            let is_read = matches!((path.canonicalize(), arguments.model.canonicalize()), (Ok(a), Ok(b)) if a == b);
            if is_read {
                let what = format!("{}: this file is read; give the result another name with --out", path.display());
                return Err(CliError::Usage { what });
            }
            check_replaceable(&path, arguments.overwrite)?;
        }
        Ok(())
    }
}
