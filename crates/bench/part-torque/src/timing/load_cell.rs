//! The load cell: a further delay and a second-order resonance behind the torque control.

use std::ops::RangeInclusive;

use faer::{Mat, MatMut, mat};
use ident::{Bounds, IdentError, Minimum, NonlinearOptions, ResidualModel, minimise};
use lti::StateSpace;
use numerics::vector;
use rig::estimation::timing_floor_s;
use rig::results::{Estimate, Parameter, Quantity, Stretch};
use signal::Signal;

use crate::torque_control::{AirGapTorqueModel, Observed, robust_covariance, usable_samples};

/// Relative step of the numerical derivatives by ω_n and ζ of an exact step: error and rounding are both near 1e-10.
const STEP: f64 = 1e-5;
/// The longest delay of a load cell looked for, s.
const LONGEST_S: f64 = 0.03;
/// Natural frequencies, rad/s, and the damping ratio tried first.
const NATURALS: [f64; 5] = [150.0, 300.0, 450.0, 700.0, 1200.0];
const DAMPED: f64 = 0.3;
/// Starts that are followed to their minimum: a cell that hardly rings has two.
const STARTS: usize = 3;
/// Values of T_d in a sample of T_d*: with 16, chords to what a lag does after an edge are off by 10⁻⁴ of it.
const FINER: usize = 16;
/// As much of a recording is used, s.
const MOST_S: f64 = 120.0;
/// Natural frequencies of a load cell, rad/s.
const NATURAL_RAD_S: RangeInclusive<f64> = 30.0..=3000.0;
/// Damping ratios of a load cell.
const DAMPING: RangeInclusive<f64> = 0.01..=0.95;

/// Findings on the load cell.
pub(super) struct LoadCell {
    /// τ_cell, ω_n, ζ.
    pub(super) dynamics: Estimate,
    /// τ + 1/a + τ_cell + 2ζ/ω_n.
    pub(super) total: Parameter,
    /// True where it reached a minimum inside its bounds.
    pub(super) usable: bool,
}

/// e^{−sD} ω_n²/(s² + 2ζω_n s + ω_n²) on T_d, times a gain, and an offset; θ = (D, ω_n, ζ, gain, offset).
///
/// T_d runs straight between its fine samples, for which the response is exact; between its own samples it is a cubic.
struct CellModel<'a> {
    torque: &'a Signal,
    observed: &'a Observed,
}

/// The cell's reading without delay and its slope, on the clock of T_d.
struct Reading {
    value: Vec<f64>,
    slope: Vec<f64>,
}

/// The exact step of the cell from one fine sample of T_d to the next: of its two states, each from both states and
/// from T_d now and next.
type Step = [[f64; 4]; 2];

/// A state of the cell, or how it changes with a parameter: its reading and the slope of that.
type State = [f64; 2];

fn advanced(step: &Step, [x, v]: State, [now, next]: [f64; 2]) -> State {
    step.map(|[by_x, by_v, by_now, by_next]| by_x * x + by_v * v + by_now * now + by_next * next)
}

/// A cubic between two states a sample apart, at this part of the way; states with slopes per sample.
fn between([x, from]: State, [y, to]: State, u: f64) -> f64 {
    let (square, cube) = (u * u, u * u * u);
    x + (y - x) * (3.0 * square - 2.0 * cube) + from * (u - 2.0 * square + cube) + to * (cube - square)
}

/// Its slope there, per sample.
fn slope_between([x, from]: State, [y, to]: State, u: f64) -> f64 {
    let square = u * u;
    (y - x) * 6.0 * (u - square) + from * (1.0 - 4.0 * u + 3.0 * square) + to * (3.0 * square - 2.0 * u)
}

impl CellModel<'_> {
    fn step(&self, natural: f64, damping: f64) -> Result<Step, IdentError> {
        let a = mat![[0.0, 1.0], [-natural * natural, -2.0 * damping * natural]];
        let cell = StateSpace::continuous(a, mat![[0.0], [natural * natural]], mat![[1.0, 0.0]], mat![[0.0]])?;
        let hold = cell.to_discrete_foh(self.torque.sample_time_s)?;
        Ok([0, 1].map(|i| [hold.a()[(i, 0)], hold.a()[(i, 1)], hold.b0()[(i, 0)], hold.b1()[(i, 0)]]))
    }

    /// How the step changes with ω_n, and with ζ.
    fn step_changes(&self, natural: f64, damping: f64) -> Result<[Step; 2], IdentError> {
        let difference = |above: Step, below: Step, by: f64| {
            let entry = |i: usize, j: usize| (above[i][j] - below[i][j]) / (2.0 * by);
            [0, 1].map(|i| [0, 1, 2, 3].map(|j| entry(i, j)))
        };
        let by = [STEP * natural, STEP * damping];
        Ok([
            difference(self.step(natural + by[0], damping)?, self.step(natural - by[0], damping)?, by[0]),
            difference(self.step(natural, damping + by[1])?, self.step(natural, damping - by[1])?, by[1]),
        ])
    }

    fn at_rest(&self) -> State {
        [self.torque.samples.first().copied().unwrap_or(0.0), 0.0]
    }

    fn reading(&self, natural: f64, damping: f64) -> Result<Reading, IdentError> {
        let step = self.step(natural, damping)?;
        let mut state = self.at_rest();
        let count = self.torque.len();
        let mut reading = Reading { value: Vec::with_capacity(count), slope: Vec::with_capacity(count) };
        reading.value.push(state[0]);
        reading.slope.push(state[1]);
        for pair in self.torque.samples.windows(2) {
            state = advanced(&step, state, [pair[0], pair[1]]);
            reading.value.push(state[0]);
            reading.slope.push(state[1]);
        }
        Ok(reading)
    }

    /// Where an instant lies on the clock of T_d, late by a delay: the fine sample before it, and how far on the way to
    /// the next; at the ends of T_d whether it lies beyond them.
    fn place(&self, time_s: f64, delay_s: f64) -> (usize, f64, bool) {
        let last = self.torque.len().saturating_sub(2) as f64;
        let position = (time_s - delay_s - self.torque.start_s) / self.torque.sample_time_s;
        let within = position.clamp(0.0, last + 1.0);
        let below = within.floor().min(last);
        (below as usize, within - below, within != position)
    }

    /// Goes through T_d once and hands over what the cell reads at each observed instant, with its derivatives by
    /// delay, ω_n and ζ. The states are kept for a step alone: T_d is long.
    fn pass(
        &self,
        [delay_s, natural, damping]: [f64; 3],
        mut put: impl FnMut(usize, f64, [f64; 3]),
    ) -> Result<(), IdentError> {
        let (step, changes) = (self.step(natural, damping)?, self.step_changes(natural, damping)?);
        let (fine_s, samples) = (self.torque.sample_time_s, &self.torque.samples);
        let per_sample = |[x, v]: State| [x, fine_s * v];
        let (mut state, mut moved) = (self.at_rest(), [[0.0; 2]; 2]);
        let mut times = self.observed.times_s.iter().map(|time_s| self.place(*time_s, delay_s)).enumerate().peekable();
        for (k, pair) in samples.windows(2).enumerate() {
            let torque = [pair[0], pair[1]];
            let next = advanced(&step, state, torque);
            let next_moved = [0, 1].map(|j| {
                let own = advanced(&step, moved[j], [0.0; 2]);
                let by_step = advanced(&changes[j], state, torque);
                [own[0] + by_step[0], own[1] + by_step[1]]
            });
            while let Some((i, (_, u, is_beyond))) = times.next_if(|(_, (below, ..))| *below <= k) {
                let ends = |from: State, to: State| (per_sample(from), per_sample(to));
                let (from, to) = ends(state, next);
                let by_delay = if is_beyond { 0.0 } else { -slope_between(from, to, u) / fine_s };
                let [by_natural, by_damping] = [0, 1].map(|j| {
                    let (from, to) = ends(moved[j], next_moved[j]);
                    between(from, to, u)
                });
                put(i, between(from, to, u), [by_delay, by_natural, by_damping]);
            }
            (state, moved) = (next, next_moved);
        }
        Ok(())
    }

    /// Readings of the cell at the observed instants, late by a delay.
    fn delayed(&self, reading: &Reading, delay_s: f64) -> Vec<f64> {
        let fine_s = self.torque.sample_time_s;
        let at = |time_s: &f64| {
            let (k, u, _) = self.place(*time_s, delay_s);
            let state = |k: usize| [reading.value[k], fine_s * reading.slope[k]];
            between(state(k), state(k + 1), u)
        };
        self.observed.times_s.iter().map(at).collect()
    }

    fn modelled(&self, parameters: &[f64]) -> Result<Vec<f64>, IdentError> {
        Ok(self.delayed(&self.reading(parameters[1], parameters[2])?, parameters[0]))
    }

    /// How the cell's delay, ω_n and ζ at a minimum move with a of the torque control before it: −(JᵀJ)⁻¹Jᵀ ∂r/∂a.
    fn moves_with_lag(
        &self,
        fit: &Minimum,
        demand: &Signal,
        torque_control: &AirGapTorqueModel,
    ) -> Result<[f64; 3], IdentError> {
        let step = STEP * torque_control.lag_rad_s;
        let moved = |by: f64| {
            let lag_rad_s = torque_control.lag_rad_s + by;
            let torque = AirGapTorqueModel { lag_rad_s, ..torque_control.clone() }.finer_air_gap_torque(demand, FINER);
            CellModel { torque: &torque, observed: self.observed }.modelled(&fit.parameters)
        };
        let (above, below) = (moved(step)?, moved(-step)?);
        let scale = fit.parameters[3] / (2.0 * step);
        let slope = Mat::from_fn(above.len(), 1, |i, _| scale * (above[i] - below[i]));
        let projected = &fit.unscaled_covariance * (fit.jacobian.transpose() * slope);
        Ok([0, 1, 2].map(|i| -projected[(i, 0)]))
    }

    /// For each of a few natural frequencies the best of a grid of delays, with one damping ratio; the best first.
    fn starts(&self) -> Result<Vec<Vec<f64>>, IdentError> {
        let delays: Vec<f64> = (0..).map(|j| 1e-3 * f64::from(j)).take_while(|d| *d < LONGEST_S).collect();
        let mut starts = Vec::new();
        for natural in NATURALS {
            let mut best = (f64::INFINITY, vec![0.0; 3]);
            let reading = self.reading(natural, DAMPED)?;
            for delay in &delays {
                let modelled = self.delayed(&reading, *delay);
                let apart: Vec<f64> = self.observed.values.iter().zip(&modelled).map(|(y, m)| y - m).collect();
                let spread = vector::standard_deviation(&apart);
                if spread < best.0 {
                    best = (spread, vec![*delay, natural, DAMPED, 1.0, 0.0]);
                }
            }
            starts.push(best);
        }
        starts.sort_by(|a, b| a.0.total_cmp(&b.0));
        Ok(starts.into_iter().map(|(_, start)| start).collect())
    }
}

impl ResidualModel for CellModel<'_> {
    fn parameter_count(&self) -> usize {
        5
    }

    fn residual_count(&self) -> usize {
        self.observed.len()
    }

    fn evaluate(
        &mut self,
        parameters: &[f64],
        residuals: &mut [f64],
        mut jacobian: Option<MatMut<'_, f64>>,
    ) -> Result<(), IdentError> {
        let (gain, offset) = (parameters[3], parameters[4]);
        let (cell, measured) = ([parameters[0], parameters[1], parameters[2]], &self.observed.values);
        self.pass(cell, |i, read, changes| {
            residuals[i] = gain * read + offset - measured[i];
            if let Some(jacobian) = &mut jacobian {
                for (j, change) in changes.into_iter().enumerate() {
                    jacobian[(i, j)] = gain * change;
                }
                (jacobian[(i, 3)], jacobian[(i, 4)]) = (read, 1.0);
            }
        })?;
        Ok(())
    }
}

/// Fits the load cell behind a torque control whose τ and a have the covariance `known`, to at most two minutes. T_d is
/// that of the torque control with the ripple found in T_d,calc, which goes through the cell as all of T_d does.
///
/// # Errors
/// Too few samples, or data that do not determine the parameters.
pub(super) fn fit(
    demand: &Signal,
    cell: &Signal,
    torque_control: &AirGapTorqueModel,
    known: [[f64; 2]; 2],
    stretch: &Stretch,
) -> Result<LoadCell, IdentError> {
    let demand = &demand.slice(demand.start_s, demand.start_s + MOST_S);
    let torque = torque_control.finer_air_gap_torque(demand, FINER);
    let usable = usable_samples(demand, cell, torque_control.torque_limit_nm);
    let observed = Observed::new(cell, &usable, 0..cell.len());
    let bounds = [
        Bounds::new(0.0, LONGEST_S),
        Bounds::new(*NATURAL_RAD_S.start(), *NATURAL_RAD_S.end()),
        Bounds::new(*DAMPING.start(), *DAMPING.end()),
        Bounds::NONE,
        Bounds::NONE,
    ];
    let mut model = CellModel { torque: &torque, observed: &observed };
    let mut fit: Option<Minimum> = None;
    for start in model.starts()?.iter().take(STARTS) {
        let found = minimise(&mut model, start, &bounds, NonlinearOptions::default())?;
        if fit.as_ref().is_none_or(|best| found.cost < best.cost) {
            fit = Some(found);
        }
    }
    let fit = fit.ok_or(IdentError::TooFewSamples { samples: observed.len(), parameters: bounds.len() })?;
    let (p, freedom) = robust_covariance(&fit, observed.sample_time_s)?;
    let [own, natural, damping] = [fit.parameters[0], fit.parameters[1], fit.parameters[2]];
    let by_lag = model.moves_with_lag(&fit, demand, torque_control)?;
    let gradient = [1.0, -2.0 * damping / (natural * natural), 2.0 / natural];
    let total_by_lag: f64 =
        -torque_control.lag_rad_s.powi(-2) + gradient.iter().zip(by_lag).map(|(g, m)| g * m).sum::<f64>();
    let pairs = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    // What τ is off by, the cell's own delay makes good.
    let variance: f64 = pairs.map(|(i, j)| gradient[i] * p[(i, j)] * gradient[j]).sum::<f64>()
        + total_by_lag * total_by_lag * known[1][1];
    let dated = timing_floor_s(demand.sample_time_s);
    let total = torque_control.delay_s + own + 1.0 / torque_control.lag_rad_s + 2.0 * damping / natural;
    let moves = [0, 1, 2].map(|i| [if i == 0 { -1.0 } else { 0.0 }, by_lag[i]]);
    let of_known = |i: usize, j: usize| -> f64 {
        (0..2).map(|k| (0..2).map(|l| moves[i][k] * known[k][l] * moves[j][l]).sum::<f64>()).sum()
    };
    let covariance: Vec<Vec<f64>> = (0..3).map(|i| (0..3).map(|j| p[(i, j)] + of_known(i, j)).collect()).collect();
    let values = [
        (Quantity::LoadCellDelay, own),
        (Quantity::LoadCellFrequency, natural),
        (Quantity::LoadCellDampingRatio, damping),
    ];
    let parameter = |(i, (quantity, value)): (usize, &(Quantity, f64))| {
        Parameter::new(*quantity, *value, covariance[i][i].sqrt(), freedom)
    };
    Ok(LoadCell {
        dynamics: Estimate {
            parameters: values.iter().enumerate().map(parameter).collect(),
            covariance: covariance.clone(),
            stretches: vec![stretch.clone()],
            iterations: fit.iterations,
            condition: fit.condition,
        },
        total: Parameter::new(Quantity::LoadCellTotalDelay, total, variance.sqrt().hypot(dated), freedom),
        usable: fit.termination.converged() && fit.parameters[3] > 0.0 && !fit.at_bound[..3].contains(&true),
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use numerics::random::Stream;

    use super::*;

    #[test]
    fn exact_derivatives_are_those_of_finite_differences() {
        let mut random = Stream::new(5, 0);
        let levels: Vec<f64> = (0..40).map(|_| 30.0 * random.normal()).collect();
        let samples = (0..4000).map(|k| levels[k / 100]).collect();
        let torque = Signal::new(0.0, 1e-4, samples).unwrap();
        // From before T_d begins until after it ends.
        let cell = Signal::new(-0.01, 1e-3, (0..430).map(|_| random.normal()).collect()).unwrap();
        let observed = Observed::new(&cell, &vec![true; cell.len()], 0..cell.len());
        let mut model = CellModel { torque: &torque, observed: &observed };
        let parameters = [4.3e-3, 420.0, 0.25, 1.1, 2.0];
        let count = observed.len();
        let (mut residuals, mut jacobian) = (vec![0.0; count], Mat::zeros(count, 5));
        model.evaluate(&parameters, &mut residuals, Some(jacobian.as_mut())).unwrap();
        for (j, step) in [1e-6, 1e-3, 1e-6, 1e-4, 1e-4].into_iter().enumerate() {
            let moved = |by: f64, model: &mut CellModel<'_>| {
                let (mut parameters, mut residuals) = (parameters, vec![0.0; count]);
                parameters[j] += by;
                model.evaluate(&parameters, &mut residuals, None).unwrap();
                residuals
            };
            let (above, below) = (moved(step, &mut model), moved(-step, &mut model));
            let scale = (0..count).map(|i| jacobian[(i, j)].abs()).fold(0.0, f64::max);
            for i in 0..count {
                let difference = (above[i] - below[i]) / (2.0 * step);
                assert!(
                    (jacobian[(i, j)] - difference).abs() < 1e-5 * scale,
                    "{i} {j}: {} {difference}",
                    jacobian[(i, j)]
                );
            }
        }
        let read = model.modelled(&parameters).unwrap();
        for (i, read) in read.iter().enumerate() {
            let residual = 1.1 * read + 2.0 - observed.values[i];
            assert!((residuals[i] - residual).abs() < 1e-9, "{i}");
        }
    }
}
