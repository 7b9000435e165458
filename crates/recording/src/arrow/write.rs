//! Writing Parquet and Arrow.

use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use arrow_array::{ArrayRef, Float64Array, RecordBatch};
use arrow_ipc::writer::FileWriter;
use arrow_schema::{DataType, Field, Schema};
use parquet::arrow::ArrowWriter;
use parquet::basic::Compression;
use parquet::file::properties::WriterProperties;

use super::{Written, key};
use crate::mat::start_text;
use crate::{Channel, Recording, RecordingError};

/// Numbers in a batch of Arrow.
const BATCH: usize = 1 << 20;
/// The name of the column of time stamps.
const TIME: &str = "time";

/// Encodes a recording as Parquet, compressed with Zstandard: one table, as data frames are kept.
///
/// The column `time` holds the time stamps of all rasters, s, merged in their order; each channel is a column of
/// doubles, null in the rows of other rasters' stamps (a missing sample is NaN, not null). Columns are named like their
/// channels, with a number appended where a name occurs again or is that of the clock. Metadata of the fields hold
/// `unit`, `comment`, the channel's own `name` and its `raster`, that of the file `comment`, `start_time` and `raster
/// N`, the name of a raster; [`crate::decode`] reads all of it back bit for bit. Of the findings, and of rasters
/// without channels, nothing is written.
///
/// # Errors
///
/// [`RecordingError::NoSuchRaster`] and [`RecordingError::LengthMismatch`] where the recording contradicts itself.
///
/// # Example
///
/// ```
/// let recording = recording::decode("run.csv", b"time [s],n [rpm]\n0,1200\n1,1210\n", &recording::Selection::All)?;
/// let bytes = recording::encode_parquet(&recording)?;
/// let read = recording::decode("run.parquet", &bytes, &recording::Selection::All)?;
/// assert_eq!((read.channels, read.rasters), (recording.channels, recording.rasters));
/// # Ok::<(), recording::RecordingError>(())
/// ```
pub fn encode_parquet(recording: &Recording) -> Result<Vec<u8>, RecordingError> {
    let (schema, batch) = table(recording).map_err(|error| error.into_error("Parquet"))?;
    let properties = WriterProperties::builder().set_compression(Compression::ZSTD(Default::default())).build();
    let write = || -> Result<Vec<u8>, parquet::errors::ParquetError> {
        let mut writer = ArrowWriter::try_new(Vec::new(), schema, Some(properties))?;
        writer.write(&batch)?;
        writer.into_inner()
    };
    write().map_err(|error| cannot("Parquet", error.to_string()))
}

/// Encodes a recording as a file of Arrow (Feather version 2), with the table of [`encode_parquet`].
///
/// # Errors
///
/// As [`encode_parquet`].
pub fn encode_arrow(recording: &Recording) -> Result<Vec<u8>, RecordingError> {
    let (schema, batch) = table(recording).map_err(|error| error.into_error("Arrow"))?;
    let write = || -> Result<Vec<u8>, arrow_schema::ArrowError> {
        let mut writer = FileWriter::try_new(Vec::new(), &schema)?;
        // A reader has one batch in memory.
        let rows = (BATCH / batch.num_columns().max(1)).max(1);
        for first in (0..batch.num_rows()).step_by(rows) {
            writer.write(&batch.slice(first, rows.min(batch.num_rows() - first)))?;
        }
        writer.into_inner()
    };
    write().map_err(|error| cannot("Arrow", error.to_string()))
}

fn cannot(format: &str, what: String) -> RecordingError {
    RecordingError::CannotExpress { format: format.into(), name: TIME.into(), what }
}

/// Why there is no table.
enum Fault {
    Recording(RecordingError),
    Arrow(arrow_schema::ArrowError),
}

impl Fault {
    fn into_error(self, format: &str) -> RecordingError {
        match self {
            Self::Recording(error) => error,
            Self::Arrow(error) => cannot(format, error.to_string()),
        }
    }
}

fn table(recording: &Recording) -> Result<Written, Fault> {
    recording.check().map_err(Fault::Recording)?;
    let used: HashSet<usize> = recording.channels.iter().map(|channel| channel.raster).collect();
    let merged = Merged::new(recording, &used);
    let field = |name: &str, metadata| Field::new(name, DataType::Float64, true).with_metadata(metadata);
    let mut names = HashSet::from([TIME.to_owned()]);
    let mut fields = vec![field(TIME, HashMap::from([(key::UNIT.into(), "s".into())]))];
    let mut columns: Vec<ArrayRef> = Vec::new();
    for channel in &recording.channels {
        let mut name = channel.name.clone();
        let mut number = 1;
        while !names.insert(name.clone()) {
            number += 1;
            name = format!("{}_{number}", channel.name);
        }
        fields.push(field(&name, metadata_of(channel)));
        columns.push(Arc::new(merged.column(channel)));
    }
    columns.insert(0, Arc::new(Float64Array::from(merged.time_s)));
    let schema = Arc::new(Schema::new_with_metadata(fields, metadata(recording)));
    let batch = RecordBatch::try_new(schema.clone(), columns).map_err(Fault::Arrow)?;
    Ok((schema, batch))
}

fn metadata_of(channel: &Channel) -> HashMap<String, String> {
    let texts = [(key::NAME, &channel.name), (key::UNIT, &channel.unit), (key::COMMENT, &channel.comment)];
    let raster = (key::RASTER.to_owned(), channel.raster.to_string());
    texts.into_iter().map(|(key, text)| (key.to_owned(), text.clone())).chain([raster]).collect()
}

fn metadata(recording: &Recording) -> HashMap<String, String> {
    let rasters = recording.rasters.iter().enumerate();
    let names = rasters.filter_map(|(index, raster)| Some((format!("raster {index}"), raster.name.clone()?)));
    let comment = recording.comment.clone().map(|comment| (key::COMMENT.to_owned(), comment));
    let start = recording.start_time.map(|start| (key::START_TIME.to_owned(), start_text(Some(start))));
    names.chain(comment).chain(start).collect()
}

/// The time stamps of all rasters in one column.
struct Merged {
    time_s: Vec<f64>,
    /// For each raster the rows of its stamps; `None` where these are all.
    rows: Vec<Option<Vec<usize>>>,
}

impl Merged {
    /// Takes the smallest of the rasters' next stamps, again and again; equal ones share a row. Each raster keeps its
    /// order, whatever its stamps.
    fn new(recording: &Recording, used: &HashSet<usize>) -> Self {
        let rasters: Vec<&[f64]> = recording.rasters.iter().map(|raster| raster.time_s.as_slice()).collect();
        if used.len() == 1 {
            let time_s = used.iter().next().map_or(Vec::new(), |&only| rasters[only].to_vec());
            return Self { time_s, rows: vec![None; rasters.len()] };
        }
        let mut rows: Vec<Vec<usize>> = vec![Vec::new(); rasters.len()];
        let mut time_s = Vec::new();
        loop {
            let next = |raster: &usize| rasters[*raster].get(rows[*raster].len()).copied();
            let Some(stamp) = used.iter().filter_map(next).min_by(f64::total_cmp) else { break };
            let due: Vec<usize> = used
                .iter()
                .copied()
                .filter(|raster| next(raster).is_some_and(|t| t.to_bits() == stamp.to_bits()))
                .collect();
            due.into_iter().for_each(|raster| rows[raster].push(time_s.len()));
            time_s.push(stamp);
        }
        Self { time_s, rows: rows.into_iter().map(Some).collect() }
    }

    /// The samples in the rows of their stamps, null elsewhere.
    fn column(&self, channel: &Channel) -> Float64Array {
        let Some(Some(rows)) = self.rows.get(channel.raster) else {
            return Float64Array::from(channel.samples.clone());
        };
        let mut column = vec![None; self.time_s.len()];
        for (&row, &sample) in rows.iter().zip(&channel.samples) {
            column[row] = Some(sample);
        }
        Float64Array::from(column)
    }
}
