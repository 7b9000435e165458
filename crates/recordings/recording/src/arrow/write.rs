//! Writing Parquet and Arrow.

use std::collections::{BTreeSet, HashMap, HashSet};
use std::io::{Error, Write};
use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::{Array, ArrayRef, Float64Array, RecordBatch};
use arrow_ipc::writer::FileWriter;
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use parquet::arrow::{ArrowSchemaConverter, add_encoded_arrow_schema_to_metadata};
use parquet::basic::Compression;
use parquet::data_type::DoubleType;
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedFileWriter, SerializedRowGroupWriter};

use super::key;
use crate::mat::start_text;
use crate::source::unwritable;
use crate::{Channel, PROGRAM, Recording, RecordingError};

/// Numbers in a batch, which is a row group of Parquet, that its writer keeps in memory once more.
const BATCH: usize = 1 << 20;
/// Bytes of different values beyond which a column is not written by their numbers.
const DIFFERENT: usize = 1 << 14;
/// The name of the column of time stamps.
const TIME: &str = "time";

/// Writes a recording as Parquet, compressed with Zstandard: one table, as data frames are kept. The file names the
/// `program` that made it.
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
/// [`RecordingError::NoSuchRaster`] and [`RecordingError::LengthMismatch`] where the recording contradicts itself,
/// [`RecordingError::Unwritable`] where `out` fails.
///
/// # Example
///
/// ```
/// let recording = recording::decode("run.csv", b"time [s],n [rpm]\n0,1200\n1,1210\n", &recording::Selection::All)?;
/// let mut bytes = Vec::new();
/// recording::write_parquet(&recording, "the program", &mut bytes)?;
/// let read = recording::decode("run.parquet", &bytes, &recording::Selection::All)?;
/// assert_eq!((read.channels, read.rasters), (recording.channels, recording.rasters));
/// # Ok::<(), recording::RecordingError>(())
/// ```
pub fn write_parquet(recording: &Recording, program: &str, out: impl Write + Send) -> Result<(), RecordingError> {
    let batches = Batches::new(recording)?;
    let mut properties = WriterProperties::builder()
        .set_created_by(program.to_owned())
        .set_compression(Compression::ZSTD(Default::default()))
        .set_dictionary_page_size_limit(DIFFERENT)
        .build();
    let write = || -> Result<(), ParquetError> {
        let schema = ArrowSchemaConverter::new().convert(&batches.schema)?;
        add_encoded_arrow_schema_to_metadata(&batches.schema, &mut properties);
        let mut writer = SerializedFileWriter::new(out, schema.root_schema_ptr(), Arc::new(properties))?;
        for batch in batches {
            let mut group = writer.next_row_group()?;
            // One column after the other: what is being written keeps buffers, whatever its rows.
            for column in batch?.columns() {
                write_column(&mut group, column.as_primitive())?;
            }
            group.close()?;
        }
        writer.close().map(drop)
    };
    write().map_err(|error| match error {
        ParquetError::External(error) => match error.downcast_ref::<Error>() {
            Some(error) => unwritable(error),
            None => cannot("Parquet", error.to_string()),
        },
        error => cannot("Parquet", error.to_string()),
    })
}

/// A recording as [`write_parquet`] writes it, in memory.
///
/// # Errors
///
/// As [`write_parquet`].
pub fn encode_parquet(recording: &Recording) -> Result<Vec<u8>, RecordingError> {
    let mut bytes = Vec::new();
    write_parquet(recording, PROGRAM, &mut bytes).map(|()| bytes)
}

/// Writes a recording as a file of Arrow (Feather version 2), with the table of [`write_parquet`].
///
/// # Errors
///
/// As [`write_parquet`].
pub fn write_arrow(recording: &Recording, out: impl Write) -> Result<(), RecordingError> {
    let batches = Batches::new(recording)?;
    let write = || -> Result<(), ArrowError> {
        let mut writer = FileWriter::try_new(out, &batches.schema)?;
        // A reader may have to have a batch in memory.
        for batch in batches {
            writer.write(&batch?)?;
        }
        writer.finish()
    };
    write().map_err(|error| match error {
        ArrowError::IoError(_, error) => unwritable(&error),
        error => cannot("Arrow", error.to_string()),
    })
}

/// A recording as [`write_arrow`] writes it, in memory.
///
/// # Errors
///
/// As [`write_parquet`].
pub fn encode_arrow(recording: &Recording) -> Result<Vec<u8>, RecordingError> {
    let mut bytes = Vec::new();
    write_arrow(recording, &mut bytes).map(|()| bytes)
}

/// Writes the next column of a row group.
fn write_column<W: Write + Send>(
    group: &mut SerializedRowGroupWriter<'_, W>,
    column: &Float64Array,
) -> Result<(), ParquetError> {
    let is_there: Vec<i16> = (0..column.len()).map(|row| i16::from(column.is_valid(row))).collect();
    let values: Vec<f64> = column.iter().flatten().collect();
    let mut writer = group.next_column()?.ok_or_else(|| ParquetError::General("too few columns".into()))?;
    writer.typed::<DoubleType>().write_batch(&values, Some(&is_there), None)?;
    writer.close()
}

fn cannot(format: &str, what: String) -> RecordingError {
    RecordingError::CannotExpress { format: format.into(), name: TIME.into(), what }
}

/// The columns: the time stamps and each channel.
fn schema(recording: &Recording) -> SchemaRef {
    let field = |name: &str, metadata| Field::new(name, DataType::Float64, true).with_metadata(metadata);
    let mut names = HashSet::from([TIME.to_owned()]);
    let mut fields = vec![field(TIME, HashMap::from([(key::UNIT.into(), "s".into())]))];
    for channel in &recording.channels {
        let mut name = channel.name.clone();
        let mut number = 1;
        while !names.insert(name.clone()) {
            number += 1;
            name = format!("{}_{number}", channel.name);
        }
        fields.push(field(&name, metadata_of(channel)));
    }
    Arc::new(Schema::new_with_metadata(fields, metadata(recording)))
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

/// The table, some rows at a time: the time stamps of all rasters merged, the smallest of the rasters' next ones again
/// and again. Equal ones share a row. Each raster keeps its order, whatever its stamps.
struct Batches<'r> {
    recording: &'r Recording,
    schema: SchemaRef,
    /// Rows of a batch.
    rows: usize,
    /// The rasters that have channels.
    used: Vec<usize>,
    /// For each raster the stamps that are written.
    done: Vec<usize>,
}

/// The rows of a batch.
struct Merged {
    time_s: Vec<f64>,
    /// For each raster the rows of its stamps.
    rows: Vec<Vec<usize>>,
}

impl<'r> Batches<'r> {
    fn new(recording: &'r Recording) -> Result<Self, RecordingError> {
        recording.check()?;
        let used: BTreeSet<usize> = recording.channels.iter().map(|channel| channel.raster).collect();
        let rows = (BATCH / (recording.channels.len() + 1)).max(1);
        let (used, done) = (used.into_iter().collect(), vec![0; recording.rasters.len()]);
        Ok(Self { recording, schema: schema(recording), rows, used, done })
    }

    fn merged(&self) -> Merged {
        let mut rows: Vec<Vec<usize>> = vec![Vec::new(); self.done.len()];
        let mut time_s = Vec::new();
        while time_s.len() < self.rows {
            let next = |raster: usize, rows: &[Vec<usize>]| {
                self.recording.rasters[raster].time_s.get(self.done[raster] + rows[raster].len()).copied()
            };
            let due = self.used.iter().filter_map(|&raster| next(raster, &rows)).min_by(f64::total_cmp);
            let Some(stamp) = due else { break };
            for &raster in &self.used {
                if next(raster, &rows).is_some_and(|t| t.to_bits() == stamp.to_bits()) {
                    rows[raster].push(time_s.len());
                }
            }
            time_s.push(stamp);
        }
        Merged { time_s, rows }
    }

    /// The samples in the rows of their stamps, null elsewhere.
    fn column(&self, channel: &Channel, merged: &Merged) -> Float64Array {
        let (first, rows) = (self.done[channel.raster], &merged.rows[channel.raster]);
        let samples = &channel.samples[first..first + rows.len()];
        if rows.len() == merged.time_s.len() {
            return Float64Array::from(samples.to_vec());
        }
        let mut column = vec![None; merged.time_s.len()];
        rows.iter().zip(samples).for_each(|(&row, &sample)| column[row] = Some(sample));
        Float64Array::from(column)
    }
}

impl Iterator for Batches<'_> {
    type Item = Result<RecordBatch, ArrowError>;

    fn next(&mut self) -> Option<Self::Item> {
        let merged = self.merged();
        if merged.time_s.is_empty() {
            return None;
        }
        let channels = self.recording.channels.iter();
        let mut columns: Vec<ArrayRef> = channels.map(|c| Arc::new(self.column(c, &merged)) as ArrayRef).collect();
        self.done.iter_mut().zip(&merged.rows).for_each(|(done, rows)| *done += rows.len());
        columns.insert(0, Arc::new(Float64Array::from(merged.time_s)));
        Some(RecordBatch::try_new(self.schema.clone(), columns))
    }
}
