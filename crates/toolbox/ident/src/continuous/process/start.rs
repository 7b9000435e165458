//! Where the search for a process model begins: the best of a grid of delays and lags, gains and zeros by least
//! squares.

use faer::Mat;

use super::ranges::Ranges;
use crate::continuous::ProcessSystem;
use crate::continuous::estimate::{Settings, errors};
use crate::continuous::record::{Record, liveliest};
use crate::continuous::start::grid;
use crate::least_squares::least_squares;
use crate::{Dataset, IdentError, Parametric, ResidualModel};
use fitting::StructureError;

/// Samples that starting values rest on.
const SAMPLES: usize = 4_000;

/// Lags tried.
const LAGS: usize = 7;

/// Best starting values that are searched from.
const KEPT: usize = 8;

struct Candidate {
    cost: f64,
    delay_s: Vec<f64>,
    longest_s: Vec<f64>,
    model: ProcessSystem,
}

pub(super) fn candidates(
    ranges: &Ranges,
    data: &Dataset,
    records: &[Record<'_>],
    settings: Settings,
) -> Result<Vec<ProcessSystem>, IdentError> {
    let short = liveliest(records, SAMPLES);
    let settings = settings.within(&short, records);
    let t = data.sample_time_s();
    let lags = lags(ranges, t, short.iter().map(Record::rows).max().unwrap_or(1));
    let mut delay_s: Vec<f64> = ranges.delay_s.iter().map(|(low, high)| 0.5 * (low + high)).collect();
    let mut longest_s = vec![lags[lags.len() / 2]; delay_s.len()];
    let mut ranked: Vec<Candidate> = Vec::new();
    for _ in 0..if delay_s.len() > 1 { 2 } else { 1 } {
        for k in 0..delay_s.len() {
            let (low, high) = ranges.delay_s[k];
            let (mut tried, delays) = (Vec::new(), delays(low / t, high / t));
            for lag in &lags {
                longest_s[k] = *lag;
                let mut judged = |delay: &f64| {
                    delay_s[k] = delay * t;
                    let model = ranges.at(&delay_s, &longest_s)?;
                    Ok(judge(ranges, model, &short, data, settings, &delay_s, &longest_s).ok())
                };
                tried.extend(lowest(delays.iter().map(&mut judged).collect::<Result<_, IdentError>>()?));
            }
            tried.sort_by(|x, y| x.cost.total_cmp(&y.cost));
            let best = tried.first().ok_or(StructureError::NoStart)?;
            (delay_s, longest_s) = (best.delay_s.clone(), best.longest_s.clone());
            ranked = tried;
        }
    }
    ranked.truncate(KEPT);
    Ok(ranked.into_iter().map(|c| c.model).collect())
}

/// Delays compared, in samples: a minimum over a range is none above that at its ends.
fn delays(low: f64, high: f64) -> Vec<f64> {
    let inner = grid((low, high)).into_iter().filter(|delay| *delay > low && *delay < high);
    let mut all: Vec<f64> = std::iter::once(low).chain(inner).chain([high]).collect();
    all.dedup();
    all
}

/// Those along a line of delays that cost less than their neighbours: what answers the wrong way at first has two.
fn lowest(line: Vec<Option<Candidate>>) -> Vec<Candidate> {
    let cost = |place: Option<usize>| {
        let candidate = place.and_then(|place| line.get(place)?.as_ref());
        candidate.map_or(f64::INFINITY, |candidate| candidate.cost)
    };
    let is_lowest = |place: usize| {
        let own = cost(Some(place));
        own < cost(place.checked_sub(1)) && own <= cost(Some(place + 1))
    };
    let kept: Vec<bool> = (0..line.len()).map(is_lowest).collect();
    line.into_iter().zip(kept).filter_map(|(candidate, is_kept)| candidate.filter(|_| is_kept)).collect()
}

/// Time constants from a sample to a third of the record, within bounds.
fn lags(ranges: &Ranges, t: f64, rows: usize) -> Vec<f64> {
    let (low, high) = (t.max(ranges.lag_s.0).min(ranges.lag_s.1), (rows as f64 * t / 3.0).max(2.0 * t));
    let high = high.min(ranges.lag_s.1).max(low);
    (0..LAGS).map(|i| low * (high / low).powf(i as f64 / (LAGS - 1) as f64)).collect()
}

/// Fits gains and zeros that are not held, which enter as K and K T_z, and returns what is left.
fn judge(
    ranges: &Ranges,
    model: ProcessSystem,
    records: &[Record<'_>],
    data: &Dataset,
    settings: Settings,
    delay_s: &[f64],
    longest_s: &[f64],
) -> Result<Candidate, IdentError> {
    let mut problem = errors(&model, records, data, settings);
    let (rows, mut theta) = (problem.residual_count(), model.parameters());
    let (mut residuals, mut jacobian) = (vec![0.0; rows], Mat::zeros(rows, theta.len()));
    problem.evaluate(&theta, &mut residuals, Some(jacobian.as_mut()))?;
    // The columns of K and T_z that are free, and for T_z the K that comes with it: at K = 1 and T_z = 0 the error is
    // y + J_K, and K T_z is what is linear.
    let (mut gains, mut columns) = (Vec::new(), Vec::new());
    for (channel, first) in model.channels().iter().zip(model.offsets()) {
        let zero = first + 1 + 2 * usize::from(channel.pair().is_some()) + channel.lags_s().len();
        let gain = Some(first).filter(|j| !ranges.is_held(*j));
        gains.extend(gain);
        columns.extend(gain.map(|j| (j, None)));
        columns.extend(channel.zero_s().filter(|_| !ranges.is_held(zero)).map(|_| (zero, gain)));
    }
    let target: Vec<f64> =
        (0..rows).map(|i| residuals[i] - gains.iter().map(|j| jacobian[(i, *j)]).sum::<f64>()).collect();
    let phi = Mat::from_fn(rows, columns.len(), |i, j| -jacobian[(i, columns[j].0)]);
    let (values, cost) = if columns.is_empty() {
        (Vec::new(), residuals.iter().map(|r| r * r).sum())
    } else {
        let fit = least_squares(phi.as_ref(), &target)?;
        (fit.parameters, fit.cost)
    };
    for ((column, gain), value) in columns.iter().zip(&values) {
        theta[*column] = value / gain.map_or(1.0, |j: usize| theta[j]);
    }
    let model = model.with_parameters(&theta)?;
    Ok(Candidate { cost, delay_s: delay_s.to_vec(), longest_s: longest_s.to_vec(), model })
}
