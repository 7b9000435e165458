//! Filters on inputs and outputs alike: differences and prefilters.

use faer::Mat;
use lti::{LtiError, TransferFunction};
use signal::Sos;

use super::{Dataset, Experiment, column};
use crate::IdentError;
use fitting::{StructureError, UnstablePart};

/// A filter `L(q)` for all channels.
#[derive(Debug, Clone, PartialEq)]
pub enum Prefilter {
    /// Second-order sections, such as [`Sos::butterworth_bandpass`].
    Sections(Sos),
    /// A ratio of polynomials in `z`.
    Ratio(TransferFunction),
}

impl From<Sos> for Prefilter {
    fn from(sections: Sos) -> Self {
        Prefilter::Sections(sections)
    }
}

impl From<TransferFunction> for Prefilter {
    fn from(ratio: TransferFunction) -> Self {
        Prefilter::Ratio(ratio)
    }
}

impl Dataset {
    /// Inputs and outputs filtered alike by a causal, stable `L(q)`, which starts as if each channel had stood at its
    /// first value for ever.
    ///
    /// The way from input to output stays as it is: `L y = G L u + (L H) e`. **The noise model is multiplied by `L`**:
    /// a model with fixed noise model, such as output error, is fitted with the weight `|L|²` over frequency; one with
    /// a free noise model estimates `L H` and largely undoes the weight.
    ///
    /// # Errors
    /// [`LtiError::SampleTimesDiffer`] for a filter of another clock; [`IdentError::Missing`]: fill the gaps or split
    /// the data there; [`IdentError::Structure`] for an unstable ratio; [`LtiError::DelayPresent`],
    /// [`LtiError::Improper`].
    ///
    /// # Example
    /// ```
    /// let data = ident::Dataset::siso(0.01, &[1.0; 50], &[3.0; 50])?;
    /// let high = signal::Sos::butterworth_highpass(2, 1.0, 0.01)?;
    /// assert!(data.prefilter(high)?.experiments()[0].output(0)[10].abs() < 1e-12);
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    ///
    /// # Source
    /// Ljung 1999, §14.4.
    pub fn prefilter(&self, filter: impl Into<Prefilter>) -> Result<Self, IdentError> {
        self.refuse_missing()?;
        match filter.into() {
            Prefilter::Sections(sos) => {
                crate::data::check_clock(sos.sample_time_s(), self.sample_time_s)?;
                self.map_columns(|x| Ok(sos.filter(x, &mut sos.state_at_level(x.first().copied().unwrap_or(0.0)))))
            }
            Prefilter::Ratio(ratio) => {
                let (num, den) = checked_ratio(&ratio, self.sample_time_s)?;
                self.map_columns(|x| Ok(filter_ratio(&num, &den, x)))
            }
        }
    }

    /// The change of every channel from sample to sample, `x(t) − x(t−1)`; the first row of each experiment is spent.
    ///
    /// As with [`Dataset::prefilter`] the noise model is multiplied, here by `1 − q⁻¹`: white measurement noise becomes
    /// coloured and strong at high frequencies, noise that drifts like a random walk becomes white. A missing sample
    /// costs two.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`] where no experiment has two rows.
    ///
    /// # Source
    /// Ljung 1999, §14.1.
    pub fn difference(&self) -> Result<Self, IdentError> {
        let later = self.rows(1..usize::MAX)?;
        let mut long = self.experiments.iter().filter(|e| e.len() > 1);
        later.map_experiments(|e| {
            let whole = long.next().unwrap_or(e);
            let change = |m: &Mat<f64>| Mat::from_fn(e.len(), m.ncols(), |i, j| m[(i + 1, j)] - m[(i, j)]);
            Ok(Experiment { inputs: change(&whole.inputs), outputs: change(&whole.outputs), ..e.clone() })
        })
    }

    /// Every channel replaced by what `change` makes of it; all of an experiment must come out equally long.
    pub(super) fn map_columns(
        &self,
        mut change: impl FnMut(&[f64]) -> Result<Vec<f64>, IdentError>,
    ) -> Result<Self, IdentError> {
        self.map_experiments(|e| {
            let mut matrix = |m: &Mat<f64>| {
                let columns: Vec<_> =
                    (0..m.ncols()).map(|j| change(column(m.as_ref(), j))).collect::<Result<_, IdentError>>()?;
                let rows = columns.first().map_or(0, Vec::len);
                Ok::<_, IdentError>(Mat::from_fn(rows, columns.len(), |i, j| columns[j][i]))
            };
            let outputs = matrix(&e.outputs)?;
            let inputs = if e.inputs.ncols() == 0 { Mat::zeros(outputs.nrows(), 0) } else { matrix(&e.inputs)? };
            Ok(Experiment { name: e.name.clone(), start_s: e.start_s, inputs, outputs })
        })
    }
}

/// Numerator and denominator in ascending powers of q⁻¹, equally long, the denominator monic.
fn checked_ratio(ratio: &TransferFunction, sample_time_s: f64) -> Result<(Vec<f64>, Vec<f64>), IdentError> {
    let Some(clock_s) = ratio.sample_time_s() else {
        return Err(LtiError::NotDiscrete.into());
    };
    crate::data::check_clock(clock_s, sample_time_s)?;
    if ratio.delay_s() > 0.0 {
        return Err(LtiError::DelayPresent { delay_s: ratio.delay_s() }.into());
    }
    let (num, den) = (ratio.num(), ratio.den());
    if num.len() > den.len() {
        return Err(LtiError::Improper { numerator: num.len() - 1, denominator: den.len() - 1 }.into());
    }
    if ratio.poles()?.iter().any(|p| p.norm() >= 1.0) {
        return Err(StructureError::Unstable(UnstablePart::Prefilter).into());
    }
    let padded = std::iter::repeat_n(0.0, den.len() - num.len()).chain(num.iter().copied());
    Ok((padded.map(|b| b / den[0]).collect(), den.iter().map(|a| a / den[0]).collect()))
}

/// Transposed direct form II from the state that belongs to the first value.
fn filter_ratio(num: &[f64], den: &[f64], x: &[f64]) -> Vec<f64> {
    let order = den.len() - 1;
    let level = x.first().copied().unwrap_or(0.0);
    let at_rest = level * num.iter().sum::<f64>() / den.iter().sum::<f64>();
    let mut state = vec![0.0; order + 1];
    for i in (0..order).rev() {
        state[i] = state[i + 1] + num[i + 1] * level - den[i + 1] * at_rest;
    }
    let step = |v: &f64| {
        let y = num[0] * v + state[0];
        for i in 0..order {
            state[i] = state[i + 1] + num[i + 1] * v - den[i + 1] * y;
        }
        y
    };
    x.iter().map(step).collect()
}
