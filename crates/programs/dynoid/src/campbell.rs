//! Campbell maps of a recording: its lines over the speed.

use std::path::Path;

use part_lines::lines::{find_lines, on_one_mains, over_speed};
use report::lines::MapFacts;
use study::experiment_of;
use work::Context;

pub use part_lines::lines::folded_hz;

use crate::bench::Bench;
use crate::error::Error;
use crate::files::Files;
use crate::recordings::{NOTHING_USABLE, worst};

/// The maps of the signals of a recording; none where its speed does not change.
///
/// # Errors
/// A bench file or a recording that cannot be read.
pub fn campbell(bench: &Path, recording: &Path, files: &Files, context: &Context) -> Result<Vec<MapFacts>, Error> {
    let bench = Bench::load(bench, files)?.into_file();
    let mut looks = Vec::new();
    for input in files.named(&[recording.to_owned()])? {
        let source = files.read_source(&input, &bench, &context.step(format!("reading {}", input.name), 0))?;
        let unusable = |reasons: Vec<rig::Diagnostic>| Error::NoneReadable {
            reasons: vec![worst(&reasons).unwrap_or_else(|| NOTHING_USABLE.to_owned())],
        };
        let (experiment, _) = experiment_of(&bench, &source).map_err(unusable)?;
        looks.push(find_lines(&experiment, &bench));
    }
    Ok(over_speed(&on_one_mains(looks)).iter().map(MapFacts::of).collect())
}
