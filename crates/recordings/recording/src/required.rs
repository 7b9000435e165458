//! Channels that were asked for have to be there.

use crate::{RecordingError, Selection, names};

/// Fails where a channel that was asked for is not among `present`.
pub(crate) fn require_names<'a>(
    file: &str,
    selection: &Selection,
    present: impl Iterator<Item = &'a str> + Clone,
) -> Result<(), RecordingError> {
    match selection.missing(present.clone()) {
        None => Ok(()),
        Some(name) => Err(RecordingError::NoSuchChannel {
            file: file.into(),
            channel: name.to_owned(),
            similar: similar(name, present),
        }),
    }
}

/// The name that differs in letter case only, or else the closest.
fn similar<'a>(name: &str, present: impl Iterator<Item = &'a str>) -> Vec<String> {
    let closest = names::closest(name, present, 3);
    match closest.first() {
        Some(best) if best.to_lowercase() == name.to_lowercase() => vec![best.clone()],
        _ => closest,
    }
}
