//! [`OrderScan`]: every ARX structure of a grid from one factorisation.

use std::ops::RangeInclusive;

use faer::Mat;
use numerics::linalg;
use work::Context;

use super::{Arx, ArxOrders, index_of};
use crate::data::regression::{Lagged, Regression, outputs_then_inputs};
use crate::{Criteria, Dataset, IdentError};
use fitting::StructureError;
use fitting::equation::factor_of;

/// A diagonal element of the factor below this fraction of its column: the column depends on those before it.
const DEPENDENT: f64 = 1e-11;

/// Compares ARX structures over a grid of orders and delays, the same numbers for every output and input.
///
/// The widest regression is factored once; every structure is a part of its factor. All structures are judged on the
/// same rows, those with enough past for the widest one, so their criteria can be compared. With validation data, which
/// are read once as well, each structure is also judged by its one-step prediction of data it has not seen.
///
/// # Example
/// ```
/// use ident::{Criterion, Dataset, OrderScan};
/// let mut random = signal::excitation::Random::new(1);
/// let (u, e): (Vec<f64>, Vec<f64>) = (0..2000).map(|_| (random.normal(), random.normal())).unzip();
/// let mut y = vec![0.0; 2000];
/// for t in 3..2000 {
///     y[t] = 1.5 * y[t - 1] - 0.7 * y[t - 2] + u[t - 2] + 0.5 * u[t - 3] + e[t];
/// }
/// let table = OrderScan::new(0..=4, 1..=4, 0..=3).run(&Dataset::siso(1.0, &u, &y)?)?;
/// let best = table.best(Criterion::Bic);
/// assert_eq!((best.na, best.nb, best.nk), (2, 2, 2));
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, §16.4–16.6 (criteria, cross-validation) and §10.1 (structures nested in one triangular factor).
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OrderScan {
    na: RangeInclusive<usize>,
    nb: RangeInclusive<usize>,
    nk: RangeInclusive<usize>,
}

/// One structure and its worth.
#[derive(Debug, Clone, PartialEq)]
pub struct ScannedStructure {
    /// Coefficients of outputs.
    pub na: usize,
    /// Coefficients of inputs.
    pub nb: usize,
    /// Delay, in samples.
    pub nk: usize,
    /// Coefficients in all.
    pub parameters: usize,
    /// Determinant of the mean of `ε εᵀ` on the data of the estimate.
    pub loss: f64,
    /// The same on the validation data.
    pub validation_loss: Option<f64>,
    /// One-step prediction fit on the validation data, in percent, the mean over the outputs that vary.
    pub validation_fit: Option<f64>,
    /// The criteria.
    pub criteria: Criteria,
}

/// Criterion for the choice of a structure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Criterion {
    /// Final prediction error.
    Fpe,
    /// Akaike's information criterion.
    Aic,
    /// The same, corrected for few samples.
    Aicc,
    /// Bayesian information criterion.
    Bic,
    /// Minimum description length.
    Mdl,
    /// Loss on the validation data; the loss of the estimate where there are none.
    Validation,
}

/// The structures of a scan that the data determine, in the order of `nk`, `nb`, `na`; never empty.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderTable {
    structures: Vec<ScannedStructure>,
    samples: usize,
    outputs: usize,
    inputs: usize,
}

impl OrderTable {
    /// All structures.
    #[must_use]
    pub fn structures(&self) -> &[ScannedStructure] {
        &self.structures
    }

    /// Rows that every structure was fitted to.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// The structure with the smallest value of a criterion; of equals, the first.
    #[must_use]
    pub fn best(&self, criterion: Criterion) -> &ScannedStructure {
        let value = |s: &ScannedStructure| match criterion {
            Criterion::Fpe => s.criteria.fpe,
            Criterion::Aic => s.criteria.aic,
            Criterion::Aicc => s.criteria.aicc,
            Criterion::Bic => s.criteria.bic,
            Criterion::Mdl => s.criteria.mdl,
            Criterion::Validation => s.validation_loss.unwrap_or(s.loss),
        };
        self.structures
            .iter()
            .reduce(|best, s| if value(s) < value(best) { s } else { best })
            .unwrap_or(&self.structures[0])
    }

    /// The options that estimate a structure of this table.
    #[must_use]
    pub fn arx(&self, structure: &ScannedStructure) -> Arx {
        let ScannedStructure { na, nb, nk, .. } = *structure;
        Arx::with_orders(ArxOrders::uniform(self.outputs, self.inputs, na, nb, nk))
    }
}

impl OrderScan {
    /// The grid of all `na`, `nb` and `nk` in these ranges.
    #[must_use]
    pub fn new(na: RangeInclusive<usize>, nb: RangeInclusive<usize>, nk: RangeInclusive<usize>) -> Self {
        OrderScan { na, nb, nk }
    }

    /// Fits every structure.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for an empty range or no parameter at all, [`IdentError::TooFewSamples`],
    /// [`IdentError::RankDeficient`] where the data determine no structure of the grid.
    pub fn run(&self, data: &Dataset) -> Result<OrderTable, IdentError> {
        self.run_as_step(&Context::new(), data, None)
    }

    /// Fits every structure to `data` and predicts `validation` with it.
    ///
    /// # Errors
    /// Those of [`OrderScan::run`], for either data; [`IdentError::Length`] where their channels differ.
    pub fn run_validated(&self, data: &Dataset, validation: &Dataset) -> Result<OrderTable, IdentError> {
        self.run_as_step(&Context::new(), data, Some(validation))
    }

    /// Structures of the grid.
    #[must_use]
    pub fn structures(&self) -> usize {
        length(&self.na).saturating_mul(length(&self.nb)).saturating_mul(length(&self.nk))
    }

    /// As [`OrderScan::run`], or [`OrderScan::run_validated`] where there are validation data. The structures are
    /// parts of a step of the work.
    ///
    /// # Errors
    /// Theirs.
    pub fn run_as_step(
        &self,
        context: &Context,
        data: &Dataset,
        validation: Option<&Dataset>,
    ) -> Result<OrderTable, IdentError> {
        let Some(validation) = validation else { return self.scan(context, data, None) };
        for (what, expected, found) in [
            ("inputs of the validation data", data.inputs(), validation.inputs()),
            ("outputs of the validation data", data.outputs(), validation.outputs()),
        ] {
            if expected != found {
                return Err(IdentError::Length { what, expected, found });
            }
        }
        self.scan(context, data, Some(validation))
    }

    fn scan(&self, context: &Context, data: &Dataset, validation: Option<&Dataset>) -> Result<OrderTable, IdentError> {
        let widest = self.widest(data)?;
        let (outputs, inputs) = (data.outputs(), data.inputs());
        let (estimation, validation) =
            (Factored::new(data, &widest)?, validation.map(|v| Factored::new(v, &widest)).transpose()?);
        let mut structures = Vec::new();
        let step = context.step("comparing the structures", self.structures() as u64);
        for nk in self.nk.clone() {
            for nb in self.nb.clone() {
                // Without coefficients of inputs their number and delay make no difference: the first stands for all.
                let undriven = inputs == 0 || nb == 0;
                let first = nk == *self.nk.start() && (inputs > 0 || nb == *self.nb.start());
                if !undriven || first {
                    let nest = Nest::new(&estimation, validation.as_ref(), (nb, nk), *self.na.end());
                    structures.extend(self.na.clone().filter_map(|na| nest.structure(na)));
                }
                step.advance(length(&self.na) as u64);
            }
        }
        if structures.is_empty() {
            return Err(IdentError::RankDeficient {
                rank: 0,
                parameters: widest.regressors(0).len(),
                condition: f64::INFINITY,
            });
        }
        Ok(OrderTable { structures, samples: estimation.rows, outputs, inputs })
    }

    /// The structure that holds all others. Delays of fewer samples have their columns in it too.
    fn widest(&self, data: &Dataset) -> Result<ArxOrders, IdentError> {
        for (what, range) in [("na", &self.na), ("nb", &self.nb), ("nk", &self.nk)] {
            if range.is_empty() {
                return Err(StructureError::EmptyRange { what, from: *range.start(), to: *range.end() }.into());
            }
        }
        let reach = self.nk.end().saturating_add(*self.nb.end()).max(*self.na.end());
        if reach >= data.samples() {
            return Err(IdentError::TooFewSamples { samples: data.samples(), parameters: reach });
        }
        let (first, span) = (*self.nk.start(), *self.nk.end() - *self.nk.start());
        let nb = if *self.nb.end() == 0 { 0 } else { self.nb.end() + span };
        let widest = ArxOrders::uniform(data.outputs(), data.inputs(), *self.na.end(), nb, first);
        widest.check(data)?;
        Ok(widest)
    }
}

/// Numbers in a range.
fn length(range: &RangeInclusive<usize>) -> usize {
    if range.is_empty() { 0 } else { (range.end() - range.start()).saturating_add(1) }
}

/// Data as the factor of their widest regression.
struct Factored {
    columns: Vec<Lagged>,
    factor: Mat<f64>,
    /// Norms of the outputs about their means, of those that vary.
    spread: Vec<Option<f64>>,
    rows: usize,
    outputs: usize,
    inputs: usize,
}

impl Factored {
    fn new(data: &Dataset, widest: &ArxOrders) -> Result<Self, IdentError> {
        let (outputs, inputs) = (data.outputs(), data.inputs());
        let mut columns = widest.regressors(0);
        (0..outputs).for_each(|signal| columns.push(Lagged::new(signal, 0)));
        let signals = outputs_then_inputs(data);
        let regression = Regression::new(&signals, columns.clone());
        if regression.rows < columns.len() {
            return Err(IdentError::TooFewSamples { samples: regression.rows, parameters: columns.len() - outputs });
        }
        let factor = regression.factor();
        let count = columns.len();
        let spread = regression.spreads(count - outputs..count);
        Ok(Factored { factor, spread, rows: regression.rows, outputs, inputs, columns })
    }

    /// The factor of the inputs at `nb` lags from `nk` on, then the outputs lag by lag up to `na`, then the outputs
    /// themselves.
    fn part(&self, (nb, nk): (usize, usize), na: usize) -> Mat<f64> {
        let (outputs, inputs) = (self.outputs, self.inputs);
        let driving = (nk..nk + nb).flat_map(|lag| (0..inputs).map(move |k| Lagged::new(outputs + k, lag as isize)));
        let own = (1..=na).flat_map(|lag| (0..outputs).map(move |i| Lagged::new(i, lag as isize)));
        let targets = (0..outputs).map(|i| Lagged::new(i, 0));
        let mut columns = self.columns.clone();
        let wanted = driving.chain(own).chain(targets);
        let wanted: Vec<usize> = wanted.map(|column| index_of(&mut columns, column)).collect();
        factor_of(&self.factor, &wanted)
    }
}

/// All structures of one `nb` and `nk`: each is the leading part of the next.
struct Nest<'a> {
    estimation: &'a Factored,
    validation: Option<&'a Factored>,
    orders: (usize, usize),
    factor: Mat<f64>,
    validation_factor: Option<Mat<f64>>,
}

impl<'a> Nest<'a> {
    fn new(estimation: &'a Factored, validation: Option<&'a Factored>, orders: (usize, usize), na: usize) -> Self {
        let factor = estimation.part(orders, na);
        let validation_factor = validation.map(|v| v.part(orders, na));
        Nest { estimation, validation, orders, factor, validation_factor }
    }

    /// `None` where the data do not determine the structure, or it has no parameter.
    fn structure(&self, na: usize) -> Option<ScannedStructure> {
        let Factored { outputs, inputs, rows, .. } = *self.estimation;
        let (nb, nk) = self.orders;
        let width = nb * inputs + na * outputs;
        let r = &self.factor;
        let determined = (0..width).all(|j| r[(j, j)].abs() > DEPENDENT * r.col(j).norm_l2());
        if width == 0 || rows <= width || !determined {
            return None;
        }
        let first = r.ncols() - outputs;
        let rest = r.get(width.., first..);
        let loss = determinant_of_mean(rest.transpose() * rest, rows);
        let parameters = width * outputs;
        let errors = self.validation_errors(width);
        let validated = errors.zip(self.validation);
        Some(ScannedStructure {
            na,
            nb,
            nk,
            parameters,
            loss,
            validation_fit: validated.as_ref().and_then(|(e, v)| {
                let fit = |i: usize| Some(100.0 * (1.0 - e[(i, i)].sqrt() / v.spread[i]?));
                let fits: Vec<f64> = (0..outputs).filter_map(fit).collect();
                (!fits.is_empty()).then(|| fits.iter().sum::<f64>() / fits.len() as f64)
            }),
            validation_loss: validated.map(|(e, v)| determinant_of_mean(e, v.rows)),
            criteria: Criteria::of(loss, parameters, rows, outputs),
        })
    }

    /// `Σ ε εᵀ` on the validation data: `‖R_v [θ; −1]‖²`.
    fn validation_errors(&self, width: usize) -> Option<Mat<f64>> {
        let unseen = self.validation_factor.as_ref()?;
        let first = self.factor.ncols() - self.estimation.outputs;
        let mut theta = self.factor.get(..width, first..).to_owned();
        let triangle = self.factor.get(..width, ..width);
        linalg::solve_upper(triangle, theta.as_mut());
        let errors = unseen.get(.., first..) - unseen.get(.., ..width) * &theta;
        Some(errors.transpose() * &errors)
    }
}

fn determinant_of_mean(products: Mat<f64>, rows: usize) -> f64 {
    let mean = faer::Scale(1.0 / rows as f64) * products;
    if mean.nrows() == 1 { mean[(0, 0)] } else { linalg::determinant(mean.as_ref()).max(0.0) }
}
