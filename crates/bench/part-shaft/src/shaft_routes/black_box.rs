//! J_d, J_e, K and B from the coefficients of a black-box model T_d → ω_d.
//!
//! The engine's torque is a disturbance. What of it repeats with the crank angle is given to the model as cos nθ and
//! sin nθ, θ from ω_e, for the orders n of a working cycle; the rest is noise of a spectrum of its own, ω_d = B/F T_d +
//! Σ orders + e/D. An ARMAX model, whose noise shares the poles of the dynamics, does as well where the engine is
//! motored; beside a fired engine, whose torque scatters about its firing lines, it bends the poles.
//!
//! The sampled two-mass system has three poles, one of them at z = 1 (free rotation), and five coefficients in B where
//! the input is straight within samples and given by its means. Its eight coefficients ρ(θ) are compared with those
//! estimated, V(θ) = (ρ(θ) − ρ̂)ᵀ P⁻¹ (ρ(θ) − ρ̂), P the covariance of ρ̂: at the minimum V is χ² with four degrees of
//! freedom where the bench has two masses, and (JᵀP⁻¹J)⁻¹ is the covariance of θ = (J_d, J_e, K, B).
//!
//! In torque control the engine's own control of its speed, P ω_e + I ∫ω_e, is part of what T_d sees: with it the
//! system has four poles, and θ has P and I too. The control is taken to act at once. One that acts at firings is late
//! by half the time between them, which near the resonance turns P from damping into inertia: B is then too small by up
//! to P times the square of J_d/J_e, J_e off by some per cent, and V too large where the data are good enough to show
//! it.
//!
//! The model has samples 1 ms apart, or as far as those of N_d, whatever T_d was recorded on; what is above half of
//! T_d's own rate is folded there, into the noise as a rule. A T_d that is not straight within a sample bends the
//! inertias by more than the coefficients scatter: with samples 2 ms apart, J_d by 0.1 % and J_e by 0.2 %.
//!
//! # Source
//! Söderström, Stoica & Friedlander, *An indirect prediction error method for system identification*, Automatica 27,
//! 1991; thesis (2.4), (6.9), §6.3.5.1; Langthaler & del Re, *Robust model predictive control of combustion engine test
//! benches* (motored engine over crank angle).

use faer::{Mat, MatMut, mat};
use ident::distributions::chi_squared_tail;
use ident::{Bounds, Dataset, Fit, IdentError, Minimum, NonlinearOptions, Polynomial, ResidualModel, minimise};
use lti::{LtiError, PolynomialModel, StateSpace};
use numerics::linalg;
use numerics::null::nan_if_null;
use rig::estimation::{EstimateError, Unsuitable, timing_floor_s};
use rig::experiment::ControlMode;
use rig::facts::Engine;
use rig::results::{Estimate, Quantity};
use serde::{Deserialize, Serialize};
use signal::Complex64;

use super::aligned::{Aligned, Clocks, TorqueSample, inner_stretch};
use super::{Timing, estimate_of, flange_torque};
use crate::shaft::ShaftInputs;

/// Orders go up to so many firing orders.
const FIRING_ORDERS: f64 = 2.0;
/// Coefficients of the noise's spectrum.
const NOISE_ORDER: usize = 12;
/// About how far samples are apart, s.
const SAMPLE_TIME_S: f64 = 1e-3;
/// The same for a model that starting values are taken from, s.
const COARSE_S: f64 = 2e-3;
/// Uncertainty of inertias, K and B that comes from the shape of T_d within a sample: this part of them, for each
/// second of a sample. With samples 1 ms apart J_d was off by 0.02 to 0.06 % in the median of three sets of benches
/// drawn over the class, and by 0.16 % at most where two masses explained the coefficients, however little these
/// scattered.
const SHAPE_PER_S: f64 = 1.0;
/// Orders stay below this part of the sample rate.
const HIGHEST_PART: f64 = 0.4;
/// Below this probability a two-mass model does not explain the coefficients.
const LEAST_PROBABILITY: f64 = 0.01;
/// Coefficients that miss those of two masses by so many times their scatter do not come from two masses.
const FAR: f64 = 10.0;
/// Step of differences, as a part of a parameter.
const STEP: f64 = 1e-5;
/// Parts of J_d that J_e is started from.
const START_PARTS: [f64; 4] = [0.1, 0.3, 1.0, 3.0];
/// Intervals that reach zero within so many standard errors mean nothing.
const SEPARATED: f64 = 2.0;

/// Control of the engine.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum EngineControl {
    /// Nothing that answers to its speed (NT): two masses.
    None,
    /// Its own speed control (TN), which the model has too.
    Speed,
}

/// The structure of the black box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BlackBoxOrders {
    /// Coefficients of F; B has two more.
    pub dynamics: usize,
    /// Coefficients of D.
    pub noise: usize,
    /// Orders of the crank angle.
    #[serde(deserialize_with = "nan_if_null")]
    pub crank: Vec<f64>,
}

/// Why not to take a black box's parameters for the bench's.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum BlackBoxDoubt {
    /// The coefficients are not those of a two-mass system.
    NotTwoMasses,
    /// J_e is too small to be seen beside J_d: zero lies in its interval, or K in one that is open.
    EngineInertiaTooSmall,
    /// The antiresonance is not separated from the resonance.
    ModesNotSeparated,
}

/// A bench's parameters by a black box.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BlackBoxRoute {
    /// J_d, J_e, K, B.
    pub estimate: Estimate,
    /// The structure.
    pub orders: BlackBoxOrders,
    /// Coefficients f_1 … and b_0 … with their standard errors.
    #[serde(deserialize_with = "nan_if_null")]
    pub coefficients: Vec<(String, f64, f64)>,
    /// V at the minimum, and its degrees of freedom.
    #[serde(deserialize_with = "nan_if_null")]
    pub chi_squared: (f64, f64),
    /// Probability that a two-mass bench gives so large a V.
    #[serde(deserialize_with = "nan_if_null")]
    pub probability: f64,
    /// √(K/J_e) and √(K(1/J_d + 1/J_e)) with their standard errors, Hz: free engine against fixed dynamometer.
    #[serde(deserialize_with = "nan_if_null")]
    pub antiresonance_hz: (f64, f64),
    /// Resonance, as above.
    #[serde(deserialize_with = "nan_if_null")]
    pub resonance_hz: (f64, f64),
    /// Reasons not to take the parameters for the bench's; none where they are determined.
    pub doubts: Vec<BlackBoxDoubt>,
    /// Sample time of the model, s.
    #[serde(deserialize_with = "nan_if_null")]
    pub sample_time_s: f64,
}

/// Estimates J_d, J_e, K and B from T_d and ω_d. J_d of the inputs serves as the start alone.
///
/// # Errors
/// A recording that is too short, a torque that is that of a flange, data that do not determine the coefficients, or
/// coefficients that are far from those of two masses.
pub fn estimate(
    inputs: &ShaftInputs<'_>,
    timing: &Timing,
    engine: Engine,
    mode: ControlMode,
) -> Result<BlackBoxRoute, EstimateError> {
    let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
    let unsuitable = |reason| EstimateError::Unsuitable { file: inputs.file.to_owned(), reason };
    let Some((inertia, _)) = inputs.inertia_kg_m2 else {
        return Err(flange_torque(inputs, "black box"));
    };
    let stretch = inner_stretch(inputs)?;
    let clocks = Clocks { engine_s: timing.engine_skew_s.0, torque_s: timing.torque_skew_s.0, gate_s: timing.gate_s.0 };
    let control = EngineControl::of(mode);
    // What is uncertain of the gate shifts the torque's mean by half of it.
    let skew_s =
        timing.torque_skew_s.1.hypot(0.5 * timing.gate_s.1).hypot(timing_floor_s(inputs.dyno_speed.sample_time_s));
    let prepared = |sample_time_s: f64| -> Result<Prepared, EstimateError> {
        let signals = Aligned::new(inputs, &stretch, clocks, TorqueSample::HeldFor(sample_time_s))?;
        Prepared::new(&signals, engine, control).map_err(of)
    };
    let fine = prepared(SAMPLE_TIME_S)?;
    let around = Around { control, skew_s, inertia_kg_m2: inertia };
    let freedom = (2 * control.poles() + 2 - control.unknowns()) as f64;
    let probability_of = |found: &Minimum| chi_squared_tail(found.cost, freedom);
    let compared = |fit: &Fit<PolynomialModel>| {
        let measured = Coefficients::of(fit, control.poles());
        around.two_masses(&measured, fine.sample_time_s()).map(|found| (measured, found))
    };
    let mut fit = polynomial(&fine.orders).fit(&fine.data).map_err(of)?;
    let mut found = compared(&fit);
    let explained = found.as_ref().is_ok_and(|(_, found)| probability_of(found) >= LEAST_PROBABILITY);
    if !explained && fine.sample_time_s() < COARSE_S {
        let again = prepared(COARSE_S).ok().and_then(|coarse| around.started_coarsely(&coarse, &fine, &fit));
        if let Some(again) = again.filter(|again| again.loss < fit.loss) {
            (found, fit) = (compared(&again), again);
        }
    }
    let (measured, found) = found.map_err(unsuitable)?;
    let probability = probability_of(&found);
    let quantities = [
        Quantity::DynoInertia,
        Quantity::EngineInertia,
        Quantity::Stiffness,
        Quantity::Damping,
        Quantity::EngineProportionalGain,
        Quantity::EngineIntegralGain,
    ];
    if found.cost > FAR * FAR * freedom {
        return Err(unsuitable(Unsuitable::NotTwoMasses));
    }
    // Where two masses do not explain the coefficients, they miss by more than these scatter.
    let explained = probability >= LEAST_PROBABILITY;
    let widening = if explained { 1.0 } else { found.cost / freedom };
    let covariance = &(faer::Scale(widening) * &found.unscaled_covariance);
    let count = control.unknowns();
    let shape = |i: usize| if i < 4 { SHAPE_PER_S * fine.sample_time_s() * found.parameters[i] } else { 0.0 };
    let entry = |i: usize, j: usize| covariance[(i, j)] + if i == j { shape(i).powi(2) } else { 0.0 };
    let rows = (0..count).map(|i| (0..count).map(|j| entry(i, j)).collect()).collect();
    let values: Vec<_> = quantities.into_iter().zip(found.parameters.iter().copied()).take(count).collect();
    let hertz = |f: fn(&[f64]) -> f64| {
        let variance = ident::covariance::delta_variance(&found.parameters, covariance, f);
        (f(&found.parameters), variance.max(0.0).sqrt())
    };
    let antiresonance_hz = hertz(|p| (p[2] / p[1]).sqrt() / std::f64::consts::TAU);
    let resonance_hz = hertz(|p| (p[2] * (1.0 / p[0] + 1.0 / p[1])).sqrt() / std::f64::consts::TAU);
    let part = hertz(|p| 1.0 - (p[0] / (p[0] + p[1])).sqrt());
    let reaches_zero =
        |i: usize| found.parameters[i] < SEPARATED * covariance[(i, i)].max(0.0).sqrt() || found.at_bound[i];
    let mut doubts = Vec::new();
    if !explained {
        doubts.push(BlackBoxDoubt::NotTwoMasses);
    }
    if reaches_zero(1) || reaches_zero(2) {
        doubts.push(BlackBoxDoubt::EngineInertiaTooSmall);
    } else if part.0 < SEPARATED * part.1 {
        doubts.push(BlackBoxDoubt::ModesNotSeparated);
    }
    Ok(BlackBoxRoute {
        estimate: estimate_of(&values, rows, fit.degrees_of_freedom, stretch, (found.iterations, found.condition)),
        coefficients: measured.named(),
        orders: fine.orders,
        chi_squared: (found.cost, freedom),
        probability,
        antiresonance_hz,
        resonance_hz,
        doubts,
        sample_time_s: fine.data.sample_time_s(),
    })
}

/// Data for the black box, and its structure.
struct Prepared {
    data: Dataset,
    orders: BlackBoxOrders,
}

impl Prepared {
    fn new(signals: &Aligned, engine: Engine, control: EngineControl) -> Result<Self, IdentError> {
        let regressors = CrankOrders::new(signals, engine);
        let data = regressors.data(signals)?;
        Ok(Prepared {
            data,
            orders: BlackBoxOrders { dynamics: control.poles(), noise: NOISE_ORDER, crank: regressors.orders },
        })
    }

    fn sample_time_s(&self) -> f64 {
        self.data.sample_time_s()
    }
}

/// Knowledge that goes with the coefficients to the parameters.
struct Around {
    control: EngineControl,
    /// Standard uncertainty of the torque's skew, s.
    skew_s: f64,
    /// J_d to start from.
    inertia_kg_m2: f64,
}

impl Around {
    /// The parameters that suit coefficients.
    fn two_masses(&self, measured: &Coefficients, sample_time_s: f64) -> Result<Minimum, Unsuitable> {
        let whitened = Whitened::new(measured, sample_time_s, self.control, self.skew_s)?;
        let start =
            |part: &f64| self.control.start(measured, self.inertia_kg_m2, part * self.inertia_kg_m2, sample_time_s);
        let all = START_PARTS.iter().filter_map(|part| whitened.fit(&start(part)).ok());
        all.min_by(|a, b| a.cost.total_cmp(&b.cost)).ok_or(Unsuitable::NotTwoMasses)
    }

    /// The model once more, from the parameters of one with samples further apart. Poles are close to one where samples
    /// are close: a search may then miss the resonance of a shaft with little damping, which the noise model takes up.
    fn started_coarsely(
        &self,
        coarse: &Prepared,
        fine: &Prepared,
        like: &Fit<PolynomialModel>,
    ) -> Option<Fit<PolynomialModel>> {
        let n = self.control.poles();
        let fit = polynomial(&coarse.orders).fit(&coarse.data).ok()?;
        let found = self.two_masses(&Coefficients::of(&fit, n), coarse.sample_time_s()).ok()?;
        let (skew_s, parameters) = found.parameters.split_last()?;
        let rho = self.control.coefficients(parameters, *skew_s, fine.sample_time_s()).ok()?;
        let (names, values) = (fit.model.coefficient_names(), fit.parameters());
        let start = |name: &String| match rho_names(n).position(|own| own == *name) {
            Some(place) => rho[place],
            // The noise model starts anew; what the crank angle adds is the same.
            None if name.starts_with('d') => 0.0,
            None => names.iter().position(|own| own == name).map_or(0.0, |place| values[place]),
        };
        let start = like.model.coefficient_names().iter().map(start).collect();
        polynomial(&fine.orders).starting_at(vec![start]).fit(&fine.data).ok()
    }
}

/// Names of f_1 … f_n and b_0 … b_{n+1} of the torque in a model of several inputs.
fn rho_names(n: usize) -> impl Iterator<Item = String> {
    (0..2 * n + 2).map(move |i| if i < n { format!("f{}[1]", i + 1) } else { format!("b{}[1]", i - n) })
}

impl EngineControl {
    fn of(mode: ControlMode) -> Self {
        match mode {
            ControlMode::Nt => EngineControl::None,
            ControlMode::Tn => EngineControl::Speed,
        }
    }

    /// Poles of T_d → ω_d.
    fn poles(self) -> usize {
        match self {
            EngineControl::None => 3,
            EngineControl::Speed => 4,
        }
    }

    /// Why coefficients with a singular covariance mean nothing.
    fn not_separated(self) -> Unsuitable {
        let (poles, coefficients) = match self {
            EngineControl::None => (3, 5),
            EngineControl::Speed => (4, 6),
        };
        Unsuitable::CoefficientsNotSeparated { poles, coefficients, speed_control: self == EngineControl::Speed }
    }

    fn unknowns(self) -> usize {
        match self {
            EngineControl::None => 4,
            EngineControl::Speed => 6,
        }
    }

    /// Parameters to start from: K and B that go with two inertias and the resonance among the poles.
    fn start(self, measured: &Coefficients, dyno: f64, engine: f64, sample_time_s: f64) -> Vec<f64> {
        let n = self.poles();
        let f: Vec<f64> = std::iter::once(1.0).chain(measured.values[..n].iter().copied()).rev().collect();
        let poles = lti::polynomial::roots(&f).unwrap_or_default();
        let fastest = poles.iter().map(|z| z.ln() / sample_time_s).filter(|s| s.im > 0.0);
        let resonance = fastest.max_by(|a, b| a.im.total_cmp(&b.im)).unwrap_or(Complex64::new(-10.0, 100.0));
        let reduced = dyno * engine / (dyno + engine);
        let (stiffness, damping) = (resonance.norm_sqr() * reduced, (-2.0 * resonance.re * reduced).max(1e-3));
        [dyno, engine, stiffness, damping, 1.0, 1.0][..self.unknowns()].to_vec()
    }

    /// T_d → ω_d at (J_d, J_e, K, B, P, I). States ω_d, ω_e, the twist, ∫ω_e.
    fn system(self, p: &[f64]) -> Result<StateSpace, LtiError> {
        let [dyno, engine, k, b] = p[..4] else { return Err(LtiError::NotContinuous) };
        let row = |i: usize, j: usize, inertia: f64, sign: f64| match (i, j) {
            (_, 0) => -sign * b / inertia,
            (_, 1) => sign * b / inertia,
            _ => sign * k / inertia,
        };
        let n = self.poles();
        let mut a = Mat::zeros(n, n);
        for j in 0..3 {
            a[(0, j)] = row(0, j, dyno, 1.0);
            a[(1, j)] = row(1, j, engine, -1.0);
        }
        (a[(2, 0)], a[(2, 1)]) = (-1.0, 1.0);
        if let [proportional, integral] = p[4..] {
            a[(1, 1)] -= proportional / engine;
            a[(1, 3)] = -integral / engine;
            a[(3, 1)] = 1.0;
        }
        let mut input = Mat::zeros(n, 1);
        input[(0, 0)] = -1.0 / dyno;
        let mut output = Mat::zeros(1, n);
        output[(0, 0)] = 1.0;
        StateSpace::continuous(a, input, output, mat![[0.0]])
    }

    /// ρ(θ): f_1 … f_n and b_0 … b_{n+1} of the system under inputs that are straight within samples, given by their
    /// means, which are `skew_s` older than they should be.
    fn coefficients(self, p: &[f64], skew_s: f64, sample_time_s: f64) -> Result<Vec<f64>, LtiError> {
        let n = self.poles();
        let straight = self.system(p)?.to_discrete_foh(sample_time_s)?;
        let f = characteristic(&straight.a().to_owned());
        let held = straight.b0() + straight.b1();
        // A slope of (u(k+1) − u(k−1))/2T about the mean adds this at k, and takes it off at k + 2.
        let slope =
            faer::Scale(0.25) * (straight.b1() - straight.b0()) + faer::Scale(0.5 * skew_s / sample_time_s) * &held;
        let output = |state: &Mat<f64>| state[(0, 0)];
        let mut state = slope.clone();
        let mut impulse = vec![output(&state)];
        for k in 1..n + 2 {
            state = straight.a() * &state;
            match k {
                1 => state += &held,
                2 => state -= &slope,
                _ => (),
            }
            impulse.push(output(&state));
        }
        // B is F times the impulse response.
        let b = (0..n + 2).map(|k| (0..=k.min(n)).map(|i| f[i] * impulse[k - i]).sum::<f64>());
        Ok(f[1..].iter().copied().chain(b).collect())
    }
}

/// Coefficients of det(zI − Φ), the first one.
///
/// # Source
/// Faddeev & Le Verrier.
fn characteristic(phi: &Mat<f64>) -> Vec<f64> {
    let n = phi.nrows();
    let mut coefficients = vec![1.0];
    let mut m = Mat::<f64>::zeros(n, n);
    for k in 1..=n {
        m = phi * &m + faer::Scale(coefficients[k - 1]) * Mat::<f64>::identity(n, n);
        let product = phi * &m;
        let trace: f64 = (0..n).map(|i| product[(i, i)]).sum();
        coefficients.push(-trace / k as f64);
    }
    coefficients
}

/// cos nθ and sin nθ of the crank angle.
struct CrankOrders {
    orders: Vec<f64>,
    angle: Vec<f64>,
}

impl CrankOrders {
    fn new(signals: &Aligned, engine: Engine) -> Self {
        let mut at = 0.0;
        let angle: Vec<f64> = signals
            .engine
            .iter()
            .map(|omega| {
                at += omega * signals.sample_time_s;
                at
            })
            .collect();
        let fastest = signals.engine.iter().copied().fold(0.0, f64::max);
        let lowest = 2.0 / f64::from(engine.strokes);
        let limit = HIGHEST_PART * std::f64::consts::TAU / (signals.sample_time_s * fastest.max(1.0));
        let highest = (FIRING_ORDERS * engine.firings_per_turn()).min(limit);
        let orders = (1..).map(|k| f64::from(k) * lowest).take_while(|n| *n <= highest).collect();
        CrankOrders { orders, angle }
    }

    /// T_d and the orders as inputs, ω_d as the output, means removed.
    fn data(&self, signals: &Aligned) -> Result<Dataset, IdentError> {
        let rows = signals.dyno.len();
        let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len().max(1) as f64;
        let (level, speed) = (mean(&signals.torque), mean(&signals.dyno));
        let wave = |i: usize, j: usize| {
            let angle = self.orders[j / 2] * self.angle[i];
            if j.is_multiple_of(2) { angle.cos() } else { angle.sin() }
        };
        let input = |i: usize, j: usize| if j == 0 { signals.torque[i] - level } else { wave(i, j - 1) };
        let inputs = Mat::from_fn(rows, 1 + 2 * self.orders.len(), input);
        let output = Mat::from_fn(rows, 1, |i, _| signals.dyno[i] - speed);
        Dataset::new(signals.sample_time_s, inputs, output)
    }
}

fn polynomial(orders: &BlackBoxOrders) -> Polynomial {
    let waves = 2 * orders.crank.len();
    let nb: Vec<usize> = std::iter::once(orders.dynamics + 2).chain(std::iter::repeat_n(1, waves)).collect();
    let nf: Vec<usize> = std::iter::once(orders.dynamics).chain(std::iter::repeat_n(0, waves)).collect();
    Polynomial::new(0, nb, 0, orders.noise, nf, 0)
}

/// f_1 … f_n and b_0 … b_{n+1} with their covariance.
struct Coefficients {
    values: Vec<f64>,
    covariance: Mat<f64>,
}

impl Coefficients {
    fn of(fit: &Fit<PolynomialModel>, n: usize) -> Self {
        let all = fit.parameters();
        let names = fit.model.coefficient_names();
        let places: Vec<usize> =
            rho_names(n).filter_map(|wanted| names.iter().position(|name| *name == wanted)).collect();
        let values = places.iter().map(|i| all[*i]).collect();
        let covariance = Mat::from_fn(places.len(), places.len(), |i, j| fit.covariance[(places[i], places[j])]);
        Coefficients { values, covariance }
    }

    fn named(&self) -> Vec<(String, f64, f64)> {
        let n = self.values.len() / 2 - 1;
        let name = |i: usize| if i < n { format!("f{}", i + 1) } else { format!("b{}", i - n) };
        let error = |i: usize| self.covariance[(i, i)].max(0.0).sqrt();
        self.values.iter().enumerate().map(|(i, v)| (name(i), *v, error(i))).collect()
    }
}

/// ρ(θ) − ρ̂ in coordinates in which the covariance of ρ̂ is one; θ ends with what is left of the torque's skew, of
/// which the last residual says what is known.
struct Whitened<'a> {
    measured: &'a Coefficients,
    factor: Mat<f64>,
    sample_time_s: f64,
    control: EngineControl,
    /// Standard uncertainty of the torque's skew, s.
    skew_s: f64,
}

impl<'a> Whitened<'a> {
    fn new(
        measured: &'a Coefficients,
        sample_time_s: f64,
        control: EngineControl,
        skew_s: f64,
    ) -> Result<Self, Unsuitable> {
        let n = measured.values.len();
        let scale: Vec<f64> = (0..n).map(|i| measured.covariance[(i, i)].sqrt()).collect();
        let correlation = Mat::from_fn(n, n, |i, j| measured.covariance[(i, j)] / (scale[i] * scale[j]));
        let not_separated = control.not_separated();
        let eigen = linalg::symmetric_eigen(correlation.as_ref()).map_err(|_| not_separated)?;
        let largest = (0..n).map(|i| eigen.values[i]).fold(0.0, f64::max);
        if !(0..n).all(|i| eigen.values[i] > 1e-14 * largest) {
            return Err(not_separated);
        }
        let factor = Mat::from_fn(n, n, |i, j| eigen.vectors[(j, i)] / (eigen.values[i].sqrt() * scale[j]));
        Ok(Whitened { measured, factor, sample_time_s, control, skew_s })
    }

    fn fit(&self, start: &[f64]) -> Result<Minimum, IdentError> {
        let mut bounds = vec![Bounds::new(0.0, f64::INFINITY); start.len()];
        bounds.push(Bounds::NONE);
        let start: Vec<f64> = start.iter().copied().chain([0.0]).collect();
        let mut model = self;
        minimise(&mut model, &start, &bounds, NonlinearOptions::default())
    }

    fn residuals(&self, p: &[f64]) -> Result<Vec<f64>, IdentError> {
        if let Some(index) = p[..2].iter().position(|inertia| *inertia <= 0.0) {
            return Err(IdentError::StartOutsideBounds { index, start: p[index], lower: 0.0, upper: f64::INFINITY });
        }
        let Some((skew_s, p)) = p.split_last() else { return Ok(Vec::new()) };
        let rho = self.control.coefficients(p, *skew_s, self.sample_time_s)?;
        let n = rho.len();
        let difference: Vec<f64> = rho.iter().zip(&self.measured.values).map(|(a, b)| a - b).collect();
        let whitened = (0..n).map(|i| (0..n).map(|j| self.factor[(i, j)] * difference[j]).sum());
        Ok(whitened.chain([*skew_s / self.skew_s]).collect())
    }
}

impl ResidualModel for &Whitened<'_> {
    fn parameter_count(&self) -> usize {
        self.control.unknowns() + 1
    }

    fn residual_count(&self) -> usize {
        self.measured.values.len() + 1
    }

    fn evaluate(
        &mut self,
        p: &[f64],
        residuals: &mut [f64],
        jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        residuals.copy_from_slice(&self.residuals(p)?);
        let Some(mut jacobian) = jacobian else { return Ok(()) };
        for j in 0..p.len() {
            let least = if j + 1 == p.len() { self.skew_s } else { 1e-3 };
            let step = STEP * p[j].abs().max(least);
            let moved = |by: f64| {
                let mut point = p.to_vec();
                point[j] += by;
                self.residuals(&point)
            };
            let (above, below) = (moved(step)?, moved(-step)?);
            for i in 0..above.len() {
                jacobian[(i, j)] = (above[i] - below[i]) / (2.0 * step);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A covariance that is singular is reported in the words of a recording, not in those of matrices.
    #[test]
    fn regress_a_singular_covariance_is_said_with_the_remedy() {
        let singular = |values: usize| Coefficients {
            values: vec![0.5; values],
            covariance: Mat::from_fn(values, values, |_, _| 1e-6),
        };
        for (control, values, poles) in [(EngineControl::None, 8, "3 poles"), (EngineControl::Speed, 10, "4 poles")] {
            for measured in
                [singular(values), Coefficients { covariance: Mat::zeros(values, values), ..singular(values) }]
            {
                let Err(error) = Whitened::new(&measured, SAMPLE_TIME_S, control, 1e-4) else {
                    panic!("a singular covariance was taken")
                };
                let text = EstimateError::Unsuitable { file: "Unfired_N_NT.mf4".to_owned(), reason: error }.to_string();
                for words in ["Unfired_N_NT.mf4: T_d", poles, "record", "another route"] {
                    assert!(text.contains(words), "{words}: {text}");
                }
                assert!(!text.contains("covariance"), "{text}");
            }
        }
    }
}
