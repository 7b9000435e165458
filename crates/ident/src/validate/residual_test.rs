//! Tests of residuals: are they white, and do they depend on an input?

use faer::Mat;

use super::JointTest;
use super::footing::Footing;
use super::quadratic::STILL;
use super::sensitivity::{self, Stack};
use super::series::{Series, pair_counts, products};
use crate::distributions::normal_quantile;
use crate::fit::check_channels;
use crate::prediction::{InitialState, residuals};
use crate::uncertainty::root::inverse_root;
use crate::{Dataset, Fit, IdentError, LinearModel, Parametric};

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
    /// Parameters of the noise model that were fitted to these very data, taken off the degrees of freedom of the tests of
    /// whiteness; zero on other data.
    pub noise_parameters: usize,
}

impl Default for ResidualTest {
    fn default() -> Self {
        ResidualTest { lags: 25, level: 0.99, initial: InitialState::Estimated, noise_parameters: 0 }
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

/// What the residuals of a model show.
#[derive(Debug, Clone, PartialEq)]
pub struct ResidualReport {
    /// One test an output.
    pub whiteness: Vec<Whiteness>,
    /// Every output against the past of every output, at lags 1 to M. For one output the test of Ljung and Box.
    pub joint_whiteness: JointTest,
    /// Each output against each input, `[output][input]`.
    pub independence: Vec<Vec<Independence>>,
}

/// The correlation of a residual with its own past.
#[derive(Debug, Clone, PartialEq)]
pub struct Whiteness {
    /// Mean of the residual; the correlations are taken about it.
    pub mean: f64,
    /// `r_ε(k)/r_ε(0)` for k = 0 … M.
    pub auto: Vec<f64>,
    /// Each of them after the first stays below this in magnitude, at the level asked for, if ε is white.
    pub bound: f64,
    /// The test of Ljung and Box over lags 1 to M.
    pub joint: JointTest,
}

/// The correlation of a residual with an input.
#[derive(Debug, Clone, PartialEq)]
pub struct Independence {
    /// `r_εu(k)/√(r_ε(0) r_u(0))` for k = −M … M, with `r_εu(k)` the mean of `ε(t) u(t − k)`, of what the parameters cannot
    /// explain in data that they were fitted to.
    pub cross: Vec<f64>,
    /// Each stays below its bound in magnitude, at the level asked for, if ε does not depend on u: k = −M … M. Next to
    /// nothing where the estimate leaves no correlation.
    pub bounds: Vec<f64>,
    /// Lags 0 to M, the input's present and past: what fails here is dynamics that the model lacks.
    pub dynamics: JointTest,
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
    /// Correlations are summed over the experiments, never across their borders. Missing outputs are left out, and so are
    /// lags at which no two outputs are known.
    ///
    /// With `U` the lagged input, `R` the covariance in time of the errors `v`, `Ψ` the sensitivity of the predictions to
    /// the parameters and to the initial states that are estimated here, and `M = I − Ψ (Ψᵀ Λ⁻¹ Ψ)⁻¹ Ψᵀ Λ⁻¹` for noise of
    /// covariance `Λ`:
    /// - on [`TestData::Own`] the sums tested are `Uᵀ M ε`, of covariance `Uᵀ M R Mᵀ U`. Where ε is the smallest in the
    ///   sense of Λ, `M ε = ε`. An estimate of another kind (instruments, subspaces) is so tested as if a last step had been
    ///   taken to that minimum: what a step of the parameters explains is no missing dynamics. One that is far from it, as
    ///   by subspaces from few data, fails more often than the level says.
    /// - on [`TestData::Unseen`] they are `Uᵀ ε`, of covariance `UᵀRU + Uᵀ Ψ P Ψᵀ U` with `P` the estimate's covariance and
    ///   `Ψ` that of the parameters; the initial states estimated here are taken out as above.
    ///
    /// `R` is that of an autoregression fitted to the residuals. Directions that the estimate holds have no degree of
    /// freedom. All this is linear in the errors of the parameters, and holds where those are small; the tests of whiteness
    /// take the parameters for known, but for [`ResidualTest::noise_parameters`].
    ///
    /// # Errors
    /// Those of [`residuals`]; [`IdentError::TooFewSamples`] under four times as many samples as lags;
    /// [`IdentError::Constant`] where a residual or an input does not vary; [`IdentError::NotFinite`] where there is no
    /// model beside the estimate.
    ///
    /// # Source
    /// Ljung 1999, §16.6; Neyman, *Optimal asymptotic tests of composite statistical hypotheses*, 1959, for sums that
    /// errors of the parameters leave alone. Ljung, G. M. and Box, *On a measure of lack of fit in time series models*,
    /// 1978; for several outputs Hosking, *The multivariate portmanteau statistic*, 1980.
    pub fn run<M: Parametric + LinearModel>(
        &self,
        fit: &Fit<M>,
        data: &Dataset,
        which: TestData,
    ) -> Result<ResidualReport, IdentError> {
        check_channels(&fit.model, data)?;
        let errors = residuals(&fit.model, data, &self.initial)?.outputs;
        let parameters = sensitivity::to_parameters(fit, data, &self.initial, &Stack::column(&errors))?;
        let mut removed = sensitivity::to_states(&fit.model, data, &self.initial)?;
        let mut uncertain = Vec::new();
        match which {
            TestData::Own => removed.extend(parameters),
            TestData::Unseen => uncertain = parameters,
        }
        self.report(data, &errors, &Columns { removed, uncertain, noise_covariance: Some(&fit.noise_covariance) })
    }

    /// Tests the one-step prediction errors of a model that is not estimated: its parameters count as known.
    ///
    /// # Errors
    /// As [`ResidualTest::run`].
    pub fn run_known<M: LinearModel + ?Sized>(&self, model: &M, data: &Dataset) -> Result<ResidualReport, IdentError> {
        check_channels(model, data)?;
        let errors = residuals(model, data, &self.initial)?.outputs;
        let removed = sensitivity::to_states(model, data, &self.initial)?;
        self.report(data, &errors, &Columns { removed, ..Columns::default() })
    }

    /// Tests residuals that are already there: they stand as the outputs of `data`, and whatever they are of counts as
    /// known.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`], [`IdentError::Constant`] as [`ResidualTest::run`].
    pub fn run_on_residuals(&self, data: &Dataset) -> Result<ResidualReport, IdentError> {
        let errors: Vec<Mat<f64>> = data.experiments().iter().map(|e| e.outputs.clone()).collect();
        self.report(data, &errors, &Columns::default())
    }

    fn report(&self, data: &Dataset, errors: &[Mat<f64>], columns: &Columns<'_>) -> Result<ResidualReport, IdentError> {
        let output = |i: usize| errors.iter().map(|e| e.col_as_slice(i)).collect::<Vec<_>>();
        let outputs = (0..data.outputs()).map(|i| Series::new(&output(i))).collect::<Vec<_>>();
        let input = |k: usize| data.experiments().iter().map(|e| e.input(k)).collect::<Vec<_>>();
        let inputs = (0..data.inputs()).map(|k| Series::new(&input(k))).collect::<Vec<_>>();
        for output in &outputs {
            let samples = output.present as usize;
            if samples < 4 * self.lags.max(1) {
                return Err(IdentError::TooFewSamples { samples, parameters: self.lags });
            }
        }
        Ok(ResidualReport {
            whiteness: outputs.iter().map(|e| self.whiteness(e)).collect::<Result<_, _>>()?,
            joint_whiteness: self.joint_whiteness(&outputs.iter().collect::<Vec<_>>())?,
            independence: self.all_independence(errors, &outputs, &inputs, columns)?,
        })
    }

    /// Every output against every input. Outputs that are there at different instants are taken one by one.
    fn all_independence(
        &self,
        errors: &[Mat<f64>],
        outputs: &[Series],
        inputs: &[Series],
        columns: &Columns<'_>,
    ) -> Result<Vec<Vec<Independence>>, IdentError> {
        if inputs.is_empty() {
            return Ok(vec![Vec::new(); outputs.len()]);
        }
        let lengths: Vec<usize> = errors.iter().map(Mat::nrows).collect();
        let stack = Stack::new(lengths.clone(), outputs.len());
        let column = Stack::column(errors);
        let missing: Vec<bool> = (errors.iter())
            .flat_map(|e| (0..e.ncols()).flat_map(|i| e.col_as_slice(i).iter().map(|v| v.is_nan())))
            .collect();
        let unknown = Mat::identity(outputs.len(), outputs.len());
        let noise = columns.noise_covariance.unwrap_or(&unknown);
        let of = |footing: &Footing, place: usize, i: usize| -> Result<Vec<Independence>, IdentError> {
            inputs.iter().map(|u| self.independence(footing, place, &outputs[i], u)).collect()
        };
        if outputs.iter().all(|e| e.there == outputs[0].there) {
            let footing = Footing::new(stack, &column, &missing, &columns.removed, &columns.uncertain, noise)?;
            return (0..outputs.len()).map(|i| of(&footing, i, i)).collect();
        }
        let alone = |i: usize| {
            let each = |all: &[Vec<f64>]| all.iter().map(|c| stack.alone(c, i)).collect::<Vec<_>>();
            let missing: Vec<bool> =
                (0..lengths.len()).flat_map(|m| missing[stack.range(m, i)].iter().copied()).collect();
            let (errors, noise) = (stack.alone(&column, i), noise.submatrix(i, i, 1, 1).to_owned());
            let own = Stack::new(lengths.clone(), 1);
            let footing =
                Footing::new(own, &errors, &missing, &each(&columns.removed), &each(&columns.uncertain), &noise)?;
            of(&footing, 0, i)
        };
        (0..outputs.len()).map(alone).collect()
    }

    fn whiteness(&self, e: &Series) -> Result<Whiteness, IdentError> {
        let sums = products(e, e, self.lags)?;
        let joint = self.joint_whiteness(&[e])?;
        Ok(Whiteness {
            mean: e.mean,
            auto: sums[self.lags..].iter().map(|s| s / sums[self.lags]).collect(),
            bound: normal_quantile(0.5 + self.level / 2.0) / e.present.sqrt(),
            joint,
        })
    }

    /// `n (n + 2) Σ_k tr(C_kᵀ C_0⁻¹ C_k C_0⁻¹)/n_k`, with `n_k` the pairs behind `C_k`.
    fn joint_whiteness(&self, outputs: &[&Series]) -> Result<JointTest, IdentError> {
        let (p, lags) = (outputs.len(), self.lags);
        let mut sums = Vec::with_capacity(p * p);
        let mut pairs = Vec::with_capacity(p * p);
        for a in outputs {
            for b in outputs {
                sums.push(products(a, b, lags)?);
                pairs.push(pair_counts(a, b, lags)?);
            }
        }
        let at = |k: usize| Mat::from_fn(p, p, |i, j| sums[i * p + j][lags + k] / pairs[i * p + j][lags].max(1.0));
        let whiten = inverse_root(&at(0), STILL)?;
        if whiten.ncols() < p {
            return Err(IdentError::Constant { what: "the residual" });
        }
        let (mut statistic, mut correlations) = (0.0, 0);
        for k in 1..=lags {
            // An output slower than the data's clock has no pairs at most lags: nothing is tested there.
            let there = (0..p * p).filter(|i| pairs[*i][lags + k] > 0.0).count();
            if there == 0 {
                continue;
            }
            let normal = whiten.transpose() * at(k) * &whiten;
            let n = pairs[0][lags];
            let count = (0..p * p).map(|i| pairs[i][lags + k]).sum::<f64>() / there as f64;
            statistic += n * (n + 2.0) / count * normal.squared_norm_l2();
            correlations += there;
        }
        let freedom = correlations.saturating_sub(self.noise_parameters);
        Ok(JointTest::chi_squared(statistic, freedom as f64))
    }

    fn independence(
        &self,
        footing: &Footing,
        output: usize,
        e: &Series,
        u: &Series,
    ) -> Result<Independence, IdentError> {
        let (size_e, size_u) = (e.energy(), u.energy());
        if size_e <= 0.0 {
            return Err(IdentError::Constant { what: "the residual" });
        }
        if size_u <= 0.0 {
            return Err(IdentError::Constant { what: "an input" });
        }
        let (lags, scale) = (self.lags, (size_e * size_u).sqrt());
        let sums = footing.sums(output, e, u, lags)?;
        let quantile = normal_quantile(0.5 + self.level / 2.0);
        Ok(Independence {
            bounds: sums.variances().iter().map(|v| quantile * v.sqrt() / scale).collect(),
            dynamics: sums.test(lags, lags + 1)?,
            feedback: sums.test(0, lags)?,
            cross: sums.values.iter().map(|s| s / scale).collect(),
        })
    }
}

/// The columns that make a footing.
#[derive(Default)]
struct Columns<'a> {
    removed: Vec<Vec<f64>>,
    uncertain: Vec<Vec<f64>>,
    noise_covariance: Option<&'a Mat<f64>>,
}
