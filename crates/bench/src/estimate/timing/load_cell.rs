//! The load cell: a further delay and a second-order resonance behind the torque control.

use ident::{Bounds, IdentError};
use signal::{Complex64, Signal};

use crate::estimate::parameter::Label;
use crate::estimate::timing_floor_s;
use crate::estimate::torque_control::{
    EARLIEST_S, HeldDemand, InverterModel, LONGEST_DELAY_S, Mode, Observed, Response, RippledModel, fit_with_ripple,
    robust_covariance, usable_samples,
};
use crate::study::{Estimate, Parameter, Stretch};

/// Relative step of the numerical derivatives by ω_n and ζ: error and rounding are both near 1e-10.
const STEP: f64 = 1e-5;
/// The longest delay of a load cell looked for, behind the longest of the torque control, s.
const LONGEST_S: f64 = 0.03;
const NATURAL_RAD_S: (f64, f64) = (30.0, 3000.0);
const DAMPING: (f64, f64) = (0.01, 0.95);

const CELL_DELAY: Label = Label { symbol: "τ_cell", name: "delay of the load cell", unit: "s" };
const NATURAL: Label = Label { symbol: "ω_n", name: "natural frequency of the load cell", unit: "rad/s" };
const RATIO: Label = Label { symbol: "ζ", name: "damping ratio of the load cell", unit: "1" };
const TOTAL: Label = Label { symbol: "τ_total", name: "total delay against T_d*", unit: "s" };

/// What was found about the load cell.
pub(super) struct LoadCell {
    /// τ_cell, ω_n, ζ.
    pub(super) dynamics: Estimate,
    /// τ + 1/a + τ_cell + 2ζ/ω_n.
    pub(super) total: Parameter,
    /// Whether it reached a minimum inside its bounds.
    pub(super) usable: bool,
}

/// e^{−sD} a/(s + a) ω_n²/(s² + 2ζω_n s + ω_n²) on the held demand, a known; θ = (D, ω_n, ζ).
///
/// With the poles −a, −α, −ᾱ, α = ω_n(ζ − j√(1 − ζ²)), this is the sum of modes k_a x_a + 2 Re(k_α x_α),
/// k_a = ω_n²/|α − a|², k_α = a ω_n²/(α (a − α)(ᾱ − α)).
struct CellResponse<'a> {
    lag: Mode<'a>,
    resonance: Mode<'a>,
    rate: f64,
}

impl<'a> CellResponse<'a> {
    fn new(demand: &'a HeldDemand, rate: f64) -> Self {
        let mut lag = Mode::new(demand);
        lag.set_rate(Complex64::from(rate));
        CellResponse { lag, resonance: Mode::new(demand), rate }
    }

    /// Calls `each` with the index, the value and its derivative by the delay at every instant.
    fn run(&mut self, parameters: [f64; 3], times_s: &[f64], mut each: impl FnMut(usize, f64, f64)) {
        let [delay, natural, damping] = parameters;
        let a = self.rate;
        let alpha = Complex64::new(damping, -(1.0 - damping * damping).max(0.0).sqrt()) * natural;
        let square = natural * natural;
        let of_lag = square / (alpha - a).norm_sqr();
        let of_resonance =
            Complex64::from(a * square) / (alpha * (Complex64::from(a) - alpha) * (alpha.conj() - alpha));
        self.resonance.set_rate(alpha);
        for (i, time) in times_s.iter().enumerate() {
            let (slow, fast) = (self.lag.at(*time, delay), self.resonance.at(*time, delay));
            let sum = |x: Complex64, y: Complex64| of_lag * x.re + 2.0 * (of_resonance * y).re;
            each(i, sum(slow.value, fast.value), sum(slow.by_delay, fast.by_delay));
        }
    }
}

impl Response for CellResponse<'_> {
    fn parameter_count(&self) -> usize {
        3
    }

    fn evaluate(
        &mut self,
        parameters: &[f64],
        times_s: &[f64],
        values: &mut [f64],
        derivatives: Option<&mut [Vec<f64>]>,
    ) {
        let point = [parameters[0], parameters[1], parameters[2]];
        let Some([by_delay, rest @ ..]) = derivatives else {
            return self.run(point, times_s, |i, value, _| values[i] = value);
        };
        for (k, column) in rest.iter_mut().enumerate() {
            let step = STEP * point[k + 1];
            let (mut above, mut below) = (point, point);
            above[k + 1] += step;
            below[k + 1] -= step;
            self.run(above, times_s, |i, value, _| column[i] = value);
            self.run(below, times_s, |i, value, _| column[i] = (column[i] - value) / (2.0 * step));
        }
        self.run(point, times_s, |i, value, slope| (values[i], by_delay[i]) = (value, slope));
    }
}

/// Fits the load cell, with ripple of its own, behind a known torque control, whose delay has the variance `delay_variance` (s²).
///
/// The product of ripple and torque is not passed through the cell: at ripple of 3 % near the resonance ω_n comes out
/// about 0.7 % low, more than the standard errors say; the delays are not affected noticeably.
///
/// # Errors
/// Too few samples, or data that do not determine the parameters.
pub(super) fn fit(
    demand: &Signal,
    cell: &Signal,
    inverter: &InverterModel,
    delay_variance: f64,
    stretch: &Stretch,
) -> Result<LoadCell, IdentError> {
    let held = HeldDemand::new(demand, inverter.torque_limit_nm);
    let usable = usable_samples(demand, cell, inverter.torque_limit_nm);
    let observed = Observed::new(cell, &usable, 0..cell.len());
    let longest = LONGEST_DELAY_S + LONGEST_S;
    let bounds = [
        Bounds::new(-EARLIEST_S, longest),
        Bounds::new(NATURAL_RAD_S.0, NATURAL_RAD_S.1),
        Bounds::new(DAMPING.0, DAMPING.1),
    ];
    let mut model = RippledModel::new(CellResponse::new(&held, inverter.lag_rad_s), &observed);
    let fit = fit_with_ripple(&mut model, &starts(longest), &bounds)?;
    let (p, freedom) = robust_covariance(&fit, observed.sample_time_s)?;
    let [late, natural, damping] = [fit.parameters[0], fit.parameters[1], fit.parameters[2]];
    let gradient = [1.0, -2.0 * damping / (natural * natural), 2.0 / natural];
    let pairs = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    let variance: f64 = pairs.map(|(i, j)| gradient[i] * p[(i, j)] * gradient[j]).sum();
    let dated = timing_floor_s(demand.sample_time_s);
    let total = late + 1.0 / inverter.lag_rad_s + 2.0 * damping / natural;
    let mut covariance: Vec<Vec<f64>> = (0..3).map(|i| (0..3).map(|j| p[(i, j)]).collect()).collect();
    covariance[0][0] += delay_variance;
    let values = [(CELL_DELAY, late - inverter.delay_s), (NATURAL, natural), (RATIO, damping)];
    let parameter =
        |(i, (label, value)): (usize, &(Label, f64))| Parameter::new(*label, *value, covariance[i][i].sqrt(), freedom);
    Ok(LoadCell {
        dynamics: Estimate {
            parameters: values.iter().enumerate().map(parameter).collect(),
            covariance: covariance.clone(),
            stretches: vec![stretch.clone()],
            iterations: fit.iterations,
            condition: fit.condition,
        },
        total: Parameter::new(TOTAL, total, variance.sqrt().hypot(dated), freedom),
        usable: fit.termination.converged() && !fit.at_bound[..3].contains(&true),
    })
}

/// A grid of delays, natural frequencies and one damping ratio.
fn starts(longest_s: f64) -> Vec<Vec<f64>> {
    let delays = (0..).map(|j| 1e-3 * f64::from(j) - EARLIEST_S).take_while(|d| *d < longest_s);
    let naturals = [150.0, 300.0, 450.0, 700.0, 1200.0];
    delays.flat_map(|d| naturals.map(|w| vec![d, w, 0.3])).collect()
}
