//! Recordings as they were written or simulated.

use page::{Axis, Block, Figure, Layer, Page, Panel, Style};
use recording::{Extras, Recording};
use rig::ExperimentLabel;
use virtual_bench::Assumption;

use crate::assumptions::assumptions;

/// Most channels drawn of one recording: more cannot be looked at.
const MOST_CHANNELS: usize = 24;

/// A recording of a virtual bench.
pub fn simulated(label: &ExperimentLabel, recording: &Recording, assumed: &[Assumption]) -> Page {
    let figures = figures(&label.to_string(), recording).into_iter().map(Block::figure);
    Page::new(format!("{label}, simulated"), assumptions(assumed).chain(figures).collect())
}

/// The channels of a recording over time, a figure for each raster.
pub fn figures(title: &str, recording: &Recording) -> Vec<Figure> {
    let shown = &recording.channels[..recording.channels.len().min(MOST_CHANNELS)];
    let count = recording.rasters.iter().filter(|raster| !raster.time_s.is_empty()).count();
    let mut all = Vec::new();
    for (number, raster) in recording.rasters.iter().enumerate() {
        let channels = shown.iter().filter(|channel| channel.raster == number);
        let panel = |channel: &recording::Channel| {
            // Alone in its panel, which bears its name, it needs no place in the legend.
            let layer = Layer::curve("", Style::Measured, &raster.time_s, &channel.samples);
            Panel::new(Axis::linear(&channel.name, &channel.unit), 110, vec![layer])
        };
        let panels: Vec<Panel> = channels.map(panel).collect();
        if !panels.is_empty() {
            let name = raster.name.as_ref().filter(|_| count > 1).map_or(String::new(), |name| format!(", {name}"));
            let figure =
                Figure::new(&format!("{title}{name}"), Axis::time(), panels).with_plain_text().of_recording(title);
            let left_out = left_out(recording).filter(|_| all.is_empty());
            all.push(left_out.into_iter().fold(figure, Figure::with_caption));
        }
    }
    all
}

/// How many channels are left out of the picture, in words.
fn left_out(recording: &Recording) -> Option<String> {
    let count = recording.channels.len();
    (count > MOST_CHANNELS).then(|| format!("the picture shows the first {MOST_CHANNELS} of {count} channels"))
}

/// Parts of a file that are not written.
pub fn not_carried_over(extras: &Extras) -> Option<String> {
    let count = |count: usize, what: &str| match count {
        0 => None,
        1 => Some(format!("1 {what}")),
        _ => Some(format!("{count} {what}s")),
    };
    let lost: Vec<String> = [count(extras.attachments.len(), "attachment"), count(extras.events.len(), "event")]
        .into_iter()
        .flatten()
        .collect();
    (!lost.is_empty()).then(|| format!("{} of the file are not carried over (see dynoid inspect)", lost.join(" and ")))
}
