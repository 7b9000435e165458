//! J_e, from what a demand that knows nothing of the engine's torque makes both sides of the shaft do.
//!
//! The engine's side is s T_shaft + J_e s² ω_e + (P s + I) h(s) ω_e = s T_e. P and I are the engine's own speed control, which
//! acts upon its next firing and holds until the one after, h(s) = (1 − e^{−2sτ})/(2sτ) with 2τ about the time between;
//! what pulses make of it otherwise is part of the uncertainty. T_e is the rest of the engine's torque, recorded nowhere,
//! which moves both speeds: least squares would take what T_e did for what J_e is.
//!
//! A demand that does not answer to T_e, T_d* in torque control and N_d* in speed control, is an instrument: with ζ_k what
//! the demand, through the shaft, makes of the slope of the error ε_k by a parameter, Σ_k Re conj(ζ_k) ε_k / S(f_k) = 0
//! holds on average at the truth whatever T_e is, be it a firing engine. S, the spectrum of s T_e, is taken from the
//! residuals; it matters for the variance alone.
//!
//! # Source
//! Söderström & Stoica, *Instrumental variable methods for system identification*, 1983, ch. 4 and 6 (optimal
//! instruments); thesis (6.4).

use std::f64::consts::TAU;

use faer::Mat;
use faer::linalg::solvers::Solve;
use ident::IdentError;
use ident::frequency::{Modulated, OVERLAP};
use signal::{Complex64, Signal};

use super::equation;
use super::response::{EngineSide, engine_side};
use super::spectra::Spectra;

/// J_e, P, I and τ.
const UNKNOWNS: usize = 4;
const DELAY: usize = 3;
/// Longest τ, s: half of what a single cylinder takes from firing to firing at 600 rpm.
const LONGEST_DELAY_S: f64 = 0.1;
/// |2sτ| below which the hold is its series: the next term is 1e-9.
const SMALL_HOLD: f64 = 1e-4;
/// Standard uncertainty of τ beforehand, of half a firing interval: pulses are no rectangles.
const SPREAD: f64 = 0.6;
/// Steps of the search, and how small a step ends it, relatively.
const STEPS: usize = 30;
const SMALL_STEP: f64 = 1e-9;
/// J_d behind a flange, which stands in no equation.
const ANY_INERTIA_KG_M2: f64 = 0.5;
/// The least J_e that instruments are made with, of J_d.
const SMALLEST: f64 = 1e-3;
/// By what factor the delay of the engine's control may change J_e before its search has run away.
const FARTHEST: f64 = 2.0;
/// Rounds in which the spectrum of s T_e and the instruments are made anew.
const ROUNDS: usize = 4;
/// The spectrum of s T_e is a mean over so many Hz: wide against the resolution, narrow against what is between firing lines.
const SMOOTHED_HZ: f64 = 0.8;
/// Bins whose scores are correlated by the window.
const REACH: usize = 4;
/// Step of the numerical gradient by the shaft's parameters, in their standard errors.
const STEP: f64 = 0.1;

/// J_e with its variance, and its covariance with the shaft's parameters.
pub(super) struct EngineInertia {
    pub(super) inertia_kg_m2: f64,
    pub(super) variance: f64,
    pub(super) with_shaft: Vec<f64>,
    pub(super) degrees_of_freedom: f64,
}

/// Estimates J_e beside shaft parameters θ with their covariance, with `demand` as the instrument. The engine's control is
/// expected to hold for about `firing_interval_s`.
///
/// # Errors
/// A demand that is not there over the window, or that moves nothing.
pub(super) fn estimate(
    spectra: &Spectra,
    demand: &Signal,
    firing_interval_s: f64,
    (theta, covariance): (&[f64], &Mat<f64>),
) -> Result<EngineInertia, IdentError> {
    let last = spectra.bins.last().copied().unwrap_or(0);
    let excitation = Modulated::new(demand, spectra.window, last)?;
    let excitation = spectra.bins.iter().map(|k| excitation.orders[0][*k]).collect();
    let mut equations = Equations {
        spectra,
        excitation,
        instruments: Vec::new(),
        half_firing_s: 0.5 * firing_interval_s,
        control: Control::Held,
        free: UNKNOWNS,
    };
    // As if both inertias were equal and T_e white: any guess serves, since instruments bias nothing.
    let guess = [dyno_inertia(theta), 0.0, 0.0, equations.half_firing_s];
    equations.set_instruments(theta, &guess, &vec![1.0; spectra.bins.len()]);
    let sides = equations.sides(theta);
    let mut solution = equations.solve(&sides, guess, DELAY)?;
    // The delay of a control that is not known yet would be anything.
    for _ in 0..ROUNDS {
        equations.set_instruments(theta, &solution, &equations.spectrum(&sides, solution));
        solution = equations.solve(&sides, solution, DELAY)?;
    }
    solution = equations.with_delay(theta, &sides, solution)?;
    let of_torque = equations.covariance(&sides, solution)?[(0, 0)];
    let gradient = equations.gradient_by_shaft(theta, covariance, solution)?;
    let n = theta.len();
    let with_shaft: Vec<f64> = (0..n).map(|i| (0..n).map(|j| covariance[(i, j)] * gradient[j]).sum()).collect();
    let through_shaft: f64 = with_shaft.iter().zip(&gradient).map(|(c, g)| c * g).sum();
    equations.control = Control::Delayed;
    let otherwise = equations.solve(&sides, solution, equations.free)?[0];
    Ok(EngineInertia {
        inertia_kg_m2: solution[0],
        // As uncertain as what another control would make of the same data; uniform between the two and as far beyond.
        variance: of_torque
            + through_shaft
            + (otherwise - solution[0]).powi(2) / 3.0
            + equations.of_untold_delay(solution[0]),
        with_shaft,
        degrees_of_freedom: (2.0 * spectra.bins.len() as f64 / OVERLAP - UNKNOWNS as f64).max(1.0),
    })
}

/// J_d for the instruments.
fn dyno_inertia(theta: &[f64]) -> f64 {
    let inertia = theta[equation::INERTIA];
    if inertia > 0.0 { inertia } else { ANY_INERTIA_KG_M2 }
}

/// The estimating equations with their instruments, each divided by the spectrum of s T_e.
struct Equations<'a> {
    spectra: &'a Spectra,
    excitation: Vec<Complex64>,
    instruments: Vec<[Complex64; UNKNOWNS]>,
    /// What τ is beforehand, s.
    half_firing_s: f64,
    control: Control,
    /// How many of the parameters, in their order, are searched for: all, or all but the delay.
    free: usize,
}

/// How the engine's control acts upon its torque, where that is not recorded.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Control {
    /// It holds for 2τ.
    Held,
    /// It acts τ late.
    Delayed,
}

impl Control {
    /// (1 − e^{−2sτ})/(2sτ) or e^{−sτ}, and its slope by τ.
    fn response(self, s: Complex64, delay: f64) -> (Complex64, Complex64) {
        let x = 2.0 * s * delay;
        match self {
            Control::Delayed => ((-s * delay).exp(), -s * (-s * delay).exp()),
            Control::Held if x.norm() < SMALL_HOLD => (1.0 - 0.5 * x, -s),
            Control::Held => {
                let late = (-x).exp();
                ((1.0 - late) / x, 2.0 * s * (late * (x + 1.0) - 1.0) / (x * x))
            }
        }
    }
}

/// s²ω_e, s ω_e and ω_e.
type SpeedOrders = [Complex64; 3];

impl Equations<'_> {
    fn s(&self, bin: usize) -> Complex64 {
        Complex64::new(0.0, TAU * self.spectra.window.frequency_hz(bin))
    }

    /// The engine's side of the equation and its slopes by J_e, P, I and τ, at one frequency.
    fn answer(
        &self,
        s: Complex64,
        [by_inertia, rate, speed]: SpeedOrders,
        [inertia, p, i, delay]: [f64; UNKNOWNS],
    ) -> (Complex64, [Complex64; UNKNOWNS]) {
        let (late, by_delay) = self.control.response(s, delay);
        let control = rate * p + speed * i;
        (by_inertia * inertia + control * late, [by_inertia, rate * late, speed * late, control * by_delay])
    }

    /// The engine's side at every bin, for the shaft's parameters.
    fn sides(&self, theta: &[f64]) -> Vec<EngineSide> {
        self.spectra.bins.iter().map(|bin| engine_side(self.spectra, theta, *bin)).collect()
    }

    /// Errors, and their slopes by the unknowns.
    fn errors<'b>(
        &'b self,
        sides: &'b [EngineSide],
        solution: [f64; UNKNOWNS],
    ) -> impl Iterator<Item = (Complex64, [Complex64; UNKNOWNS])> + 'b {
        self.spectra.bins.iter().zip(sides).map(move |(bin, side)| {
            let (answered, slopes) = self.answer(self.s(*bin), side.regressors, solution);
            (side.torque_rate + answered, slopes)
        })
    }

    /// The spectrum of s T_e: a running mean of the errors' powers.
    fn spectrum(&self, sides: &[EngineSide], solution: [f64; UNKNOWNS]) -> Vec<f64> {
        let reach = (0.5 * SMOOTHED_HZ * self.spectra.window.duration_s).ceil() as usize;
        let mut sums = vec![0.0];
        for (error, _) in self.errors(sides, solution) {
            sums.push(sums[sums.len() - 1] + error.norm_sqr());
        }
        let n = sums.len() - 1;
        let mean = |i: usize| {
            let (from, to) = (i.saturating_sub(reach), (i + reach + 1).min(n));
            ((sums[to] - sums[from]) / (to - from) as f64).max(f64::MIN_POSITIVE)
        };
        (0..n).map(mean).collect()
    }

    /// What the demand, through the shaft, makes of the slopes, over the spectrum.
    fn set_instruments(&mut self, theta: &[f64], solution: &[f64; UNKNOWNS], spectrum: &[f64]) {
        let dyno = dyno_inertia(theta);
        let engine = solution[0].abs().max(SMALLEST * dyno);
        let instrument = |((bin, u), power): ((&usize, &Complex64), &f64)| {
            let s = self.s(*bin);
            let spring = theta[equation::K] + theta[equation::B] * s;
            let speed = -spring / (s * (dyno * engine * s * s + (dyno + engine) * spring)) * *u / *power;
            self.answer(s, [s * s * speed, s * speed, speed], *solution).1
        };
        let bins = self.spectra.bins.iter().zip(&self.excitation).zip(spectrum);
        self.instruments = bins.map(instrument).collect();
    }

    /// The first `unknowns` of the parameters, the others as they are.
    fn solve(
        &self,
        sides: &[EngineSide],
        mut solution: [f64; UNKNOWNS],
        unknowns: usize,
    ) -> Result<[f64; UNKNOWNS], IdentError> {
        for _ in 0..STEPS {
            let mut left = Mat::zeros(unknowns, unknowns);
            let mut right = Mat::zeros(unknowns, 1);
            for ((error, slopes), instruments) in self.errors(sides, solution).zip(&self.instruments) {
                for i in 0..unknowns {
                    right[(i, 0)] -= (instruments[i].conj() * error).re;
                    (0..unknowns).for_each(|j| left[(i, j)] += (instruments[i].conj() * slopes[j]).re);
                }
            }
            if unknowns == UNKNOWNS {
                left[(DELAY, DELAY)] += self.prior();
                right[(DELAY, 0)] += self.prior() * (self.half_firing_s - solution[DELAY]);
            }
            let step = solved(&left, &right)?;
            (0..unknowns).for_each(|i| solution[i] += step[(i, 0)]);
            solution[DELAY] = solution[DELAY].clamp(0.0, LONGEST_DELAY_S);
            if step[(0, 0)].abs() <= SMALL_STEP * solution[0].abs() {
                break;
            }
        }
        Ok(solution)
    }

    /// The solution with the delay too, or without where that runs away: the equations are linear but for it.
    fn with_delay(
        &mut self,
        theta: &[f64],
        sides: &[EngineSide],
        without: [f64; UNKNOWNS],
    ) -> Result<[f64; UNKNOWNS], IdentError> {
        let mut solution = without;
        for _ in 0..ROUNDS {
            self.set_instruments(theta, &solution, &self.spectrum(sides, solution));
            solution = self.solve(sides, solution, UNKNOWNS)?;
            if !(without[0] / FARTHEST..=without[0] * FARTHEST).contains(&solution[0]) {
                self.set_instruments(theta, &without, &self.spectrum(sides, without));
                self.free = DELAY;
                return Ok(without);
            }
        }
        Ok(solution)
    }

    /// The variance that is added to J_e where the search for the delay ran away: the engine's control is then not known well
    /// enough to tell J_e to better than the factor that the search may change it by; uniform that far either way.
    fn of_untold_delay(&self, inertia_kg_m2: f64) -> f64 {
        if self.free == UNKNOWNS { 0.0 } else { ((FARTHEST - 1.0) * inertia_kg_m2).powi(2) / 3.0 }
    }

    /// How J_e moves with the shaft's parameters.
    fn gradient_by_shaft(
        &self,
        theta: &[f64],
        covariance: &Mat<f64>,
        solution: [f64; UNKNOWNS],
    ) -> Result<Vec<f64>, IdentError> {
        let slope = |i: usize| {
            let step = STEP * covariance[(i, i)].max(0.0).sqrt();
            let moved = |by: f64| {
                let mut theta = theta.to_vec();
                theta[i] += by;
                self.solve(&self.sides(&theta), solution, self.free).map(|found| found[0])
            };
            if step == 0.0 { Ok(0.0) } else { Ok((moved(step)? - moved(-step)?) / (2.0 * step)) }
        };
        (0..theta.len()).map(slope).collect()
    }

    /// Covariance by T_e alone, robust to a spectrum that is not quite that of s T_e: A⁻¹ M A⁻ᵀ, M the products of scores as
    /// far as the window correlates them.
    fn covariance(&self, sides: &[EngineSide], solution: [f64; UNKNOWNS]) -> Result<Mat<f64>, IdentError> {
        let bins = &self.spectra.bins;
        let mut left = Mat::zeros(UNKNOWNS, UNKNOWNS);
        let mut scores = Vec::with_capacity(bins.len());
        for ((error, slopes), instruments) in self.errors(sides, solution).zip(&self.instruments) {
            for i in 0..UNKNOWNS {
                (0..UNKNOWNS).for_each(|j| left[(i, j)] += (instruments[i].conj() * slopes[j]).re);
            }
            scores.push(instruments.map(|z| (z.conj() * error).re));
        }
        let mut middle = Mat::<f64>::zeros(UNKNOWNS, UNKNOWNS);
        for k in 0..bins.len() {
            let near = k.saturating_sub(REACH)..(k + REACH + 1).min(bins.len());
            for l in near.filter(|l| bins[k].abs_diff(bins[*l]) <= REACH) {
                for i in 0..UNKNOWNS {
                    (0..UNKNOWNS).for_each(|j| middle[(i, j)] += scores[k][i] * scores[l][j]);
                }
            }
        }
        left[(DELAY, DELAY)] += self.prior();
        // The score of the prior varies by its own precision.
        middle[(DELAY, DELAY)] += 0.5 * OVERLAP * self.prior();
        let half = solved(&left, &middle)?;
        solved(&left, &half.transpose().to_owned())
    }

    /// Precision of τ beforehand, on the scale of the equations, in which n bins count as n over their overlap and each of
    /// its two parts as half of one.
    fn prior(&self) -> f64 {
        0.5 * OVERLAP / (SPREAD * self.half_firing_s).powi(2)
    }
}

/// The solution of a small system whose rows and columns differ in scale.
fn solved(left: &Mat<f64>, right: &Mat<f64>) -> Result<Mat<f64>, IdentError> {
    let n = left.nrows();
    let rows: Vec<f64> = (0..n).map(|i| left.row(i).norm_max()).collect();
    let columns: Vec<f64> =
        (0..n).map(|j| (0..n).map(|i| (left[(i, j)] / rows[i]).abs()).fold(0.0, f64::max)).collect();
    if rows.iter().chain(&columns).any(|s| !s.is_finite() || *s <= 0.0) {
        return Err(IdentError::Constant { what: "the demand" });
    }
    let scaled = Mat::from_fn(n, n, |i, j| left[(i, j)] / (rows[i] * columns[j]));
    let target = Mat::from_fn(n, right.ncols(), |i, j| right[(i, j)] / rows[i]);
    let solution = scaled.full_piv_lu().solve(&target);
    if (0..n).any(|i| !solution[(i, 0)].is_finite()) {
        return Err(IdentError::Constant { what: "the demand" });
    }
    Ok(Mat::from_fn(n, right.ncols(), |i, j| solution[(i, j)] / columns[i]))
}
