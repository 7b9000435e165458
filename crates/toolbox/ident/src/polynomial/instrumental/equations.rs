//! The regression behind an estimate by instruments.

use faer::Mat;
use lti::PolynomialModel;

use crate::data::column;
use crate::data::regression::{Lagged, Regression, Signals, outputs_then_inputs};
use crate::polynomial::arx::{
    ArxOrders, Noise, filter, index_of, largest_pole, layout, polynomial_fit, solve_equations,
};
use crate::{Dataset, Experiment, Fit, IdentError};
use fitting::equation::Equation;

/// Radius that poles on the unit circle are pulled to.
const INSIDE: f64 = 0.9999;

/// Data with instruments, filtered for every equation.
pub(super) struct Instrumented<'a> {
    data: &'a Dataset,
    orders: &'a ArxOrders,
    /// For each experiment: outputs, inputs, instruments, all filtered; a set for each filter.
    filtered: Vec<Vec<Vec<f64>>>,
    /// Signals of one filter.
    set: usize,
    /// True if equations have filters of their own.
    several: bool,
    given: bool,
}

impl<'a> Instrumented<'a> {
    /// `instruments` take the place of the outputs, for each experiment samples × outputs; without them, earlier inputs
    /// are taken. One of `filters` an equation.
    pub(super) fn new(
        data: &'a Dataset,
        orders: &'a ArxOrders,
        instruments: Option<&[Mat<f64>]>,
        filters: &[Vec<f64>],
    ) -> Self {
        let reach = filters.iter().map(Vec::len).max().unwrap_or(1);
        let several = filters.windows(2).any(|pair| pair[0] != pair[1]);
        let used = if several { filters } else { &filters[..filters.len().min(1)] };
        let signals = outputs_then_inputs(data);
        let filter_experiment = |(index, record): (usize, &Vec<&[f64]>)| {
            let x = instruments.map(|x| &x[index]);
            let x = x.iter().flat_map(|x| (0..x.ncols()).map(|j| column(x.as_ref(), j)));
            let all: Vec<&[f64]> = record.iter().copied().chain(x).collect();
            used.iter().flat_map(|l| all.iter().map(|s| filter(l, s, reach))).collect()
        };
        let filtered = signals.iter().enumerate().map(filter_experiment).collect();
        let set = data.outputs() + data.inputs() + if instruments.is_some() { data.outputs() } else { 0 };
        Instrumented { data, orders, filtered, set, several, given: instruments.is_some() }
    }

    /// Solves the equations; `noise` is made from the number of rows and of parameters of the largest equation. Errors
    /// and loss are those of the model on the data as they are, not filtered.
    pub(super) fn fit(&self, noise: impl Fn(usize, usize) -> Noise) -> Result<Fit<PolynomialModel>, IdentError> {
        let (columns, equations) = self.layout();
        let signals: Signals<'_> = self.filtered.iter().map(|e| e.iter().map(Vec::as_slice).collect()).collect();
        let regression = Regression::new(&signals, columns);
        let widest = equations.iter().map(|e| e.regressors.len()).max().unwrap_or(0);
        let solved = solve_equations(&regression, &equations, noise(regression.rows, widest))?;
        let plain_signals = outputs_then_inputs(self.data);
        let (columns, equations) = layout(self.orders);
        let plain = Regression::new(&plain_signals, columns);
        let factor = plain.factor();
        let fit = polynomial_fit(self.orders, self.data.sample_time_s(), &plain, &factor, &equations, &solved)?;
        Ok(fit.doubting(self.data).made_by("instrumental variables", self.data))
    }

    fn layout(&self) -> (Vec<Lagged>, Vec<Equation>) {
        let (outputs, inputs) = (self.data.outputs(), self.data.inputs());
        let mut columns = Vec::new();
        let mut equations = Vec::new();
        for i in 0..outputs {
            let base = if self.several { i * self.set } else { 0 };
            let mut place = |c: &Lagged| index_of(&mut columns, Lagged::new(base + c.signal, c.lag));
            let phi = self.orders.regressors(i);
            let own: usize = self.orders.na[i].iter().sum();
            let regressors = phi.iter().map(&mut place).collect();
            let mut instruments: Vec<usize> = phi[own..].iter().map(&mut place).collect();
            if self.given {
                let behind = |c: &Lagged| Lagged::new(c.signal + outputs + inputs, c.lag);
                instruments.extend(phi[..own].iter().map(|c| place(&behind(c))));
            } else {
                let further = |k: usize| (self.orders.nk[i][k] + self.orders.nb[i][k]) as isize;
                let lags = |k: usize| Lagged::each(outputs + k, further(k)..further(k) + own as isize);
                let driving = (0..inputs).filter(|k| self.orders.nb[i][*k] > 0).flat_map(lags);
                instruments.extend(driving.map(|c| place(&c)));
            }
            equations.push(Equation { regressors, instruments, target: place(&Lagged::new(i, 0)) });
        }
        (columns, equations)
    }
}

/// The outputs of an ARX model for the inputs of every experiment, from rest and without noise. A missing input is
/// taken as the one before: instruments need not be exact.
pub(super) fn simulate(model: &PolynomialModel, data: &Dataset) -> Vec<Mat<f64>> {
    data.experiments().iter().map(|experiment| simulate_experiment(model, experiment)).collect()
}

fn simulate_experiment(model: &PolynomialModel, experiment: &Experiment) -> Mat<f64> {
    let (rows, inputs, outputs) = (experiment.len(), model.inputs(), model.outputs());
    let held = |u: &[f64]| {
        let mut last = 0.0;
        let hold = |v: &f64| {
            last = if v.is_nan() { last } else { *v };
            last
        };
        u.iter().map(hold).collect()
    };
    let u: Vec<Vec<f64>> = (0..inputs).map(|k| held(experiment.input(k))).collect();
    let mut x = vec![vec![0.0; rows]; outputs];
    for t in work::checked(0..rows) {
        for (i, e) in model.equations().iter().enumerate() {
            let of = |p: &[f64], first: usize, s: &[f64]| -> f64 {
                let lags = p.iter().enumerate().take_while(|(l, _)| first + l <= t);
                lags.map(|(l, v)| v * s[t - first - l]).sum()
            };
            let driven: f64 = (0..inputs).map(|k| of(&e.b[k], e.nk[k], &u[k])).sum();
            let past: f64 = (0..outputs).map(|j| of(&e.a[j], 1, &x[j])).sum();
            x[i][t] = driven - past;
        }
    }
    Mat::from_fn(rows, outputs, |t, i| x[i][t])
}

/// The same model where it is stable, otherwise with all poles pulled towards zero until it is.
pub(super) fn stabilised(model: &PolynomialModel) -> Result<PolynomialModel, IdentError> {
    let radius = largest_pole(model)?;
    if radius < 1.0 {
        return Ok(model.clone());
    }
    // a_l ρˡ is the polynomial whose roots are ρ times those of a; poles outside end about where they mirror.
    let ratio = (1.0 / radius).min(INSIDE) / radius;
    let mut equations = model.equations().to_vec();
    for a in equations.iter_mut().flat_map(|e| e.a.iter_mut()) {
        a.iter_mut().enumerate().for_each(|(l, v)| *v *= ratio.powi(l as i32 + 1));
    }
    Ok(PolynomialModel::new(model.sample_time_s(), equations, model.noise_covariance().to_owned())?)
}
