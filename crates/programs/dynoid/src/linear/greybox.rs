//! Structures of grey-box models: matrices of formulas.

use std::path::Path;

use ident::{FormulaStructure, GreyNoise, Structure};

use super::fit::FitNeeds;
use super::gaps::Gaps;
use crate::error::Error;
use crate::files::Files;

/// Reads the structure of a grey-box model from TOML.
///
/// # Errors
/// A file that cannot be read, or holds no structure.
pub fn structure(path: &Path, files: &Files) -> Result<FormulaStructure, Error> {
    let wrong = |error: toml::de::Error| Error::StructureFile {
        path: path.to_owned(),
        reason: error.to_string().trim_end().to_owned(),
    };
    toml::from_str(&files.read_text(path, "a structure in TOML as `dynoid fit greybox --help` shows it")?)
        .map_err(wrong)
}

impl FitNeeds {
    /// Of a structure: one with white noise on its outputs alone simulates, any other predicts.
    pub fn of_structure(structure: &FormulaStructure) -> Self {
        let values: Vec<f64> = structure.parameters().iter().map(|p| p.value).collect();
        let is_output_error = matches!(structure.noise(&values), GreyNoise::OutputError);
        FitNeeds { sees_through: is_output_error, gaps: Gaps::OfInputs }
    }
}
