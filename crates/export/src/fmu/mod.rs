//! A bench model as an FMU: FMI 2.0 or 3.0, Co-Simulation and Model Exchange, for Linux, Windows and macOS.
//!
//! An FMU is a ZIP archive. It has the model description, the runtime as binaries and as sources, the numbers of the model as a
//! resource, a page of documentation, and files about the model in `extra`. The runtime is in `crates/export/runtime`; it is the same
//! for every model, so that nothing is compiled here.

mod archive;
mod csv;
mod description;
mod documentation;
mod extra;
mod fmi2;
mod fmi3;
mod numbers;
mod platforms;
mod reference;
mod resource;
mod sources;
mod variables;

use bench_model::document::BenchModelDocument;

use crate::names::Names;
use crate::{ExportError, ExportedFile};
use archive::Archive;
use description::Description;
use numbers::BenchNumbers;
pub use numbers::DRAWS;
pub use platforms::FmiVersion;

/// The FMU of a bench model, `NAME.fmu`. `report` is the report of its study, a page of HTML, which goes along in `extra`. The same model gives
/// the same bytes.
///
/// # Errors
/// [`ExportError::Delay`] for a delay that the runtime cannot hold, [`ExportError::NoDraws`] for a covariance that hardly any bench fits,
/// [`ExportError::Simulation`] where the reference trajectory cannot be made.
pub fn fmu(
    document: &BenchModelDocument,
    names: &Names,
    version: FmiVersion,
    report: Option<&[u8]>,
) -> Result<ExportedFile, ExportError> {
    let numbers = BenchNumbers::of(document)?;
    let description = Description::of(document, &numbers);
    let mut archive = Archive::default();
    let (xml, icon) = match version {
        FmiVersion::V2 => (fmi2::xml(&description), "model.png"),
        FmiVersion::V3 => (fmi3::xml(&description), "terminalsAndIcons/icon.png"),
    };
    // As it is: the first bytes of the archive name the program that wrote it.
    archive.store("modelDescription.xml", xml.as_bytes());
    archive.add(icon, include_bytes!("icon.png"));
    if version == FmiVersion::V3 {
        archive.add("terminalsAndIcons/terminalsAndIcons.xml", fmi3::icons().as_bytes());
        archive.add("sources/buildDescription.xml", fmi3::build_description().as_bytes());
    }
    archive.add("documentation/index.html", documentation::page(&description).as_bytes());
    archive.add("resources/bench.txt", resource::text(&numbers, &description.token).as_bytes());
    platforms::add_to(&mut archive, version);
    for (name, text) in sources::runtime() {
        archive.add(&format!("sources/{name}"), text.as_bytes());
    }
    for (name, content) in extra::files(document, &numbers, report)? {
        archive.add(&format!("extra/{name}"), &content);
    }
    Ok(ExportedFile { name: format!("{}.fmu", names.file), content: archive.into_bytes() })
}

/// The runtime without FMI, for programs in C: the numbers of the model as a header `NAME.h`, sources, and an example.
///
/// # Errors
/// [`ExportError::Delay`] for a delay that the runtime cannot hold.
pub fn c_files(document: &BenchModelDocument, names: &Names) -> Result<Vec<ExportedFile>, ExportError> {
    let numbers = BenchNumbers::without_draws(document)?;
    Ok(sources::for_c(document, &numbers, names))
}
