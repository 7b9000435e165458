//! [`Iv4`]: nearly optimal instruments in four steps.

use faer::Mat;
use lti::PolynomialModel;

use super::check_inputs;
use super::equations::{Instrumented, filter, simulate, stabilised};
use crate::arx::{Arx, ArxOrders, Noise};
use crate::{Dataset, Experiment, Fit, IdentError};

/// Estimates an ARX model (see [`Arx`]) by the four-step instrumental-variable method: consistent whatever the colour of the
/// noise in open loop, and nearly as accurate as a model of the noise would allow where `A v` is close to autoregressive.
///
/// 1. Least squares; its model simulated gives instruments.
/// 2. Instrumental variables; the new model simulated gives better ones.
/// 3. The equation errors, of this model, as an autoregression of `na + nb` coefficients: the filter `L`.
/// 4. Instrumental variables with all signals filtered by `L`.
///
/// The covariance is that of the last step, where the filtered errors are taken as white. Noise and loss are those of the
/// ARX model itself, so they are larger than a model of the noise would leave.
///
/// # Example
/// ```
/// use ident::{Dataset, Iv4};
/// let mut random = signal::excitation::Random::new(1);
/// let u: Vec<f64> = (0..5000).map(|_| random.normal()).collect();
/// let mut x = vec![0.0; 5000];
/// for t in 2..5000 {
///     x[t] = 1.5 * x[t - 1] - 0.7 * x[t - 2] + u[t - 1];
/// }
/// let y: Vec<f64> = x.iter().map(|x| x + random.normal()).collect();
/// let fit = Iv4::new(2, 1, 1).fit(&Dataset::siso(1.0, &u, &y)?)?;
/// assert!((fit.parameters()[0] + 1.5).abs() < 4.0 * fit.standard_errors()[0]);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, §15.3, (15.21)–(15.26); covariance (15.28).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Iv4 {
    orders: ArxOrders,
}

impl Iv4 {
    /// One input and one output: `na` and `nb` coefficients, delay `nk`.
    #[must_use]
    pub fn new(na: usize, nb: usize, nk: usize) -> Self {
        Self::with_orders(ArxOrders::siso(na, nb, nk))
    }

    /// Several inputs or outputs.
    #[must_use]
    pub fn with_orders(orders: ArxOrders) -> Self {
        Iv4 { orders }
    }

    /// Fits the model to data.
    ///
    /// # Errors
    /// Those of [`Arx::fit`]; [`IdentError::Structure`] for a model without inputs.
    pub fn fit(&self, data: &Dataset) -> Result<Fit<PolynomialModel>, IdentError> {
        self.orders.check(data)?;
        check_inputs(&self.orders)?;
        let first = Arx::with_orders(self.orders.clone()).fit(data)?.model;
        let unfiltered = vec![vec![1.0]; data.outputs()];
        let second = self.refined(data, &first, &unfiltered)?.model;
        let filters = (0..data.outputs()).map(|i| self.whitening(data, &second, i)).collect::<Result<Vec<_>, _>>()?;
        self.refined(data, &second, &filters)
    }

    /// Instrumental variables with the simulated outputs of `model`.
    fn refined(
        &self,
        data: &Dataset,
        model: &PolynomialModel,
        filters: &[Vec<f64>],
    ) -> Result<Fit<PolynomialModel>, IdentError> {
        let instruments = simulate(&stabilised(model)?, data);
        Instrumented::new(data, &self.orders, Some(&instruments), filters).fit(|_, _| Noise::White)
    }

    /// `1 + l₁ q⁻¹ + …`, which makes the errors of one equation white.
    fn whitening(&self, data: &Dataset, model: &PolynomialModel, equation: usize) -> Result<Vec<f64>, IdentError> {
        let order = self.orders.regressors(equation).len();
        let mut errors: Option<Dataset> = None;
        for experiment in data.experiments() {
            let e = equation_errors(model, experiment, equation);
            let outputs = Mat::from_fn(e.len(), 1, |t, _| e[t]);
            errors = Some(match errors {
                None => Dataset::new(data.sample_time_s(), Mat::new(), outputs)?,
                Some(data) => {
                    let experiment = Experiment { name: String::new(), start_s: 0.0, inputs: Mat::new(), outputs };
                    data.with_experiment(experiment)?
                }
            });
        }
        let fit = errors.filter(|_| order > 0).map(|e| Arx::autoregression(order).fit(&e)).transpose();
        let coefficients = match fit {
            Ok(fit) => fit.map_or_else(Vec::new, |f| f.parameters()),
            // Errors that vanish, or are too few: nothing to whiten.
            Err(IdentError::RankDeficient { .. } | IdentError::TooFewSamples { .. }) => Vec::new(),
            Err(error) => return Err(error),
        };
        Ok(std::iter::once(1.0).chain(coefficients).collect())
    }
}

/// `Σ_j A_ij y_j − Σ_k B_ik u_k` for the rows with all their past.
fn equation_errors(model: &PolynomialModel, experiment: &Experiment, equation: usize) -> Vec<f64> {
    let e = &model.equations()[equation];
    let from_output = |(j, a): (usize, &Vec<f64>)| {
        let own = if j == equation { 1.0 } else { 0.0 };
        (std::iter::once(own).chain(a.iter().copied()).collect::<Vec<f64>>(), experiment.output(j))
    };
    let from_input = |k: usize| (e.delayed_b(k).iter().map(|b| -b).collect(), experiment.input(k));
    let outputs = e.a.iter().enumerate().filter(|(j, a)| *j == equation || !a.is_empty()).map(from_output);
    let inputs = (0..e.b.len()).filter(|k| !e.b[*k].is_empty()).map(from_input);
    let terms: Vec<(Vec<f64>, &[f64])> = outputs.chain(inputs).collect();
    let reach = terms.iter().map(|(p, _)| p.len()).max().unwrap_or(1);
    let mut errors = vec![0.0; (experiment.len() + 1).saturating_sub(reach)];
    for (p, signal) in &terms {
        errors.iter_mut().zip(filter(p, signal, reach)).for_each(|(e, v)| *e += v);
    }
    errors
}
