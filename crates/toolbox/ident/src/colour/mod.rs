//! The covariance of an estimate whose errors are coloured although its model takes them for white.
//!
//! To first order `θ̂ − θ = (JᵀJ)⁻¹ Jᵀ v`, so that the covariance is `(JᵀJ)⁻¹ JᵀRJ (JᵀJ)⁻¹` with `R` the covariance of
//! the errors `v` in time. Their autocorrelation is that of an autoregression fitted to the residuals, of an order
//! chosen by Akaike's criterion: none where they look white, and the covariance is the usual one then. Where its errors
//! `e` change in size over time, `R` has their variance at each instant.
//!
//! It holds where `J` does not depend on `v`, as for errors of a simulation in open loop.
//!
//! # Source
//! Ljung 1999, (9.42)–(9.44) for the covariance; Whittle, *On the fitting of multivariate autoregressions*, Biometrika
//! 50, 1963, for the recursion; Berk, *Consistent autoregressive spectral estimates*, Ann. Statist. 2, 1974, for how
//! certain the spectrum is.

pub(crate) mod variance_course;

use faer::{Mat, MatRef};
use numerics::linalg::{self, Cholesky};

use crate::IdentError;
use crate::dense::covariance_root::root;

/// Most lags of the autoregression, times the decades of the number of residuals.
const LAGS_PER_DECADE: f64 = 10.0;
/// Residuals that every coefficient of the autoregression must have at least.
const ROWS_PER_COEFFICIENT: usize = 10;
/// Part of a response below which it counts as over.
const DECAYED: f64 = 1e-10;
/// Part of an autocovariance below which it counts as over.
const MEMORY: f64 = 1e-4;
/// Autocovariances that a count of independent rows takes in, at most.
const REACH: usize = 10_000;

/// The autocorrelation of residuals as an autoregression `ṽ(t) = Σ A_k ṽ(t−k) + e(t)` of the series read backwards.
#[derive(Debug, Clone)]
pub(crate) struct Colour {
    /// `A_k`, outputs × outputs; none for white errors.
    coefficients: Vec<Mat<f64>>,
    /// `L` with `L Lᵀ` the covariance of `e`, at the size that the residuals have.
    root: Mat<f64>,
    /// The autocovariances `E ṽ(t) ṽ(t−k)ᵀ` for k = 0 … order.
    moments: Vec<Mat<f64>>,
    rows: usize,
    /// Where the size of `e` changes, its variance at each instant of each series over that of all.
    course: Option<Vec<Vec<f64>>>,
}

impl Colour {
    /// That of the residuals of all experiments: of each, instant by instant, every output; NaN where there is none.
    pub(crate) fn of(series: &[Vec<f64>], outputs: usize) -> Self {
        let moments = Moments::new(series, outputs);
        let mut now = Recursion::new(moments.at(0));
        let mut chosen = (f64::INFINITY, Vec::new(), Mat::zeros(outputs, outputs), 0);
        for order in 0..=moments.lags() {
            if order > 0 {
                now.extend(&moments.reversed(order));
            }
            let Ok(factor) = Cholesky::new(now.forward_error.as_ref()) else { break };
            let lower = factor.lower().to_owned();
            let log_determinant = 2.0 * (0..outputs).map(|i| lower[(i, i)].ln()).sum::<f64>();
            let criterion = moments.rows as f64 * log_determinant + (2 * order * outputs * outputs) as f64;
            if criterion.is_finite() && criterion < chosen.0 {
                chosen = (criterion, now.forward.clone(), lower, order);
            }
        }
        now.moments.truncate(chosen.3 + 1);
        let (coefficients, root) = (chosen.1, chosen.2);
        let sizes: Vec<Vec<f64>> = series.iter().map(|s| sizes(s, &coefficients, &root)).collect();
        let course = variance_course::course(&sizes);
        Colour { coefficients, root, moments: now.moments, rows: moments.rows, course }
    }

    /// That of independent white errors of variance one.
    pub(crate) fn white(outputs: usize) -> Self {
        let identity = Mat::identity(outputs, outputs);
        Colour { coefficients: Vec::new(), root: identity.clone(), moments: vec![identity], rows: 0, course: None }
    }

    /// Returns true if the residuals look white, and as large at all times.
    pub(crate) fn is_white(&self) -> bool {
        self.coefficients.is_empty() && self.course.is_none()
    }

    /// `E v(t) v(t−k)ᵀ` for k = 0, 1, … until it has decayed, at most `reach`.
    pub(crate) fn autocovariances(&self, reach: usize) -> Vec<Mat<f64>> {
        let mut moments: Vec<Mat<f64>> = self.moments.iter().take(reach + 1).cloned().collect();
        let least = MEMORY * self.moments[0].norm_max();
        let order = self.coefficients.len();
        while order > 0 && moments.len() <= reach {
            let now = moments.len();
            if moments[now - order.min(now)..].iter().all(|m| m.norm_max() <= least) {
                break;
            }
            let next = self.coefficients.iter().enumerate().map(|(k, a)| a * &moments[now - 1 - k]);
            let zero = Mat::zeros(self.root.nrows(), self.root.nrows());
            moments.push(next.fold(zero, |sum, part| sum + part));
        }
        // Those of the series read backwards are transposed.
        moments.iter().map(|m| m.transpose().to_owned()).collect()
    }

    /// As many rows of one output determine a mean square, or the correlation with a series that is as coloured, as one
    /// independent row does.
    ///
    /// # Source
    /// Bartlett, *Some aspects of the time-correlation problem in regard to tests of significance*, J. R. Stat. Soc.
    /// 98, 1935.
    pub(crate) fn rows_per_independent(&self) -> f64 {
        let moments = self.autocovariances(REACH);
        let at = |moment: &Mat<f64>| moment[(0, 0)] / moments[0][(0, 0)];
        1.0 + 2.0 * moments.iter().skip(1).map(|moment| at(moment).powi(2)).sum::<f64>()
    }

    /// Degrees of freedom of a variance that rests on the spectrum at low frequencies, `N/2p` for `p` lags.
    pub(crate) fn degrees_of_freedom(&self) -> f64 {
        (self.rows as f64 / (2 * self.coefficients.len()).max(1) as f64).max(1.0)
    }
}

/// The covariance under coloured errors, with no variance less than under white ones: of short records the residuals
/// look more opposed from sample to sample than the errors are, since the fit has taken out what is slow. Correlations
/// stay.
pub(crate) fn no_less_than(white: &Mat<f64>, coloured: &Mat<f64>) -> Mat<f64> {
    let n = coloured.nrows();
    let ratio = |j: usize| (white[(j, j)] / coloured[(j, j)]).sqrt();
    let factors: Vec<f64> = (0..n).map(ratio).map(|r| if r.is_finite() { r.max(1.0) } else { 1.0 }).collect();
    Mat::from_fn(n, n, |i, j| factors[i] * factors[j] * coloured[(i, j)])
}

/// The sizes of `L⁻¹ e(t)`, with a sign where there is one output; NaN where a residual is missing that it takes.
fn sizes(series: &[f64], coefficients: &[Mat<f64>], root: &Mat<f64>) -> Vec<f64> {
    let p = root.nrows();
    let mut e = vec![0.0; p];
    let mut size = |t: usize| {
        e.copy_from_slice(&series[t * p..(t + 1) * p]);
        for (k, a) in coefficients.iter().enumerate() {
            // Backwards: the samples to come are the past. Beyond the end nothing is known.
            let Some(later) = series.get((t + k + 1) * p..(t + k + 2) * p) else { return f64::NAN };
            for (i, slot) in e.iter_mut().enumerate() {
                *slot -= later.iter().enumerate().map(|(j, v)| a[(i, j)] * v).sum::<f64>();
            }
        }
        for i in 0..p {
            let known: f64 = (0..i).map(|j| root[(i, j)] * e[j]).sum();
            e[i] = (e[i] - known) / root[(i, i)];
        }
        if p == 1 { e[0] } else { (e.iter().map(|v| v * v).sum::<f64>() / p as f64).sqrt() }
    };
    (0..series.len() / p.max(1)).map(&mut size).collect()
}

/// Autocovariances of series with gaps.
struct Moments<'a> {
    series: &'a [Vec<f64>],
    outputs: usize,
    /// Instants with a residual.
    rows: usize,
}

impl<'a> Moments<'a> {
    fn new(series: &'a [Vec<f64>], outputs: usize) -> Self {
        let rows = series.iter().flat_map(|s| s.chunks_exact(outputs)).filter(|v| !v[0].is_nan()).count();
        Moments { series, outputs, rows }
    }

    fn lags(&self) -> usize {
        let usual = (LAGS_PER_DECADE * (self.rows.max(1) as f64).log10()) as usize;
        usual.min(self.rows / (ROWS_PER_COEFFICIENT * self.outputs.max(1)))
    }

    /// `E v(t) v(t−lag)ᵀ`, the mean over the pairs there are, with the taper that makes it a covariance without gaps.
    fn at(&self, lag: usize) -> Mat<f64> {
        let (p, mut sums) = (self.outputs, vec![0.0; self.outputs * self.outputs]);
        let (mut pairs, mut places, mut all) = (0_usize, 0_usize, 0_usize);
        for series in self.series {
            all += series.len() / p;
            let Some(later) = series.get(lag * p..) else { continue };
            places += later.len() / p;
            for (now, before) in later.chunks_exact(p).zip(series.chunks_exact(p)) {
                if now[0].is_nan() || before[0].is_nan() {
                    continue;
                }
                pairs += 1;
                for (sums, v) in sums.chunks_exact_mut(p).zip(now) {
                    sums.iter_mut().zip(before).for_each(|(s, w)| *s += v * w);
                }
            }
        }
        // In this order lest the product of two counts overflows.
        let scale = places as f64 / pairs.max(1) as f64 / all.max(1) as f64;
        Mat::from_fn(p, p, |i, j| scale * sums[i * p + j])
    }

    /// The autocovariance of the series read backwards.
    fn reversed(&self, lag: usize) -> Mat<f64> {
        self.at(lag).transpose().to_owned()
    }
}

/// Whittle's recursion over the order of an autoregression.
struct Recursion {
    moments: Vec<Mat<f64>>,
    forward: Vec<Mat<f64>>,
    backward: Vec<Mat<f64>>,
    forward_error: Mat<f64>,
    backward_error: Mat<f64>,
}

impl Recursion {
    fn new(variance: Mat<f64>) -> Self {
        Recursion {
            forward: Vec::new(),
            backward: Vec::new(),
            forward_error: variance.clone(),
            backward_error: variance.clone(),
            moments: vec![variance],
        }
    }

    /// Takes in the autocovariance at the next lag.
    fn extend(&mut self, moment: &Mat<f64>) {
        let order = self.forward.len();
        self.moments.push(moment.clone());
        let explained = self.forward.iter().enumerate().map(|(k, a)| a * &self.moments[order - k]);
        let cross = explained.fold(moment.clone(), |left, part| left - part);
        let forward = &cross * linalg::inverse(self.backward_error.as_ref());
        let backward = cross.transpose() * linalg::inverse(self.forward_error.as_ref());
        let (old_forward, old_backward) = (self.forward.clone(), self.backward.clone());
        for k in 0..order {
            self.forward[k] -= &forward * &old_backward[order - 1 - k];
            self.backward[k] -= &backward * &old_forward[order - 1 - k];
        }
        self.forward_error -= &forward * cross.transpose();
        self.backward_error -= &backward * &cross;
        self.forward.push(forward);
        self.backward.push(backward);
    }
}

/// `JᵀRJ`, gathered row by row: with `R` that of an autoregression it is the sum of squares of the columns of `J` put
/// through the autoregression's filter.
pub(crate) struct Sandwich<'a> {
    colour: &'a Colour,
    /// `U` with `U Uᵀ = (JᵀJ)⁻¹`: in these directions all is well scaled. None where the rows are taken as they are.
    unit: Option<Mat<f64>>,
    directions: usize,
    /// The filter's latest outputs, outputs × directions by rows, the next to be overwritten at `head`.
    past: Vec<Vec<f64>>,
    head: usize,
    /// Series that have ended, and instants of the present one.
    ended: usize,
    pushed: usize,
    largest: f64,
    /// One row of `Lᵀ z`.
    weighed: Vec<f64>,
    /// `Σ zᵀ L Lᵀ z` by rows.
    sum: Vec<f64>,
}

impl<'a> Sandwich<'a> {
    /// Of an estimate with this `(JᵀJ)⁻¹`, zero in rows and columns of parameters that were held.
    ///
    /// # Errors
    /// [`IdentError::Decomposition`].
    pub(crate) fn new(colour: &'a Colour, inverse_information: &Mat<f64>) -> Result<Self, IdentError> {
        Ok(Self::with_unit(colour, root(inverse_information)?))
    }

    /// Of an estimate whose `(JᵀJ)⁻¹` is `unit unitᵀ`.
    pub(crate) fn with_unit(colour: &'a Colour, unit: Mat<f64>) -> Self {
        let directions = unit.ncols();
        Self::with(colour, Some(unit), directions)
    }

    /// Of `JᵀRJ` itself, for rows of so many columns of about the same size.
    pub(crate) fn of_rows(colour: &'a Colour, columns: usize) -> Self {
        Self::with(colour, None, columns)
    }

    fn with(colour: &'a Colour, unit: Option<Mat<f64>>, directions: usize) -> Self {
        let outputs = colour.root.nrows();
        let past = vec![vec![0.0; outputs * directions]; colour.coefficients.len() + 1];
        let (weighed, sum) = (vec![0.0; directions], vec![0.0; directions * directions]);
        Sandwich { colour, unit, directions, past, head: 0, ended: 0, pushed: 0, largest: 0.0, weighed, sum }
    }

    /// Takes the rows of `J` at the next instant, outputs × parameters by rows; zeros where there is no residual.
    pub(crate) fn push(&mut self, rows: &[f64]) {
        let (outputs, directions) = (self.colour.root.nrows(), self.directions);
        let mut z = std::mem::take(&mut self.past[self.head]);
        match &self.unit {
            None => z.copy_from_slice(rows),
            Some(unit) => {
                let places = z.chunks_exact_mut(directions.max(1));
                for (row, slot) in rows.chunks_exact(rows.len() / outputs.max(1)).zip(places) {
                    for (k, value) in slot.iter_mut().enumerate() {
                        *value = row.iter().zip(unit.col(k).iter()).map(|(j, u)| j * u).sum();
                    }
                }
            }
        }
        self.filter(&mut z);
        self.gather(&z);
        self.largest = z.iter().fold(self.largest, |largest, v| largest.max(v.abs()));
        self.past[self.head] = z;
        self.head = (self.head + 1) % self.past.len();
        self.pushed += 1;
    }

    /// `z(t) = x(t) + Σ A_kᵀ z(t−k)`, in place.
    fn filter(&self, z: &mut [f64]) {
        let (count, directions) = (self.past.len(), self.directions.max(1));
        for (k, a) in self.colour.coefficients.iter().enumerate() {
            let before = &self.past[(self.head + count - 1 - k) % count];
            for (i, slot) in z.chunks_exact_mut(directions).enumerate() {
                for (l, from) in before.chunks_exact(directions).enumerate() {
                    let weight = a[(l, i)];
                    slot.iter_mut().zip(from).for_each(|(s, v)| *s += weight * v);
                }
            }
        }
    }

    /// Adds `zᵀ L Lᵀ z`, times the variance of the instant.
    fn gather(&mut self, z: &[f64]) {
        let course = self.colour.course.as_ref().and_then(|course| course.get(self.ended)?.get(self.pushed));
        let variance = course.copied().unwrap_or(1.0);
        let (outputs, directions) = (self.colour.root.nrows(), self.directions.max(1));
        for l in 0..outputs {
            self.weighed.fill(0.0);
            for (i, row) in z.chunks_exact(directions).enumerate().skip(l) {
                let weight = self.colour.root[(i, l)];
                self.weighed.iter_mut().zip(row).for_each(|(w, v)| *w += weight * v);
            }
            for (a, row) in self.weighed.iter().zip(self.sum.chunks_exact_mut(directions)) {
                row.iter_mut().zip(&self.weighed).for_each(|(s, b)| *s += variance * a * b);
            }
        }
    }

    /// Ends a series: lets the filter die away, for at most as long as the series was, and starts afresh.
    pub(crate) fn finish_series(&mut self) {
        let columns = self.unit.as_ref().map_or(self.directions, Mat::nrows);
        let silence = vec![0.0; columns * self.colour.root.nrows()];
        for _ in 0..self.pushed {
            if self.past.iter().flatten().all(|v| v.abs() <= DECAYED * self.largest) {
                break;
            }
            self.push(&silence);
        }
        self.past.iter_mut().for_each(|z| z.fill(0.0));
        (self.ended, self.pushed, self.largest) = (self.ended + 1, 0, 0.0);
    }

    /// `U Uᵀ (JᵀRJ) U Uᵀ`; `JᵀRJ` of rows taken as they are.
    pub(crate) fn covariance(&self) -> Mat<f64> {
        let middle = MatRef::from_row_major_slice(&self.sum, self.directions, self.directions);
        match &self.unit {
            None => middle.to_owned(),
            Some(unit) => unit * middle * unit.transpose(),
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use faer::mat;
    use signal::excitation::Random;

    use super::*;

    /// Two outputs of a vector autoregression with a correlation that looks different backwards, and its
    /// `R(0), R(1), …` by summing the responses.
    fn coloured(samples: usize) -> (Vec<f64>, Vec<Mat<f64>>) {
        let a = mat![[0.7, 0.4], [-0.3, 0.5]];
        let root = mat![[1.0, 0.0], [0.5, 0.8]];
        let mut random = Random::new(3);
        let (mut v, mut series) = (Mat::<f64>::zeros(2, 1), Vec::new());
        for t in 0..samples + 200 {
            let e = Mat::from_fn(2, 1, |_, _| random.normal());
            v = &a * v + &root * e;
            if t >= 200 {
                series.extend([v[(0, 0)], v[(1, 0)]]);
            }
        }
        let mut variance = Mat::<f64>::zeros(2, 2);
        let mut power = Mat::<f64>::identity(2, 2);
        for _ in 0..400 {
            variance += &power * &root * root.transpose() * power.transpose();
            power = &a * power;
        }
        let mut moments = vec![variance];
        for lag in 1..60 {
            moments.push(&a * &moments[lag - 1]);
        }
        (series, moments)
    }

    /// Jᵀ R J with R written out.
    fn dense(j: &[Vec<f64>], moments: &[Mat<f64>]) -> f64 {
        let at = |t: usize, s: usize, a: usize, b: usize| match t.checked_sub(s) {
            Some(lag) => moments[lag][(a, b)],
            None => moments[s - t][(b, a)],
        };
        let indices = || (0..j.len()).flat_map(|t| (0..2).map(move |a| (t, a)));
        indices()
            .flat_map(|p| indices().map(move |q| (p, q)))
            .map(|((t, a), (s, b))| j[t][a] * at(t, s, a, b) * j[s][b])
            .sum()
    }

    #[test]
    fn exact_filtered_rows_equal_the_covariance_written_out() {
        let (series, moments) = coloured(400_000);
        let colour = Colour::of(&[series], 2);
        assert!(!colour.is_white());
        let mut recursion = Recursion::new(moments[0].clone());
        recursion.extend(&moments[1].transpose().to_owned());
        let lower = Cholesky::new(recursion.forward_error.as_ref()).unwrap().lower().to_owned();
        let known =
            Colour { coefficients: recursion.forward, root: lower, moments: recursion.moments, rows: 0, course: None };
        for (lag, found) in known.autocovariances(40).iter().enumerate() {
            assert!((found - &moments[lag]).norm_max() < 1e-9, "{lag}");
        }
        let j: Vec<Vec<f64>> =
            (0..50).map(|t| vec![(0.3 * f64::from(t)).sin(), if t % 7 == 0 { 0.0 } else { 1.0 }]).collect();
        let wanted = dense(&j, &moments);
        for (colour, tolerance) in [(&known, 1e-9), (&colour, 0.02)] {
            let mut sandwich = Sandwich::with_unit(colour, Mat::identity(1, 1));
            for _ in 0..2 {
                j.iter().for_each(|row| sandwich.push(row));
                sandwich.finish_series();
            }
            let found = sandwich.covariance()[(0, 0)] / 2.0;
            assert!((found / wanted - 1.0).abs() < tolerance, "{found} {wanted}");
        }
    }

    #[test]
    fn stat_white_errors_are_mostly_taken_for_white_and_gaps_do_not_matter() {
        let mut random = Random::new(8);
        let white = (0..100).filter(|_| {
            let series: Vec<f64> = (0..500).map(|_| random.normal()).collect();
            Colour::of(&[series], 1).is_white()
        });
        assert!(white.count() > 50);
        let (series, _) = coloured(20_000);
        let one: Vec<f64> = series.iter().step_by(2).copied().collect();
        let mut gappy = one.clone();
        gappy.iter_mut().step_by(5).for_each(|v| *v = f64::NAN);
        let level = |series: &[f64]| {
            let colour = Colour::of(&[series.to_vec()], 1);
            colour.root[(0, 0)] / (1.0 - colour.coefficients.iter().map(|a| a[(0, 0)]).sum::<f64>())
        };
        let ratio = level(&gappy) / level(&one);
        assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
        assert!(Colour::of(&[vec![0.0; 50]], 1).is_white() && Colour::of(&[], 2).is_white());
    }
}
