//! Writing MDF 4.10: a data group with one channel group for each raster, deflated.

use std::io::{Cursor, Result as Io, Seek, SeekFrom, Write};
use std::ops::Range;

use libdeflater::{CompressionLvl, Compressor};

use crate::source::unwritable;
use crate::{Channel, PROGRAM, Raster, Recording, RecordingError, StartTime};

/// Samples are stored as f64.
const SAMPLE: usize = 8;
/// Bytes of records in one compressed block.
const CHUNK: usize = 1 << 22;
/// Below this, compression does not pay.
const SMALL: usize = 1 << 10;

/// A recording as [`write_mdf4`] writes it, in memory.
///
/// # Errors
///
/// As [`write_mdf4`].
pub fn encode_mdf4(recording: &Recording) -> Result<Vec<u8>, RecordingError> {
    let mut out = Cursor::new(Vec::new());
    write_mdf4(recording, PROGRAM, &mut out).map(|()| out.into_inner())
}

/// Writes a recording as MDF 4.10 to `out`, which is empty. The change history names the `program` that made it.
///
/// Each raster becomes a channel group with its time stamps as master channel `time` in seconds; samples are stored as
/// f64, so that what is read back equals what was written bit for bit. Of the findings nothing is written, and NaN is
/// written as NaN.
///
/// # Errors
///
/// [`RecordingError::NoSuchRaster`] and [`RecordingError::LengthMismatch`] where the recording contradicts itself,
/// [`RecordingError::CannotExpress`] for a raster of more channels than a record can hold, and for text with a NUL,
/// [`RecordingError::Unwritable`] where `out` fails.
pub fn write_mdf4(recording: &Recording, program: &str, out: impl Write + Seek) -> Result<(), RecordingError> {
    let mut out = Out::begin(out).map_err(|e| unwritable(&e))?;
    let history = out.history(program).map_err(|e| unwritable(&e))?;
    let comment = match &recording.comment {
        Some(comment) => out.text("the file", comment)?,
        None => 0,
    };
    let mut next = 0;
    for index in (0..recording.rasters.len()).rev() {
        next = out.raster(recording, index, next)?;
    }
    check_rasters(recording)?;
    out.head(next, history, comment, recording.start_time).map_err(|e| unwritable(&e))
}

fn check_rasters(recording: &Recording) -> Result<(), RecordingError> {
    let rasters = recording.rasters.len();
    let stray = recording.channels.iter().find(|c| c.raster >= rasters);
    stray.map_or(Ok(()), |c| Err(RecordingError::NoSuchRaster { channel: c.name.clone(), raster: c.raster, rasters }))
}

struct Out<W> {
    out: W,
    /// Bytes that are written.
    length: u64,
}

impl<W: Write + Seek> Out<W> {
    /// The identification block and room for the header.
    fn begin(out: W) -> Io<Self> {
        let mut bytes = b"MDF     4.10    dynoid  ".to_vec();
        bytes.extend_from_slice(&[0; 4]);
        bytes.extend_from_slice(&410_u16.to_le_bytes());
        bytes.resize(64 + 104, 0);
        let mut begun = Self { out, length: 0 };
        begun.append(&bytes)?;
        Ok(begun)
    }

    fn append(&mut self, bytes: &[u8]) -> Io<()> {
        self.length += bytes.len() as u64;
        self.out.write_all(bytes)
    }

    /// Appends a block and returns its offset.
    fn block(&mut self, id: &[u8; 4], links: &[u64], data: &[u8]) -> Io<u64> {
        let gap = self.length.next_multiple_of(8) - self.length;
        self.append(&[0; 8][..gap as usize])?;
        let offset = self.length;
        self.append(&block(id, links, data))?;
        Ok(offset)
    }

    fn head(&mut self, groups: u64, history: u64, comment: u64, start: Option<StartTime>) -> Io<()> {
        let mut data = [0; 32];
        if let Some(start) = start {
            let offset = start.utc_offset_min.and_then(|m| i16::try_from(m).ok());
            data[..8].copy_from_slice(&start.nanoseconds.to_le_bytes());
            data[8..10].copy_from_slice(&offset.unwrap_or(0).to_le_bytes());
            data[12] = u8::from(start.is_local) | (u8::from(offset.is_some()) << 1);
        }
        let head = block(b"##HD", &[groups, history, 0, 0, 0, comment], &data);
        self.out.seek(SeekFrom::Start(64))?;
        self.out.write_all(&head)?;
        self.out.flush()
    }

    /// The change history, which the format requires.
    fn history(&mut self, program: &str) -> Io<u64> {
        let program = program.replace('&', "&amp;").replace('<', "&lt;");
        let xml = format!(
            "<FHcomment xmlns='http://www.asam.net/mdf/v4'><TX>written by {program}</TX><tool_id>dynoid</tool_id>\
             <tool_vendor>dynoid</tool_vendor><tool_version>{}</tool_version></FHcomment>\0",
            env!("CARGO_PKG_VERSION"),
        );
        let comment = self.block(b"##MD", &[], &padded(xml.as_bytes()))?;
        self.block(b"##FH", &[0, comment], &[0; 16])
    }

    fn text(&mut self, owner: &str, text: &str) -> Result<u64, RecordingError> {
        if text.contains('\0') {
            return Err(cannot(owner, "a NUL in the text"));
        }
        if text.is_empty() {
            return Ok(0);
        }
        let mut data = text.as_bytes().to_vec();
        data.push(0);
        self.block(b"##TX", &[], &padded(&data)).map_err(|e| unwritable(&e))
    }

    /// A raster with its channels and records; `next` is the data group that follows.
    fn raster(&mut self, recording: &Recording, index: usize, next: u64) -> Result<u64, RecordingError> {
        let raster = &recording.rasters[index];
        let channels: Vec<_> = recording.channels.iter().filter(|c| c.raster == index).collect();
        check_lengths(raster, &channels)?;
        let name = raster.name.as_deref().unwrap_or_default();
        let record = (channels.len() + 1) * SAMPLE;
        let record_bytes = u32::try_from(record).map_err(|_| cannot(name, "the number of channels"))?;

        let mut chain = 0;
        for (place, channel) in channels.iter().enumerate().rev() {
            chain = self.channel(channel, (place + 1) * SAMPLE, chain)?;
        }
        let time = Column { name: "time", unit: "s", comment: "", place: 0, is_time: true };
        let first = self.column(&time, chain)?;
        let name = self.text(name, name)?;
        let mut data = [0; 32];
        data[8..16].copy_from_slice(&(raster.time_s.len() as u64).to_le_bytes());
        data[24..28].copy_from_slice(&record_bytes.to_le_bytes());
        let group = self.block(b"##CG", &[0, first, name, 0, 0, 0], &data);
        let records = |group| Ok((group, self.records(raster, &channels, record)?));
        let (group, records) = group.and_then(records).map_err(|e| unwritable(&e))?;
        self.block(b"##DG", &[next, group, records, 0], &[0; 8]).map_err(|e| unwritable(&e))
    }

    fn channel(&mut self, channel: &Channel, place: usize, next: u64) -> Result<u64, RecordingError> {
        let column =
            Column { name: &channel.name, unit: &channel.unit, comment: &channel.comment, place, is_time: false };
        self.column(&column, next)
    }

    fn column(&mut self, column: &Column<'_>, next: u64) -> Result<u64, RecordingError> {
        let name = self.text(column.name, column.name)?;
        let unit = self.text(column.name, column.unit)?;
        let comment = self.text(column.name, column.comment)?;
        let place = u32::try_from(column.place).map_err(|_| cannot(column.name, "the place"))?;
        let mut data = [0; 72];
        // Type 2 and synchronisation 1 are a time master; data type 4 is a little-endian float.
        data[..3].copy_from_slice(if column.is_time { &[2, 1, 4] } else { &[0, 0, 4] });
        data[4..8].copy_from_slice(&place.to_le_bytes());
        data[8..12].copy_from_slice(&64_u32.to_le_bytes());
        self.block(b"##CN", &[next, 0, name, 0, 0, 0, unit, comment], &data).map_err(|e| unwritable(&e))
    }

    fn records(&mut self, raster: &Raster, channels: &[&Channel], record: usize) -> Io<u64> {
        let count = raster.time_s.len();
        if count == 0 {
            return Ok(0);
        }
        if count * record < SMALL {
            return self.block(b"##DT", &[], &records(raster, channels, 0..count));
        }
        let rows = (CHUNK / record).max(1);
        let chunk = rows * record;
        let mut links = vec![0];
        for first in (0..count).step_by(rows) {
            let part = deflated(&records(raster, channels, first..count.min(first + rows)), record);
            links.push(self.block(b"##DZ", &[], &part)?);
        }
        let mut data = [0; 16];
        data[0] = 1;
        // There are at most as many chunks as samples in memory; the count is 32 bits wide by definition of the format.
        data[4..8].copy_from_slice(&u32::try_from(links.len() - 1).unwrap_or(u32::MAX).to_le_bytes());
        data[8..16].copy_from_slice(&(chunk as u64).to_le_bytes());
        let list = self.block(b"##DL", &links, &data)?;
        self.block(b"##HL", &[list], &[1, 0, 1, 0, 0, 0, 0, 0])
    }
}

struct Column<'a> {
    name: &'a str,
    unit: &'a str,
    comment: &'a str,
    place: usize,
    is_time: bool,
}

fn cannot(name: &str, what: &str) -> RecordingError {
    RecordingError::CannotExpress { format: "MDF 4.10".into(), name: name.into(), what: what.into() }
}

fn check_lengths(raster: &Raster, channels: &[&Channel]) -> Result<(), RecordingError> {
    let times = raster.time_s.len();
    let wrong = channels.iter().find(|c| c.samples.len() != times);
    wrong.map_or(Ok(()), |c| {
        Err(RecordingError::LengthMismatch { channel: c.name.clone(), samples: c.samples.len(), times })
    })
}

fn block(id: &[u8; 4], links: &[u64], data: &[u8]) -> Vec<u8> {
    let length = 24 + links.len() * 8 + data.len();
    let mut block = Vec::with_capacity(length);
    block.extend_from_slice(id);
    block.extend_from_slice(&[0; 4]);
    block.extend_from_slice(&(length as u64).to_le_bytes());
    block.extend_from_slice(&(links.len() as u64).to_le_bytes());
    links.iter().for_each(|link| block.extend_from_slice(&link.to_le_bytes()));
    block.extend_from_slice(data);
    block
}

fn padded(data: &[u8]) -> Vec<u8> {
    let mut padded = data.to_vec();
    padded.resize(data.len().next_multiple_of(8), 0);
    padded
}

/// Records of a raster: time stamp, then the channels.
fn records(raster: &Raster, channels: &[&Channel], rows: Range<usize>) -> Vec<u8> {
    let mut records = Vec::with_capacity(rows.len() * (channels.len() + 1) * SAMPLE);
    for i in rows {
        records.extend_from_slice(&raster.time_s[i].to_le_bytes());
        for channel in channels {
            records.extend_from_slice(&channel.samples[i].to_le_bytes());
        }
    }
    records
}

/// A DZ block's data: the transposed records, deflated.
fn deflated(records: &[u8], record: usize) -> Vec<u8> {
    let rows = records.len() / record;
    let mut columns = Vec::with_capacity(records.len());
    for byte in 0..record {
        columns.extend((0..rows).map(|row| records[row * record + byte]));
    }
    let mut compressor = Compressor::new(CompressionLvl::default());
    let mut packed = vec![0; compressor.zlib_compress_bound(columns.len())];
    // The room is enough for whatever is packed.
    let length = compressor.zlib_compress(&columns, &mut packed).unwrap_or_default();
    packed.truncate(length);
    let mut data = Vec::with_capacity(packed.len() + 24);
    data.extend_from_slice(b"DT\x01\0");
    // The record size fits: the channel group holds it in the same width.
    data.extend_from_slice(&u32::try_from(record).unwrap_or(u32::MAX).to_le_bytes());
    data.extend_from_slice(&(records.len() as u64).to_le_bytes());
    data.extend_from_slice(&(packed.len() as u64).to_le_bytes());
    data.extend_from_slice(&packed);
    data
}
