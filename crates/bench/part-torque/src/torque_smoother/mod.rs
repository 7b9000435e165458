//! A torque that was not recorded, from the speeds that answer it: a fixed-interval smoother, which says how certain it
//! is.
//!
//! The torque sought wanders (its slope is a random walk) and swings at the firing frequency and its multiples (damped
//! oscillators that noise drives); the mechanics answer it and T_d exactly; what is wrong with T_d is white; speeds are
//! means over a sample, with white noise. The levels of the noises are those of greatest likelihood.

mod levels;
mod needed;
mod observations;
mod prepared;
mod states;

use std::f64::consts::TAU;

use faer::Mat;
use ident::IdentError;
use ident::smoothing::{Belief, NoisySystem, Smoothed};
use lti::StateSpace;
use rig::Experiment;
use rig::estimation::EstimateError;
use rig::facts::Engine;
use signal::Signal;
use signal::resample::{Interpolation, interpolate_at};

pub use self::levels::NoiseLevels;
pub use self::prepared::{Prepared, TorqueSource};
pub use self::states::Levels;
use needed::SHORTEST_S;
use needed::WITHIN;
pub use needed::needed;
pub use observations::Observations;

/// Multiples of the firing frequency that are modelled at most.
const LINES: usize = 4;
/// Deviation of the speed, of its mean, beyond which firing is at no frequency that could be modelled.
const STEADY: f64 = 0.02;
/// Standard deviation of the torque sought at the start, Nm.
const START_NM: f64 = 300.0;
/// Standard deviation of its slope at the start, Nm/s.
const START_NM_PER_S: f64 = 1e4;

/// How speeds answer T_d and the torque that is sought: dx/dt = A x + b T_d + e T.
#[derive(Debug, Clone)]
pub struct Mechanics {
    /// A.
    pub a: Mat<f64>,
    /// b.
    pub by_air_gap: Vec<f64>,
    /// e.
    pub by_sought: Vec<f64>,
    /// The states that are measured, as means over a sample.
    pub measured: Vec<usize>,
    /// x at the start over T_d at the start.
    pub at_rest: Vec<f64>,
    /// Standard deviations of x at the start.
    pub start: Vec<f64>,
}

/// Equally spaced stamps of N_d at which the smoother has a row.
#[derive(Debug, Clone, Copy)]
pub struct Stamps {
    /// Time of the first, s.
    pub first_s: f64,
    /// Time between them, s.
    pub step_s: f64,
    /// How many there are.
    pub count: usize,
}

/// The stamps over which T_d is known, and when their rows are.
#[derive(Debug)]
pub struct Clock {
    /// Which of the stamps.
    pub used: std::ops::Range<usize>,
    /// Instant of the first row, at which the mean that its reading is ends, s.
    pub start_s: f64,
    /// T_d from every row to the next.
    pub torque_nm: Vec<f64>,
}

impl Clock {
    /// The mean over a gate is taken for that over a step about the same instant; `late_s` is how late T_d is dated.
    ///
    /// # Errors
    /// Stamps and T_d share too little.
    pub fn new(file: &str, stamps: Stamps, torque: &Signal, late_s: f64, gate_s: f64) -> Result<Self, EstimateError> {
        let step = stamps.step_s;
        let row_s = |i: usize| stamps.first_s + i as f64 * step + 0.5 * (step - gate_s);
        let is_inside = |i: &usize| {
            let t = row_s(*i) + late_s;
            t >= torque.start_s && t + step <= torque.end_s()
        };
        let mut inside = (0..stamps.count).filter(is_inside);
        let first = inside.next().unwrap_or(0);
        let used = first..inside.next_back().map_or(first, |last| last + 1);
        let duration_s = used.len() as f64 * step;
        if duration_s < SHORTEST_S {
            return Err(EstimateError::TooShort { file: file.to_owned(), duration_s, needed_s: SHORTEST_S });
        }
        let at = |k: usize| (k / WITHIN) as f64 + ((k % WITHIN) as f64 + 0.5) / WITHIN as f64;
        let start_s = row_s(used.start);
        let instants: Vec<f64> = (0..used.len() * WITHIN).map(|k| start_s + late_s + at(k) * step).collect();
        let way = if torque.sample_time_s > step { Interpolation::BandLimited } else { Interpolation::Linear };
        let within = interpolate_at(torque, &instants, way)
            .map_err(|source| EstimateError::Signal { file: file.to_owned(), source })?;
        let mean = |part: &[f64]| part.iter().sum::<f64>() / WITHIN as f64;
        Ok(Clock { used, start_s, torque_nm: within.chunks_exact(WITHIN).map(mean).collect() })
    }
}

/// The firing frequency and its multiples up to `highest_hz`; none where the speed is not steady or the shaft is off.
pub fn firing_lines(experiment: &Experiment, engine: Engine, speed: &Signal, highest_hz: f64) -> Vec<f64> {
    let mean = speed.mean().unwrap_or(0.0).abs();
    let spread =
        (speed.samples.iter().map(|n| (n.abs() - mean).powi(2)).sum::<f64>() / speed.len().max(1) as f64).sqrt();
    if experiment.label.is_without_shaft() || spread > STEADY * mean {
        return Vec::new();
    }
    let firing_hz = engine.firings_per_turn() * mean / TAU;
    (1..=LINES).map(|k| k as f64 * firing_hz).filter(|hz| *hz > 1.0 && *hz < highest_hz).collect()
}

/// Mechanics and what was observed of them. The states: means of the measured ones over the sample, those of the
/// mechanics, the wandering part of the torque sought, its slope, and two for each line.
pub struct TorqueSmoother<'a> {
    /// The mechanics.
    pub mechanics: &'a Mechanics,
    /// Observations of them.
    pub observed: &'a Observations,
}

impl TorqueSmoother<'_> {
    fn means(&self) -> usize {
        self.mechanics.measured.len()
    }

    /// Where a state of the mechanics stands.
    pub fn of_mechanics(&self, state: usize) -> usize {
        self.means() + state
    }

    /// Where the wandering part of the torque stands.
    fn wandering(&self) -> usize {
        self.means() + self.mechanics.by_sought.len()
    }

    fn states(&self) -> usize {
        self.wandering() + 2 + 2 * self.observed.lines_hz.len()
    }

    /// Weights with which the states make up the torque sought.
    pub fn weights(&self) -> Vec<f64> {
        let first = self.wandering();
        let is_part = |i: usize| i == first || (i >= first + 2 && (i - first).is_multiple_of(2));
        (0..self.states()).map(|i| f64::from(u8::from(is_part(i)))).collect()
    }

    /// The states under these noise levels.
    ///
    /// # Errors
    /// Measurements that noise and start leave no room for.
    pub fn smooth(&self, levels: &Levels) -> Result<Smoothed, IdentError> {
        let (system, start) = self.system(&levels.logarithms, levels.scale)?;
        system.smooth(&start, self.observed.torque.as_ref(), self.observed.speeds.as_ref())
    }

    /// The torque sought alone, without its uncertainty.
    ///
    /// # Errors
    /// Those of [`TorqueSmoother::smooth`].
    pub fn sought(&self, levels: &Levels) -> Result<Vec<f64>, IdentError> {
        let (system, start) = self.system(&levels.logarithms, levels.scale)?;
        let states = system.smooth_states(&start, self.observed.torque.as_ref(), self.observed.speeds.as_ref())?;
        let weights = self.weights();
        let value = |k: usize| weights.iter().enumerate().map(|(i, weight)| weight * states[(k, i)]).sum();
        Ok((0..states.nrows()).map(value).collect())
    }

    /// The model at logarithms of noise densities, see [`levels`], all covariances times `scale`.
    fn system(&self, logarithms: &[f64], scale: f64) -> Result<(NoisySystem, Belief), IdentError> {
        let (n, step, means, wandering) = (self.states(), self.observed.sample_time_s, self.means(), self.wandering());
        let (mechanics, sought) = (self.mechanics, self.weights());
        let moved = means..wandering;
        let mut a = Mat::<f64>::zeros(n, n);
        let mut density = Mat::<f64>::zeros(n, n);
        for (mean, state) in mechanics.measured.iter().enumerate() {
            a[(mean, means + state)] = 1.0;
        }
        for (i, row) in moved.clone().enumerate() {
            moved.clone().enumerate().for_each(|(j, column)| a[(row, column)] = mechanics.a[(i, j)]);
            (wandering..n).for_each(|j| a[(row, j)] = mechanics.by_sought[i] * sought[j]);
            let of_torque = scale * logarithms[states::TORQUE].exp();
            for (j, column) in moved.clone().enumerate() {
                density[(row, column)] = of_torque * mechanics.by_air_gap[i] * mechanics.by_air_gap[j];
            }
        }
        a[(wandering, wandering + 1)] = 1.0;
        density[(wandering + 1, wandering + 1)] = scale * logarithms[states::WANDERING].exp();
        for (k, hz) in self.observed.lines_hz.iter().enumerate() {
            let (at, omega) = (wandering + 2 + 2 * k, TAU * hz);
            for i in [at, at + 1] {
                a[(i, i)] = -logarithms[states::DAMPING].exp() * omega;
                density[(i, i)] = scale * logarithms[states::DAMPING + 1 + k].exp();
            }
            (a[(at, at + 1)], a[(at + 1, at)]) = (omega, -omega);
        }
        let b = Mat::from_fn(n, 1, |i, _| if moved.contains(&i) { mechanics.by_air_gap[i - means] } else { 0.0 });
        let c = Mat::from_fn(means, n, |i, j| f64::from(u8::from(i == j)));
        let continuous = StateSpace::continuous(a, b, c.clone(), Mat::zeros(means, 1))?;
        let process = continuous.sampled_noise(density.as_ref(), step)?;
        let held = continuous.to_discrete_zoh(step)?;
        // The first states are angles turned in a sample over the sample's length: they start anew with every sample.
        let unit = |i: usize| if i < means { 1.0 / step } else { 1.0 };
        let transition = Mat::from_fn(n, n, |i, j| if j < means { 0.0 } else { unit(i) * held.a()[(i, j)] });
        let input = Mat::from_fn(n, 1, |i, _| unit(i) * held.b()[(i, 0)]);
        let process = Mat::from_fn(n, n, |i, j| unit(i) * unit(j) * process[(i, j)]);
        let sampled = StateSpace::discrete(transition, input, c, Mat::zeros(means, 1), step)?;
        let ratios = self.observed.noise_rad_s.iter().zip(self.noise_ratios(logarithms));
        let variances = ratios.map(|(noise, ratio)| scale * ratio * noise.powi(2)).collect();
        Ok((NoisySystem::new(sampled, process, variances)?, self.start()))
    }

    /// Speeds near the first reading, the torque sought somewhere about T_d.
    fn start(&self) -> Belief {
        let (n, means, wandering) = (self.states(), self.means(), self.wandering());
        let mechanics = self.mechanics;
        let torque = self.observed.torque[(0, 0)];
        let deviation = |i: usize| match i {
            i if i < means => mechanics.start[mechanics.measured[i]],
            i if i < wandering => mechanics.start[i - means],
            i if i == wandering + 1 => START_NM_PER_S,
            _ => START_NM,
        };
        let mean = |i: usize| match i {
            i if i < means => 0.0,
            i if i < wandering => mechanics.at_rest[i - means] * torque,
            i if i == wandering => torque,
            _ => 0.0,
        };
        Belief {
            mean: (0..n).map(mean).collect(),
            covariance: Mat::from_fn(n, n, |i, j| if i == j { deviation(i).powi(2) } else { 0.0 }),
        }
    }
}
