//! Band-limited inputs between their samples.
//!
//! No recursion in the samples alone is exact for an input without content above half the sample rate: what it does
//! within an interval depends on samples far before and after. So its course in each interval is made an input of
//! several columns, the coefficients of a polynomial, and systems in continuous time are sampled exactly under that.

use std::borrow::Cow;

use faer::Mat;
use lti::{Innovations, LtiError};
use numerics::vector::dot;
use signal::Signal;
use signal::resample::{Interpolation, interpolate_at};

use crate::{Dataset, Experiment, IdentError, Intersample};

/// Coefficients of the polynomial in each interval: at 0.45 of the sample rate the rest is some 4e-5 of the amplitude,
/// at 0.3 of it 1e-6.
pub(crate) const COEFFICIENTS: usize = 7;

/// Samples on either side that the interpolation looks at, so that rows nearer to an end rest on a guess beyond it.
pub(crate) const REACH: usize = 32;

/// A model in continuous time under band-limited inputs.
///
/// The courses `u(k − delay + τ) = Σ_j c_j(k) τ^j`, `0 ≤ τ ≤ 1`, take the place of the samples: the form has the
/// coefficients `c_0 … c_6` of each course as inputs, one course after the other.
#[derive(Debug, Clone)]
pub struct BandLimitedForm {
    pub(crate) innovations: Innovations,
    /// The input and its delay in samples that each course is of.
    pub(crate) courses: Vec<(usize, f64)>,
}

/// The data with the coefficients of courses in place of the inputs.
pub(crate) fn with_courses(data: &Dataset, courses: &[(usize, f64)], at_rest: bool) -> Result<Dataset, IdentError> {
    let filters = courses.iter().map(|(_, delay)| Filter::new(*delay)).collect::<Result<Vec<_>, _>>()?;
    let mut whole: Option<Dataset> = None;
    for e in data.experiments() {
        let mut inputs = Mat::zeros(e.len(), COEFFICIENTS * courses.len());
        for (place, ((input, _), filter)) in courses.iter().zip(&filters).enumerate() {
            for (j, column) in filter.run(e.input(*input), at_rest).iter().enumerate() {
                inputs.col_mut(COEFFICIENTS * place + j).iter_mut().zip(column).for_each(|(slot, v)| *slot = *v);
            }
        }
        let courses = Experiment { inputs, ..e.clone() };
        whole = Some(match whole {
            Some(data) => data.with_experiment(courses)?,
            None => Dataset::new(data.sample_time_s(), courses.inputs, courses.outputs)?,
        });
    }
    Ok(whole.unwrap_or_else(|| data.clone()).with_intersample(data.intersample()))
}

/// Filter from the samples about an interval to the coefficients of the interval.
struct Filter {
    /// The first sample, counted from that at the start of the interval.
    first: i64,
    /// For each coefficient the weight of each sample from the first on.
    weights: Vec<Vec<f64>>,
}

impl Filter {
    /// The polynomial through the band-limited signal at the nodes of Chebyshev and Lobatto, the ends of the interval
    /// among them.
    fn new(delay: f64) -> Result<Self, IdentError> {
        if !(0.0..=1e9).contains(&delay) {
            return Err(LtiError::Delay { delay_s: delay }.into());
        }
        let reach = REACH as i64;
        let first = (-delay).floor() as i64 - reach;
        let count = 2 * REACH + 3;
        let mut weights = vec![vec![0.0; count]; COEFFICIENTS];
        let nodes = nodes();
        for (i, node) in nodes.iter().enumerate() {
            let powers = lagrange(&nodes, i);
            for (of, weight) in sinc_weights(node - delay)? {
                let place = (of - first) as usize;
                weights.iter_mut().zip(&powers).for_each(|(row, power)| row[place] += power * weight);
            }
        }
        Ok(Filter { first, weights })
    }

    /// The coefficients of every interval that starts at a sample. Beyond its ends the record is continued by odd
    /// reflection, before its beginning by zeros if it starts `at_rest`.
    fn run(&self, u: &[f64], at_rest: bool) -> Vec<Vec<f64>> {
        let width = self.weights[0].len();
        let last = u.len() as i64 + self.first + width as i64;
        let around: Vec<f64> = (self.first..last).map(|k| beyond(u, k, at_rest)).collect();
        let column = |weights: &Vec<f64>| {
            around.windows(width).take(u.len()).map(|near| dot(weights, near)).collect::<Vec<f64>>()
        };
        self.weights.iter().map(column).collect()
    }
}

/// `τ` of the nodes, rising from 0 to 1.
fn nodes() -> Vec<f64> {
    let last = (COEFFICIENTS - 1) as f64;
    (0..COEFFICIENTS).map(|i| 0.5 * (1.0 - (std::f64::consts::PI * i as f64 / last).cos())).collect()
}

/// The coefficients in rising powers of the polynomial that is one at one node and zero at the others.
fn lagrange(nodes: &[f64], one: usize) -> Vec<f64> {
    let others = nodes.iter().enumerate().filter(|(i, _)| *i != one).map(|(_, node)| node);
    let mut p = others.fold(vec![1.0], |p, node| {
        let scale = 1.0 / (nodes[one] - node);
        lti::polynomial::multiply(&p, &[scale, -scale * node])
    });
    p.reverse();
    p
}

/// The samples that make a band-limited signal at this position, with their weights.
fn sinc_weights(position: f64) -> Result<Vec<(i64, f64)>, IdentError> {
    let nearest = position.round();
    if (position - nearest).abs() < 1e-9 {
        return Ok(vec![(nearest as i64, 1.0)]);
    }
    let (below, reach) = (position.floor(), REACH as i64);
    // The weight of a sample is what a lone one there gives at the position.
    let middle = 2 * REACH;
    let lone = (0..=2 * middle).map(|i| f64::from(u8::from(i == middle))).collect();
    let lone = Signal::new(0.0, 1.0, lone)?;
    let near: Vec<i64> = (1 - reach..=reach).collect();
    let places: Vec<f64> = near.iter().map(|k| middle as f64 + position - below - *k as f64).collect();
    let weights = interpolate_at(&lone, &places, Interpolation::BandLimited)?;
    Ok(near.iter().map(|k| below as i64 + k).zip(weights).collect())
}

/// A sample at any index; further than the interpolation reaches beyond an end the last value there stays.
fn beyond(u: &[f64], index: i64, at_rest: bool) -> f64 {
    let (Some(first), Some(last)) = (u.first(), u.last()) else { return 0.0 };
    let end = u.len() as i64 - 1;
    let reflected = |distance: i64| distance.min(REACH as i64).min(end) as usize;
    match index {
        _ if index < 0 && at_rest => 0.0,
        _ if index < 0 => 2.0 * first - u[reflected(-index)],
        _ if index > end => 2.0 * last - u[end as usize - reflected(index - end)],
        _ => u[index as usize],
    }
}

/// Data as a search over models in continuous time needs them: band-limited inputs by their courses, and no outputs
/// where these rest on a guess beyond the end. Rows so near to the beginning are for the search to leave out.
pub(crate) struct Ground<'a> {
    /// The data as they came.
    pub(crate) plain: &'a Dataset,
    pub(crate) data: Cow<'a, Dataset>,
    /// Columns an input.
    pub(crate) width: usize,
    /// Rows at the beginning that rest on a guess.
    pub(crate) edge: usize,
}

impl<'a> Ground<'a> {
    pub(crate) fn new(plain: &'a Dataset, at_rest: bool) -> Result<Self, IdentError> {
        if plain.intersample() != Intersample::BandLimited || plain.inputs() == 0 {
            return Ok(Ground { plain, data: Cow::Borrowed(plain), width: 1, edge: 0 });
        }
        let courses: Vec<(usize, f64)> = (0..plain.inputs()).map(|k| (k, 0.0)).collect();
        let data = with_courses(plain, &courses, at_rest)?.map_experiments(|e| {
            let known = e.len().saturating_sub(REACH);
            let output = |t: usize, i: usize| if t < known { e.outputs[(t, i)] } else { f64::NAN };
            Ok(Experiment { outputs: Mat::from_fn(e.len(), e.outputs.ncols(), output), ..e.clone() })
        })?;
        Ok(Ground { plain, data: Cow::Owned(data), width: COEFFICIENTS, edge: if at_rest { 0 } else { REACH } })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// A tone up to 0.45 of the sample rate, with and without a delay, at instants between the samples.
    #[test]
    fn exact_courses_of_tones() {
        for (frequency, tolerance) in [(0.05, 1e-5), (0.3, 1e-5), (0.45, 3e-4)] {
            let tone = |t: f64| (std::f64::consts::TAU * frequency * t + 0.4).cos();
            let u: Vec<f64> = (0..200).map(|k| tone(f64::from(k))).collect();
            for delay in [0.0, 3.0, 7.31] {
                let courses = Filter::new(delay).unwrap().run(&u, false);
                for k in REACH + 8..200 - REACH - 1 {
                    for tau in [0.0, 0.1, 0.5, 0.83, 1.0] {
                        let value = courses.iter().rev().fold(0.0, |sum, c| sum * tau + c[k]);
                        let error = value - tone(k as f64 - delay + tau);
                        assert!(error.abs() < tolerance, "{frequency} {delay} {k} {tau}: {error:e}");
                    }
                }
            }
        }
    }
}
