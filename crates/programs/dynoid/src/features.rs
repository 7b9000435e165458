//! Formats that a build may leave out.

use std::path::Path;

use crate::error::Error;

/// A feature of the build.
pub(crate) struct Feature {
    name: &'static str,
    is_on: bool,
}

/// PDF, and figures drawn to pixels.
pub(crate) const PDF: Feature = Feature { name: "pdf", is_on: cfg!(feature = "pdf") };
/// Parquet and Arrow.
pub(crate) const PARQUET: Feature = Feature { name: "parquet", is_on: cfg!(feature = "parquet") };

impl Feature {
    /// Fails where this build lacks the feature, and so cannot write a file of this format.
    pub(crate) fn check(&self, path: &Path, format: &'static str) -> Result<(), Error> {
        match self.is_on {
            true => Ok(()),
            false => Err(Error::LeftOut { path: path.to_owned(), format, feature: self.name }),
        }
    }
}
