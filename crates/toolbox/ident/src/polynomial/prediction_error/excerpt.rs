//! A part of the data that starting values are sought on.

use std::borrow::Cow;

use super::segment::Segment;

/// Enough of the data to start from: where there is much, the stretch in which the inputs move most.
pub(super) fn excerpt<'s>(all: &'s [Segment<'_>], enough: usize) -> Vec<Segment<'s>> {
    let rows: usize = all.iter().map(Segment::len).sum();
    let whole = |s: &'s Segment<'_>| s.part(0, s.len());
    if rows <= 2 * enough {
        return all.iter().map(whole).collect();
    }
    let long = all.iter().filter(|s| s.len() >= enough);
    let windows = long.flat_map(|s| (0..s.len() / enough).map(move |w| (s, w * enough)));
    let activity = |(s, first): &(&Segment<'_>, usize)| activity(s, *first, enough);
    if let Some((segment, first)) = windows.max_by(|a, b| activity(a).total_cmp(&activity(b))) {
        return vec![segment.part(first, enough)];
    }
    let mut taken = 0;
    let first = |s: &&Segment<'_>| {
        taken += s.len();
        taken <= 2 * enough
    };
    all.iter().take_while(first).map(whole).collect()
}

/// How much the inputs, or without any the output, change from sample to sample in a window.
fn activity(segment: &Segment<'_>, first: usize, rows: usize) -> f64 {
    let change = |x: &[f64]| x[first..first + rows].windows(2).map(|p| (p[1] - p[0]).powi(2)).sum::<f64>();
    match segment.inputs.as_slice() {
        [] => change(&segment.output),
        inputs => inputs.iter().map(|u| change(u)).sum(),
    }
}

/// The segment with straight lines through its missing outputs: good enough to start from.
pub(super) fn interpolated<'s>(segment: &'s Segment<'_>) -> Segment<'s> {
    let mut copy = segment.part(0, segment.len());
    if segment.missing.is_empty() {
        return copy;
    }
    let mut y = segment.output.to_vec();
    let mut before: Option<usize> = None;
    let known: Vec<usize> = (0..y.len()).filter(|t| segment.missing.binary_search(t).is_err()).collect();
    for t in known.iter().copied() {
        let first = before.map_or(0, |b| b + 1);
        let from = before.map_or(y[t], |b| y[b]);
        let span = (t + 1 - first) as f64;
        (first..t).for_each(|m| y[m] = from + (y[t] - from) * ((m + 1 - first) as f64 / span));
        before = Some(t);
    }
    if let Some(b) = before {
        let value = y[b];
        y[b + 1..].fill(value);
    }
    copy.output = Cow::Owned(y);
    copy.missing.clear();
    copy
}
