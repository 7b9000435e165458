//! ARX models by linear least squares.

mod estimate;
mod orders;
mod scan;
mod whitening;

use lti::PolynomialModel;

pub(crate) use estimate::{Noise, largest_pole, polynomial_fit, solve_equations};
pub use orders::ArxOrders;
pub use scan::{Criterion, OrderScan, OrderTable, ScannedStructure};
pub(crate) use whitening::{filter, whitening_filter};

use crate::data::regression::{Lagged, Regression, outputs_then_inputs};
use crate::{Dataset, Fit, IdentError};
use fitting::equation::Equation;

/// Estimates an ARX model, one equation an output:
///
/// `y_i(t) + Σ_j Σ_l a_ij,l y_j(t − l) = Σ_k Σ_l b_ik,l u_k(t − nk_ik − l) + e_i(t)`
///
/// with `l = 1…na_ij` and `l = 0…nb_ik − 1`. Without inputs it is an autoregression (AR). Least squares over all
/// experiments; an experiment's first rows, which lack some of their past, and rows that touch a missing sample of any
/// channel the model uses are left out, the same rows in every equation. No initial condition is assumed.
///
/// The covariance holds for white `e` that may be correlated between outputs; see [`Arx::robust`] for coloured `e`. The
/// data are read once, in blocks.
///
/// # Example
/// ```
/// use ident::{Arx, Dataset};
/// // y(t) = 0.5 y(t−1) + 2 u(t−1), started at y = 1
/// let u: Vec<f64> = (0..50).map(|t| f64::from(t * t % 7)).collect();
/// let mut y = vec![1.0];
/// for t in 1..50 {
///     y.push(0.5 * y[t - 1] + 2.0 * u[t - 1]);
/// }
/// let fit = Arx::new(1, 1, 1).fit(&Dataset::siso(0.1, &u, &y)?)?;
/// let theta = fit.parameters();
/// assert!((theta[0] + 0.5).abs() < 1e-12 && (theta[1] - 2.0).abs() < 1e-12);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, (4.7), (7.34) and §10.1.
#[derive(Debug, Clone, PartialEq)]
pub struct Arx {
    orders: ArxOrders,
    noise: Noise,
}

impl Arx {
    /// One input and one output: `na` and `nb` coefficients, delay `nk`.
    #[must_use]
    pub fn new(na: usize, nb: usize, nk: usize) -> Self {
        Self::with_orders(ArxOrders::siso(na, nb, nk))
    }

    /// One output without input: an autoregression with `na` coefficients.
    #[must_use]
    pub fn autoregression(na: usize) -> Self {
        Self::with_orders(ArxOrders::miso(na, &[], &[]))
    }

    /// Several inputs or outputs.
    #[must_use]
    pub fn with_orders(orders: ArxOrders) -> Self {
        Arx { orders, noise: Noise::White }
    }

    /// Takes the covariance from the scatter between `batches` equal stretches of the data, right also where `e` is
    /// coloured. A stretch has to be long against the memory of the system; 10 to 30 of them are usual. The data are
    /// read a second time.
    #[must_use]
    pub fn robust(mut self, batches: usize) -> Self {
        self.noise = Noise::Coloured { batches };
        self
    }

    /// Fits the model to data.
    ///
    /// # Errors
    /// [`IdentError::Length`] where the orders are not made for the channels of the data,
    /// [`IdentError::TooFewSamples`], [`IdentError::RankDeficient`] where the data do not determine every coefficient,
    /// [`IdentError::Structure`] where there is none.
    pub fn fit(&self, data: &Dataset) -> Result<Fit<PolynomialModel>, IdentError> {
        self.orders.check(data)?;
        let signals = outputs_then_inputs(data);
        let (columns, equations) = layout(&self.orders);
        let regression = Regression::new(&signals, columns);
        let solved = solve_equations(&regression, &equations, self.noise)?;
        let fit = polynomial_fit(&self.orders, data.sample_time_s(), &regression, &solved.factor, &equations, &solved)?;
        Ok(fit.doubting(data).made_by("least squares", data))
    }
}

/// The columns all equations need, each once, the targets last, and the equations in terms of them.
pub(crate) fn layout(orders: &ArxOrders) -> (Vec<Lagged>, Vec<Equation>) {
    let outputs = orders.na.len();
    let mut columns: Vec<Lagged> = Vec::new();
    let regressors: Vec<Vec<usize>> =
        (0..outputs).map(|i| orders.regressors(i).iter().map(|c| index_of(&mut columns, *c)).collect()).collect();
    let equations = regressors
        .into_iter()
        .enumerate()
        .map(|(i, regressors)| Equation {
            instruments: regressors.clone(),
            regressors,
            target: index_of(&mut columns, Lagged::new(i, 0)),
        })
        .collect();
    (columns, equations)
}

/// Where a column stands, appended if it was not there.
pub(crate) fn index_of(columns: &mut Vec<Lagged>, column: Lagged) -> usize {
    columns.iter().position(|c| *c == column).unwrap_or_else(|| {
        columns.push(column);
        columns.len() - 1
    })
}
