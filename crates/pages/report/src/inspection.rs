//! Inventory of a recording, in words and tables.

use dataset::inspection::{Apart, Beside, Clock, File, ListedRaster, Listing, Values};
use page::{Align, Block, Blocks, Cell, Finding, Page, Prose, Table, Tone};
use rig::Finding as Found;

use crate::wording::{self, experiment, number};

/// Deviations of time stamps smaller than this share of the sample time are not worth a word.
const SMALL_JITTER: f64 = 0.01;
/// Shares of the samples at an extreme value smaller than this are not worth a word.
const SMALL_SHARE: f64 = 0.001;
/// Most events that are shown.
const MOST_EVENTS: usize = 20;

/// Names of channels and files are no symbols: they are shown as they are.
fn line(text: String) -> Block {
    Block::paragraph(Prose::verbatim(text))
}

fn remark(tone: Tone, what: &str, text: &str) -> Block {
    Block::Finding(Finding::new(tone, what, Prose::verbatim(text)))
}

fn name(text: &str) -> Cell {
    Prose::verbatim(text).into()
}

/// A recording that was read.
pub fn file(facts: &File) -> Page {
    let File { file, format, start, label, comment, extras, findings, .. } = facts;
    let mut all = head(&Head { file, format, start, label, comment, extras, findings });
    let rasters = facts.rasters.iter().enumerate().map(|(index, clock)| raster(index, clock));
    all.push(or_nothing(rasters.collect()));
    Page::new(file.as_str(), all.into_vec())
}

fn or_nothing(rasters: Blocks) -> Blocks {
    if rasters.is_empty() { line("It holds no numeric channel over time.".to_owned()).into() } else { rasters }
}

/// Listing of a recording, without its samples.
pub fn listing(listing: &Listing) -> Page {
    let Listing { file, format, start, label, comment, extras, findings, .. } = listing;
    let mut all = head(&Head { file, format, start, label, comment, extras, findings });
    let rasters = listing.rasters.iter().enumerate().map(|(index, raster)| listed(index, raster));
    all.push(or_nothing(rasters.collect()));
    Page::new(file.as_str(), all.into_vec())
}

fn listed(index: usize, raster: &ListedRaster) -> Blocks {
    let mut table = Table::new(&[("channel", Align::Left), ("unit", Align::Left), ("", Align::Left)]);
    for channel in &raster.channels {
        table.row([name(&channel.name), name(&channel.unit), name(&channel.comment)]);
    }
    let title = format!("raster {index}{}: {}", named(&raster.name), listed_samples(raster.samples));
    [line(title), Block::Table(table)].into_iter().collect()
}

/// Facts above the rasters.
struct Head<'a> {
    file: &'a str,
    format: &'a str,
    start: &'a Option<String>,
    label: &'a Option<String>,
    comment: &'a Option<String>,
    extras: &'a Beside,
    findings: &'a [String],
}

/// Description of the experiment that a label names.
fn described(label: &str) -> Option<&'static str> {
    experiment(&label.parse().ok()?)
}

fn head(facts: &Head<'_>) -> Blocks {
    let mut all = vec![Block::heading(Prose::verbatim(facts.file))];
    let start = facts.start.as_ref().map(|start| format!(", started {start}")).unwrap_or_default();
    all.push(line(format!("{}{start}", facts.format)));
    let label = match facts.label.as_deref().map(|label| (label, described(label))) {
        Some((label, Some(words))) => format!("{label}: {words}"),
        Some((label, None)) => label.to_owned(),
        None => "no label in the file name (such as BS_T_NT); the bench file can give one".to_owned(),
    };
    all.push(remark(Tone::Plain, "experiment", &label));
    if let Some(comment) = facts.comment.as_ref().filter(|comment| !comment.trim().is_empty()) {
        let comment = comment.split_whitespace().collect::<Vec<_>>().join(" ");
        all.push(remark(Tone::Plain, "comment", &comment));
    }
    for attached in &facts.extras.attachments {
        let place = if attached.embedded_bytes > 0 { "in the file" } else { "not in the file" };
        let kind = [attached.kind.as_str(), place].into_iter().filter(|text| !text.is_empty()).collect::<Vec<_>>();
        all.push(remark(Tone::Plain, "attachment", &format!("{} ({})", attached.name, kind.join(", "))));
    }
    for event in facts.extras.events.iter().take(MOST_EVENTS) {
        let texts = [event.name.as_str(), event.comment.as_str()].into_iter().filter(|text| !text.is_empty());
        let texts: String = texts.map(|text| format!(", {text}")).collect();
        let event = format!("{} at {} {}{texts}", event.kind, event.at, event.unit);
        all.push(remark(Tone::Plain, "event", &event));
    }
    if facts.extras.events.len() > MOST_EVENTS {
        all.push(line(format!("and {} more events (--json)", facts.extras.events.len() - MOST_EVENTS)));
    }
    all.extend(facts.findings.iter().map(|finding| remark(Tone::Caution, "please note", finding)));
    all.into()
}

/// A name in brackets, if there is one.
fn named(name: &Option<String>) -> String {
    name.as_ref().map(|name| format!(" ({name})")).unwrap_or_default()
}

/// How many samples a list knows of.
fn listed_samples(count: Option<usize>) -> String {
    count.map_or_else(|| "samples that only reading counts (leave out --list)".to_owned(), samples)
}

fn samples(count: usize) -> String {
    if count == 1 { "1 sample".to_owned() } else { format!("{count} samples") }
}

fn raster(index: usize, clock: &Clock) -> Blocks {
    let every = match clock.sample_time_s {
        Some(sample_time_s) => format!("every {}", number::duration(sample_time_s)),
        None => "without a clock".to_owned(),
    };
    let span = match (clock.from_s, clock.to_s) {
        (Some(from), Some(to)) => format!(", from {} to {}", number::time(from), number::time(to)),
        _ => String::new(),
    };
    let title = format!("raster {index}{}: {} {every}{span}", named(&clock.name), samples(clock.samples));
    let mut all = vec![line(title)];
    all.extend(clock_remarks(clock).iter().map(|text| remark(Tone::Caution, "please note", text)));
    use Align::{Left, Right};
    let mut table =
        Table::new(&[("channel", Left), ("unit", Left), ("min", Right), ("max", Right), ("mean", Right), ("", Left)]);
    for channel in &clock.channels {
        table.row([
            name(&channel.name),
            name(&channel.unit),
            value(channel.minimum).into(),
            value(channel.maximum).into(),
            value(channel.mean).into(),
            Cell::toned(remarks(channel).join(", "), Tone::Caution),
        ]);
    }
    all.push(Block::Table(table));
    all.into()
}

fn value(value: Option<f64>) -> String {
    value.map_or_else(|| "–".to_owned(), |value| number::significant_with_unit(value, 5, ""))
}

fn clock_remarks(clock: &Clock) -> Vec<String> {
    let mut remarks = Vec::new();
    if let Some(gap) = &clock.longest_gap {
        let (count, longest) =
            if clock.gaps == 1 { ("1 gap".to_owned(), "it") } else { (format!("{} gaps", clock.gaps), "the longest") };
        remarks.push(format!(
            "{count} in the time stamps, {} samples missing; {longest} lasts {} after {}",
            clock.missing_samples,
            number::duration(gap.duration_s),
            number::time(gap.at_s),
        ));
    }
    if clock.stamps_not_later_than_the_one_before > 0 {
        remarks.push(format!("{} time stamps go back or repeat", clock.stamps_not_later_than_the_one_before));
    }
    if clock.stamps_not_a_number > 0 {
        remarks.push(format!("{} time stamps are not a number", clock.stamps_not_a_number));
    }
    if let (Some(jitter_s), Some(sample_time_s)) = (clock.worst_jitter_s, clock.sample_time_s)
        && jitter_s > SMALL_JITTER * sample_time_s
    {
        remarks.push(format!("time stamps jitter by up to {}", number::duration(jitter_s)));
    }
    remarks.extend(clock.runs_apart.iter().map(apart));
    remarks
}

fn remarks(channel: &Values) -> Vec<String> {
    let mut remarks = Vec::new();
    if channel.is_constant {
        remarks.push("constant".to_owned());
    }
    if channel.not_a_number > 0 {
        remarks.push(format!("{} not a number", channel.not_a_number));
    }
    for (share, extreme) in [(channel.share_at_minimum, "minimum"), (channel.share_at_maximum, "maximum")] {
        if share > SMALL_SHARE {
            remarks.push(format!("{} at its {extreme}", number::share(share)));
        }
    }
    match channel.spikes {
        0 => {}
        1 => remarks.push("1 spike".to_owned()),
        spikes => remarks.push(format!("{spikes} spikes")),
    }
    remarks
}

/// That a clock runs apart, and what to do.
fn apart(found: &Apart) -> String {
    let [own, other] = &found.shown_by;
    let against = format!("raster {} (seen in {own} and {other})", found.raster);
    let &Apart { rate, standard_error, apart_s, .. } = found;
    let finding = Found::ClockDrift { against, rate, standard_error, apart_s };
    format!("{} {}", wording::finding(&finding), wording::advice(&finding))
}
