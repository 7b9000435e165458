//! Failures of the reader in our terms.

use ::mdf::MdfError;

use crate::{RecordingError, SkipReason};

/// A failure of the reader in our terms.
pub(super) fn failure(file: &str, error: MdfError) -> RecordingError {
    let file = file.to_owned();
    match error {
        MdfError::Io { offset, detail, .. } => RecordingError::Unreadable { file, offset, detail },
        MdfError::NotMdf { start } => RecordingError::UnknownFormat { file, start },
        MdfError::UnsupportedVersion { version } => RecordingError::UnsupportedVersion { file, version },
        MdfError::Truncated { offset, expected, available } => {
            RecordingError::Truncated { file, offset, expected, available }
        }
        MdfError::Damaged { offset, detail } => RecordingError::Damaged { file, offset: Some(offset), detail },
        MdfError::TooLarge { numbers } => RecordingError::TooLarge { file, what: format!("{numbers} numbers") },
        MdfError::Unsupported { feature, .. } => RecordingError::Unsupported { file, feature },
        MdfError::Unreadable { name, obstacle } => RecordingError::UnusableChannel {
            file,
            channel: name,
            reason: SkipReason::Unsupported { detail: obstacle.to_string() },
        },
        other => RecordingError::Damaged { file, offset: None, detail: other.to_string() },
    }
}
