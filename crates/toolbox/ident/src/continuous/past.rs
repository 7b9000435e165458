//! Values of the inputs before a record.
//!
//! Behind a delay the first rows of a record answer to inputs before it. An input that rests at first is taken to have
//! rested before too: otherwise the rows that the longest delay reaches say nothing, and with them goes the step of a
//! short test. Outputs can refute that; then those rows are left out, for all delays alike.

use super::channel::ContinuousChannel;
use super::estimate::{OutputFit, Settings, fit_output};
use super::profile::profiled;
use super::record::{Beginning, Record, records};
use crate::colour::Colour;
use crate::data::band_limited::Ground;
use crate::distributions::f_quantile;
use crate::{Dataset, IdentError};

/// Confidence from which on the first rows refute inputs at rest before the record.
const REFUTED: f64 = 0.999;

/// An input rests at first where its first step is at most this part of its range.
const RESTING: f64 = 0.05;

/// Inputs that each move at least so often behind the first rows go without these.
const MANY_MOVES: f64 = 20.0;

/// Part of an input's scatter behind the first rows below which it counts as nothing.
const UNMOVED: f64 = 0.01;

/// Errors below this part of the output are rounding.
const ROUNDING: f64 = 1e-9;

/// The estimates of all outputs with the ends of their intervals by profiles.
pub(crate) fn with_ends<C: ContinuousChannel>(
    ground: &Ground<'_>,
    beginning: Beginning,
    parts: Vec<OutputFit<C>>,
    settings: Settings,
) -> Result<Vec<OutputFit<C>>, IdentError> {
    let with_ends = |(output, part)| Ok(profiled(ground.plain, &records(ground, output, beginning)?, part, settings));
    parts.into_iter().enumerate().map(with_ends).collect()
}

/// The estimates of all outputs, where the rows begin that they rest on, and what they take for the inputs before.
/// Delays reach `reached` rows back; `part` makes the estimate of one output from a beginning.
pub(crate) fn begun<C: ContinuousChannel>(
    ground: &Ground<'_>,
    reached: usize,
    settings: Settings,
    part: impl Fn(usize, Beginning) -> Result<OutputFit<C>, IdentError>,
) -> Result<(Beginning, Vec<OutputFit<C>>), IdentError> {
    let all = |beginning: Beginning| -> Result<(Beginning, Vec<OutputFit<C>>), IdentError> {
        let parts = (0..ground.plain.outputs()).map(|output| part(output, beginning));
        Ok((beginning, parts.collect::<Result<_, _>>()?))
    };
    let unknown = Beginning { first: ground.edge + reached, is_held: false, is_refuted: false };
    if reached == 0 || !may_rest(ground.plain, unknown.first) {
        return all(unknown);
    }
    let held = Beginning { first: ground.edge, is_held: true, is_refuted: false };
    let parts = match all(held) {
        Ok((_, parts)) => parts,
        Err(error) => return all(unknown).map_err(|_| error),
    };
    for (output, part) in parts.iter().enumerate() {
        if is_refuted(ground, output, part, held, unknown, settings)? {
            return Ok(all(unknown).unwrap_or((Beginning { is_refuted: true, ..held }, parts)));
        }
    }
    Ok((held, parts))
}

/// Returns true if all inputs rest at the first samples, or do not move behind the first rows, so that nothing else can
/// be assumed. Where inputs move often behind them the first rows are spared, and nothing has to be assumed: an input
/// that is held for some samples between moves looks at rest wherever a record begins, as behind a gap.
fn may_rest(data: &Dataset, first: usize) -> bool {
    if (0..data.inputs()).all(|k| moves(data, k, first) >= MANY_MOVES) {
        return false;
    }
    (0..data.inputs()).all(|k| {
        let courses = || data.experiments().iter().map(|e| e.input(k));
        let whole = || courses().flatten();
        let range = whole().fold(f64::NEG_INFINITY, |a, b| a.max(*b)) - whole().fold(f64::INFINITY, |a, b| a.min(*b));
        let rests = |u: &[f64]| u.len() < 2 || (u[1] - u[0]).abs() <= RESTING * range;
        let behind: f64 = courses().map(|u| scatter(u.get(first..).unwrap_or(&[]))).sum();
        courses().all(rests) || behind <= UNMOVED * courses().map(scatter).sum::<f64>()
    })
}

/// As many moves of equal size have the mean of squares over the square of the mean that the moves of an input have
/// behind the first rows.
fn moves(data: &Dataset, input: usize, first: usize) -> f64 {
    let behind = data.experiments().iter().flat_map(|e| e.input(input).get(first..).unwrap_or(&[]).windows(2));
    let steps = behind.map(|pair| (pair[1] - pair[0]).powi(2));
    let (sum, squares) = steps.fold((0.0, 0.0), |(sum, squares), step| (sum + step, squares + step * step));
    if squares > 0.0 { sum * sum / squares } else { 0.0 }
}

/// The sum of squares about the mean.
fn scatter(u: &[f64]) -> f64 {
    let mean = u.iter().sum::<f64>() / u.len().max(1) as f64;
    u.iter().map(|v| (v - mean).powi(2)).sum()
}

/// Returns true if the first rows fit in worse with the others than chance explains: by the F-test of leaving them out.
/// This is the test of inputs of any course before the record. It counts as many independent rows as the colour of the
/// errors leaves.
fn is_refuted<C: ContinuousChannel>(
    ground: &Ground<'_>,
    output: usize,
    part: &OutputFit<C>,
    held: Beginning,
    unknown: Beginning,
    settings: Settings,
) -> Result<bool, IdentError> {
    let (all, later) = (records(ground, output, held)?, records(ground, output, unknown)?);
    let start = std::slice::from_ref(&part.model);
    let least = |records: &[Record<'_>]| fit_output(ground.plain, records, start, &part.bounds, settings);
    let Ok(without) = least(&later) else { return Ok(false) };
    // An estimate of another kind has more than the least errors, whatever the inputs were before.
    let Ok(cost) = (if part.is_searched { Ok(part.minimum.cost) } else { least(&all).map(|least| least.minimum.cost) })
    else {
        return Ok(false);
    };
    let energy: f64 = later.iter().map(Record::energy).sum();
    let more = part.minimum.residuals.len() - without.minimum.residuals.len();
    if more == 0 || cost <= ROUNDING * ROUNDING * energy {
        return Ok(false);
    }
    let by_row = Colour::of(&without.residual_series(&later), 1).rows_per_independent();
    let [numerator, denominator] = [more as f64, without.remaining()].map(|rows| (rows / by_row).max(1.0));
    let ratio = (cost - without.minimum.cost) / more as f64 / (without.minimum.cost / without.remaining());
    Ok(ratio > f_quantile(REFUTED, numerator, denominator))
}
