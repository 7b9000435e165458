//! Periods of the signals at the lines that the demand excites.

use std::f64::consts::{PI, TAU};

use ident::IdentError;
use ident::frequency::{Window, samples_in};
use rig::estimation::{EstimateError, Unsuitable};
use rig::facts::Engine;
use rig::results::Stretch;
use signal::periodicity::detect_period;
use signal::{Complex64, Signal};

use super::super::Timing;
use super::super::aligned::{self, inner_stretch};
use crate::shaft::{CLEAN_PART, DYNO, ENGINE, HIGHEST_HZ, ShaftInputs, TORQUE};

/// Fewest periods.
const FEWEST_PERIODS: usize = 3;
/// Part of a period over which its window rises.
const RISE: f64 = 0.25;
/// Part of the power of a demand that need not repeat: rounding, and a first value of its own.
const UNREPEATED: f64 = 1e-3;
/// Left out at the start, s, for the bench to settle.
const SETTLING_S: f64 = 2.0;
/// A line is excited where the demand has more than this part of its strongest line.
const EXCITED: f64 = 0.02;
/// Lowest line used, Hz.
const LOWEST_HZ: f64 = 0.4;
/// Degrees of freedom that a variance is averaged up to.
const WANTED_FREEDOM: usize = 24;

/// ω_d, ω_e and T_d; then ω cos θ and ω sin θ of both encoders.
pub(super) const SIGNALS: usize = 7;
pub(super) const DYNO_WAVES: [usize; 2] = [3, 4];
pub(super) const ENGINE_WAVES: [usize; 2] = [5, 6];

/// Coefficients of a signal and its first two derivatives.
pub(super) type Orders = [Complex64; 3];
/// Those of every signal: of an equation, or its transforms.
pub(super) type Row = [Orders; SIGNALS];

/// The sum of an equation's terms.
pub(super) fn applied(equation: &Row, transforms: &Row) -> Complex64 {
    let terms = equation.iter().flatten().zip(transforms.iter().flatten());
    terms.map(|(c, z)| c * z).sum()
}

/// Transforms of every period at the excited lines.
pub(super) struct Lines {
    start_s: f64,
    pub(super) period_s: f64,
    pub(super) frequencies_hz: Vec<f64>,
    /// By line, then by period.
    transforms: Vec<Vec<Row>>,
    /// Lines on either side over which variances are averaged.
    pub(super) reach: usize,
    /// How far the engine's cycles repeat with the demand: 0 not at all, 1 wholly.
    pub(super) coherence: f64,
}

impl Lines {
    pub(super) fn new(
        inputs: &ShaftInputs<'_>,
        demand: &Signal,
        timing: &Timing,
        engine: Engine,
    ) -> Result<Self, EstimateError> {
        let of = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
        let stretch = inner_stretch(inputs)?;
        let start_s = stretch.start_s.max(demand.start_s) + SETTLING_S;
        let end_s = stretch.end_s.min(demand.end_s());
        let used = demand.slice(start_s, end_s);
        let not_periodic = || {
            // The last window falls within the period after it.
            let reason = Unsuitable::NotPeriodic { periods: FEWEST_PERIODS + 1 };
            EstimateError::Unsuitable { file: inputs.file.to_owned(), reason }
        };
        let period = detect_period(&used.samples, UNREPEATED).map_err(|_| not_periodic())?.ok_or_else(not_periodic)?;
        let period_s = period.period as f64 * demand.sample_time_s;
        // The last window falls within the period after it.
        let periods = ((end_s - start_s) / period_s - RISE + 1e-6).floor() as usize;
        if periods < FEWEST_PERIODS {
            return Err(not_periodic());
        }
        let slowest_s = inputs.signals().map(|s| s.sample_time_s).fold(0.0, f64::max);
        let highest_hz = HIGHEST_HZ.min(CLEAN_PART / slowest_s);
        let excited = excited(&used, Window { start_s: used.start_s, duration_s: period_s }, highest_hz).map_err(of)?;
        if excited.is_empty() {
            return Err(of(IdentError::Constant { what: "T_d* in the band of the shaft" }));
        }
        let grid = Grid { start_s, period_s, periods, harmonics: &excited };
        let transforms = grid.transforms(inputs, timing).map_err(of)?;
        let groups = WANTED_FREEDOM.div_ceil(periods - 1);
        Ok(Lines {
            start_s,
            period_s,
            frequencies_hz: excited.iter().map(|k| *k as f64 / period_s).collect(),
            transforms,
            reach: (groups / 2).min((excited.len() - 1) / 2),
            coherence: grid.coherence(inputs.engine_speed, engine),
        })
    }

    pub(super) fn count(&self) -> usize {
        self.transforms.len()
    }

    pub(super) fn periods(&self) -> usize {
        self.transforms.first().map_or(0, Vec::len)
    }

    pub(super) fn s(&self, k: usize) -> Complex64 {
        Complex64::new(0.0, TAU * self.frequencies_hz[k])
    }

    /// Degrees of freedom of an averaged variance.
    pub(super) fn freedom(&self) -> f64 {
        ((self.periods() - 1) * (2 * self.reach + 1)) as f64
    }

    /// The mean over periods of an equation's error at a line, and the variance of that mean from its scatter.
    pub(super) fn error(&self, k: usize, equation: &Row) -> (Complex64, f64) {
        let errors: Vec<Complex64> = self.transforms[k].iter().map(|z| applied(equation, z)).collect();
        let count = errors.len() as f64;
        let mean = errors.iter().sum::<Complex64>() / count;
        let scatter: f64 = errors.iter().map(|e| (e - mean).norm_sqr()).sum();
        (mean, scatter / (count * (count - 1.0)))
    }

    /// The mean transforms at a line.
    pub(super) fn mean(&self, k: usize) -> Row {
        let count = self.periods() as f64;
        let sum = |i: usize, n: usize| self.transforms[k].iter().map(|z| z[i][n]).sum::<Complex64>() / count;
        std::array::from_fn(|i| std::array::from_fn(|n| sum(i, n)))
    }

    pub(super) fn stretch(&self, file: &str) -> Stretch {
        let end_s = self.start_s + (self.periods() as f64 + RISE) * self.period_s;
        Stretch { file: file.to_owned(), start_s: self.start_s, end_s }
    }
}

/// Periods and harmonics.
pub(super) struct Grid<'a> {
    start_s: f64,
    period_s: f64,
    periods: usize,
    harmonics: &'a [usize],
}

impl Grid<'_> {
    /// By harmonic, then by period.
    fn transforms(&self, inputs: &ShaftInputs<'_>, timing: &Timing) -> Result<Vec<Vec<Row>>, IdentError> {
        let mut all = vec![vec![[[Complex64::default(); 3]; SIGNALS]; self.periods]; self.harmonics.len()];
        let mut add = |place: usize, signal: &Signal, earlier_s: f64| -> Result<(), IdentError> {
            let dated = Signal { start_s: signal.start_s - earlier_s, ..signal.clone() };
            for p in 0..self.periods {
                let transform = self.transform(&dated, p)?;
                for (line, orders) in all.iter_mut().zip(transform) {
                    line[p][place].iter_mut().zip(orders).for_each(|(sum, value)| *sum += value);
                }
            }
            Ok(())
        };
        for record in &inputs.torque {
            add(TORQUE, &record.signal, timing.torque_skew_s.0)?;
        }
        let speeds = [
            (inputs.dyno_speed, 0.0, DYNO, DYNO_WAVES),
            (inputs.engine_speed, timing.engine_skew_s.0, ENGINE, ENGINE_WAVES),
        ];
        for (speed, earlier_s, place, waves) in speeds {
            add(place, speed, earlier_s)?;
            for (place, wave) in waves.into_iter().zip(once_a_turn(speed)) {
                add(place, &wave, earlier_s)?;
            }
        }
        Ok(all)
    }

    /// Transforms of a signal and its derivatives over one period.
    fn transform(&self, signal: &Signal, period: usize) -> Result<Vec<Orders>, IdentError> {
        let start_s = self.start_s + period as f64 * self.period_s;
        let whole = samples_in(signal, Window { start_s, duration_s: self.period_s })?;
        let next = samples_in(signal, Window { start_s: start_s + self.period_s, duration_s: RISE * self.period_s })?;
        let (count, dt) = (whole.values.len(), whole.sample_time_s);
        // The mean has no part in any line, and would swamp the others.
        let mean = whole.values.iter().sum::<f64>() / count as f64;
        let mut weighed = [vec![0.0; count], vec![0.0; count], vec![0.0; count]];
        let falling =
            next.values.iter().enumerate().map(|(i, x)| (i, next.offset_s + i as f64 * dt + self.period_s, x));
        let rising = whole.values.iter().enumerate().map(|(i, x)| (i, whole.offset_s + i as f64 * dt, x));
        for (i, time_s, x) in rising.chain(falling) {
            let window = self.window(time_s);
            for (sums, weight) in weighed.iter_mut().zip(window) {
                // What falls into the next period has the same phases there.
                sums[i % count] += weight * (x - mean);
            }
        }
        let spectra: Vec<Vec<Complex64>> = weighed
            .iter()
            .map(|w| signal::spectrum::fft_real(w).map_err(IdentError::from))
            .collect::<Result<_, _>>()?;
        let orders = |k: &usize| {
            let omega = TAU * *k as f64 / self.period_s;
            let dated = Complex64::cis(-omega * whole.offset_s) / count as f64;
            let [h0, h1, h2] = [0, 1, 2].map(|n| spectra[n].get(*k).copied().unwrap_or_default() * dated);
            let s = Complex64::new(0.0, omega);
            [h0, s * h0 - h1, s * (s * h0 - 2.0 * h1) + h2]
        };
        Ok(self.harmonics.iter().map(orders).collect())
    }

    /// The window and its first two derivatives at a time after its start.
    fn window(&self, time_s: f64) -> [f64; 3] {
        let rise_s = RISE * self.period_s;
        let (edge, slope) = if time_s < rise_s {
            (time_s / rise_s, 1.0)
        } else if time_s >= self.period_s {
            ((self.period_s - time_s) / rise_s + 1.0, -1.0)
        } else {
            return [1.0, 0.0, 0.0];
        };
        let ((sin, cos), rate) = ((PI * edge.clamp(0.0, 1.0)).sin_cos(), PI / rise_s);
        [0.5 * (1.0 - cos), 0.5 * slope * rate * sin, 0.5 * rate * rate * cos]
    }

    /// |mean over periods of e^{jnφ}| of the worst harmonic n of the working cycle up to the firing, φ the cycle's angle at the
    /// start of a period.
    fn coherence(&self, engine_speed: &Signal, engine: Engine) -> f64 {
        let mut angle = 0.0;
        let mut at_start = Vec::with_capacity(self.periods);
        for (i, omega) in engine_speed.samples.iter().enumerate() {
            let next_s = self.start_s + at_start.len() as f64 * self.period_s;
            if at_start.len() < self.periods && engine_speed.time_s(i) >= next_s {
                at_start.push(2.0 * angle / f64::from(engine.strokes));
            }
            angle += omega * engine_speed.sample_time_s;
        }
        let mean = |n: u32| {
            let sum: Complex64 = at_start.iter().map(|a| Complex64::cis(f64::from(n) * a)).sum();
            sum.norm() / at_start.len().max(1) as f64
        };
        (1..=engine.cylinders).map(mean).fold(0.0, f64::max)
    }
}

/// ω cos θ and ω sin θ, θ being the angle turned since the first sample.
pub(super) fn once_a_turn(speed: &Signal) -> [Signal; 2] {
    let [cosine, sine] = aligned::once_a_turn(&speed.samples, speed.sample_time_s);
    [speed.with_samples(cosine), speed.with_samples(sine)]
}

/// Harmonics that the demand excites.
pub(super) fn excited(demand: &Signal, window: Window, highest_hz: f64) -> Result<Vec<usize>, IdentError> {
    let values = samples_in(demand, window)?.values;
    let spectrum = signal::spectrum::fft_real(&values)?;
    let bins = window.bins(LOWEST_HZ, highest_hz.min(0.45 / demand.sample_time_s));
    let strongest = bins.clone().map(|k| spectrum[k].norm()).fold(0.0, f64::max);
    Ok(bins.filter(|k| spectrum[*k].norm() > EXCITED * strongest && strongest > 0.0).collect())
}
