//! Content of recordings: channels, units, clocks, gaps.

use dataset::inspection::{File, Listing};
use recording::Selection;
use rig::ExperimentLabel;
use work::Context;

use crate::error::Error;
use crate::files::Files;
use crate::find::InputFile;
use crate::read::Read;

impl Files {
    /// The content of a recording, of which only these channels are read.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn inspect(&self, file: &InputFile, channels: &Selection, context: &Context) -> Result<File, Error> {
        let step = context.step(format!("reading {}", file.name), 0);
        let Read { recording, .. } = self.read_recording(file, channels, None, &step)?;
        Ok(File::of(&file.name, label(&file.name), &recording, &self.extras(file)?))
    }

    /// The channels of a recording; without reading samples, if the format allows.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn list(&self, file: &InputFile) -> Result<Listing, Error> {
        Ok(Listing::of(&file.name, label(&file.name), &self.catalogue(file)?, &self.extras(file)?))
    }
}

/// The experiment's label in a file's name.
fn label(name: &str) -> Option<String> {
    let file_name = name.rsplit(['/', '\\']).next().unwrap_or(name);
    file_name.parse().ok().map(|label: ExperimentLabel| label.to_string())
}
