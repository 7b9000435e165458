//! Tests of whether inputs follow the residuals of a model.

use faer::{Mat, MatRef};
use numerics::vector::variation;

use crate::advice::repeats_exactly;
use crate::data::regression::{Lagged, Regression, Signals};
use crate::distributions::f_tail;
use crate::prediction::{InitialState, residuals};
use crate::{Dataset, Doubt, Fit, LinearModel};

/// Past and future samples looked at, and past samples of an input that its own future is predicted from.
const LAGS: isize = 10;
const OWN_LAGS: isize = 20;

/// The probability of finding feedback in data without any, for all channels together.
const FALSE_ALARMS: f64 = 1e-3;

/// Parts of a residual and of an input below these do not count: the bias is small then, and what a model of a wrong
/// order leaves under an input that is predictable, such as a multisine, looks like that.
const OF_RESIDUAL: f64 = 5e-3;
const OF_INPUT: f64 = 1e-3;

/// Rows looked at, at most: feedback that so many do not show makes no bias that matters.
const MOST_ROWS: usize = 100_000;

impl<M: LinearModel> Fit<M> {
    /// The same with the inputs that follow its residuals, for a method that takes inputs for independent of the noise.
    /// Where there are no residuals nothing is doubted.
    pub(crate) fn doubting_feedback(mut self, data: &Dataset) -> Self {
        let initial = InitialState::Given(self.initial_states.clone());
        let form = self.model.innovations(data.sample_time_s(), data.intersample());
        if let (Ok(errors), Ok(form)) = (residuals(&self.model, data, &initial), form) {
            self.doubts.extend(found_in(&errors.outputs, data, form.system().d()));
        }
        self
    }
}

/// The inputs that follow the residual of an output (samples × outputs for each experiment), and those that go with it
/// in the same sample where the model has no direct way, `direct` being zero.
///
/// Future inputs explain the residual beyond what its own past and present and past inputs do, and the residual
/// explains the input beyond what the input's own past does. In open loop they cannot, however the inputs are made. An
/// input that repeats without noise is in open loop. The input of the same sample explains it beyond past inputs where
/// a controller without delay acts, or where the input acts at once: data cannot separate the two.
///
/// # Source
/// Sims, *Money, income, and causality*, Am. Econ. Rev. 62, 1972; Geweke, Meese & Dent, *Comparing alternative tests of
/// causality in temporal systems*, J. Econometrics 21, 1983.
fn found_in(errors: &[Mat<f64>], data: &Dataset, direct: MatRef<'_, f64>) -> Vec<Doubt> {
    let (outputs, inputs) = (data.outputs(), data.inputs());
    let level = FALSE_ALARMS / (outputs * inputs).max(1) as f64;
    let is_open: Vec<bool> = (0..inputs).map(|k| repeats_exactly(data, k)).collect();
    let most = MOST_ROWS / data.experiments().len().max(1);
    let mut found = Vec::new();
    for output in 0..outputs {
        let records = errors.iter().zip(data.experiments());
        let signals: Signals<'_> = records
            .map(|(e, of)| {
                let all = std::iter::once(e.col_as_slice(output)).chain((0..inputs).map(|k| of.input(k)));
                all.map(|x| &x[..x.len().min(most)]).collect()
            })
            .collect();
        for input in (0..inputs).filter(|k| !is_open[*k]) {
            if follows(&signals, inputs, input + 1, level) {
                found.push(Doubt::Feedback { output, input });
            } else if direct[(output, input)] == 0.0 && goes_with(&signals, inputs, input + 1, level) {
                found.push(Doubt::WithinSample { output, input });
            }
        }
    }
    found
}

/// Returns true if an input, by its place among the signals, follows the first signal.
fn follows(signals: &Signals<'_>, inputs: usize, input: usize, level: f64) -> bool {
    let past_and_present = Lagged::each(0, 1..=LAGS).chain((1..=inputs).flat_map(|k| Lagged::each(k, 0..=LAGS)));
    let future = Lagged::each(input, (1..=LAGS).map(|lead| -lead)).collect();
    let of_residual = Explained::new(signals, past_and_present.collect(), future, Lagged::new(0, 0));
    let own = Lagged::each(input, 1..=OWN_LAGS).collect();
    let of_input = Explained::new(signals, own, Lagged::each(0, 0..=LAGS).collect(), Lagged::new(input, 0));
    [(of_residual, OF_RESIDUAL), (of_input, OF_INPUT)]
        .iter()
        .all(|(explained, least)| explained.as_ref().is_some_and(|e| e.share > *least && e.p_value < level))
}

/// Returns true if an input, by its place among the signals, explains the first signal of the same sample beyond all
/// others.
fn goes_with(signals: &Signals<'_>, inputs: usize, input: usize, level: f64) -> bool {
    let past = Lagged::each(0, 1..=LAGS).chain((1..=inputs).flat_map(|k| Lagged::each(k, 1..=LAGS)));
    let others = (1..=inputs).filter(|k| *k != input).map(|k| Lagged::new(k, 0));
    let explained =
        Explained::new(signals, past.chain(others).collect(), vec![Lagged::new(input, 0)], Lagged::new(0, 0));
    explained.is_some_and(|e| e.share > OF_RESIDUAL && e.p_value < level)
}

/// Part of a target that some columns explain beyond others.
struct Explained {
    /// Of the target's variation.
    share: f64,
    p_value: f64,
}

impl Explained {
    /// `None` where the rows are too few.
    fn new(signals: &Signals<'_>, known: Vec<Lagged>, further: Vec<Lagged>, target: Lagged) -> Option<Self> {
        let (first, last) = (known.len(), known.len() + further.len());
        let regression = Regression::new(signals, [known, further, vec![target]].concat());
        if regression.rows < 3 * (last + 1) {
            return None;
        }
        let factor = regression.factor();
        let explained: f64 = (first..last).map(|i| factor[(i, last)].powi(2)).sum();
        let (count, freedom) = ((last - first) as f64, (regression.rows - last) as f64);
        let whole: f64 = signals.iter().filter_map(|record| variation(|| record[target.signal].iter().copied())).sum();
        let statistic = explained / count / (factor[(last, last)].powi(2) / freedom);
        Some(Explained { share: explained / whole, p_value: f_tail(statistic, count, freedom) })
    }
}
