//! Contents of the blocks of a file, before any sample is read.

use std::sync::{Arc, OnceLock};

use crate::stream::Stream;
use crate::{Attachment, Event, Finding, Group, MdfError, StartTime};

/// Contents of the blocks of a file.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    pub(crate) start_time: Option<StartTime>,
    pub(crate) comment: Option<Arc<str>>,
    pub(crate) groups: Vec<Group>,
    pub(crate) attachments: Vec<Attachment>,
    pub(crate) events: Vec<Event>,
    pub(crate) findings: Vec<Finding>,
    pub(crate) data: Vec<Data>,
    /// Streams of values of varying length.
    pub(crate) signals: Vec<Stream>,
    /// The file was not closed by the program that recorded it.
    pub(crate) is_open: bool,
}

/// Records of one group or several.
#[derive(Debug, Default)]
pub(crate) struct Data {
    pub(crate) stream: Stream,
    /// Invalidation bytes that are stored apart from the records.
    pub(crate) invalid: Option<Stream>,
    /// Bytes of the identifier before each record.
    pub(crate) id_bytes: usize,
    /// Bytes of the identifier after each record.
    pub(crate) trailing: usize,
    /// Records of several groups follow each other in any order.
    pub(crate) is_mixed: bool,
    /// Indices of the groups.
    pub(crate) groups: Vec<usize>,
    /// Where the records of its groups are, once they were counted.
    pub(crate) index: OnceLock<Result<Index, MdfError>>,
}

/// Where the records of a stream are.
#[derive(Debug, Clone, Default)]
pub(crate) struct Index {
    /// Records of each member.
    pub counts: Vec<u64>,
    /// Places from the first to the last.
    pub marks: Vec<Mark>,
}

/// A place of a stream where a record begins.
#[derive(Debug, Clone)]
pub(crate) struct Mark {
    pub place: u64,
    /// Records of each member before it.
    pub rows: Vec<u64>,
}
