//! MDF: from what the crate `mdf` reads to a recording or a catalogue, and back ([`write`]).

mod failure;
mod plan;
mod write;

use ::mdf::{Attachment, Event, Mdf, Source};
use work::Context;

use crate::part::Part;
use crate::source::Shared;
use crate::{Catalogue, Format, Recording, RecordingError, Selection};
use failure::failure;
use plan::Choice;
pub(crate) use plan::some_text;
pub use write::{encode_mdf4, write_mdf4};

/// Contents of a file beside its channels.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Extras {
    /// Files carried with the measurement, or referred to.
    pub attachments: Vec<Attachment>,
    /// Events during the measurement.
    pub events: Vec<Event>,
}

/// Returns true if the first bytes are those of an MDF file.
pub(crate) fn is_mdf(bytes: &[u8]) -> bool {
    bytes.starts_with(b"MDF     ") || bytes.starts_with(b"UnFinMF ")
}

/// A file whose structure is read.
pub(crate) struct Opened {
    name: String,
    file: Mdf<Shared>,
    row_distance_s: Option<f64>,
}

impl Opened {
    pub(crate) fn new(name: &str, source: &Shared, row_distance_s: Option<f64>) -> Result<Self, RecordingError> {
        let file = Mdf::open(source.clone()).map_err(|e| failure(name, e))?;
        Ok(Self { name: name.to_owned(), file, row_distance_s })
    }

    fn choice<'s>(&'s self, selection: &Selection) -> Result<Choice<'s>, RecordingError> {
        Choice::new(&self.name, &self.file, selection, self.row_distance_s)
    }
}

impl crate::part::Opened for Opened {
    fn catalogue(&self) -> Result<Catalogue, RecordingError> {
        let groups = plan::groups(&self.name, &self.file, self.row_distance_s)?;
        let (rasters, channels, findings) = plan::list(&self.name, &self.file, &groups)?;
        Ok(Catalogue {
            format: Format::Mdf { version: self.file.version() },
            comment: self.file.comment().map(str::to_owned),
            start_time: plan::start_time(&self.file),
            rasters,
            channels,
            findings: plan::with_findings(&self.file, findings),
        })
    }

    fn decode(&self, selection: &Selection, context: &Context) -> Result<Recording, RecordingError> {
        self.choice(selection)?.whole(context)
    }

    fn part<'s>(&'s self, selection: &'s Selection, _: &Context) -> Result<Box<dyn Part + 's>, RecordingError> {
        Ok(Box::new(self.choice(selection)?))
    }
}

/// Attachments and events.
pub(crate) fn extras<S: Source>(name: &str, source: S) -> Result<Extras, RecordingError> {
    let file = Mdf::open(source).map_err(|e| failure(name, e))?;
    Ok(Extras { attachments: file.attachments().to_vec(), events: file.events().to_vec() })
}
