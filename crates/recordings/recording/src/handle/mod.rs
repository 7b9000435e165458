//! Recordings as handles: a file is opened once, then ranges and overviews of it are read.

mod levels;
mod pyramid;
mod span;
mod whole;

use std::collections::HashMap;
use std::fmt;
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};

use work::Context;

pub use pyramid::{Envelope, Pyramid};
pub use span::Span;
use whole::Whole;

use crate::kind::Kind;
use crate::part::Opened;
use crate::{Catalogue, Recording, RecordingError, Selection, Source, arrow, csv, finding, mdf};

/// An open recording, of which ranges and overviews are read. Clones are of the same recording, and any thread may have
/// one.
///
/// | format | read of a range |
/// | --- | --- |
/// | MDF | its records, and of compressed data the blocks with them |
/// | MDF whose groups are mixed | the first range goes through the file once, later ones read only their part |
/// | Parquet | the clocks whole, once, and of channels the pages with its rows |
/// | Arrow | the clocks whole, once, and of channels its rows, of compressed batches all of them |
/// | CSV | its rows, after a first pass over the text that notes where each 256th row is |
/// | HDF5 | the clocks whole, once, and of arrays with samples along the first dimension its rows or chunks |
/// | MAT-files | the selected channels whole, which are kept for later ranges, up to 256 MB |
///
/// Arrays of MAT-files are compressed as a whole up to level 5. At level 7.3 the samples of vectors lie along the
/// second dimension, and the reader of HDF5 takes parts along the first one alone.
#[derive(Clone)]
pub struct Handle {
    inner: Arc<Inner>,
}

struct Inner {
    /// The file's name as the user knows it.
    name: String,
    opened: Arc<dyn Opened>,
    /// The overviews that were made, by channel.
    pyramids: Mutex<HashMap<String, pyramid::Kept>>,
}

/// Opens a recording: recognises its format, and reads the structure of MDF, Parquet and Arrow. `name` and
/// `row_distance_s` are those of [`crate::decode_from`].
///
/// # Errors
///
/// As [`crate::decode_from`], as far as they concern the structure.
///
/// # Example
///
/// ```
/// use recording::{Selection, Span};
/// use work::Context;
///
/// let text = b"time [s],speed [rpm]\n0,1200\n1,1201\n2,1202\n".to_vec();
/// let handle = recording::open("run.csv", std::sync::Arc::new(text), None, &Context::new())?;
/// let span = Span::Time { from_s: 0.5, to_s: 1.5 };
/// let part = handle.read(&Selection::names(["speed"]), &span, &Context::new())?;
/// assert_eq!((&part.rasters[0].time_s[..], &part.channels[0].samples[..]), (&[1.0][..], &[1201.0][..]));
/// # Ok::<(), recording::RecordingError>(())
/// ```
pub fn open(
    name: &str,
    source: Arc<dyn Source>,
    row_distance_s: Option<f64>,
    _context: &Context,
) -> Result<Handle, RecordingError> {
    if let Some(given) = row_distance_s.filter(|given| !(given.is_finite() && *given > 0.0)) {
        return Err(RecordingError::RowDistance { given: given.to_string() });
    }
    let opened: Arc<dyn Opened> = match Kind::detect(name, &*source)? {
        Kind::Mdf => Arc::new(mdf::Opened::new(name, &source, row_distance_s)?),
        Kind::Table(kind) => arrow::open(name, source, kind, row_distance_s)?,
        Kind::Csv => Arc::new(csv::Indexed::new(name, source, row_distance_s)),
        Kind::Mat => Arc::new(Whole::new(name, source, row_distance_s)),
    };
    Ok(Handle { inner: Arc::new(Inner { name: name.to_owned(), opened, pyramids: Mutex::default() }) })
}

impl Handle {
    /// Lists the channels, as [`crate::catalogue_from`] does.
    ///
    /// # Errors
    ///
    /// As [`crate::catalogue_from`].
    pub fn catalogue(&self) -> Result<Catalogue, RecordingError> {
        let mut catalogue = self.inner.opened.catalogue()?;
        catalogue.note_duplicates();
        Ok(catalogue)
    }

    /// Reads a span of the selected channels. Values and time stamps are those that the same rows have in the whole
    /// recording. Findings are those of the whole; of integers that were rounded, those of the channels in which the
    /// span has some.
    ///
    /// # Errors
    ///
    /// As [`crate::decode_from`].
    pub fn read(&self, selection: &Selection, span: &Span, context: &Context) -> Result<Recording, RecordingError> {
        if *span == Span::All {
            return self.inner.opened.decode(selection, context).map(with_duplicates);
        }
        let part = self.inner.opened.part(selection, context)?;
        let clocks = part.clocks()?;
        let rows = clocks.iter().enumerate().map(|(clock, shape)| {
            let stamps = |rows: Range<u64>| part.stamps(clock, rows, &Context::new());
            span.rows(shape, &stamps)
        });
        let rows = rows.collect::<Result<Vec<_>, _>>()?;
        part.read(&rows, context).map(with_duplicates)
    }

    /// Makes an overview of a channel, or gives the one that was made before; of several channels of this name, of the
    /// first.
    ///
    /// # Errors
    ///
    /// As [`crate::decode_from`].
    pub fn pyramid(&self, channel: &str, context: &Context) -> Result<Pyramid, RecordingError> {
        let mut pyramids = self.pyramids(&[channel], context)?;
        pyramids.pop().ok_or_else(|| RecordingError::NoSuchChannel {
            file: self.inner.name.clone(),
            channel: channel.into(),
            similar: Vec::new(),
        })
    }

    /// Makes overviews of channels in one pass over the file; those that were made before are not made again.
    ///
    /// # Errors
    ///
    /// As [`crate::decode_from`].
    pub fn pyramids(&self, channels: &[&str], context: &Context) -> Result<Vec<Pyramid>, RecordingError> {
        let kept = || self.inner.pyramids.lock().unwrap_or_else(PoisonError::into_inner);
        let missing: Vec<&str> = channels.iter().filter(|name| !kept().contains_key(**name)).copied().collect();
        if !missing.is_empty() {
            let selection = Selection::names(missing);
            let made = pyramid::make(&*self.inner.opened.part(&selection, context)?, context)?;
            kept().extend(made);
        }
        let all = kept();
        let pyramid = |name: &&str| Some(Pyramid::new(self.inner.opened.clone(), name, all.get(*name)?.clone()));
        Ok(channels.iter().filter_map(pyramid).collect())
    }
}

fn with_duplicates(mut recording: Recording) -> Recording {
    let names = recording.channels.iter().map(|c| c.name.as_str());
    let doubles = finding::duplicate_names(names);
    recording.findings.extend(doubles);
    recording
}

impl fmt::Debug for Handle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Handle").field("name", &self.inner.name).finish_non_exhaustive()
    }
}
