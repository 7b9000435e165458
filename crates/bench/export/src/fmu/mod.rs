//! A bench model or a linear model as an FMU: FMI 2.0 or 3.0, Co-Simulation and Model Exchange, for Linux, Windows and
//! macOS.
//!
//! An FMU is a ZIP archive. It has the model description, the runtime as binaries and as sources, the numbers of the
//! model as a resource, a page of documentation, and files about the model in `extra`. The runtimes are in
//! `crates/bench/export/runtime`: one for benches and one for linear models. Each is the same for every model, so that
//! nothing is compiled here.

mod archive;
mod csv;
mod description;
mod documentation;
mod extra;
mod fmi2;
mod fmi3;
mod linear;
mod numbers;
mod platforms;
mod reference;
mod resource;
mod sources;
mod ssp;
mod unpack;
mod variables;

use bench_model::document::BenchModelDocument;

use crate::names::Names;
use crate::{ExportError, ExportedFile};
use archive::Archive;
use description::Description;
pub use linear::{c_files as linear_c_files, fmu as linear_fmu};
use numbers::BenchNumbers;
pub use numbers::DRAWS;
pub use platforms::FmiVersion;
use platforms::Runtime;
pub use ssp::ssp;

const DESCRIPTION: &str = "modelDescription.xml";

/// The FMU of a bench model, `NAME_fmi2.fmu` or `NAME_fmi3.fmu`. `report` is the report of its study, a page of HTML,
/// which goes along in `extra`. The same model gives the same bytes.
///
/// # Errors
/// [`ExportError::Delay`] for a delay that the runtime cannot hold, [`ExportError::NoDraws`] for a covariance that
/// hardly any bench fits, [`ExportError::Simulation`] where the reference trajectory cannot be made.
pub fn fmu(
    document: &BenchModelDocument,
    names: &Names,
    version: FmiVersion,
    report: Option<&[u8]>,
) -> Result<ExportedFile, ExportError> {
    let numbers = BenchNumbers::of(document)?;
    let description = Description::of(document, &numbers);
    let xml = match version {
        FmiVersion::V2 => fmi2::xml(&description),
        FmiVersion::V3 => fmi3::xml(&description),
    };
    let content = Content {
        xml,
        documentation: documentation::page(&description),
        resource: ("bench.txt", resource::text(&numbers, &description.token)),
        extra: extra::files(document, &numbers, report)?,
    };
    Ok(packed(names, version, Runtime::Bench, &content))
}

/// Tells whether the bytes are those of an FMU, or of another ZIP archive.
#[must_use]
pub fn is_archive(bytes: &[u8]) -> bool {
    unpack::is_archive(bytes)
}

/// The text of the model file that an FMU of dynoid holds: of a bench model or of a linear model. `None` for any other
/// file.
#[must_use]
pub fn model_in(bytes: &[u8]) -> Option<String> {
    let path = format!("extra/{}/{}", extra::FOLDER, extra::MODEL);
    String::from_utf8(unpack::content(bytes, &path)?).ok()
}

/// The version of FMI that the bytes of an FMU are of; `None` where they are no FMU of these versions.
#[must_use]
pub fn version_of(bytes: &[u8]) -> Option<FmiVersion> {
    let description = String::from_utf8(unpack::content(bytes, DESCRIPTION)?).ok()?;
    let is_of = |version: &FmiVersion| description.contains(&format!("fmiVersion=\"{}\"", version.number()));
    [FmiVersion::V2, FmiVersion::V3].into_iter().find(is_of)
}

/// Tells whether a file of this name is a source that all programs in C share, whatever their model.
#[must_use]
pub fn is_shared_source(name: &str) -> bool {
    sources::is_shared(name)
}

/// Parts that differ from FMU to FMU.
struct Content {
    xml: String,
    documentation: String,
    /// Name and text.
    resource: (&'static str, String),
    /// By their paths below `extra`.
    extra: Vec<(String, Vec<u8>)>,
}

/// An FMU with binaries, sources and icon.
fn packed(names: &Names, version: FmiVersion, runtime: Runtime, content: &Content) -> ExportedFile {
    let mut archive = Archive::default();
    // As it is: the first bytes of the archive name the program that wrote it.
    archive.store(DESCRIPTION, content.xml.as_bytes());
    let icon: &[u8] = include_bytes!("icon.png");
    match version {
        FmiVersion::V2 => archive.add("model.png", icon),
        FmiVersion::V3 => {
            archive.add("terminalsAndIcons/icon.png", icon);
            archive.add("terminalsAndIcons/terminalsAndIcons.xml", fmi3::icons(runtime).as_bytes());
            archive.add("sources/buildDescription.xml", fmi3::build_description(runtime).as_bytes());
        }
    }
    archive.add("documentation/index.html", content.documentation.as_bytes());
    archive.add(&format!("resources/{}", content.resource.0), content.resource.1.as_bytes());
    platforms::add_to(&mut archive, version, runtime);
    for (name, text) in sources::all(runtime) {
        archive.add(&format!("sources/{name}"), text.as_bytes());
    }
    for (name, bytes) in &content.extra {
        archive.add(&format!("extra/{name}"), bytes);
    }
    ExportedFile { name: format!("{}{}.fmu", names.file, version.suffix()), content: archive.into_bytes() }
}

/// The runtime without FMI, for programs in C: the numbers of the model as a header `NAME.h`, sources, and an example.
///
/// # Errors
/// [`ExportError::Delay`] for a delay that the runtime cannot hold.
pub fn c_files(document: &BenchModelDocument, names: &Names) -> Result<Vec<ExportedFile>, ExportError> {
    let numbers = BenchNumbers::without_draws(document)?;
    Ok(sources::for_c(document, &numbers, names))
}
