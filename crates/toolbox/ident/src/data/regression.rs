//! Linear regressions whose columns are delayed signals: which rows are usable, their triangular factor, their scores.

use std::ops::Range;

use faer::Mat;
use numerics::parallel;
use numerics::vector::{dot, variation};

use crate::least_squares::{LinearFit, solve_factor};
use crate::{Dataset, IdentError, Triangle};
use fitting::equation::{Equation, Solution};

/// Multiplications from which a second thread pays.
const WORTH_A_THREAD: usize = 4_000_000;
/// Rows worked on at a time: a few columns of them stay in the cache.
const CHUNK: usize = 2048;

/// A column of a regression: `signal(t − lag)`; a negative lag reads ahead.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Lagged {
    pub(crate) signal: usize,
    pub(crate) lag: isize,
}

impl Lagged {
    pub(crate) fn new(signal: usize, lag: isize) -> Self {
        Lagged { signal, lag }
    }

    /// `signal(t − lag)` for each of these lags, one after the other.
    pub(crate) fn each(signal: usize, lags: impl IntoIterator<Item = isize>) -> impl Iterator<Item = Self> {
        lags.into_iter().map(move |lag| Lagged { signal, lag })
    }

    /// Where the samples of rows from `row` on begin. Rows are chosen so that none begins before the first sample.
    fn first(self, row: usize) -> usize {
        row.wrapping_add_signed(-self.lag)
    }
}

/// The signals of every experiment as slices: for each experiment, one slice a signal.
pub(crate) type Signals<'a> = Vec<Vec<&'a [f64]>>;

/// The outputs of a dataset, then its inputs.
pub(crate) fn outputs_then_inputs(data: &Dataset) -> Signals<'_> {
    let outputs = data.outputs();
    let signal = |e, s| {
        let e: &crate::Experiment = e;
        if s < outputs { e.output(s) } else { e.input(s - outputs) }
    };
    data.experiments().iter().map(|e| (0..outputs + data.inputs()).map(|s| signal(e, s)).collect()).collect()
}

/// Rows `range` of one experiment, each with all that its columns read and without a missing sample.
#[derive(Debug, Clone)]
struct Stretch {
    experiment: usize,
    range: Range<usize>,
}

/// A regression over all rows of all experiments in which no column reaches beyond its ends or touches a missing
/// sample.
pub(crate) struct Regression<'a> {
    signals: &'a Signals<'a>,
    columns: Vec<Lagged>,
    stretches: Vec<Stretch>,
    /// Usable rows.
    pub(crate) rows: usize,
    /// Rows with all that their columns read, whether samples are missing or not.
    pub(crate) candidates: usize,
}

impl<'a> Regression<'a> {
    pub(crate) fn new(signals: &'a Signals<'a>, columns: Vec<Lagged>) -> Self {
        let first = columns.iter().map(|c| c.lag.max(0).unsigned_abs()).max().unwrap_or(0);
        let ahead = columns.iter().map(|c| c.lag.min(0).unsigned_abs()).max().unwrap_or(0);
        let mut regression = Regression { signals, columns, stretches: Vec::new(), rows: 0, candidates: 0 };
        for (experiment, record) in signals.iter().enumerate() {
            let end = record.first().map_or(0, |s| s.len()).saturating_sub(ahead);
            regression.candidates += end.saturating_sub(first);
            for range in usable_rows(record, &regression.columns, first..end) {
                regression.rows += range.len();
                regression.stretches.push(Stretch { experiment, range });
            }
        }
        regression
    }

    /// The triangular factor of all columns, read once.
    pub(crate) fn factor(&self) -> Mat<f64> {
        let columns = self.columns.len();
        if self.rows.saturating_mul(columns * columns) < WORTH_A_THREAD {
            return self.gather(0..self.rows).finish();
        }
        // Always the same two halves, whatever the machine: the same data give the same numbers everywhere.
        let half = self.rows / 2;
        let (mut first, second) = parallel::join(|| self.gather(0..half), || self.gather(half..self.rows));
        first.merge(second);
        first.finish()
    }

    /// The last column in terms of the others.
    ///
    /// # Errors
    /// Those of [`solve_factor`].
    pub(crate) fn least_squares(&self) -> Result<LinearFit, IdentError> {
        let parameters = self.columns.len().saturating_sub(1);
        if self.rows <= parameters {
            return Err(IdentError::TooFewSamples { samples: self.rows, parameters });
        }
        solve_factor(&self.factor(), self.rows)
    }

    /// The norm of each of these columns about its mean; none of a column that does not vary.
    pub(crate) fn spreads(&self, columns: Range<usize>) -> Vec<Option<f64>> {
        let samples = |j| self.stretches.iter().flat_map(move |s| self.column(j, s).iter().copied());
        columns.map(|j| variation(|| samples(j)).map(f64::sqrt)).collect()
    }

    fn gather(&self, rows: Range<usize>) -> Triangle {
        let mut triangle = Triangle::for_rows(self.columns.len(), rows.len());
        for Stretch { experiment, range } in self.within(rows) {
            let record = &self.signals[experiment];
            triangle.push_columns(range.len(), |j, start, target| {
                let column = self.columns[j];
                let from = column.first(range.start + start);
                target.copy_from_slice(&record[column.signal][from..from + target.len()]);
            });
        }
        triangle
    }

    /// The stretches that make up these rows, counted over all stretches.
    fn within(&self, rows: Range<usize>) -> impl Iterator<Item = Stretch> + '_ {
        let mut before = 0;
        self.stretches.iter().filter_map(move |Stretch { experiment, range }| {
            let (from, to) = (before.max(rows.start), (before + range.len()).min(rows.end));
            let offset = range.start;
            let start = before;
            before += range.len();
            (from < to).then(|| Stretch { experiment: *experiment, range: offset + from - start..offset + to - start })
        })
    }

    fn column(&self, index: usize, stretch: &Stretch) -> &'a [f64] {
        let column = self.columns[index];
        let from = column.first(stretch.range.start);
        &self.signals[stretch.experiment][column.signal][from..from + stretch.range.len()]
    }

    /// For each of `batches` stretches of equally many rows, the sum of `z(t) ε_i(t)` of every equation, one below the
    /// other: rows are instruments, columns batches.
    pub(crate) fn batched_scores(&self, equations: &[(&Equation, &[f64])], batches: usize) -> Mat<f64> {
        let count = equations.iter().map(|(e, _)| e.instruments.len()).sum();
        let mut scores = Mat::zeros(count, batches);
        let mut errors = vec![0.0; CHUNK];
        for batch in 0..batches {
            let rows = batch * self.rows / batches..(batch + 1) * self.rows / batches;
            for stretch in self.within(rows).flat_map(in_chunks) {
                work::checkpoint();
                let mut top = 0;
                for (equation, theta) in equations {
                    let errors = &mut errors[..stretch.range.len()];
                    self.write_errors(equation, theta, &stretch, errors);
                    for (k, z) in equation.instruments.iter().enumerate() {
                        scores[(top + k, batch)] += dot(self.column(*z, &stretch), errors);
                    }
                    top += equation.instruments.len();
                }
            }
        }
        scores
    }

    fn write_errors(&self, equation: &Equation, theta: &[f64], stretch: &Stretch, errors: &mut [f64]) {
        errors.copy_from_slice(self.column(equation.target, stretch));
        for (j, value) in equation.regressors.iter().zip(theta) {
            self.column(*j, stretch).iter().zip(errors.iter_mut()).for_each(|(x, e)| *e -= value * x);
        }
    }
}

fn in_chunks(stretch: Stretch) -> impl Iterator<Item = Stretch> {
    let Stretch { experiment, range } = stretch;
    range.clone().step_by(CHUNK).map(move |start| Stretch { experiment, range: start..(start + CHUNK).min(range.end) })
}

/// The rows of `range` in which no column touches a missing sample.
fn usable_rows(record: &[&[f64]], columns: &[Lagged], range: Range<usize>) -> Vec<Range<usize>> {
    if range.is_empty() {
        return Vec::new();
    }
    // Starts and ends of blocked rows; allocated only where something is missing.
    let mut change: Vec<i64> = Vec::new();
    for (signal, samples) in record.iter().enumerate() {
        let runs = lag_runs(columns, signal);
        if runs.is_empty() || !has_missing(samples) {
            continue;
        }
        change.resize(range.end + 1, 0);
        for s in (0..samples.len()).filter(|s| samples[*s].is_nan()) {
            let blocked = |lag: isize| s.saturating_add_signed(lag).min(range.end);
            for (low, high) in &runs {
                change[blocked(*low)] += 1;
                change[blocked(high + 1)] -= 1;
            }
        }
    }
    if change.is_empty() { vec![range] } else { unblocked(&change, range) }
}

/// The first and the last of each run of neighbouring lags of a signal: between the past values of a slow signal others
/// may be missing.
fn lag_runs(columns: &[Lagged], signal: usize) -> Vec<(isize, isize)> {
    let mut lags: Vec<isize> = columns.iter().filter(|c| c.signal == signal).map(|c| c.lag).collect();
    lags.sort_unstable();
    lags.dedup();
    lags.chunk_by(|a, b| b - a == 1).filter_map(|run| Some((*run.first()?, *run.last()?))).collect()
}

/// Returns true if a sample is NaN; checks a chunk at a time, so that the inner loop has no branch.
fn has_missing(samples: &[f64]) -> bool {
    samples.chunks(CHUNK).any(|chunk| chunk.iter().fold(false, |found, v| found | v.is_nan()))
}

fn unblocked(change: &[i64], range: Range<usize>) -> Vec<Range<usize>> {
    let mut ranges = Vec::new();
    let mut blocked: i64 = change[..range.start].iter().sum();
    let mut open = None;
    for t in range.clone() {
        blocked += change[t];
        match (blocked == 0, open) {
            (true, None) => open = Some(t),
            (false, Some(start)) => {
                ranges.push(start..t);
                open = None;
            }
            _ => {}
        }
    }
    ranges.extend(open.map(|start| start..range.end));
    ranges
}

/// The covariance of all parameters, equation by equation, whatever the colour of the errors: the sandwich whose middle
/// is made of the sums of `z(t) ε(t)` over `batches` stretches of equally many rows. Student's t with `batches − 1`
/// degrees of freedom goes with it.
///
/// # Errors
/// [`IdentError::TooFewSamples`] for fewer than two batches, or batches shorter than there are parameters.
///
/// # Source
/// Ljung 1999, §9.2; Ibragimov & Müller 2010 for the use of batches.
pub(crate) fn robust_covariance(
    regression: &Regression<'_>,
    equations: &[Equation],
    solutions: &[Solution],
    batches: usize,
) -> Result<Mat<f64>, IdentError> {
    let widest = solutions.iter().map(|s| s.theta.len()).max().unwrap_or(0);
    if batches < 2 || regression.rows / batches <= widest {
        let parameters = batches.max(2).saturating_mul(widest);
        return Err(IdentError::TooFewSamples { samples: regression.rows, parameters });
    }
    let pairs: Vec<_> = equations.iter().zip(solutions).map(|(e, s)| (e, s.theta.as_slice())).collect();
    let scores = regression.batched_scores(&pairs, batches);
    let count = solutions.iter().map(|s| s.theta.len()).sum();
    let mut deviations = Mat::<f64>::zeros(count, batches);
    let (mut top, mut from) = (0, 0);
    for Solution { gain, .. } in solutions {
        let part = gain * scores.get(from..from + gain.ncols(), ..);
        deviations.get_mut(top..top + gain.nrows(), ..).copy_from(part);
        top += gain.nrows();
        from += gain.ncols();
    }
    // The deviations add up to zero at the estimate: one degree of freedom is spent on that.
    let share = batches as f64 / (batches as f64 - 1.0);
    Ok(faer::Scale(share) * (&deviations * deviations.transpose()))
}
