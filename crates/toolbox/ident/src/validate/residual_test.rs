//! Tests of residuals: are they white, and do they depend on an input?

use std::borrow::Cow;

use faer::Mat;

use super::JointTest;
use super::linearised_residuals::{Columns, LinearisedResiduals};
use super::sensitivity::{self, Stack};
use super::series::{Series, pair_counts};
use super::whiteness::PastSums;
use crate::distributions::normal_quantile;
use crate::fit::check_channels;
use crate::prediction::{InitialState, residuals};
use crate::{Dataset, Experiment, Fit, IdentError, LinearModel, Parametric};

/// How to test the residuals of a model.
///
/// # Example
/// ```
/// use ident::{Dataset, validate::ResidualTest};
/// use lti::{PolynomialEquation, PolynomialModel};
/// let mut random = signal::excitation::Random::new(1);
/// let u: Vec<f64> = (0..500).map(|_| random.normal()).collect();
/// // The truth answers after two samples, the model after one.
/// let y: Vec<f64> = (0..500).map(|t: usize| if t < 2 { 0.0 } else { u[t - 2] + 0.1 * random.normal() }).collect();
/// let equation = PolynomialEquation { b: vec![vec![1.0]], ..Default::default() };
/// let model = PolynomialModel::siso(1.0, 1, equation)?;
/// let report = ResidualTest::default().run_known(&model, &Dataset::siso(1.0, &u, &y)?)?;
/// assert!(!report.independence[0][0].dynamics.passes(0.99));
/// assert!(report.independence[0][0].feedback.passes(0.99));
/// # Ok::<(), ident::IdentError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualTest {
    /// Correlations are taken up to this lag, in samples.
    pub lags: usize,
    /// The region of each correlation holds it with this probability where there is nothing to find.
    pub level: f64,
    /// The initial state of each experiment.
    pub initial: InitialState,
    /// Of longer data, as many samples as this, in stretches spread evenly over them, or from the start of each
    /// experiment where its initial state is known; never fewer than forty times the lags. Of an estimate with many
    /// parameters fewer: time and memory are in proportion to the samples times the parameters.
    pub most_samples: usize,
}

/// Of so many samples a correlation of 0.008 is already outside its region at 99 %. What is smaller changes no model.
const MOST_SAMPLES: usize = 100_000;
/// Sensitivities that are held at once: samples times outputs times parameters.
const MOST_SENSITIVITIES: usize = 6_000_000;
/// So many samples are tested whatever they cost. A correlation of 0.012 is then outside its region at 99 %.
const ENOUGH_SAMPLES: usize = 50_000;
/// Least samples for each lag.
const SAMPLES_PER_LAG: usize = 40;

impl Default for ResidualTest {
    fn default() -> Self {
        ResidualTest { lags: 25, level: 0.99, initial: InitialState::Estimated, most_samples: MOST_SAMPLES }
    }
}

/// Which data the residuals of an estimate are tested on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum TestData {
    /// Those it was fitted to, or some of them.
    Own,
    /// Others, whose noise has nothing to do with the errors of the estimate.
    Unseen,
}

/// Tests of the residuals of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualReport {
    /// One test an output.
    pub whiteness: Vec<Whiteness>,
    /// Every output against the past of every output, at lags 1 to M; for one output as its own test.
    pub joint_whiteness: JointTest,
    /// Each output against each input, `[output][input]`.
    pub independence: Vec<Vec<Independence>>,
    /// Samples that were tested.
    pub samples: usize,
    /// Samples that were given.
    pub samples_given: usize,
}

/// The correlation of a residual with its own past.
#[derive(Debug, Clone, PartialEq)]
pub struct Whiteness {
    /// Mean of the residual; the correlations are taken about it.
    pub mean: f64,
    /// `r_ε(k)/r_ε(0)` for k = 0 … M, of what the parameters cannot explain in data that they were fitted to. NaN at
    /// lags at which no two samples are known.
    pub auto: Vec<f64>,
    /// Each of them after the first stays below its bound in magnitude, at the level asked for, if ε is white: k = 0 …
    /// M, NaN where there is no correlation. Narrow where the estimate leaves little.
    pub bounds: Vec<f64>,
    /// The test over lags 1 to M. With parameters that are known it is that of Ljung and Box.
    pub joint: JointTest,
}

impl Whiteness {
    /// The widest of the bounds.
    #[must_use]
    pub fn widest_bound(&self) -> f64 {
        self.bounds.iter().copied().fold(0.0, f64::max)
    }
}

/// The correlation of a residual with an input.
#[derive(Debug, Clone, PartialEq)]
pub struct Independence {
    /// `r_εu(k)/√(r_ε(0) r_u(0))` for k = −M … M, with `r_εu(k)` the mean of `ε(t) u(t − k)`, of what the parameters
    /// cannot explain in data that they were fitted to. NaN at lags at which no sample meets another.
    pub cross: Vec<f64>,
    /// Each stays below its bound in magnitude, at the level asked for, if ε does not depend on u: k = −M … M. Next to
    /// nothing where the estimate leaves no correlation, NaN where there is none.
    pub bounds: Vec<f64>,
    /// Lags 0 to M, the input's present and past: what fails here is dynamics that the model lacks.
    pub dynamics: JointTest,
    /// Lags 1 to M, the input's past alone. Where this passes and [`Independence::dynamics`] fails, the residual goes
    /// with the input of the same sample only: the input acts at once, or it follows the output within a sample.
    pub past: JointTest,
    /// Lags −M to −1, the input's future: what fails here is feedback from the output to the input.
    pub feedback: JointTest,
}

impl Independence {
    /// The widest of the bounds.
    #[must_use]
    pub fn widest_bound(&self) -> f64 {
        self.bounds.iter().copied().fold(0.0, f64::max)
    }
}

impl ResidualTest {
    /// Tests the one-step prediction errors of an estimate, on data it was fitted to or on others.
    ///
    /// Correlations are summed over the experiments, never across their borders. Missing outputs are left out, and so
    /// are lags at which no two samples are known, as those longer than every experiment: they have no degree of
    /// freedom.
    ///
    /// With `U` the lagged input, or the lagged residual for whiteness, `R` the covariance in time of the errors `v`,
    /// `Ψ` the sensitivity of the predictions to the parameters, to the initial states that are estimated here and on
    /// own data to [levels](Fit::levels) that were estimated, and `M = I − Ψ (Ψᵀ Λ⁻¹ Ψ)⁻¹ Ψᵀ Λ⁻¹` for noise of
    /// covariance `Λ`:
    /// - on [`TestData::Own`] the sums tested are `Uᵀ M ε`, of covariance `Uᵀ M R Mᵀ U`. Where ε is the smallest in the
    ///   sense of Λ, `M ε = ε`. An estimate of another kind (instruments, subspaces) is so tested as if a last step had
    ///   been taken to that minimum: what a step of the parameters explains is no missing dynamics. One that is far
    ///   from it, as by subspaces from few data, fails more often than the level says.
    /// - on [`TestData::Unseen`] they are `Uᵀ ε`, of covariance `UᵀRU + Uᵀ Ψ P Ψᵀ U` with `P` the estimate's covariance
    ///   and `Ψ` that of the parameters; the initial states estimated here are taken out as above.
    ///
    /// `R` is that of an autoregression fitted to the residuals; for whiteness, that of white errors, with `UᵀU` what
    /// it then is on average. Directions that the estimate holds have no degree of freedom: of an autoregression
    /// estimated with `n` coefficients that are forgotten within M lags, M − n are left on its own data. On unseen data
    /// its errors change no correlation on average, but all of them together by as much as chance does: `Uᵀ Ψ P Ψᵀ U`
    /// is of the order of `UᵀRU`. All this is linear in the errors of the parameters, and holds where those are small.
    /// A model of the dynamics alone has nothing that would make its residuals white.
    ///
    /// # Errors
    /// Those of [`residuals`]; [`IdentError::TooFewSamples`] under four times as many samples as lags;
    /// [`IdentError::Constant`] where a residual or an input does not vary; [`IdentError::NotFinite`] where there is no
    /// model beside the estimate.
    ///
    /// # Source
    /// Ljung 1999, §16.6; Box and Pierce, *Distribution of residual autocorrelations in autoregressive-integrated
    /// moving average time series models*, 1970, and McLeod, *On the distribution of residual autocorrelations in
    /// Box–Jenkins models*, 1978, for whiteness on own data; Neyman, *Optimal asymptotic tests of composite statistical
    /// hypotheses*, 1959, for sums that errors of the parameters leave alone. Ljung, G. M. and Box, *On a measure of
    /// lack of fit in time series models*, 1978; for several outputs Hosking, *The multivariate portmanteau statistic*,
    /// 1980.
    pub fn run<M: Parametric + LinearModel>(
        &self,
        fit: &Fit<M>,
        data: &Dataset,
        which: TestData,
    ) -> Result<ResidualReport, IdentError> {
        check_channels(&fit.model, data)?;
        let (given, part) = (data.samples(), self.part(data, fit.free_parameters * data.outputs())?);
        let data = part.as_ref();
        let predicted = residuals(&fit.model, data, &self.initial)?;
        let parameters = sensitivity::to_parameters(fit, data, &self.initial, &predicted)?;
        let errors = predicted.outputs;
        let mut columns =
            Columns { states: sensitivity::to_states(&fit.model, data, &self.initial)?, ..Columns::default() };
        match which {
            TestData::Own => {
                columns.removed = parameters;
                if !fit.levels.is_empty() {
                    columns.states = with_levels(&columns.states, &errors);
                }
            }
            TestData::Unseen => columns.uncertain = parameters,
        }
        self.report(data, given, &errors, &columns, Some(&fit.noise_covariance))
    }

    /// Tests the one-step prediction errors of a model that is not estimated: its parameters count as known.
    ///
    /// # Errors
    /// As [`ResidualTest::run`].
    pub fn run_known<M: LinearModel + ?Sized>(&self, model: &M, data: &Dataset) -> Result<ResidualReport, IdentError> {
        check_channels(model, data)?;
        let part = self.part(data, 0)?;
        let errors = residuals(model, &part, &self.initial)?.outputs;
        let states = sensitivity::to_states(model, &part, &self.initial)?;
        self.report(&part, data.samples(), &errors, &Columns { states, ..Columns::default() }, None)
    }

    /// Tests residuals that are already there: they stand as the outputs of `data`, and whatever they are of counts as
    /// known.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`], [`IdentError::Constant`] as [`ResidualTest::run`].
    pub fn run_on_residuals(&self, data: &Dataset) -> Result<ResidualReport, IdentError> {
        let part = data.excerpts(self.most(0));
        let errors: Vec<Mat<f64>> = part.experiments().iter().map(|e| e.outputs.clone()).collect();
        self.report(&part, data.samples(), &errors, &Columns::default(), None)
    }

    /// Most samples that are tested, where each has so many sensitivities.
    fn most(&self, sensitivities: usize) -> usize {
        let affordable = (MOST_SENSITIVITIES / sensitivities.max(1)).max(ENOUGH_SAMPLES);
        self.most_samples.min(affordable).max(SAMPLES_PER_LAG.saturating_mul(self.lags))
    }

    /// Part of the data that is tested, where each sample has so many sensitivities.
    fn part<'d>(&self, data: &'d Dataset, sensitivities: usize) -> Result<Cow<'d, Dataset>, IdentError> {
        let (most, all) = (self.most(sensitivities), data.samples());
        match self.initial {
            InitialState::Estimated => Ok(data.excerpts(most)),
            InitialState::Zero | InitialState::Given(_) if all <= most => Ok(Cow::Borrowed(data)),
            InitialState::Zero | InitialState::Given(_) => {
                let part = |e: &Experiment| (e.len() as f64 * (most as f64 / all as f64)).ceil() as usize;
                data.starts(part).map(Cow::Owned)
            }
        }
    }

    /// The tests on data that are part of so many samples.
    fn report(
        &self,
        data: &Dataset,
        samples_given: usize,
        errors: &[Mat<f64>],
        columns: &Columns,
        noise_covariance: Option<&Mat<f64>>,
    ) -> Result<ResidualReport, IdentError> {
        let residuals = Residuals::new(data, errors, columns, noise_covariance);
        for output in &residuals.outputs {
            let samples = output.present as usize;
            if samples < 4 * self.lags.max(1) {
                return Err(IdentError::TooFewSamples { samples, parameters: self.lags });
            }
        }
        let longest = data.experiments().iter().map(Experiment::len).max().unwrap_or(0);
        let reach = self.lags.min(longest.saturating_sub(1));
        let together = residuals.together()?;
        let past = PastSums::new(&together, &residuals.outputs, reach)?;
        let whiteness: Vec<Whiteness> =
            (0..residuals.outputs.len()).map(|i| self.whiteness(&past, i, &residuals)).collect::<Result<_, _>>()?;
        let joint_whiteness = if let [alone] = whiteness.as_slice() { alone.joint } else { past.joint()? };
        let independence = self.all_independence(&residuals, together, reach)?;
        Ok(ResidualReport { whiteness, joint_whiteness, independence, samples: data.samples(), samples_given })
    }

    fn whiteness(&self, past: &PastSums, output: usize, residuals: &Residuals<'_>) -> Result<Whiteness, IdentError> {
        let own = past.own(output)?;
        let quantile = normal_quantile(0.5 + self.level / 2.0);
        let padded = |mut values: Vec<f64>| {
            values.resize(self.lags + 1, f64::NAN);
            values
        };
        Ok(Whiteness {
            mean: residuals.outputs[output].mean,
            auto: padded(own.auto),
            bounds: padded(own.deviations.iter().map(|d| quantile * d).collect()),
            joint: own.joint,
        })
    }

    /// Every output against every input. Outputs that are there at different instants are taken one by one.
    fn all_independence(
        &self,
        residuals: &Residuals<'_>,
        together: LinearisedResiduals,
        reach: usize,
    ) -> Result<Vec<Vec<Independence>>, IdentError> {
        let outputs = &residuals.outputs;
        if residuals.inputs.is_empty() {
            return Ok(vec![Vec::new(); outputs.len()]);
        }
        let of = |linearised: &LinearisedResiduals, place: usize, i: usize| -> Result<Vec<Independence>, IdentError> {
            residuals.inputs.iter().map(|u| self.independence(linearised, place, &outputs[i], u, reach)).collect()
        };
        if residuals.meet() {
            return (0..outputs.len()).map(|i| of(&together, i, i)).collect();
        }
        drop(together);
        (0..outputs.len()).map(|i| of(&residuals.alone(i)?, 0, i)).collect()
    }

    fn independence(
        &self,
        linearised: &LinearisedResiduals,
        output: usize,
        e: &Series,
        u: &Series,
        reach: usize,
    ) -> Result<Independence, IdentError> {
        let (size_e, size_u) = (e.energy(), u.energy());
        if size_e <= 0.0 {
            return Err(IdentError::Constant { what: "the residual" });
        }
        if size_u <= 0.0 {
            return Err(IdentError::Constant { what: "an input" });
        }
        let scale = (size_e * size_u).sqrt();
        let (sums, pairs) = (linearised.sums(output, e, u, reach)?, pair_counts(u, e, reach)?);
        let quantile = normal_quantile(0.5 + self.level / 2.0);
        let at_lags = |values: &[f64]| {
            let mut all = vec![f64::NAN; 2 * self.lags + 1];
            let there = values.iter().zip(&pairs).map(|(v, n)| if *n > 0.0 { *v } else { f64::NAN });
            all[self.lags - reach..].iter_mut().zip(there).for_each(|(slot, v)| *slot = v);
            all
        };
        let bounds: Vec<f64> = sums.variances().iter().map(|v| quantile * v.sqrt() / scale).collect();
        Ok(Independence {
            bounds: at_lags(&bounds),
            dynamics: sums.test(reach, reach + 1)?,
            past: sums.test(reach + 1, reach)?,
            feedback: sums.test(0, reach)?,
            cross: at_lags(&sums.values.iter().map(|s| s / scale).collect::<Vec<_>>()),
        })
    }
}

/// The directions of initial states, and beside them a level of every output in each experiment, where the output is
/// there.
fn with_levels(states: &[Mat<f64>], errors: &[Mat<f64>]) -> Vec<Mat<f64>> {
    let of = |(states, errors): (&Mat<f64>, &Mat<f64>)| {
        let (length, count) = (errors.nrows(), states.ncols());
        let is_there = |row: usize, output: usize| row / length == output && !errors[(row % length, output)].is_nan();
        Mat::from_fn(states.nrows(), count + errors.ncols(), |row, k| match k.checked_sub(count) {
            None => states[(row, k)],
            Some(output) => f64::from(u8::from(is_there(row, output))),
        })
    };
    states.iter().zip(errors).map(of).collect()
}

/// Residuals with the inputs, and what they rest on.
struct Residuals<'a> {
    outputs: Vec<Series>,
    inputs: Vec<Series>,
    lengths: Vec<usize>,
    /// One column of them all.
    stacked: Vec<f64>,
    missing: Vec<bool>,
    columns: &'a Columns,
    noise_covariance: Mat<f64>,
}

impl<'a> Residuals<'a> {
    fn new(data: &Dataset, errors: &[Mat<f64>], columns: &'a Columns, noise: Option<&Mat<f64>>) -> Self {
        let output = |i: usize| errors.iter().map(|e| e.col_as_slice(i)).collect::<Vec<_>>();
        let input = |k: usize| data.experiments().iter().map(|e| e.input(k)).collect::<Vec<_>>();
        let outputs = data.outputs();
        let mut residuals = Residuals {
            outputs: (0..outputs).map(|i| Series::new(&output(i))).collect(),
            inputs: (0..data.inputs()).map(|k| Series::new(&input(k))).collect(),
            lengths: errors.iter().map(Mat::nrows).collect(),
            stacked: Stack::column(errors),
            missing: (errors.iter())
                .flat_map(|e| (0..e.ncols()).flat_map(|i| e.col_as_slice(i).iter().map(|v| v.is_nan())))
                .collect(),
            columns,
            noise_covariance: noise.map_or_else(|| Mat::identity(outputs, outputs), Mat::clone),
        };
        if !residuals.meet() {
            // No weight may carry an output to instants at which it is not there.
            let all = &residuals.noise_covariance;
            residuals.noise_covariance = Mat::from_fn(outputs, outputs, |i, j| if i == j { all[(i, i)] } else { 0.0 });
        }
        residuals
    }

    /// Returns true if all outputs are there at the same instants.
    fn meet(&self) -> bool {
        self.outputs.iter().all(|e| e.there == self.outputs[0].there)
    }

    fn together(&self) -> Result<LinearisedResiduals, IdentError> {
        let stack = Stack::new(self.lengths.clone(), self.outputs.len());
        LinearisedResiduals::new(stack, &self.stacked, &self.missing, self.columns, &self.noise_covariance)
    }

    /// The linearised residuals of an output by itself.
    fn alone(&self, i: usize) -> Result<LinearisedResiduals, IdentError> {
        let stack = Stack::new(self.lengths.clone(), self.outputs.len());
        let missing: Vec<bool> =
            (0..self.lengths.len()).flat_map(|m| self.missing[stack.range(m, i)].iter().copied()).collect();
        let noise = self.noise_covariance.submatrix(i, i, 1, 1).to_owned();
        let (own, columns) = (Stack::new(self.lengths.clone(), 1), self.columns.alone(&stack, i));
        LinearisedResiduals::new(own, &stack.alone(&self.stacked, i), &missing, &columns, &noise)
    }
}
