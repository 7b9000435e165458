//! A gain and a dead time under a held input: the output jumps with the input, some samples later.

use faer::Mat;

use super::model::{DelayFault, DelayModel, LEAD, ModelledDelay, ROUNDING};
use super::ripple::PER_LINE;
use super::structure::{dependence, variance};
use crate::delay::DelayEstimate;
use crate::distributions::chi_squared_quantile;
use crate::validate::ResidualTest;
use crate::{Dataset, Experiment};

/// A gain and the level of each experiment by least squares.
struct Line {
    gain: f64,
    levels: Vec<f64>,
    cost: f64,
}

/// The best gain without dynamics. `y(t) = g u(t − k)` at whole samples leaves the dead time between k − 1 and k; as
/// far as a model with a lag goes, its rows are those of `lagged`, and so is the colour of its errors.
pub(super) fn fit(
    options: &ModelledDelay,
    first_row: usize,
    clean: &Dataset,
    lagged: &DelayModel,
) -> Option<DelayModel> {
    let longest = options.longest + LEAD;
    let lines: Vec<Line> = (0..=longest).map(|k| line(clean, k, first_row)).collect::<Option<_>>()?;
    let best = (0..lines.len()).min_by(|a, b| lines[*a].cost.total_cmp(&lines[*b].cost))?;
    let (rows, variance) = (lagged.samples as f64, variance(clean));
    let loss = |k: usize| (lines[k].cost / rows).max(ROUNDING * variance);
    let worse = lagged.inflation * chi_squared_quantile(options.level, 1.0);
    let as_good = |k: &usize| rows * (loss(*k) / loss(best)).ln() <= worse;
    let (first, last) = (lines.len().checked_sub(1)?, 0);
    let (first, last) =
        (0..lines.len()).filter(as_good).fold((first, last), |(low, high), k| (low.min(k), high.max(k)));
    let (low, high) = (first as f64 - 1.0 - LEAD as f64, last as f64 - LEAD as f64);
    // No effect comes before its cause; where all else is excluded, that is a fault.
    let low = if high > 0.0 { low.max(0.0) } else { low };
    let spread = options.dated((high - low) / 12.0_f64.sqrt());
    let widened = options.reach() * options.dating;
    let mut faults: Vec<DelayFault> = Vec::new();
    if last == longest {
        faults.push(DelayFault::AtLongest { input: 0, tried: options.longest });
    } else if high <= 0.0 {
        faults.push(DelayFault::TooEarly { input: 0 });
    }
    if loss(best) > ROUNDING * variance {
        faults.extend(tested(clean, best, first_row, &lines[best]));
    }
    let within = |end: f64| end.clamp(0.0, options.longest as f64);
    let levels = clean.experiments().iter().filter(|e| e.len() > first_row).count();
    Some(DelayModel {
        zeros: 0,
        poles: 0,
        dead_times: vec![DelayEstimate { samples: 0.5 * (low + high), standard_error: spread }],
        intervals: vec![(within(low - widened), within(high + widened))],
        late_by: vec![None],
        late_intervals: vec![None],
        loss: loss(best),
        fit_percent: 100.0 * (1.0 - (loss(best) / variance.max(f64::MIN_POSITIVE)).sqrt()),
        ripple_hz: lagged.ripple_hz.clone(),
        samples: lagged.samples,
        faults,
        channels: Vec::new(),
        free: 2 + levels * (1 + PER_LINE * lagged.ripple_hz.len()),
        inflation: lagged.inflation,
    })
}

/// Pairs of input `k` samples before and output of one experiment, of the rows from `first` on; before the record the
/// input is what it is at first.
fn pairs(e: &Experiment, k: usize, first: usize) -> impl Iterator<Item = (f64, f64)> + Clone {
    let (u, y) = (e.input(0), e.output(0));
    (first..e.len()).map(move |t| (u[t.saturating_sub(k)], y[t])).filter(|(_, y)| !y.is_nan())
}

/// The means of pairs; of none, zero.
fn means(pairs: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    let (rows, u, y) = pairs.fold((0.0_f64, 0.0, 0.0), |(n, su, sy), (u, y)| (n + 1.0, su + u, sy + y));
    (u / rows.max(1.0), y / rows.max(1.0))
}

fn line(data: &Dataset, k: usize, first: usize) -> Option<Line> {
    let experiments = data.experiments();
    let about: Vec<(f64, f64)> = experiments.iter().map(|e| means(pairs(e, k, first))).collect();
    let all = experiments.iter().zip(&about);
    let all = all.flat_map(|(e, (u, y))| pairs(e, k, first).map(move |(v, w)| (v - u, w - y)));
    let (uu, uy) = all.clone().fold((0.0, 0.0), |(uu, uy), (v, w)| (uu + v * v, uy + v * w));
    let gain = uy / uu;
    let cost = all.map(|(v, w)| (w - gain * v).powi(2)).sum();
    let levels = about.iter().map(|(u, y)| y - gain * u).collect();
    gain.is_finite().then_some(Line { gain, levels, cost })
}

fn tested(data: &Dataset, k: usize, first: usize, line: &Line) -> Vec<DelayFault> {
    let mut levels = line.levels.iter();
    let left = data.map_experiments(|e| {
        let level = levels.next().copied().unwrap_or(0.0);
        let error = |t: usize| match t < first {
            true => f64::NAN,
            false => e.outputs[(t, 0)] - line.gain * e.inputs[(t.saturating_sub(k), 0)] - level,
        };
        Ok(Experiment { outputs: Mat::from_fn(e.len(), 1, |t, _| error(t)), ..e.clone() })
    });
    let report = left.and_then(|left| ResidualTest::default().run_on_residuals(&left));
    report.map_or(vec![DelayFault::Untested], |report| report.independence[0].iter().flat_map(dependence).collect())
}
