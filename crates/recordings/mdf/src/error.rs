//! Why a file cannot be read.

use thiserror::Error;

use crate::Obstacle;

/// Why a file, or a channel of it, cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MdfError {
    /// The source fails.
    #[error("{length} bytes at byte {offset} cannot be read: {detail}")]
    Io {
        /// Where it was read.
        offset: u64,
        /// How much.
        length: u64,
        /// Message of the system.
        detail: String,
    },
    /// No MDF file.
    #[error("not an MDF file: it starts with \"{start}\"")]
    NotMdf {
        /// Its first bytes.
        start: String,
    },
    /// A version that is not known.
    #[error("MDF version {version} is not supported")]
    UnsupportedVersion {
        /// The version as stored.
        version: String,
    },
    /// The file ends too early.
    #[error("the file ends too early: {expected} bytes are needed at byte {offset}, {available} are there")]
    Truncated {
        /// Where the missing part begins.
        offset: u64,
        /// Bytes that should be there.
        expected: u64,
        /// Bytes that are there.
        available: u64,
    },
    /// The structure contradicts itself.
    #[error("damaged at byte {offset}: {detail}")]
    Damaged {
        /// Where.
        offset: u64,
        /// Description of the damage.
        detail: String,
    },
    /// The file uses a feature that cannot be read.
    #[error("{feature} at byte {offset} cannot be read")]
    Unsupported {
        /// Where.
        offset: u64,
        /// The feature.
        feature: String,
    },
    /// More was asked for than fits in memory.
    #[error("{numbers} numbers do not fit in memory")]
    TooLarge {
        /// How many.
        numbers: u64,
    },
    /// A channel that is not in the file was asked for.
    #[error("group {group} has no channel {channel}")]
    NoSuchChannel {
        /// Index of the group.
        group: usize,
        /// Index of the channel in it.
        channel: usize,
    },
    /// A channel that cannot be read was asked for.
    #[error("channel \"{name}\" cannot be read: {obstacle}")]
    Unreadable {
        /// Its name.
        name: String,
        /// Why.
        obstacle: Obstacle,
    },
}

pub(crate) fn damaged(offset: u64, detail: impl Into<String>) -> MdfError {
    MdfError::Damaged { offset, detail: detail.into() }
}
