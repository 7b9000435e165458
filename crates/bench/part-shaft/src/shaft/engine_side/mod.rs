//! J_e, from what a demand that knows nothing of the engine's torque makes both sides of the shaft do.
//!
//! A demand that does not answer to T_e, T_d* in torque control and N_d* in speed control, is an instrument: with v
//! what the demand, through the shaft, makes of ω_e, the errors s T_e of the engine's equation are on average
//! orthogonal to s²v, s v, v and to what the engine's control makes of these, whatever T_e is, be it a firing engine;
//! least squares would take what T_e did for what J_e is. Over √S, S the spectrum of s T_e, which is taken from the
//! residuals and matters for the variance alone, the errors' projection on these instruments is made as small as it can
//! be. It is linear but for τ, the delay of the engine's control: J_e, P and I are solved for each τ, and τ is searched
//! for alone (variable projection).
//!
//! # Source
//! Söderström & Stoica, *Instrumental variable methods for system identification*, 1983, ch. 3 (extended instruments),
//! 4 and 6; Golub & Pereyra, SIAM J. Numer. Anal. 10 (1973) 413; thesis (6.4).

mod equation;
mod instruments;

use faer::Mat;
use ident::IdentError;
use ident::frequency::{Modulated, OVERLAP};
use numerics::linalg;
use numerics::search;
use signal::{Complex64, Signal};

use self::equation::{Control, DELAY, EngineEquation, Sides, UNKNOWNS, Unknowns};
use self::instruments::{Instruments, solved};
use super::spectra::Spectra;

/// Longest τ, s: half of what a single cylinder takes from firing to firing at 600 rpm.
const LONGEST_DELAY_S: f64 = 0.1;
/// Values of τ that are tried before the best is refined.
const TRIED_DELAYS: usize = 50;
/// Standard uncertainty of τ beforehand, of half a firing interval: pulses are no rectangles.
const SPREAD: f64 = 0.6;
/// Rounds in which the spectrum of s T_e and the instruments are made anew.
const ROUNDS: usize = 4;
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

/// Estimates J_e beside shaft parameters θ with their covariance, with `demand` as the instrument. The engine's control
/// is expected to hold for about `firing_interval_s`.
///
/// # Errors
/// A demand that is not there over the window, or that moves nothing.
pub(super) fn estimate(
    spectra: &Spectra,
    demand: &Signal,
    firing_interval_s: f64,
    theta: &[f64],
    covariance: &Mat<f64>,
) -> Result<EngineInertia, IdentError> {
    let last = spectra.bins.last().copied().unwrap_or(0);
    let excitation = Modulated::new(demand, spectra.window, last)?;
    let excitation: Vec<Complex64> = spectra.bins.iter().map(|k| excitation.orders[0][*k]).collect();
    let held = EngineEquation { spectra, control: Control::Held };
    let search = Search { equation: held, sides: held.sides(theta), half_firing_s: 0.5 * firing_interval_s };
    // As if both inertias were equal and T_e white: any guess serves, since instruments bias nothing.
    let of = |engine_kg_m2: f64, spectrum: &[f64]| {
        Instruments::new(spectra, &excitation, theta, engine_kg_m2, spectrum, search.half_firing_s)
    };
    let mut instruments = of(instruments::dyno_inertia(theta), &vec![1.0; spectra.bins.len()])?;
    let mut solution = search.best(&instruments)?;
    for _ in 0..ROUNDS {
        instruments = of(solution[0], &held.spectrum(&search.sides, solution))?;
        solution = search.best(&instruments)?;
    }
    let scores = Scores::new(&search, &instruments, solution);
    let of_torque = scores.covariance()?[(0, 0)];
    let gradient = scores.gradient_by_shaft(theta, covariance)?;
    let n = theta.len();
    let with_shaft: Vec<f64> = (0..n).map(|i| (0..n).map(|j| covariance[(i, j)] * gradient[j]).sum()).collect();
    let through_shaft: f64 = with_shaft.iter().zip(&gradient).map(|(c, g)| c * g).sum();
    let delayed = Search { equation: EngineEquation { spectra, control: Control::Delayed }, ..search };
    let otherwise = delayed.best(&instruments)?[0];
    Ok(EngineInertia {
        inertia_kg_m2: solution[0],
        // As uncertain as what another control would make of the same data; uniform between the two and as far beyond.
        variance: of_torque + through_shaft + (otherwise - solution[0]).powi(2) / 3.0,
        with_shaft,
        degrees_of_freedom: (2.0 * spectra.bins.len() as f64 / OVERLAP - UNKNOWNS as f64).max(1.0),
    })
}

/// The search for J_e, P, I and τ.
struct Search<'a> {
    equation: EngineEquation<'a>,
    sides: Sides,
    /// Prior value of τ, s.
    half_firing_s: f64,
}

impl Search<'_> {
    /// The unknowns whose errors project least on the instruments, with τ as near as may be to what it is beforehand.
    fn best(&self, instruments: &Instruments) -> Result<Unknowns, IdentError> {
        let merit = |delay_s: f64| self.with_delay(instruments, delay_s).map_or(f64::NEG_INFINITY, |(_, cost)| -cost);
        let delay_s = search::global_maximum((0.0, LONGEST_DELAY_S), TRIED_DELAYS, merit);
        Ok(self.with_delay(instruments, delay_s)?.0)
    }

    /// J_e, P and I for a given τ, and what is left.
    fn with_delay(&self, instruments: &Instruments, delay_s: f64) -> Result<(Unknowns, f64), IdentError> {
        let at_none = [0.0, 0.0, 0.0, delay_s];
        let (error, slopes) = instruments.project(self.equation.errors(&self.sides, at_none));
        let slopes = slopes.get(.., ..DELAY);
        let scale: Vec<f64> = slopes.col_iter().map(|column| column.norm_l2()).collect();
        if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(IdentError::Constant { what: "the demand" });
        }
        let scaled = Mat::from_fn(slopes.nrows(), DELAY, |i, j| slopes[(i, j)] / scale[j]);
        let found = linalg::Qr::new(scaled.as_ref()).least_squares(error.as_ref());
        let left = (&error - &scaled * &found).squared_norm_l2();
        let prior = self.prior() * (delay_s - self.half_firing_s).powi(2);
        let [inertia, p, i] = std::array::from_fn(|j| -found[(j, 0)] / scale[j]);
        Ok(([inertia, p, i, delay_s], left + prior))
    }

    /// Precision of τ beforehand, on the scale of the equations, in which n bins count as n over their overlap and each
    /// of its two parts as half of one.
    fn prior(&self) -> f64 {
        0.5 * OVERLAP / (SPREAD * self.half_firing_s).powi(2)
    }
}

/// The estimating equations at their solution: as many instruments as unknowns, each the projection of a slope.
struct Scores<'a> {
    search: &'a Search<'a>,
    instruments: Vec<[Complex64; UNKNOWNS]>,
    solution: Unknowns,
    /// Slopes of the scores by the unknowns.
    by_unknowns: Mat<f64>,
}

impl<'a> Scores<'a> {
    fn new(search: &'a Search<'a>, instruments: &Instruments, solution: Unknowns) -> Self {
        let (_, slopes) = instruments.project(search.equation.errors(&search.sides, solution));
        let mut by_unknowns = slopes.transpose() * &slopes;
        by_unknowns[(DELAY, DELAY)] += search.prior();
        Scores { search, instruments: instruments.combined(&slopes), solution, by_unknowns }
    }

    /// Each bin's part in each score.
    fn of_bins<'b>(&'b self, sides: &'b Sides) -> impl Iterator<Item = [f64; UNKNOWNS]> + 'b {
        let errors = self.search.equation.errors(sides, self.solution);
        errors.zip(&self.instruments).map(|((error, _), instruments)| instruments.map(|z| (z.conj() * error).re))
    }

    /// How J_e moves with the shaft's parameters.
    fn gradient_by_shaft(&self, theta: &[f64], covariance: &Mat<f64>) -> Result<Vec<f64>, IdentError> {
        let sum_at = |theta: &[f64]| {
            let mut sum = Mat::<f64>::zeros(UNKNOWNS, 1);
            let sides = self.search.equation.sides(theta);
            self.of_bins(&sides).for_each(|score| (0..UNKNOWNS).for_each(|i| sum[(i, 0)] += score[i]));
            sum
        };
        let slope = |i: usize| {
            let step = STEP * covariance[(i, i)].max(0.0).sqrt();
            if step == 0.0 {
                return Ok(0.0);
            }
            let moved = |by: f64| {
                let mut theta = theta.to_vec();
                theta[i] += by;
                sum_at(&theta)
            };
            let by_parameter = (moved(step) - moved(-step)) * faer::Scale(-0.5 / step);
            Ok(solved(&self.by_unknowns, &by_parameter)?[(0, 0)])
        };
        (0..theta.len()).map(slope).collect()
    }

    /// Covariance by T_e alone, robust to a spectrum that is not quite that of s T_e: A⁻¹ M A⁻ᵀ, M the products of
    /// scores as far as the window correlates them.
    fn covariance(&self) -> Result<Mat<f64>, IdentError> {
        let bins = &self.search.equation.spectra.bins;
        let scores: Vec<[f64; UNKNOWNS]> = self.of_bins(&self.search.sides).collect();
        let mut middle = Mat::<f64>::zeros(UNKNOWNS, UNKNOWNS);
        for k in 0..bins.len() {
            let near = k.saturating_sub(REACH)..(k + REACH + 1).min(bins.len());
            for l in near.filter(|l| bins[k].abs_diff(bins[*l]) <= REACH) {
                for i in 0..UNKNOWNS {
                    (0..UNKNOWNS).for_each(|j| middle[(i, j)] += scores[k][i] * scores[l][j]);
                }
            }
        }
        // The score of the prior varies by its own precision.
        middle[(DELAY, DELAY)] += 0.5 * OVERLAP * self.search.prior();
        let half = solved(&self.by_unknowns, &middle)?;
        solved(&self.by_unknowns, &half.transpose().to_owned())
    }
}
