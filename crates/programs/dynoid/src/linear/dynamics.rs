//! Dynamics of a model: frequency response, step response, poles and zeros in one.

use std::path::{Path, PathBuf};

use ident::IdentError;
use serde::Serialize;
use toolbox_report::models::{CurveFacts, ModelRootsFacts, RegionFacts, bode, poles, step};

use super::models::models_in;
use crate::error::Error;
use crate::files::Files;

/// Dynamics of a model in numbers.
#[derive(Debug, Clone, Serialize)]
pub struct DynamicsFacts {
    bode: Vec<CurveFacts>,
    step: Vec<CurveFacts>,
    roots: Vec<ModelRootsFacts>,
    /// Outlines of the regions that hold a root with this confidence.
    regions: Vec<RegionFacts>,
}

/// The dynamics of the model in a file, with intervals of this confidence.
///
/// # Errors
/// A file that cannot be read or holds no model, and dynamics that cannot be computed.
pub fn dynamics(path: &Path, level: f64, files: &Files) -> Result<DynamicsFacts, Error> {
    let paths: [PathBuf; 1] = [path.to_owned()];
    let models = || models_in(&paths, false, files);
    let failed = |source: IdentError| Error::identify("the response", source);
    let roots = poles(models()?, level).map_err(failed)?;
    Ok(DynamicsFacts {
        bode: bode(models()?, level).map_err(failed)?.facts(),
        step: step(models()?, level).map_err(failed)?.facts(),
        regions: roots.regions(),
        roots: roots.facts(),
    })
}
