//! A figure with as many points as can be seen. Series of one clock and unit keep the same samples, so that a
//! difference that is drawn is the difference of what is drawn beside it.

use crate::figure::thin::{kept_indices, steps};
use crate::figure::{Abscissa, Figure, Layer, Rounded};

/// A line of a figure: the indices of its panel and of its layer.
pub(crate) type Place = (usize, usize);

/// Largest number of samples of a line that a page holds. With 8 bytes a value, and at most as many
/// for its place, that is 4 MB a line, however long the recording is.
pub(crate) const HELD_SAMPLES: usize = 250_000;

/// Points of all lines of a page.
const PAGE_POINTS: usize = 100_000;
/// Points of a line: two a pixel of a wide figure, and fewer in a page of very many figures.
const MOST_POINTS: usize = 1500;
const FEWEST_POINTS: usize = 260;

/// Points of a line, so that a page of many figures stays small: about five bytes are written for each.
pub(crate) fn most_points(figures: &[&Figure]) -> usize {
    let lengths: Vec<usize> = figures.iter().flat_map(|figure| figure.line_lengths()).collect();
    let total = |most: usize| lengths.iter().map(|length| (*length).min(most)).sum::<usize>();
    [MOST_POINTS, 1200, 1000, 800, 650, 500, 400, 320]
        .into_iter()
        .find(|most| total(*most) <= PAGE_POINTS)
        .unwrap_or(FEWEST_POINTS)
}

/// The figure with at most about `most` points of each line, and a caption that states how many are drawn.
pub(crate) fn thinned(figure: &Figure, most: usize) -> Figure {
    let mut drawn = figure.clone();
    thin(&mut drawn, most);
    if let Some(note) = samples_drawn(&drawn, figure) {
        drawn.caption = format!("{} {note}", drawn.caption).trim_start().to_owned();
    }
    drawn
}

/// How many samples of the whole figure are drawn, in words; nothing where all are.
pub(crate) fn samples_drawn(drawn: &Figure, whole: &Figure) -> Option<String> {
    let counts = |(whole, drawn): (&Layer, &Layer)| match (whole, drawn) {
        (Layer::Line { x, y, .. }, Layer::Line { y: kept, .. }) => Some((kept.len(), recorded(x, y.len()))),
        _ => None,
    };
    let (kept, all) = layers(whole).zip(layers(drawn)).filter_map(counts).find(|(kept, all)| kept < all)?;
    Some(format!("Drawn with {kept} of {all} samples; every peak is kept."))
}

fn layers(figure: &Figure) -> impl Iterator<Item = &Layer> {
    figure.panels.iter().flat_map(|panel| &panel.layers)
}

/// The number of samples before any was left out.
pub(crate) fn recorded(x: &Abscissa, count: usize) -> usize {
    match x {
        Abscissa::Uniform { skip: Some(skip), .. } => 1 + skip.iter().map(|step| *step as usize).sum::<usize>(),
        _ => count,
    }
}

/// Leaves at most about `most` points of each line.
pub(crate) fn thin(figure: &mut Figure, most: usize) {
    for group in groups(figure, most) {
        let series: Vec<Vec<f64>> = group.iter().filter_map(|place| values(figure, *place)).collect();
        let kept = kept_together(&series, most);
        group.iter().for_each(|place| keep(figure, *place, &kept));
    }
}

/// Lines with more than `most` points, those of one clock and unit together.
pub(crate) fn groups(figure: &Figure, most: usize) -> Vec<Vec<Place>> {
    let mut groups: Vec<(&Abscissa, &str, Vec<Place>)> = Vec::new();
    for (row, panel) in figure.panels.iter().enumerate() {
        for (column, layer) in panel.layers.iter().enumerate() {
            let Layer::Line { x, y, .. } = layer else { continue };
            if y.len() <= most {
                continue;
            }
            let length = |group: &[Place]| group.first().and_then(|place| line(figure, *place)).map(|(_, y)| y.len());
            let same = groups
                .iter_mut()
                .find(|(clock, unit, group)| *unit == panel.y.unit && length(group) == Some(y.len()) && *clock == x);
            match same {
                Some((.., group)) => group.push((row, column)),
                None => groups.push((x, &panel.y.unit, vec![(row, column)])),
            }
        }
    }
    groups.into_iter().map(|(.., group)| group).collect()
}

/// Places and values of a line.
pub(crate) fn line(figure: &Figure, (row, column): Place) -> Option<(&Abscissa, &[Rounded])> {
    match figure.panels.get(row)?.layers.get(column)? {
        Layer::Line { x, y, .. } => Some((x, y)),
        _ => None,
    }
}

fn values(figure: &Figure, place: Place) -> Option<Vec<f64>> {
    Some(line(figure, place)?.1.iter().map(|value| value.0).collect())
}

fn keep(figure: &mut Figure, (row, column): Place, kept: &[usize]) {
    let layer = figure.panels.get_mut(row).and_then(|panel| panel.layers.get_mut(column));
    let Some(Layer::Line { x, y, .. }) = layer else { return };
    let picked = |all: &[Rounded]| kept.iter().filter_map(|&index| all.get(index)).copied().collect();
    *y = picked(y);
    match x {
        Abscissa::Uniform { skip, .. } => *skip = Some(joined(skip.as_deref(), kept)),
        Abscissa::Values(values) => *values = picked(values),
    }
}

/// The steps between samples that are kept of those that `skip` left.
fn joined(skip: Option<&[u32]>, kept: &[usize]) -> Vec<u32> {
    let Some(skip) = skip else { return steps(kept) };
    let sum = |at: &usize, so_far: usize| skip.get(so_far..=*at).unwrap_or_default().iter().sum::<u32>();
    let mut next = 0;
    let step = |at: &usize| {
        let step = sum(at, next);
        next = at + 1;
        step
    };
    kept.iter().map(step).collect()
}

/// Indices to keep of series of one length, so that about `most` of each remain. A sample that is kept of one is kept
/// of all.
fn kept_together(series: &[Vec<f64>], most: usize) -> Vec<usize> {
    let share = most / series.len().max(1);
    let of_one = |values: &Vec<f64>| kept_indices(values, share).unwrap_or_else(|| (0..values.len()).collect());
    let mut kept: Vec<usize> = series.iter().flat_map(of_one).collect();
    kept.sort_unstable();
    kept.dedup();
    kept
}
