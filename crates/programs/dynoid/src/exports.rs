//! Models as the files of other programs.

use std::path::{Path, PathBuf};

use bench_model::document::BenchModelDocument;
use export::fmu::FmiVersion;
use export::names::Names;
use export::{ExportError, ExportedFile};
use ident::ModelDocument;

use crate::error::Error;
use crate::files::Files;
use crate::mark::Mark;
use crate::models::{Model, is_reported, model_name};
use crate::output::{OutputFolder, check_replaceable, replace_file};
use crate::paths;
use crate::written::REPORT;

const VERSION: &str = env!("CARGO_PKG_VERSION");

/// Endings of files, which are no names of folders.
const OTHER_ENDINGS: [&str; 13] = ["c", "csv", "fmu", "h", "html", "json", "m", "mat", "mo", "py", "ssp", "ssv", "txt"];

/// Targets to which a model is exported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportTarget {
    /// MATLAB and Octave.
    Mat,
    /// Modelica.
    Modelica,
    /// Python with numpy.
    Python,
    /// Functional Mock-up Unit, FMI 2.0.
    Fmu2,
    /// Functional Mock-up Unit, FMI 3.0.
    Fmu3,
    /// C99.
    C,
    /// SSP system with the bench and the place of an engine.
    Ssp,
    /// SSP parameter sets.
    Ssv {
        /// Benches drawn from the covariance, a file each.
        draws: usize,
    },
    /// Linear models, a model file for each control mode.
    Linear,
}

impl ExportTarget {
    /// The version of FMI.
    pub fn fmi_version(self) -> Option<FmiVersion> {
        match self {
            ExportTarget::Fmu2 => Some(FmiVersion::V2),
            ExportTarget::Fmu3 => Some(FmiVersion::V3),
            _ => None,
        }
    }

    /// The ending of its main file.
    pub fn ending(self) -> &'static str {
        match self {
            ExportTarget::Mat => "mat",
            ExportTarget::Modelica => "mo",
            ExportTarget::Python => "py",
            ExportTarget::Fmu2 | ExportTarget::Fmu3 => "fmu",
            ExportTarget::C => "h",
            ExportTarget::Ssp => "ssp",
            ExportTarget::Ssv { .. } => "ssv",
            ExportTarget::Linear => "json",
        }
    }

    /// Tells whether its main file can have this name as it is. In the other targets it names what is in it, which
    /// takes fewer names.
    fn takes_name(self, name: &str) -> bool {
        match self {
            ExportTarget::Fmu2 | ExportTarget::Fmu3 | ExportTarget::Ssp | ExportTarget::Ssv { .. } => true,
            ExportTarget::Python | ExportTarget::Mat => Names::of(name).file == name.to_ascii_lowercase(),
            ExportTarget::C => name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c)),
            ExportTarget::Modelica | ExportTarget::Linear => false,
        }
    }
}

/// The files of an exported model.
#[derive(Debug, Clone)]
pub struct Export {
    target: ExportTarget,
    files: Vec<ExportedFile>,
    place: Place,
    remark: Option<String>,
}

/// The files that an export wrote.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WrittenExport {
    /// All files; none where they went to a pipe or a device.
    pub files: Vec<PathBuf>,
    /// Files among them that replaced others.
    pub replaced: Vec<PathBuf>,
    /// That draws of an earlier export are among those that were written.
    pub older_draws: Option<String>,
}

impl Export {
    /// Exports the model in a file: a model.json or study.json of a study, a linear model, or an FMU made of one. The
    /// files go to `out`, a folder or the name of the first file, or to the current folder.
    ///
    /// # Errors
    /// A file that cannot be read, a model that the target has no place for, and a name that does not fit the target.
    pub fn of_file(model: &Path, target: ExportTarget, out: Option<&Path>, files: &Files) -> Result<Self, Error> {
        let source = files.model(model)?;
        let place = Place::of(&source, model, target, out)?;
        let (report, remark) = report(&source, model, target);
        let exported = exported(&source, target, report.as_deref(), &place.names);
        let exported = exported.map_err(|source| Error::Export { path: model.to_owned(), source })?;
        Ok(Export { target, files: place.named(exported, target), place, remark })
    }

    /// Exports the model of a bench that is in memory into a folder.
    ///
    /// # Errors
    /// A model that the target has no place for.
    pub fn of_bench(model: &BenchModelDocument, target: ExportTarget, folder: &Path) -> Result<Self, Error> {
        let names = Names::of(&model.bench.name);
        let source = Model::Bench(Box::new(model.clone()));
        let files = exported(&source, target, None, &names);
        let files = files.map_err(|source| Error::Export { path: folder.to_owned(), source })?;
        let place = Place { folder: folder.to_owned(), names, file: None, device: None };
        Ok(Export { target, files, place, remark: None })
    }

    /// The files, by their names.
    pub fn files(&self) -> &[ExportedFile] {
        &self.files
    }

    /// That the report beside the model is left out, and why.
    pub fn remark(&self) -> Option<&str> {
        self.remark.as_deref()
    }

    /// Writes the files: all of them, or, if one cannot be written, none.
    ///
    /// # Errors
    /// A file that must stay, or cannot be written.
    pub fn write(&self, run: &Files) -> Result<WrittenExport, Error> {
        let mut written = WrittenExport { files: Vec::new(), replaced: Vec::new(), older_draws: None };
        if let Some(device) = &self.place.device {
            let [file] = &self.files[..] else {
                return Err(Error::ManyFiles { path: device.clone(), count: self.files.len() });
            };
            replace_file(device, &file.content, run)?;
            return Ok(written);
        }
        self.place.check(&self.files, self.target, run)?;
        let folder = OutputFolder::check(&self.place.folder, run)?;
        written.replaced = self.files.iter().filter_map(|file| self.place.replaced_by(file)).collect();
        let contents: Vec<(&str, &[u8])> =
            self.files.iter().map(|file| (file.name.as_str(), &file.content[..])).collect();
        written.files = folder.write(&contents)?;
        if let ExportTarget::Ssv { draws } = self.target {
            written.older_draws = self.place.older_draws(draws);
        }
        Ok(written)
    }
}

fn exported(
    source: &Model,
    target: ExportTarget,
    report: Option<&[u8]>,
    names: &Names,
) -> Result<Vec<ExportedFile>, ExportError> {
    match (source, target) {
        (Model::Bench(document), ExportTarget::Mat) => export::matlab::bench(document, names),
        (Model::Bench(document), ExportTarget::Modelica) => Ok(vec![export::modelica::bench(document, names)]),
        (Model::Bench(document), ExportTarget::Python) => Ok(vec![export::python::bench(document, names)]),
        (Model::Bench(document), ExportTarget::Ssv { draws }) => export::ssv::bench(document, names, draws),
        (Model::Bench(document), ExportTarget::Linear) => linear(document, names),
        (Model::Bench(document), ExportTarget::Fmu2) => fmu(document, FmiVersion::V2, report, names),
        (Model::Bench(document), ExportTarget::Fmu3) => fmu(document, FmiVersion::V3, report, names),
        (Model::Bench(document), ExportTarget::Ssp) => Ok(vec![export::fmu::ssp(document, names, report)?]),
        (Model::Bench(document), ExportTarget::C) => export::fmu::c_files(document, names),
        (Model::Linear(document), ExportTarget::Mat) => export::matlab::linear(document, names, VERSION),
        (Model::Linear(document), ExportTarget::Modelica) => {
            Ok(vec![export::modelica::linear(document, names, VERSION)?])
        }
        (Model::Linear(document), ExportTarget::Python) => Ok(vec![export::python::linear(document, names, VERSION)?]),
        (Model::Linear(document), ExportTarget::Fmu2) => linear_fmu(document, FmiVersion::V2, names),
        (Model::Linear(document), ExportTarget::Fmu3) => linear_fmu(document, FmiVersion::V3, names),
        (Model::Linear(document), ExportTarget::C) => export::fmu::linear_c_files(document, names, VERSION),
        (Model::Linear(document), ExportTarget::Ssv { .. }) => export::ssv::linear(document, names, VERSION),
        (Model::Linear(_), ExportTarget::Linear) => Err(ExportError::BenchOnly { target: "linear" }),
        (Model::Linear(_), ExportTarget::Ssp) => Err(ExportError::BenchOnly { target: "ssp" }),
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

/// The report that is in the folder of the model, for targets that take it along. One of another study is left out,
/// which the remark says.
fn report(source: &Model, path: &Path, target: ExportTarget) -> (Option<Vec<u8>>, Option<String>) {
    let takes_it = matches!(target, ExportTarget::Fmu2 | ExportTarget::Fmu3 | ExportTarget::Ssp);
    let Model::Bench(document) = source else { return (None, None) };
    let path = path.with_file_name(REPORT);
    match takes_it.then(|| std::fs::read(&path).ok()).flatten() {
        Some(report) if !is_reported(document, &report) => {
            let remark =
                "this report is of another study than the model, and is left out; run `dynoid study bench.toml` again";
            (None, Some(format!("{}: {remark}", path.display())))
        }
        report => (report, None),
    }
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
#[derive(Debug, Clone)]
struct Place {
    folder: PathBuf,
    names: Names,
    /// The name of the first file, where it is stated.
    file: Option<String>,
    /// Device in place of a folder.
    device: Option<PathBuf>,
}

impl Place {
    fn of(source: &Model, model: &Path, target: ExportTarget, out: Option<&Path>) -> Result<Self, Error> {
        let own = match source {
            Model::Bench(document) => Names::of(&document.bench.name),
            Model::Linear(_) => Names::of(&model_name(model)),
        };
        let in_folder = |folder: PathBuf| Place { folder, names: own.clone(), file: None, device: None };
        let Some(out) = out else { return Ok(in_folder(PathBuf::from("."))) };
        if paths::is_stream(out) {
            return Ok(Place { device: Some(out.to_owned()), ..in_folder(PathBuf::from(".")) });
        }
        let ending = paths::ending(out).filter(|_| !out.is_dir());
        if !ending.is_some_and(|ending| ending.eq_ignore_ascii_case(target.ending())) {
            let is_other = |ending: &&str| OTHER_ENDINGS.iter().any(|one| ending.eq_ignore_ascii_case(one));
            return match ending.filter(is_other) {
                Some(other) => {
                    Err(Error::OtherEnding { path: out.to_owned(), wanted: target.ending(), found: other.to_owned() })
                }
                None => Ok(in_folder(out.to_owned())),
            };
        }
        if target == ExportTarget::Linear {
            return Err(Error::FileOfLinear { path: out.to_owned() });
        }
        let file = out.file_name().map(|name| name.to_string_lossy().into_owned());
        let stem = model_name(out);
        let mut names = Names::of(&stem);
        if target.takes_name(&stem) {
            names.file = stem;
        }
        Ok(Place { folder: paths::folder_of(out), names, file, device: None })
    }

    /// The files, an FMU by the name that is stated.
    fn named(&self, mut files: Vec<ExportedFile>, to: ExportTarget) -> Vec<ExportedFile> {
        if let (Some(asked), ExportTarget::Fmu2 | ExportTarget::Fmu3, [fmu]) = (&self.file, to, &mut files[..]) {
            asked.clone_into(&mut fmu.name);
        }
        files
    }

    /// Refuses, before anything is written, names that the target cannot take, and files that must stay.
    fn check(&self, files: &[ExportedFile], target: ExportTarget, run: &Files) -> Result<(), Error> {
        if let (Some(asked), Some(first)) = (&self.file, files.first())
            && *asked != first.name
        {
            return Err(Error::NameInside { asked: asked.clone(), possible: first.name.clone() });
        }
        for file in files {
            let path = self.folder.join(&file.name);
            check_replaceable(&path, Mark::of_content(&file.content).as_ref(), run)?;
            if !run.overwrites() {
                self.check_version(file, target)?;
            }
        }
        Ok(())
    }

    /// Refuses to replace an FMU of another version of FMI, and sources of another version of dynoid that other models
    /// use.
    fn check_version(&self, file: &ExportedFile, to: ExportTarget) -> Result<(), Error> {
        let Some(path) = self.replaced_by(file) else { return Ok(()) };
        if to == ExportTarget::C && export::fmu::is_shared_source(&file.name) {
            return Err(Error::OtherSource { path });
        }
        let Some(wanted) = to.fmi_version() else { return Ok(()) };
        match std::fs::read(&path).ok().and_then(|bytes| export::fmu::version_of(&bytes)) {
            Some(found) if found != wanted => {
                Err(Error::OtherFmi { path, found: found.number(), wanted: wanted.number() })
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
