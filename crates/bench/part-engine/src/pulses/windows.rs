//! The engine's torque at the harmonics of its working cycle, window by window of a recording.
//!
//! Least squares in the angle of the crank, weighted by a Hann window over [`TURNS`] turns, as for the tracks of
//! orders: harmonics that fold are separated as far as the speed and the window allow. The amplitudes of N_e, N_d and
//! T_d then go through the two masses and the shaft: T_e = jω J_e ω_e + T_shaft, where T_shaft is jω J_d ω_d + T_d on
//! the one hand and (K/jω + B)(ω_e − ω_d) on the other.
//!
//! # Source
//! Blough, Mechanical Systems and Signal Processing 17 (2003) 1185–1199; (2.7), (6.1), (6.4).

use std::f64::consts::{PI, TAU};

use faer::Mat;
use numerics::linalg::{Qr, solve_upper};
use rig::bench_parameters::ONCE_A_TURN;
use rig::dyno_friction::ExpectedFriction;
use signal::{Complex64, Signal};

use crate::source::Values;

/// The window, in turns of the crank: five working cycles of four strokes.
const TURNS: f64 = 10.0;
/// Mean of the squared weights of a Hann window over the mean of the weights.
const HANN: f64 = 0.75;
/// A window has so many samples for each coefficient.
const SAMPLES_EACH: f64 = 1.5;
/// Coefficients of what drifts.
const DRIFT: usize = 3;
/// Where other harmonics make a variance this many times larger, they cannot be separated.
const INSEPARABLE: f64 = 10.0;
/// Speeds below this are those of an engine at rest, rad/s.
const AT_REST_RAD_S: f64 = 10.0;
/// Orders that differ by less are the same.
const SAME_ORDER: f64 = 1e-6;
/// The error of an encoder at an order, of the speed: a disc that runs out by some hundredths of a millimetre.
pub(super) fn encoder_error(order: f64) -> f64 {
    match order {
        1.0 => ONCE_A_TURN,
        2.0 => 1e-4,
        _ => 0.0,
    }
}

/// Windows of a recording, at most: those of a long one are apart.
const MOST_WINDOWS: usize = 600;

/// How many independent firings the mean over a window has, at a firing order.
pub(super) fn firings_counted(order: f64) -> f64 {
    TURNS * order / 1.5
}

/// Findings of a window.
#[derive(Debug)]
pub(super) struct Seen {
    /// Mean torque of the engine, Nm.
    pub(super) torque_nm: f64,
    /// Mean speed, rad/s.
    pub(super) speed_rad_s: f64,
    /// At each harmonic that is separated.
    pub(super) waves: Vec<Option<Wave>>,
}

/// The torque of a harmonic in a window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Wave {
    /// Complex amplitude in the angle of the engine's crank, Nm.
    pub(super) torque_nm: Complex64,
    /// Variance of its real part, which that of the imaginary part equals.
    pub(super) variance: f64,
    /// Part that the errors of both encoders have in it, [`encoder_error`] of each being 1, the engine's first, Nm.
    /// Angles of these errors are anywhere, so a quarter turn of both is left out, and what the damping turns them.
    pub(super) of_encoders_nm: [f64; 2],
}

/// A signal, and how late its stamps are, s.
pub(super) struct Late<'a> {
    pub(super) signal: &'a Signal,
    pub(super) late_s: f64,
}

/// Signals of a recording, each with the time by which its values are late.
pub(super) struct Record<'a> {
    pub(super) dyno_speed: Late<'a>,
    pub(super) engine_speed: Late<'a>,
    pub(super) torque: Late<'a>,
    /// Of the dynamometer's bearings.
    pub(super) friction: ExpectedFriction,
    /// Time over which the encoders average, s.
    pub(super) gate_s: f64,
}

impl Record<'_> {
    /// All windows, which overlap by a half. `orders` are multiples of the crank's speed.
    pub(super) fn seen(&self, orders: &[f64], values: &Values) -> Vec<Seen> {
        let crank = Crank::of(&self.dyno_speed);
        let turned = crank.angle_rad.last().copied().unwrap_or(0.0);
        let count = (2.0 * turned / (TAU * TURNS)).floor() as usize;
        let middle = |k: usize| (k as f64 + 1.0) * 0.5 * TAU * TURNS;
        let apart = count.div_ceil(MOST_WINDOWS).max(1);
        let windows = (0..count.saturating_sub(1)).step_by(apart).filter_map(|k| crank.window(middle(k)));
        windows.filter_map(|window| self.of_window(&window, orders, values)).collect()
    }

    fn of_window(&self, window: &Window<'_>, orders: &[f64], values: &Values) -> Option<Seen> {
        let Moments { speed_rad_s, torque_nm, twist_rad } = self.moments(window, values)?;
        let dyno = window.waves(&self.dyno_speed, orders)?;
        let engine = window.waves(&self.engine_speed, orders)?;
        // A T_d of too few samples shows nothing at these orders.
        let torque = window.waves(&self.torque, orders).unwrap_or_else(|| vec![None; orders.len()]);
        // The engine's crank is ahead of the dynamometer's by the twist.
        let ahead = |k: usize| Complex64::cis(-orders[k] * twist_rad);
        let wave = |k: usize| {
            let of = [engine[k]?, dyno[k]?, torque[k].unwrap_or((Complex64::default(), f64::INFINITY))];
            let wave = self.torque_of(of, orders[k], speed_rad_s, values);
            Some(Wave { torque_nm: wave.torque_nm * ahead(k), ..wave })
        };
        let swing = |k: usize| {
            let omega = orders[k] * speed_rad_s;
            engine[k].map(|(speed, _)| ahead(k) * speed / Complex64::new(0.0, omega * mean_over(omega * self.gate_s)))
        };
        let waves: Vec<Option<Wave>> = (0..orders.len()).map(wave).collect();
        let swings_rad: Vec<Option<Complex64>> = (0..orders.len()).map(swing).collect();
        Some(Seen { torque_nm, speed_rad_s, waves: in_own_angle(&waves, &swings_rad, orders) })
    }

    /// T_e of the amplitudes of ω_e, ω_d and T_d, T_shaft by both ways as their variances weigh them. An error of the
    /// encoders, which every turn has alike, counts in these weights.
    fn torque_of(
        &self,
        [engine, dyno, torque]: [(Complex64, f64); 3],
        order: f64,
        speed_rad_s: f64,
        v: &Values,
    ) -> Wave {
        let omega = order * speed_rad_s;
        let read = mean_over(omega * self.gate_s);
        let jw = Complex64::new(0.0, omega);
        let spring = v.stiffness / jw + v.damping;
        let of_encoder = encoder_error(order) * speed_rad_s;
        let doubt = |variance: f64| variance / (read * read) + of_encoder * of_encoder;
        let by_momentum = (omega * v.dyno_inertia).powi(2) * doubt(dyno.1) + torque.1;
        let by_spring = spring.norm_sqr() * (doubt(engine.1) + doubt(dyno.1));
        let share = 1.0 / (1.0 + by_spring / by_momentum);
        let parts = [
            ((jw * v.engine_inertia + spring * share) / read, engine),
            ((jw * v.dyno_inertia * (1.0 - share) - spring * share) / read, dyno),
            (Complex64::new(1.0 - share, 0.0), torque),
        ];
        let known = parts.iter().filter(|(weight, _)| weight.norm_sqr() > 0.0);
        let of_spring = share * v.stiffness / omega;
        Wave {
            torque_nm: parts.iter().map(|(weight, (value, _))| weight * value).sum(),
            variance: known.map(|(weight, (_, variance))| weight.norm_sqr() * variance).sum(),
            of_encoders_nm: [
                of_encoder * (omega * v.engine_inertia - of_spring),
                of_encoder * (omega * v.dyno_inertia * (1.0 - share) + of_spring),
            ],
        }
    }

    /// Mean speed and torque of the engine, and the mean twist of the shaft.
    fn moments(&self, window: &Window<'_>, v: &Values) -> Option<Moments> {
        let (speeds, torques) = (window.samples(&self.dyno_speed), window.samples(&self.torque));
        let engine_speeds = window.samples(&self.engine_speed);
        let mean = |samples: &[Sample]| {
            let weights: f64 = samples.iter().map(Sample::weight).sum();
            (weights > 0.0).then(|| samples.iter().map(|s| s.weight() * s.value).sum::<f64>() / weights)
        };
        let (speed_rad_s, air_gap_nm) = (mean(&speeds)?, mean(&torques)?);
        // Integrated by parts, the mean of dω/dt is that of −ω dw/dt.
        let of_place = speed_rad_s / (TAU * TURNS);
        let slope = |s: &Sample| PI * (TAU * s.place).sin() * of_place * (s.value - speed_rad_s);
        let acceleration = |samples: &[Sample]| {
            let weights: f64 = samples.iter().map(Sample::weight).sum();
            (weights > 0.0).then(|| samples.iter().map(slope).sum::<f64>() / weights)
        };
        let friction_nm = self.friction.mean_nm(speed_rad_s);
        let shaft_nm = air_gap_nm + friction_nm + v.dyno_inertia * acceleration(&speeds)?;
        Some(Moments {
            speed_rad_s,
            torque_nm: shaft_nm + v.engine_inertia * acceleration(&engine_speeds)?,
            twist_rad: shaft_nm / v.stiffness,
        })
    }
}

/// Amplitudes in the angle of the engine's own crank, which the pulses swing by φ against the mean angle that they are
/// given in: to the first order A_m = C_m − i Σ_k o_k C_k φ_{m−k}, both being two-sided. It is A_m = 1/2π ∮ T
/// e^{−io_mθ} dθ with θ the mean angle + φ.
fn in_own_angle(waves: &[Option<Wave>], swings_rad: &[Option<Complex64>], orders: &[f64]) -> Vec<Option<Wave>> {
    let both = || (0..orders.len()).flat_map(|k| [(k, 1.0), (k, -1.0)]);
    let side = |value: Complex64, sign: f64| if sign > 0.0 { 0.5 * value } else { 0.5 * value.conj() };
    let moved = |m: usize| {
        let wave = waves[m]?;
        let mut sum = Complex64::default();
        for ((k, of_wave), (n, of_swing)) in both().flat_map(|one| both().map(move |other| (one, other))) {
            let order = of_wave * orders[k] + of_swing * orders[n];
            if (order - orders[m]).abs() < SAME_ORDER
                && let (Some(at), Some(swing)) = (waves[k], swings_rad[n])
            {
                sum += of_wave * orders[k] * side(at.torque_nm, of_wave) * side(swing, of_swing);
            }
        }
        Some(Wave { torque_nm: wave.torque_nm - Complex64::new(0.0, 2.0) * sum, ..wave })
    };
    (0..orders.len()).map(moved).collect()
}

struct Moments {
    speed_rad_s: f64,
    torque_nm: f64,
    twist_rad: f64,
}

/// sin(x/2)/(x/2): what a mean over a time leaves of a wave, its phase counted from the middle.
fn mean_over(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (0.5 * x).sin() / (0.5 * x) }
}

/// The angle of the dynamometer, which the pulses hardly move.
struct Crank {
    first_s: f64,
    step_s: f64,
    angle_rad: Vec<f64>,
}

impl Crank {
    fn of(speed: &Late<'_>) -> Self {
        let Late { signal: speed, late_s } = *speed;
        let mut turned = 0.0;
        let steps = speed.samples.windows(2).map(|pair| {
            turned += 0.5 * (pair[0] + pair[1]) * speed.sample_time_s;
            turned
        });
        let angle_rad = std::iter::once(0.0).chain(steps).collect();
        Crank { first_s: speed.start_s - late_s, step_s: speed.sample_time_s, angle_rad }
    }

    /// At a time within the recording, rad.
    fn at(&self, time_s: f64) -> f64 {
        let place = ((time_s - self.first_s) / self.step_s).clamp(0.0, (self.angle_rad.len() - 1) as f64);
        let before = (place as usize).min(self.angle_rad.len().saturating_sub(2));
        let (from, to) = (self.angle_rad[before], self.angle_rad[(before + 1).min(self.angle_rad.len() - 1)]);
        from + (place - before as f64) * (to - from)
    }

    /// The window about an angle; none where the engine hardly turns.
    fn window(&self, middle_rad: f64) -> Option<Window<'_>> {
        let half = 0.5 * TAU * TURNS;
        let place = |angle: f64| self.angle_rad.partition_point(|turned| *turned < angle);
        let (from, to) = (place(middle_rad - half), place(middle_rad + half));
        let time = |k: usize| self.first_s + k as f64 * self.step_s;
        let is_turning = to < self.angle_rad.len() && 2.0 * half > AT_REST_RAD_S * (time(to) - time(from));
        is_turning.then(|| Window { crank: self, middle_rad, from_s: time(from), to_s: time(to) })
    }
}

struct Window<'a> {
    crank: &'a Crank,
    middle_rad: f64,
    from_s: f64,
    to_s: f64,
}

/// A sample in a window.
struct Sample {
    /// −½ … ½ over the turns of the window.
    place: f64,
    angle_rad: f64,
    value: f64,
}

impl Sample {
    fn weight(&self) -> f64 {
        (PI * self.place).cos().powi(2)
    }
}

impl Window<'_> {
    fn samples(&self, signal: &Late<'_>) -> Vec<Sample> {
        let Late { signal, late_s } = *signal;
        let index = |time_s: f64| ((time_s + late_s - signal.start_s) / signal.sample_time_s).ceil().max(0.0) as usize;
        let sample = |k: usize| {
            let angle_rad = self.crank.at(signal.time_s(k) - late_s);
            let place = (angle_rad - self.middle_rad) / (TAU * TURNS);
            Sample { place, angle_rad, value: signal.samples[k] }
        };
        let all = (index(self.from_s)..index(self.to_s).min(signal.len())).map(sample);
        all.filter(|sample| sample.place.abs() < 0.5).collect()
    }

    /// Complex amplitude and variance of its parts at each order that is separated; `None` of too few samples.
    fn waves(&self, signal: &Late<'_>, orders: &[f64]) -> Option<Vec<Option<(Complex64, f64)>>> {
        let samples = self.samples(signal);
        let (rows, columns) = (samples.len(), 2 * orders.len() + DRIFT);
        if (rows as f64) < SAMPLES_EACH * columns as f64 {
            return None;
        }
        let regressor = |sample: &Sample, j: usize| match j.checked_sub(2 * orders.len()) {
            Some(power) => (2.0 * sample.place).powi(power as i32),
            None if j.is_multiple_of(2) => (orders[j / 2] * sample.angle_rad).cos(),
            None => -(orders[j / 2] * sample.angle_rad).sin(),
        };
        let root: Vec<f64> = samples.iter().map(|sample| sample.weight().sqrt()).collect();
        let weighted = Mat::from_fn(rows, columns, |k, j| root[k] * regressor(&samples[k], j));
        let wanted = Mat::from_fn(rows, 1, |k, _| root[k] * samples[k].value);
        let qr = Qr::new(weighted.as_ref());
        let solution = qr.least_squares(wanted.as_ref());
        let left = &wanted - &weighted * &solution;
        let sum: f64 = root.iter().map(|root| root * root).sum();
        let noise = left.squared_norm_l2() / sum * rows as f64 / (rows - columns) as f64;
        let mut inverse = Mat::identity(columns, columns);
        solve_upper(qr.r(), inverse.as_mut());
        let spread = |j: usize| inverse.row(j).squared_norm_l2();
        let wave = |k: usize| {
            let of_parts = 0.5 * (spread(2 * k) + spread(2 * k + 1));
            let value = Complex64::new(solution[(2 * k, 0)], solution[(2 * k + 1, 0)]);
            let is_separated = value.is_finite() && 0.5 * sum * of_parts < INSEPARABLE;
            is_separated.then_some((value, HANN * noise * of_parts))
        };
        Some((0..orders.len()).map(wave).collect())
    }
}
