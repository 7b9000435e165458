//! The samples of lines that are drawn with fewer points, packed into the page. Its script shows them where a figure is
//! zoomed, and writes them to CSV files.
//!
//! A packed figure is a header and bytes: of each group of lines on one clock the places of its samples, then the
//! values of each line. A column of numbers is differences of whole numbers, in planes of bytes, deflated.
//! `assets/samples.js` reads it.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use libdeflater::{CompressionLvl, Compressor};
use serde::Serialize;

use crate::figure::{Abscissa, Axis, Figure, Layer, Rounded, Scale, Style};
use crate::thinned::{HELD_SAMPLES, Place, groups, line, recorded, thin};

/// How samples are stored so that there is room for them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Storage {
    /// Largest number of samples of a line, where no model is compared.
    most: usize,
    /// Steps of a line's values from its lowest to its highest.
    levels: f64,
}

/// How many times the samples of another figure one has that shows what a model leaves over.
const COMPARED: usize = 3;
/// Share of the characters of samples that coarser values need, about.
const SHARE_OF_COARSE: f64 = 0.8;
/// Characters of a sample at the very least, to see early that too many are too many.
const LEAST_CHARACTERS: f64 = 0.4;
/// Steps of a line's values from its lowest to its highest: 14 bits, or 12 where the page has less room.
const FINE: f64 = 16_380.0;
const COARSE: f64 = 4_092.0;
/// Of deflating, from 1 to 12.
const LEVEL: i32 = 9;
/// Steps of places that are on no clock.
const PLACES: f64 = 16_777_214.0;

/// Lines of one clock.
#[derive(Debug, Serialize)]
struct Group {
    /// Panel and layer of each line.
    lines: Vec<Place>,
    /// Samples of each.
    count: usize,
    /// Samples that were recorded.
    of: usize,
    /// First place and distance of samples, for those on a clock.
    clock: Option<[f64; 2]>,
    /// True if the number of each sample on the clock is written.
    numbered: bool,
    /// How the places were made whole numbers, for those on no clock.
    places: Option<Code>,
    /// How the values of each line were.
    values: Vec<Code>,
}

/// How numbers are whole numbers: `low + step·(n − 1)`, and `n = 0` where there is none; `order` differences of them.
/// Where `log` is set the numbers are decimal logarithms.
#[derive(Debug, Clone, Copy, Serialize)]
struct Code {
    low: f64,
    step: f64,
    order: usize,
    log: bool,
}

/// Header and bytes as text.
pub(super) struct Packed {
    pub(super) header: String,
    pub(super) text: String,
}

/// Lines with more points are packed: each is a smaller part of the page then.
pub(super) const UNPACKED: usize = 120;

impl Storage {
    /// That with which the samples of all figures have room in so many characters. First values become coarser, and
    /// then samples are left out, down to the number that is `drawn`.
    pub(super) fn within(room: usize, figures: &[&Figure], drawn: usize) -> Storage {
        let longest = figures.iter().flat_map(|figure| figure.line_lengths()).max().unwrap_or_default();
        let mut storage = Storage { most: longest.min(HELD_SAMPLES), levels: FINE };
        while storage.most > drawn {
            let share = room as f64 / storage.size(room, figures).max(1) as f64;
            if share >= 1.0 {
                break;
            }
            let part = match storage.levels == FINE {
                true => (share / SHARE_OF_COARSE).clamp(0.2, 1.0),
                false => share.clamp(0.2, 0.9),
            };
            storage = Storage { most: (part * storage.most as f64) as usize, levels: COARSE };
        }
        Storage { most: storage.most.max(drawn), ..storage }
    }

    /// Largest number of samples of a line of a figure: more where it shows what a model leaves over, since such
    /// figures are zoomed.
    pub(super) fn most_of(self, figure: &Figure) -> usize {
        if shows_residuals(figure) { COMPARED * self.most } else { self.most }
    }

    /// Characters of all samples; about so many where they are far too many.
    fn size(self, room: usize, figures: &[&Figure]) -> usize {
        let samples = |figure: &&Figure| {
            let lengths = figure.line_lengths().filter(|length| *length > UNPACKED);
            lengths.map(|length| length.min(self.most_of(figure))).sum::<usize>()
        };
        let least = LEAST_CHARACTERS * figures.iter().map(samples).sum::<usize>() as f64;
        if least > room as f64 {
            return least as usize;
        }
        let size = |figure: &&Figure| {
            let mut stored = (*figure).clone();
            thin(&mut stored, self.most_of(figure));
            self.packed(figure, &stored).map_or(0, |packed| packed.text.len() + packed.header.len())
        };
        figures.iter().map(size).sum()
    }

    /// Packs the long lines of what is stored of a figure; nothing where there is none.
    pub(super) fn packed(self, whole: &Figure, stored: &Figure) -> Option<Packed> {
        let mut bytes = Vec::new();
        let lines = groups(stored, UNPACKED);
        let pack = |lines: &Vec<Place>| self.group(&mut bytes, whole, stored, lines);
        let groups: Vec<Group> = lines.iter().filter_map(pack).collect();
        if groups.is_empty() {
            return None;
        }
        let mut compressor = Compressor::new(CompressionLvl::new(LEVEL).ok()?);
        let mut deflated = vec![0; compressor.zlib_compress_bound(bytes.len())];
        let length = compressor.zlib_compress(&bytes, &mut deflated).ok()?;
        let text = STANDARD.encode(&deflated[..length]);
        Some(Packed { header: serde_json::to_string(&groups).ok()?, text })
    }

    fn group(self, bytes: &mut Vec<u8>, whole: &Figure, stored: &Figure, lines: &[Place]) -> Option<Group> {
        let of = lines.first().and_then(|place| line(whole, *place)).map(|(x, y)| recorded(x, y.len()))?;
        let series: Vec<(&Abscissa, &[Rounded])> = lines.iter().filter_map(|place| line(stored, *place)).collect();
        let (x, y) = series.first()?;
        let (clock, numbered, places) = match x {
            Abscissa::Uniform { start, step, skip } => {
                if let Some(skip) = skip {
                    write(bytes, skip, 4);
                }
                (Some([*start, *step]), skip.is_some(), None)
            }
            Abscissa::Values(values) => (None, false, Some(column(bytes, &whole.x, values, PLACES, 4))),
        };
        let axes = lines.iter().filter_map(|(row, _)| stored.panels.get(*row)).map(|panel| &panel.y);
        let values = axes.zip(&series).map(|(axis, (_, y))| column(bytes, axis, y, self.levels, 2)).collect();
        Some(Group { lines: lines.to_vec(), count: y.len(), of, clock, numbered, places, values })
    }
}

/// Returns true if a panel has the residuals of models and nothing else.
fn shows_residuals(figure: &Figure) -> bool {
    figure.panels.iter().any(|panel| {
        let style = |layer: &Layer| match layer {
            Layer::Line { style, .. } => Some(*style),
            _ => None,
        };
        let styles: Vec<Style> = panel.layers.iter().filter_map(style).collect();
        let is_left_over = |style: &Style| matches!(style, Style::Residual | Style::Other);
        styles.contains(&Style::Residual) && styles.iter().all(is_left_over)
    })
}

/// Writes numbers as whole numbers of `planes` bytes; of their first differences or of differences of these, whichever
/// are smaller.
fn column(bytes: &mut Vec<u8>, axis: &Axis, values: &[Rounded], levels: f64, planes: usize) -> Code {
    let log = matches!(axis.scale, Scale::Log);
    let values: Vec<f64> = values.iter().map(|value| if log { value.0.log10() } else { value.0 }).collect();
    let finite = || values.iter().filter(|value| value.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    let (low, span) = if low <= high { (low, high - low) } else { (0.0, 0.0) };
    let step = if span > 0.0 && span.is_finite() { short(span / levels) } else { 1.0 };
    let code = |value: &f64| if value.is_finite() { 1 + ((value - low) / step).round() as i64 } else { 0 };
    let codes: Vec<i64> = values.iter().map(code).collect();
    let (first, second) = (differences(&codes), differences(&differences(&codes)));
    let size = |all: &[i64]| all.iter().map(|d| f64::from(1 + d.unsigned_abs() as u32).ln()).sum::<f64>();
    let (order, chosen) = if size(&second) < size(&first) { (2, second) } else { (1, first) };
    let zigzag = |d: &i64| ((d << 1) ^ (d >> 63)) as u32;
    write(bytes, &chosen.iter().map(zigzag).collect::<Vec<_>>(), planes);
    Code { low, step, order, log }
}

/// A number with few digits, which is short to write.
fn short(value: f64) -> f64 {
    format!("{value:.7e}").parse().unwrap_or(value)
}

/// Each number less the one before it.
fn differences(all: &[i64]) -> Vec<i64> {
    let before = std::iter::once(&0).chain(all);
    all.iter().zip(before).map(|(number, before)| number - before).collect()
}

/// The lowest bytes of all numbers, then the next ones.
fn write(bytes: &mut Vec<u8>, numbers: &[u32], planes: usize) {
    for plane in 0..planes {
        bytes.extend(numbers.iter().map(|number| (number >> (8 * plane)) as u8));
    }
}
