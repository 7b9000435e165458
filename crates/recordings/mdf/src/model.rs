//! Contents of a file, as plain data.

use std::fmt;
use std::sync::Arc;

use crate::conversion::Conversion;
use crate::field::Field;

/// When a measurement started, as stored in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StartTime {
    /// Nanoseconds since 1970-01-01 00:00, in UTC or, where `is_local`, on the clock of the recording computer.
    pub nanoseconds: i64,
    /// The count is on the local clock.
    pub is_local: bool,
    /// Minutes by which the local clock was ahead of UTC, daylight saving included, where the file says so.
    pub utc_offset_min: Option<i32>,
}

/// A channel group: channels recorded together, on one clock.
#[derive(Debug, Clone)]
pub struct Group {
    /// The name of the acquisition; empty where the file gives none.
    pub name: Arc<str>,
    /// Its comment; empty where the file gives none.
    pub comment: Arc<str>,
    /// Records as the file announces them.
    pub announced: u64,
    /// Records that its data can hold; `None` if only reading can count them (see [`crate::Mdf::count`]).
    pub found: Option<u64>,
    /// Records that its data could hold at most.
    pub at_most: u64,
    /// Bytes of the data this group is stored in, after decompression, with that of the groups stored between.
    pub stream_bytes: u64,
    /// The clock, or what else the group runs over.
    pub master: Option<Master>,
    /// Its channels in the order of the file; elements of structures follow the structure, elements of arrays take the
    /// place of the array.
    pub channels: Vec<Channel>,
    pub(crate) records: Records,
}

/// Master channel that a group runs over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Master {
    /// The channel, in this group or another one.
    pub address: Address,
    /// Quantity that it counts.
    pub quantity: Quantity,
}

/// Quantity that a master channel counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Time in s.
    Time,
    /// Angle in rad.
    Angle,
    /// Distance in m.
    Distance,
    /// Index of the record.
    Index,
}

/// Where a channel is: indices into [`crate::Mdf::groups`] and [`Group::channels`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Address {
    /// The group.
    pub group: usize,
    /// The channel in the group.
    pub channel: usize,
}

/// A channel.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Its name; an element of an array carries its place, as in `map[1][0]`.
    pub name: Arc<str>,
    /// Its unit; empty where the file gives none.
    pub unit: Arc<str>,
    /// Its comment; empty where the file gives none.
    pub comment: Arc<str>,
    /// True if it is the master of its group.
    pub is_master: bool,
    /// True if it is an element of an array.
    pub is_element: bool,
    /// Kind of its samples.
    pub kind: Kind,
    /// Why it cannot be read, if it cannot.
    pub obstacle: Option<Obstacle>,
    pub(crate) storage: Storage,
    pub(crate) conversion: Arc<Conversion>,
    /// Bit of the invalidation bytes.
    pub(crate) invalid_bit: Option<u32>,
    pub(crate) all_invalid: bool,
}

/// Kind of the samples of a channel, conversion applied.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Numbers.
    Number,
    /// Text.
    Text,
    /// Bytes whose meaning the file does not state.
    Bytes,
}

/// Why a channel cannot be read.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Obstacle {
    /// It reaches beyond the record.
    OutsideRecord,
    /// A data type, or a number of bits, that the format does not define.
    DataType {
        /// Code of the data type.
        code: u16,
        /// Number of bits.
        bits: u32,
    },
    /// A channel type that the format does not define.
    ChannelType {
        /// Its code.
        code: u16,
    },
    /// An array whose elements are stored apart, or are too many.
    Array,
    /// A conversion that is not understood.
    Conversion {
        /// Part of the conversion that is not understood.
        detail: String,
    },
    /// Values of varying length whose data are missing.
    NoData,
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OutsideRecord => f.write_str("it reaches beyond the record"),
            Self::DataType { code, bits } => write!(f, "data type {code} of {bits} bits is not known"),
            Self::ChannelType { code } => write!(f, "channel type {code} is not known"),
            Self::Array => f.write_str("the elements of the array are stored apart, or are too many"),
            Self::Conversion { detail } => write!(f, "its conversion is not understood: {detail}"),
            Self::NoData => f.write_str("its values of varying length are missing"),
        }
    }
}

/// Where the raw samples of a channel are.
#[derive(Debug, Clone)]
pub(crate) enum Storage {
    /// A number in the record.
    Number(Field),
    /// Text or bytes of fixed length in the record.
    Bytes { byte: usize, width: usize, encoding: Option<Encoding> },
    /// Text or bytes in the record, of a length held by another number of it.
    Sized { byte: usize, width: usize, size: Field, encoding: Option<Encoding> },
    /// Values of varying length, elsewhere; the number in the record is their place there.
    Elsewhere { place: Field, values: Place, encoding: Option<Encoding> },
    /// The index of the record.
    Index,
    /// Cannot be read.
    None,
}

/// Where values of varying length are.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Place {
    /// A stream of its own: index into the streams.
    Stream(usize),
    /// Records of a group between the others, by its record identifier.
    Records(u64),
}

/// How text is encoded.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Latin1,
    Utf8,
    Utf16Le,
    Utf16Be,
}

/// How the records of a group are stored.
#[derive(Debug, Clone, Default)]
pub(crate) struct Records {
    /// Index into the data.
    pub data: usize,
    /// Identifier before each record, as a number.
    pub id: u64,
    /// Bytes of samples in a record.
    pub data_bytes: usize,
    /// Bytes of invalidation bits that follow the samples.
    pub invalid_bytes: usize,
    /// The invalidation bits are in a stream of their own.
    pub is_invalid_apart: bool,
    /// A record is a value of varying length.
    pub is_varying: bool,
}

impl Records {
    /// Bytes of a record in its stream, without identifiers.
    pub(crate) fn record_bytes(&self) -> usize {
        let trailing = if self.is_invalid_apart { 0 } else { self.invalid_bytes };
        self.data_bytes.saturating_add(trailing)
    }
}

/// A file carried with the measurement.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Attachment {
    /// Its name.
    pub file_name: Arc<str>,
    /// Its MIME type.
    pub mime_type: Arc<str>,
    /// Its comment.
    pub comment: Arc<str>,
    /// Bytes embedded in the measurement file; 0 where it is only referred to.
    pub embedded_bytes: u64,
}

/// Something that happened during the measurement: a marker, a trigger, a recording period.
#[derive(Debug, Clone, PartialEq)]
pub struct Event {
    /// Its name.
    pub name: Arc<str>,
    /// Its comment.
    pub comment: Arc<str>,
    /// Code of its type: 0 recording, 1 recording interrupt, 2 acquisition interrupt, 3 start trigger, 4 stop trigger,
    /// 5 trigger, 6 marker.
    pub kind: u8,
    /// Quantity that `at` is counted in.
    pub quantity: Option<Quantity>,
    /// When, in the unit of its quantity.
    pub at: f64,
}

/// Something to know about a file that could be opened.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Finding {
    /// The program that recorded the file did not close it.
    NotFinalised,
    /// Data that the file refers to lie beyond its end.
    CutOff {
        /// Where the missing part begins.
        offset: u64,
    },
    /// A list of data names a block that is none, as in a file that was not closed.
    ListEndsEarly {
        /// Where the block should be.
        offset: u64,
    },
}
