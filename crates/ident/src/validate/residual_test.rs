//! Tests of residuals: are they white, and do they depend on an input?

use faer::Mat;
use signal::correlation::cross_correlation;

use super::JointTest;
use super::toeplitz::{STILL, quadratic_form};
use crate::distributions::normal_quantile;
use crate::fit::check_channels;
use crate::gram::dot;
use crate::prediction::{InitialState, residuals};
use crate::uncertainty::root::inverse_root;
use crate::{Dataset, Experiment, IdentError, LinearModel};

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
/// let report = ResidualTest::default().run(&model, &Dataset::siso(1.0, &u, &y)?)?;
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
    /// `r_εu(k)/√(r_ε(0) r_u(0))` for k = −M … M, with `r_εu(k)` the mean of `ε(t) u(t − k)`.
    pub cross: Vec<f64>,
    /// Each stays below this in magnitude, at the level asked for, if ε does not depend on u.
    pub bound: f64,
    /// Lags 0 to M, the input's present and past: what fails here is dynamics that the model lacks.
    pub dynamics: JointTest,
    /// Lags −M to −1, the input's future: what fails here is feedback from the output to the input.
    pub feedback: JointTest,
}

impl ResidualTest {
    /// Tests the one-step prediction errors of `model` on `data`.
    ///
    /// Correlations are summed over the experiments, never across their borders. Missing outputs are left out, and so are
    /// lags at which no two outputs are known.
    /// The regions take the parameters for known. Those of an estimate carry errors into the residuals: where the model
    /// describes the noise too, hardly any, and on its own data the correlations are even smaller than the regions allow;
    /// where it leaves strongly coloured noise, as output-error models may, `dynamics` fails far more often than the level
    /// says (with AR(1) noise of 0.95 in one case of six on its own data and in one of three on others), so that a failure
    /// is to be weighed against the intervals of the parameters.
    ///
    /// # Errors
    /// Those of [`residuals`]; [`IdentError::TooFewSamples`] under four times as many samples as lags;
    /// [`IdentError::Constant`] where a residual or an input does not vary.
    ///
    /// # Source
    /// Ljung 1999, §16.6. Ljung, G. M. and Box, *On a measure of lack of fit in time series models*, 1978; for several
    /// outputs Hosking, *The multivariate portmanteau statistic*, 1980.
    pub fn run<M: LinearModel + ?Sized>(&self, model: &M, data: &Dataset) -> Result<ResidualReport, IdentError> {
        check_channels(model, data)?;
        let mut errors = residuals(model, data, &self.initial)?.outputs.into_iter();
        let of = |e: &Experiment| Ok(Experiment { outputs: errors.next().unwrap_or_else(Mat::new), ..e.clone() });
        self.run_on_residuals(&data.map_experiments(of)?)
    }

    /// Tests residuals that are already there: they stand as the outputs of `data`.
    ///
    /// # Errors
    /// [`IdentError::TooFewSamples`], [`IdentError::Constant`] as [`ResidualTest::run`].
    pub fn run_on_residuals(&self, data: &Dataset) -> Result<ResidualReport, IdentError> {
        let output = |i: usize| data.experiments().iter().map(|e| e.output(i)).collect::<Vec<_>>();
        let outputs = (0..data.outputs()).map(|i| Series::new(&output(i))).collect::<Vec<_>>();
        let input = |k: usize| data.experiments().iter().map(|e| e.input(k)).collect::<Vec<_>>();
        let inputs = (0..data.inputs()).map(|k| Series::new(&input(k))).collect::<Vec<_>>();
        for output in &outputs {
            let samples = output.present as usize;
            if samples < 4 * self.lags.max(1) {
                return Err(IdentError::TooFewSamples { samples, parameters: self.lags });
            }
        }
        let independence = |e: &Series| inputs.iter().map(|u| self.independence(e, u)).collect::<Result<_, _>>();
        Ok(ResidualReport {
            whiteness: outputs.iter().map(|e| self.whiteness(e)).collect::<Result<_, _>>()?,
            joint_whiteness: self.joint_whiteness(&outputs.iter().collect::<Vec<_>>())?,
            independence: outputs.iter().map(independence).collect::<Result<_, _>>()?,
        })
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

    fn independence(&self, e: &Series, u: &Series) -> Result<Independence, IdentError> {
        let lags = self.lags;
        let cross = products(u, e, lags)?;
        let variance = sum_covariances(e, u, lags)?;
        let (size_e, size_u) = (e.energy(), u.energy());
        if size_e <= 0.0 {
            return Err(IdentError::Constant { what: "the residual" });
        }
        if size_u <= 0.0 {
            return Err(IdentError::Constant { what: "an input" });
        }
        let scale = (size_e * size_u).sqrt();
        Ok(Independence {
            bound: normal_quantile(0.5 + self.level / 2.0) * variance[0].max(0.0).sqrt() / scale,
            dynamics: quadratic_form(&cross[lags..], &variance)?,
            feedback: quadratic_form(&cross[..lags], &variance)?,
            cross: cross.iter().map(|s| s / scale).collect(),
        })
    }
}

/// One channel over all experiments: its mean taken off, zeros for what is missing.
struct Series {
    parts: Vec<Vec<f64>>,
    /// One where a sample is there; none where all are.
    there: Option<Vec<Vec<f64>>>,
    mean: f64,
    present: f64,
}

impl Series {
    fn new(parts: &[&[f64]]) -> Self {
        let there = || parts.iter().flat_map(|p| p.iter()).filter(|v| !v.is_nan());
        let present = there().count() as f64;
        let mean = there().sum::<f64>() / present.max(1.0);
        let gaps = parts.iter().any(|p| p.iter().any(|v| v.is_nan()));
        let centred = |v: &f64| if v.is_nan() { 0.0 } else { v - mean };
        let indicator = |v: &f64| f64::from(u8::from(!v.is_nan()));
        Series {
            parts: parts.iter().map(|p| p.iter().map(centred).collect()).collect(),
            there: gaps.then(|| parts.iter().map(|p| p.iter().map(indicator).collect()).collect()),
            mean,
            present,
        }
    }

    fn energy(&self) -> f64 {
        self.parts.iter().flatten().map(|v| v * v).sum()
    }

    fn indicators(&self) -> Vec<Vec<f64>> {
        self.there.clone().unwrap_or_else(|| self.parts.iter().map(|p| vec![1.0; p.len()]).collect())
    }
}

/// `Σ_t x(t) y(t + k)` for k = −M … M, summed over the experiments.
fn products(x: &Series, y: &Series, lags: usize) -> Result<Vec<f64>, IdentError> {
    sum_products(&x.parts, &y.parts, lags)
}

fn sum_products(x: &[Vec<f64>], y: &[Vec<f64>], lags: usize) -> Result<Vec<f64>, IdentError> {
    let mut sums = vec![0.0; 2 * lags + 1];
    for (x, y) in x.iter().zip(y).filter(|(x, _)| !x.is_empty()) {
        let reach = lags.min(x.len() - 1);
        let correlation = cross_correlation(x, y, reach)?;
        for (slot, value) in sums[lags - reach..].iter_mut().zip(&correlation.values) {
            *slot += value * x.len() as f64;
        }
    }
    Ok(sums)
}

/// How many pairs `x(t)`, `y(t + k)` are there, for k = −M … M.
fn pair_counts(x: &Series, y: &Series, lags: usize) -> Result<Vec<f64>, IdentError> {
    if x.there.is_some() || y.there.is_some() {
        return Ok(sum_products(&x.indicators(), &y.indicators(), lags)?.iter().map(|v| v.round()).collect());
    }
    let count = |k: usize| x.parts.iter().map(|p| p.len().saturating_sub(k)).sum::<usize>() as f64;
    Ok((0..=2 * lags).map(|i| count(i.abs_diff(lags))).collect())
}

/// The covariances of `S_k = Σ_t ε(t) u(t − k)` and `S_{k+l}` for l = 0 … M under independence: `N Σ_s r_ε(s) r_u(s + l)`.
///
/// Parzen's window on `r_ε` keeps them a covariance and leaves out lags at which there is nothing but chance.
fn sum_covariances(e: &Series, u: &Series, lags: usize) -> Result<Vec<f64>, IdentError> {
    let rows = e.parts.iter().map(Vec::len).sum::<usize>();
    let reach = (4 * lags).min(rows / 10).max(1);
    let (re, ru) = (products(e, e, reach)?, products(u, u, reach + lags)?);
    let window = |s: usize| {
        let x = s as f64 / reach as f64;
        if x < 0.5 { 1.0 - 6.0 * x * x * (1.0 - x) } else { 2.0 * (1.0 - x).powi(3) }
    };
    let windowed: Vec<f64> = re.iter().enumerate().map(|(i, r)| window(i.abs_diff(reach)) * r).collect();
    Ok((0..=lags).map(|l| dot(&windowed, &ru[lags + l..=lags + l + 2 * reach]) / rows as f64).collect())
}
