//! Recordings cut where samples are missing.

use ident::{Channel, Dataset, IdentError};

use super::loaded::{Loaded, named};
use super::note::Note;
use crate::error::Error;

/// Stretches between gaps that are shorter than this, in samples, are left out: they add hardly more than their own
/// initial states need.
const SHORTEST: usize = 20;

/// Where data have to be without gaps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Gaps {
    /// In the inputs.
    OfInputs,
    /// In every channel.
    OfAll,
}

impl Loaded {
    /// The same data cut at gaps, each stretch an experiment with an initial state of its own. What was done is in the
    /// last of the notes.
    ///
    /// # Errors
    /// Data of which nothing is left.
    pub fn cut_at(self, gaps: Gaps) -> Result<Loaded, Error> {
        if !has(&self.data, gaps) {
            return Ok(self);
        }
        let mut whole: Option<Dataset> = None;
        let (mut recording, mut notes) = (Vec::new(), self.notes.clone());
        for (index, of) in self.recording.iter().enumerate() {
            let one = self.data.only_experiments(&[index]);
            let one = one.map_err(|source| Error::identify("cutting at gaps", source))?;
            let parts = if has(&one, gaps) { cut(&one, gaps) } else { Ok(one.clone()) };
            notes.extend(note(&one, parts.as_ref().ok(), gaps));
            let Ok(parts) = parts else { continue };
            recording.extend(vec![*of; parts.experiments().len()]);
            let merged = whole.map_or(Ok(parts.clone()), |before| before.merge(&parts));
            whole = Some(merged.map_err(|source| Error::identify("cutting at gaps", source))?);
        }
        let data = whole.ok_or_else(|| Error::OnlyGaps {
            data: named(&self.data, &self.sources),
            channels: missing_channels(&self.data, gaps).join(", "),
            shortest: SHORTEST,
        })?;
        Loaded { data, recording, notes, ..self }.without_unused()
    }
}

fn cut(data: &Dataset, gaps: Gaps) -> Result<Dataset, IdentError> {
    match gaps {
        Gaps::OfInputs => data.without_input_gaps(SHORTEST),
        Gaps::OfAll => data.without_gaps(SHORTEST),
    }
}

fn has(data: &Dataset, gaps: Gaps) -> bool {
    !missing_channels(data, gaps).is_empty()
}

/// Names of the channels that miss samples where none may be missing.
fn missing_channels(data: &Dataset, gaps: Gaps) -> Vec<String> {
    let inputs = data.input_labels().iter().enumerate().map(|(k, label)| (Channel::Input(k), label));
    let outputs = data.output_labels().iter().enumerate().map(|(i, label)| (Channel::Output(i), label));
    let outputs = outputs.filter(|_| gaps == Gaps::OfAll);
    let misses = |channel: Channel| data.experiments().iter().any(|e| e.channel(channel).iter().any(|v| v.is_nan()));
    let missing = inputs.chain(outputs).filter(|(channel, _)| misses(*channel));
    missing.map(|(_, label)| format!("\"{}\"", label.name)).collect()
}

/// Note on the gaps of one recording; nothing where it has none.
fn note(before: &Dataset, parts: Option<&Dataset>, gaps: Gaps) -> Option<Note> {
    let channels = missing_channels(before, gaps);
    if channels.is_empty() {
        return None;
    }
    let name = &before.experiments().first()?.name;
    let channels = channels.join(", ");
    let Some(parts) = parts else {
        return Some(Note::Warning(format!(
            "{name} was left out: {channels} {} never there for {SHORTEST} samples on end",
            if channels.contains(", ") { "are" } else { "is" }
        )));
    };
    let (count, used, of) = (parts.experiments().len(), parts.samples(), before.samples());
    let stretches = match count {
        1 => "one stretch".to_owned(),
        _ => format!("{count} stretches, each with an initial state of its own"),
    };
    let text = format!("{name} was cut at the gaps of {channels} into {stretches}: {used} of {of} samples are used");
    Some(Note::Done(text))
}
