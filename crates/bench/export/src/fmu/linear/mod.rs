//! A linear model as an FMU, or as a program in C. Both are the model on the clock of its data, which is what dynoid
//! simulates.

mod description;
mod extra;
mod fmi2;
mod fmi3;
mod model;
mod page;
mod program;

use ident::ModelDocument;

use super::description::token;
use super::platforms::Runtime;
use super::{Content, FmiVersion, packed};
use crate::names::Names;
use crate::{ExportError, ExportedFile};
use description::Description;
use model::LinearNumbers;

/// The FMU of a linear model, `NAME_fmi2.fmu` or `NAME_fmi3.fmu`; `version` is that of the program. The same model
/// gives the same bytes.
///
/// # Errors
/// [`ExportError::Model`] where the model has no state space, [`ExportError::TooLarge`] where the runtime cannot hold
/// it.
pub fn fmu(
    document: &ModelDocument,
    names: &Names,
    fmi: FmiVersion,
    version: &str,
) -> Result<ExportedFile, ExportError> {
    let numbers = LinearNumbers::of(document)?;
    let token = token(&numbers.resource("-"));
    let description = Description::of(document, &numbers, names, version, &token);
    let xml = match fmi {
        FmiVersion::V2 => fmi2::xml(&description),
        FmiVersion::V3 => fmi3::xml(&description),
    };
    let content = Content {
        xml,
        documentation: page::page(&description),
        resource: ("linear.txt", numbers.resource(&token)),
        extra: extra::files(document, &description)?,
    };
    Ok(packed(names, fmi, Runtime::Linear, &content))
}

/// A linear model for programs in C: its matrices as a header `NAME.h`, sources, and an example.
///
/// # Errors
/// [`ExportError::Model`] where the model has no state space.
pub fn c_files(document: &ModelDocument, names: &Names, version: &str) -> Result<Vec<ExportedFile>, ExportError> {
    program::files(document, names, version)
}
