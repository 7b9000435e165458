//! A figure with as many points as can be seen. Series of one clock and unit keep the same samples, so that a difference that is
//! drawn is the difference of what is drawn beside it.

use crate::figure::thin::{kept_indices, steps};
use crate::figure::{Abscissa, Figure, Layer, Rounded};

/// A line of a figure: the indices of its panel and of its layer.
type Place = (usize, usize);

/// The figure with at most about `most` points of each line, and a caption that states how many are drawn.
pub(crate) fn thinned(figure: &Figure, most: usize) -> Figure {
    let mut drawn = figure.clone();
    let mut note = None;
    for group in groups(figure, most) {
        let series: Vec<Vec<f64>> = group.iter().filter_map(|place| values(figure, *place)).collect();
        let kept = kept_together(&series, most);
        note = note.or_else(|| Some((kept.len(), series.first().map_or(0, Vec::len))));
        group.iter().for_each(|place| keep(&mut drawn, *place, &kept));
    }
    if let Some((kept, all)) = note {
        let text = format!("{} Drawn with {kept} of {all} samples; every peak is kept.", drawn.caption);
        drawn.caption = text.trim_start().to_owned();
    }
    drawn
}

/// Lines with more than `most` points, those of one clock and unit together.
fn groups(figure: &Figure, most: usize) -> Vec<Vec<Place>> {
    let mut groups: Vec<(&Abscissa, &str, Vec<Place>)> = Vec::new();
    for (row, panel) in figure.panels.iter().enumerate() {
        for (column, layer) in panel.layers.iter().enumerate() {
            let Layer::Line { x, y, .. } = layer else { continue };
            if y.len() <= most || matches!(x, Abscissa::Uniform { skip: Some(_), .. }) {
                continue;
            }
            let length = |group: &[Place]| group.first().and_then(|place| line(figure, *place)).map(<[Rounded]>::len);
            let same = groups
                .iter_mut()
                .find(|(clock, unit, group)| *clock == x && *unit == panel.y.unit && length(group) == Some(y.len()));
            match same {
                Some((.., group)) => group.push((row, column)),
                None => groups.push((x, &panel.y.unit, vec![(row, column)])),
            }
        }
    }
    groups.into_iter().map(|(.., group)| group).collect()
}

fn line(figure: &Figure, (row, column): Place) -> Option<&[Rounded]> {
    match figure.panels.get(row)?.layers.get(column)? {
        Layer::Line { y, .. } => Some(y),
        _ => None,
    }
}

fn values(figure: &Figure, place: Place) -> Option<Vec<f64>> {
    Some(line(figure, place)?.iter().map(|value| value.0).collect())
}

fn keep(figure: &mut Figure, (row, column): Place, kept: &[usize]) {
    let layer = figure.panels.get_mut(row).and_then(|panel| panel.layers.get_mut(column));
    let Some(Layer::Line { x, y, .. }) = layer else { return };
    let picked = |all: &[Rounded]| kept.iter().filter_map(|&index| all.get(index)).copied().collect();
    *y = picked(y);
    match x {
        Abscissa::Uniform { skip, .. } => *skip = Some(steps(kept)),
        Abscissa::Values(values) => *values = picked(values),
    }
}

/// Indices to keep of series of one length, so that about `most` of each remain. A sample that is kept of one is kept of all.
fn kept_together(series: &[Vec<f64>], most: usize) -> Vec<usize> {
    let share = most / series.len().max(1);
    let of_one = |values: &Vec<f64>| kept_indices(values, share).unwrap_or_else(|| (0..values.len()).collect());
    let mut kept: Vec<usize> = series.iter().flat_map(of_one).collect();
    kept.sort_unstable();
    kept.dedup();
    kept
}
