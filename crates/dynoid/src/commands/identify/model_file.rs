//! Model files, and the recordings that models meet.

use std::path::Path;

use ident::{Intersample, ModelDocument};

use super::data::{Loaded, load};
use crate::cli::identify::{Between, DataArguments, MeetArguments};
use crate::error::CliError;
use crate::input::read_text;
use crate::terminal::Terminal;

/// Reads a model file.
pub(super) fn read(path: &Path) -> Result<ModelDocument, CliError> {
    let wrong = |reason: String| CliError::ModelFile { path: path.to_owned(), reason };
    let document: ModelDocument = serde_json::from_str(&read_text(path)?).map_err(|error| wrong(error.to_string()))?;
    document.checked().map_err(|error| wrong(error.to_string()))
}

/// What a model is called: the name of its file.
pub(super) fn name(path: &Path) -> String {
    path.file_stem().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

/// The model's channels out of recordings, on the model's clock.
pub(super) fn meet(
    document: &ModelDocument,
    arguments: &MeetArguments,
    terminal: &mut Terminal,
) -> Result<Loaded, CliError> {
    let names = |labels: &[ident::Label]| labels.iter().map(|label| label.name.clone()).collect();
    let data = DataArguments {
        recordings: arguments.on.clone(),
        inputs: names(&document.inputs),
        outputs: names(&document.outputs),
        from_s: arguments.from_s,
        to_s: arguments.to_s,
        sample_time_s: Some(document.sample_time_s),
        detrend: arguments.detrend,
        between: match document.intersample {
            Intersample::ZeroOrderHold => Between::Held,
            Intersample::FirstOrderHold => Between::Straight,
            Intersample::BandLimited => Between::BandLimited,
        },
    };
    load(&data, terminal)
}

/// A number of one to the right of the point, such as a confidence.
pub(super) fn checked_share(option: &str, share: f64) -> Result<f64, CliError> {
    if share > 0.0 && share < 1.0 {
        return Ok(share);
    }
    Err(CliError::Usage { what: format!("{option} {share}: give a share between 0 and 1") })
}
