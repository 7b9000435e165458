//! Impulse responses as they are, with or without a prior expectation.

mod kernel;
mod posterior;
mod response;
mod search;

use faer::Mat;
use lti::{PolynomialEquation, PolynomialModel};

pub use kernel::{Hyperparameters, Kernel};
pub use response::{ImpulseFit, ResponseEstimate};

use self::posterior::{Evidence, Posterior};
use self::search::Prior;
use crate::data::regression::{Regression, Signals, outputs_then_inputs};
use crate::least_squares::solve_factor;
use crate::polynomial::arx::{ArxOrders, filter, layout, whitening_filter};
use crate::{Dataset, Doubt, Fit, IdentError, LinearFit, Origin, Termination};
use fitting::condition::ILL_CONDITIONED;
use fitting::equation::{Equation, factor_of, noise_covariance};
use fitting::{Count, StructureError};

/// Estimates finite impulse responses, from every input to every output:
///
/// `y_i(t) = Σ_k Σ_l g_ik(l) u_k(t − delay − l) + e_i(t)`, `l = 0…taps − 1`
///
/// By default the response is expected to decay and to be continuous, as a Gaussian prior whose size and decay are
/// tuned to the data by maximum marginal likelihood, with the noise variance; outputs are treated one by one and every
/// input has a prior of its own. That beats least squares by far where data are short or noisy, and allows more taps
/// than samples. Rows without all their past and rows that touch a missing sample are left out.
///
/// # Example
/// ```
/// use ident::{Dataset, ImpulseResponse};
/// let mut random = signal::excitation::Random::new(1);
/// let u: Vec<f64> = (0..400).map(|_| random.normal()).collect();
/// let mut x = vec![0.0; 400];
/// for t in 1..400 {
///     x[t] = 0.8 * x[t - 1] + u[t - 1];
/// }
/// let y: Vec<f64> = x.iter().map(|x| x + 0.1 * random.normal()).collect();
/// let estimate = ImpulseResponse::new(40).delay(1).fit(&Dataset::siso(0.1, &u, &y)?)?;
/// let step = estimate.step(0, 0)?;
/// assert!((step.value[39] - 5.0).abs() < 0.2);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Chen, Ohlsson & Ljung, *On the estimation of transfer functions, regularizations and Gaussian processes –
/// revisited*, Automatica 48, 2012; Chen & Ljung, *Implementation of algorithms for tuning parameters in regularized
/// least squares problems in system identification*, Automatica 49, 2013 (the factorisation).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImpulseResponse {
    taps: usize,
    delay: usize,
    kernel: Option<Kernel>,
    prewhitening: usize,
}

impl ImpulseResponse {
    /// Responses of `taps` coefficients from no delay on, with the kernel [`Kernel::TunedCorrelated`].
    #[must_use]
    pub fn new(taps: usize) -> Self {
        ImpulseResponse { taps, delay: 0, kernel: Some(Kernel::TunedCorrelated), prewhitening: 0 }
    }

    /// Responses that begin this many samples after the input.
    #[must_use]
    pub fn delay(mut self, samples: usize) -> Self {
        self.delay = samples;
        self
    }

    /// Another prior.
    #[must_use]
    pub fn kernel(mut self, kernel: Kernel) -> Self {
        self.kernel = Some(kernel);
        self
    }

    /// No prior: least squares.
    #[must_use]
    pub fn unregularised(mut self) -> Self {
        self.kernel = None;
        self
    }

    /// Estimates twice: the errors of the first estimate, as an autoregression of this order, give a filter that makes
    /// the noise white for the second. Without it coloured noise leaves the estimate consistent, but less accurate than
    /// could be and with a wrong covariance.
    #[must_use]
    pub fn prewhitening(mut self, order: usize) -> Self {
        self.prewhitening = order;
        self
    }

    /// Fits the responses to data.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for no tap or no input, [`IdentError::TooFewSamples`], [`IdentError::Constant`] for a
    /// channel that is zero throughout; without a kernel [`IdentError::RankDeficient`] where the inputs do not excite
    /// every coefficient.
    pub fn fit(&self, data: &Dataset) -> Result<ImpulseFit, IdentError> {
        if data.inputs() == 0 {
            return Err(StructureError::inputs("an impulse response", Count::AtLeast(1), 0).into());
        }
        if self.taps == 0 {
            return Err(StructureError::TooFew { what: "taps", found: 0, least: 1 }.into());
        }
        let orders = ArxOrders::uniform(data.outputs(), data.inputs(), 0, self.taps, self.delay);
        orders.check(data)?;
        let signals = outputs_then_inputs(data);
        let (columns, equations) = layout(&orders);
        let regression = Regression::new(&signals, columns);
        self.check_rows(data, regression.rows)?;
        let factor = regression.factor();
        let parts = equations.iter().map(|e| self.estimate(&factor, e, regression.rows));
        let mut parts = parts.collect::<Result<Vec<_>, _>>()?;
        if self.prewhitening > 0 {
            let first = self.model(data, &parts)?;
            for (i, part) in parts.iter_mut().enumerate() {
                let whitening = whitening_filter(data, &first, i, self.prewhitening)?;
                *part = self.estimate_filtered(data, i, &whitening)?;
            }
        }
        self.assemble(data, &regression, &factor, &equations, parts)
    }

    fn check_rows(&self, data: &Dataset, rows: usize) -> Result<(), IdentError> {
        // A prior needs enough to be tuned by.
        let parameters = data.inputs() * self.kernel.map_or(self.taps, Kernel::hyperparameters);
        if rows <= parameters { Err(IdentError::TooFewSamples { samples: rows, parameters }) } else { Ok(()) }
    }

    /// One output, from the factor of all columns.
    fn estimate(&self, factor: &Mat<f64>, equation: &Equation, rows: usize) -> Result<Part, IdentError> {
        let columns: Vec<usize> = equation.regressors.iter().chain([&equation.target]).copied().collect();
        let own = factor_of(factor, &columns);
        let Some(kernel) = self.kernel else { return Ok(unregularised(solve_factor(&own, rows)?)) };
        let inputs = equation.regressors.len() / self.taps;
        let evidence = Evidence::new(own, rows);
        let magnitudes =
            (0..inputs).map(|k| evidence.magnitude(k * self.taps..(k + 1) * self.taps)).collect::<Vec<_>>();
        for (what, constant) in
            [("an input", magnitudes.contains(&0.0)), ("an output", evidence.target_magnitude() == 0.0)]
        {
            if constant {
                return Err(IdentError::Constant { what });
            }
        }
        let prior = Prior { kernel, taps: self.taps, inputs: magnitudes };
        let mut hyperparameters = prior.tune(&evidence);
        let posterior = evidence.posterior(&prior.root(&hyperparameters))?;
        for (h, magnitude) in hyperparameters.iter_mut().zip(&prior.inputs) {
            h.scale *= posterior.noise_variance / (magnitude * magnitude);
        }
        Ok(Part { posterior, hyperparameters })
    }

    /// One output, all signals filtered.
    fn estimate_filtered(&self, data: &Dataset, output: usize, whitening: &[f64]) -> Result<Part, IdentError> {
        let filtered = |s: &[f64]| filter(whitening, s, whitening.len());
        let record = |e: &crate::Experiment| {
            std::iter::once(filtered(e.output(output)))
                .chain((0..data.inputs()).map(|k| filtered(e.input(k))))
                .collect()
        };
        let records: Vec<Vec<Vec<f64>>> = data.experiments().iter().map(record).collect();
        let signals: Signals<'_> = records.iter().map(|r| r.iter().map(Vec::as_slice).collect()).collect();
        let (columns, equations) = layout(&ArxOrders::uniform(1, data.inputs(), 0, self.taps, self.delay));
        let regression = Regression::new(&signals, columns);
        self.check_rows(data, regression.rows)?;
        self.estimate(&regression.factor(), &equations[0], regression.rows)
    }

    fn model(&self, data: &Dataset, parts: &[Part]) -> Result<PolynomialModel, IdentError> {
        let (inputs, outputs) = (data.inputs(), data.outputs());
        let equation = |part: &Part| PolynomialEquation {
            a: vec![Vec::new(); outputs],
            b: part.posterior.mean.chunks(self.taps).map(<[f64]>::to_vec).collect(),
            nk: vec![self.delay; inputs],
            f: vec![Vec::new(); inputs],
            ..Default::default()
        };
        let equations = parts.iter().map(equation).collect();
        Ok(PolynomialModel::new(data.sample_time_s(), equations, Mat::identity(outputs, outputs))?)
    }

    fn assemble(
        &self,
        data: &Dataset,
        regression: &Regression<'_>,
        factor: &Mat<f64>,
        equations: &[Equation],
        parts: Vec<Part>,
    ) -> Result<ImpulseFit, IdentError> {
        let rows = regression.rows;
        let thetas: Vec<&[f64]> = parts.iter().map(|p| p.posterior.mean.as_slice()).collect();
        let effective: Vec<f64> = parts.iter().map(|p| p.posterior.effective_parameters).collect();
        let (noise_covariance, loss) = noise_covariance(factor, equations, &thetas, &effective, rows);
        let model = self.model(data, &parts)?.with_noise_covariance(noise_covariance.clone())?;
        let n = self.taps * data.inputs();
        let mut covariance = Mat::zeros(n * parts.len(), n * parts.len());
        for (i, part) in parts.iter().enumerate() {
            covariance.get_mut(i * n.., i * n..).get_mut(..n, ..n).copy_from(&part.posterior.covariance);
        }
        let condition = parts.iter().map(|p| p.posterior.condition).fold(1.0, f64::max);
        let fit = Fit {
            model,
            covariance,
            degrees_of_freedom: (rows as f64 - effective.iter().copied().fold(0.0, f64::max)).max(1.0),
            noise_covariance,
            loss,
            samples: rows,
            free_parameters: effective.iter().sum::<f64>().ceil() as usize,
            initial_states: Vec::new(),
            levels: Vec::new(),
            termination: Termination::Direct,
            iterations: 0,
            condition,
            doubts: self.doubts(regression, condition),
            origin: Some(Origin::new(
                if self.kernel.is_some() { "regularised least squares" } else { "least squares" },
                data,
            )),
        };
        let tuned = self.kernel.is_some();
        let hyperparameters = if tuned { parts.into_iter().map(|p| p.hyperparameters).collect() } else { Vec::new() };
        Ok(ImpulseFit { fit, hyperparameters })
    }

    fn doubts(&self, regression: &Regression<'_>, condition: f64) -> Vec<Doubt> {
        let left_out = regression.candidates - regression.rows;
        let rows = (left_out > 0).then_some(Doubt::RowsLeftOut { rows: left_out, of: regression.candidates });
        // A prior settles what the data leave open.
        let ill = self.kernel.is_none() && condition > ILL_CONDITIONED;
        rows.into_iter().chain(ill.then_some(Doubt::IllConditioned { condition })).collect()
    }
}

/// The estimate of one output.
struct Part {
    posterior: Posterior,
    hyperparameters: Vec<Hyperparameters>,
}

/// Least squares as an estimate with a prior that says nothing.
fn unregularised(fit: LinearFit) -> Part {
    let posterior = Posterior {
        covariance: fit.covariance(),
        noise_variance: fit.noise_variance(),
        effective_parameters: fit.parameters.len() as f64,
        condition: fit.condition,
        mean: fit.parameters,
    };
    Part { posterior, hyperparameters: Vec::new() }
}
