//! The largest sine that a bench can be asked for, over frequency and speed.
//!
//! Short of its limits the bench is linear, so what a sine adds grows with its amplitude. A limit binds where the mean,
//! the firing pulses and the sine together reach it; in the worst case their peaks come at one moment, and the map
//! takes that case. The pulses are the largest of all speeds and torques of the engine that the sine itself passes.

use std::f64::consts::{PI, TAU};

use bench_model::friction::DynoFriction;
use bench_model::model::BenchModel;
use bench_model::simulate::LoopMode;
use design::safety::{BenchSpread, FrictionSpread, SPEED_CHANGE_S};
use numerics::null::{infinite_if_null, nan_if_null};
use numerics::{order, parallel};
use rig::bench_file::Limits;
use rig::bench_parameters::EngineParameters;
use rig::engine_pulses::KnownPulses;
use rig::random::Source;
use rig::results::Part;
use serde::{Deserialize, Serialize};
use signal::Complex64;

use crate::error::CapabilityError;
use crate::extremes::{LimitOf, TORQUE_CHANGE_S};
use crate::pulses::{About, Pulses};

/// Halvings of the range in which the largest amplitude is looked for: its last part is 1e-12 of the whole.
const HALVINGS: usize = 40;
/// Lowest speed of the engine at which a sine can meet pulses, as a part of the lowest mean speed.
const LOWEST_REACHED: f64 = 0.02;
/// The highest, as a part of the highest mean speed.
const HIGHEST_REACHED: f64 = 2.0;

/// Frequencies at which the response is looked at for bandwidths, less one.
const BANDWIDTH_STEPS: u32 = 400;

/// Demand that the sine is on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum SineOf {
    /// N_d* in speed control (NT).
    Speed,
    /// T_d* in torque control, engine in speed control (TN).
    Torque,
}

/// Inputs of a map.
#[derive(Debug, Clone, Copy)]
pub struct MapInputs<'a> {
    /// The bench.
    pub model: &'a BenchModel,
    /// Its engine.
    pub engine: &'a EngineParameters,
    /// Knowledge of its firing pulses.
    pub pulses: &'a KnownPulses,
    /// Limits that the bench must not exceed.
    pub limits: Limits,
    /// How benches differ from it.
    pub spread: BenchSpread<'a>,
    /// How the friction of their dynamometers differs.
    pub friction: FrictionSpread,
    /// Mean torque, Nm: of the engine in speed control, of T_d* in torque control.
    pub torque_nm: f64,
    /// Benches drawn.
    pub samples: usize,
    /// Seed of the draws.
    pub seed: u64,
}

/// One place of a map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Place {
    /// Largest amplitude that 95 %, 50 % and 5 % of the benches can do, rad/s or Nm; infinite where no limit is stated.
    #[serde(deserialize_with = "infinite_if_null")]
    pub amplitude: [f64; 3],
    /// The limit that binds on the nominal bench; a sine that would stop it counts as one beyond the limit of the
    /// speed.
    pub binds: Option<LimitOf>,
}

/// Largest amplitudes over frequency and speed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CapabilityMap {
    /// Of what.
    pub of: SineOf,
    /// Frequencies, Hz.
    #[serde(deserialize_with = "nan_if_null")]
    pub frequency_hz: Vec<f64>,
    /// Speeds, rad/s.
    #[serde(deserialize_with = "nan_if_null")]
    pub speed_rad_s: Vec<f64>,
    /// A row a speed, a place a frequency.
    pub places: Vec<Vec<Place>>,
    /// How fast the demand is followed.
    pub bandwidths: Bandwidths,
}

/// Up to which frequency a demand is followed, Hz: what 95 %, 50 % and 5 % of the benches reach, infinite beyond 300
/// Hz.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Bandwidths {
    /// Within ±10 % of the amplitude.
    #[serde(deserialize_with = "infinite_if_null")]
    pub ten_per_cent_hz: [f64; 3],
    /// Within ±3 dB.
    #[serde(deserialize_with = "infinite_if_null")]
    pub three_db_hz: [f64; 3],
    /// With a delay of the phase of at most 1 ms; 0.1 Hz where it is longer everywhere.
    #[serde(deserialize_with = "infinite_if_null")]
    pub one_ms_hz: [f64; 3],
    /// Delay at the lowest frequency, s: of 5 %, 50 % and 95 % of the benches it is shorter.
    #[serde(deserialize_with = "nan_if_null")]
    pub delay_s: [f64; 3],
}

/// Gains from 1 rad/s or 1 Nm of a demand to each quantity, at one frequency.
#[derive(Debug, Clone, Copy)]
struct Gains {
    omega_rad_s: f64,
    /// The quantity demanded.
    followed: Complex64,
    dyno_speed: f64,
    engine_speed: f64,
    demand: f64,
    shaft: f64,
    engine_torque: f64,
}

/// The map over these frequencies and speeds.
///
/// # Errors
/// The model lacks torque control, or speed control for sines of the speed; an uncertainty without possible benches.
pub fn map(
    inputs: &MapInputs<'_>,
    of: SineOf,
    frequency_hz: &[f64],
    speed_rad_s: &[f64],
) -> Result<CapabilityMap, CapabilityError> {
    let benches = benches(inputs)?;
    let amplitudes = |bench: &Braked| one_bench(inputs, bench, of, frequency_hz, speed_rad_s);
    let all = parallel::map(&benches, amplitudes).into_iter().collect::<Result<Vec<_>, _>>()?;
    let nominal = amplitudes(&nominal(inputs))?;
    let place =
        |k: usize| Place { amplitude: quantiles(all.iter().map(|bench| bench[k].0).collect()), binds: nominal[k].1 };
    let columns = frequency_hz.len();
    let row = |row: usize| (0..columns).map(|column| place(row * columns + column)).collect();
    Ok(CapabilityMap {
        of,
        frequency_hz: frequency_hz.to_vec(),
        speed_rad_s: speed_rad_s.to_vec(),
        places: (0..speed_rad_s.len()).map(row).collect(),
        bandwidths: bandwidths(inputs, of, &benches)?,
    })
}

/// A bench of a map.
#[derive(Debug, Clone)]
pub(crate) struct Braked {
    pub(crate) model: BenchModel,
    pub(crate) engine: EngineParameters,
    pub(crate) friction: DynoFriction,
}

/// The nominal bench of a map.
pub(crate) fn nominal(inputs: &MapInputs<'_>) -> Braked {
    Braked { model: inputs.model.clone(), engine: inputs.engine.clone(), friction: inputs.friction.middle() }
}

/// The benches of a map.
pub(crate) fn benches(inputs: &MapInputs<'_>) -> Result<Vec<Braked>, CapabilityError> {
    let mut random = Source::Safety.stream(inputs.seed);
    let mut of_friction = Source::Friction.stream(inputs.seed);
    let draw = |_| {
        let model = inputs.spread.draw(inputs.model, &mut random).ok_or(CapabilityError::NoBench)?;
        let engine = inputs.pulses.draw(inputs.engine, model.mechanics.engine_inertia_kg_m2, &mut random);
        Ok::<Braked, CapabilityError>(Braked { model, engine, friction: inputs.friction.draw(&mut of_friction) })
    };
    let benches: Vec<Braked> = (0..inputs.samples).map(draw).collect::<Result<_, _>>()?;
    if benches.is_empty() { Err(CapabilityError::NoSamples) } else { Ok(benches) }
}

/// 5, 50 and 95 % of some values.
pub(crate) fn quantiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.05, 0.5, 0.95].map(|share| order::quantile_of_sorted(&values, share).unwrap_or(f64::NAN))
}

fn bandwidths(inputs: &MapInputs<'_>, of: SineOf, benches: &[Braked]) -> Result<Bandwidths, CapabilityError> {
    let all = parallel::map(benches, |bench| bandwidths_of(inputs, &bench.model, of));
    let all = all.into_iter().collect::<Result<Vec<[f64; 4]>, _>>()?;
    let [ten_per_cent_hz, three_db_hz, one_ms_hz, delay_s] =
        [0, 1, 2, 3].map(|k| quantiles(all.iter().map(|one| one[k]).collect()));
    Ok(Bandwidths { ten_per_cent_hz, three_db_hz, one_ms_hz, delay_s })
}

/// The first frequencies between 0.1 and 300 Hz at which the response leaves 10 %, 3 dB and 1 ms, and its delay at the
/// lowest.
fn bandwidths_of(inputs: &MapInputs<'_>, model: &BenchModel, of: SineOf) -> Result<[f64; 4], CapabilityError> {
    let mut found = [f64::INFINITY; 3];
    let mut lowest_s = None;
    for k in 0..=BANDWIDTH_STEPS {
        let frequency_hz = 0.1 * 3000.0_f64.powf(f64::from(k) / f64::from(BANDWIDTH_STEPS));
        let response = gains(inputs, model, of, TAU * frequency_hz)?.followed;
        let (gain, delay_s) = (response.norm(), -response.arg() / (TAU * frequency_hz));
        lowest_s = lowest_s.or(Some(delay_s));
        let keeps =
            [(0.9..=1.1).contains(&gain), (0.5_f64.sqrt()..=2.0_f64.sqrt()).contains(&gain), delay_s.abs() <= 1e-3];
        for (first, keeps) in found.iter_mut().zip(keeps) {
            *first = if keeps { *first } else { first.min(frequency_hz) };
        }
    }
    Ok([found[0], found[1], found[2], lowest_s.unwrap_or(f64::NAN)])
}

/// Largest amplitude and what binds, speed by speed, in each frequency by frequency.
pub(crate) fn one_bench(
    inputs: &MapInputs<'_>,
    Braked { model, engine, friction }: &Braked,
    of: SineOf,
    frequency_hz: &[f64],
    speed_rad_s: &[f64],
) -> Result<Vec<(f64, Option<LimitOf>)>, CapabilityError> {
    let gains: Vec<Gains> =
        frequency_hz.iter().map(|f| gains(inputs, model, of, TAU * f)).collect::<Result<_, CapabilityError>>()?;
    let (low, high) = speed_rad_s.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), w| (low.min(*w), high.max(*w)));
    let mode = if of == SineOf::Speed { LoopMode::Speed } else { LoopMode::Torque };
    let swings_nm = gains.iter().map(|gains| high / gains.dyno_speed * gains.engine_torque).fold(0.0, f64::max);
    let most_nm = inputs.torque_nm.abs() + friction.torque_nm(high).abs() + swings_nm;
    let pulses = Pulses::of(model, engine, mode, (LOWEST_REACHED * low, HIGHEST_REACHED * high), most_nm);
    let rows = speed_rad_s.iter().flat_map(|speed| {
        let (torque, friction) = (inputs.torque_nm, friction.torque_nm(*speed));
        let (engine, dyno) =
            if of == SineOf::Speed { (torque, torque - friction) } else { (torque + friction, torque) };
        let place = Mean { speed: *speed, engine, dyno, limits: inputs.limits, pulses: pulses.about(*speed) };
        gains.iter().map(|gains| place.largest(gains)).collect::<Vec<_>>()
    });
    Ok(rows.collect())
}

/// Mean speed and torques, about which a sine goes.
struct Mean<'a> {
    speed: f64,
    /// Of engine and shaft.
    engine: f64,
    /// Of the dynamometer.
    dyno: f64,
    limits: Limits,
    pulses: About<'a>,
}

impl Mean<'_> {
    /// The largest amplitude, and the limit that binds: no limit is used more as a sine becomes smaller.
    fn largest(&self, gains: &Gains) -> (f64, Option<LimitOf>) {
        // The bench does not turn backwards.
        let most = self.speed / gains.dyno_speed;
        let (used, mut binds) = self.used(gains, most);
        if used < 1.0 {
            return (most, Some(LimitOf::Speed));
        }
        let (mut low, mut high) = (0.0, most);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            match self.used(gains, middle) {
                (used, _) if used < 1.0 => low = middle,
                (_, of) => (high, binds) = (middle, of),
            }
        }
        (low, binds)
    }

    /// The largest part of a limit that a sine of this amplitude uses, and of which limit.
    fn used(&self, gains: &Gains, amplitude: f64) -> (f64, Option<LimitOf>) {
        let slope = |gain: f64, over_s: f64| {
            amplitude * gain * 2.0 * (0.5 * gains.omega_rad_s * over_s).min(0.5 * PI).sin() / over_s
        };
        let swings_nm = amplitude * gains.engine_torque;
        let added =
            self.pulses.within(amplitude * gains.engine_speed, [self.engine - swings_nm, self.engine + swings_nm]);
        let beyond_nm = (self.engine + added.shaft_above_nm).max(added.shaft_below_nm - self.engine);
        let demand = self.dyno.abs() + amplitude * gains.demand + added.demand_nm;
        let dyno = amplitude * gains.dyno_speed + added.dyno_speed_rad_s;
        let engine = amplitude * gains.engine_speed + added.engine_speed_rad_s;
        let values = [
            (LimitOf::ShaftTorque, beyond_nm + amplitude * gains.shaft),
            (LimitOf::ShaftTorqueSlew, amplitude * gains.shaft * gains.omega_rad_s + added.shaft_slew_nm_per_s),
            (LimitOf::TorqueDemand, demand),
            (LimitOf::TorqueSlew, slope(gains.demand, TORQUE_CHANGE_S) + added.demand_slew_nm_per_s),
            (LimitOf::Speed, self.speed + dyno.max(engine)),
            (LimitOf::SpeedGradient, slope(gains.dyno_speed, SPEED_CHANGE_S) + added.speed_gradient_rad_s2),
            (LimitOf::Power, demand * (self.speed + dyno)),
            (LimitOf::DriveHeat, self.heat(gains, amplitude, added.demand_rms_nm)),
        ];
        let used = values.into_iter().filter_map(|(of, value)| Some((value / of.limit(&self.limits)?, Some(of))));
        used.fold((0.0, None), |most, one| if one.0 > most.0 { one } else { most })
    }

    /// The largest heat of the drive as a part of that of its continuous torque T_c, with the root mean square p of the
    /// pulses: (T² + p² + 2 T a h_1 + a²/2 (1 + h_2))/T_c², a = A g_T, where h_n is what is left of the n-th harmonic
    /// of the loss after the time constant.
    fn heat(&self, gains: &Gains, amplitude: f64, pulses_nm: f64) -> f64 {
        let Some(drive) = self.limits.drive_heat else { return 0.0 };
        let left = |n: f64| 1.0 / (n * gains.omega_rad_s * drive.time_constant_s).hypot(1.0);
        let a = amplitude * gains.demand;
        let steady = self.dyno.powi(2) + pulses_nm.powi(2);
        let heat = steady + 2.0 * self.dyno.abs() * a * left(1.0) + 0.5 * a * a * (1.0 + left(2.0));
        heat / drive.continuous_torque_nm.powi(2)
    }
}

fn gains(inputs: &MapInputs<'_>, model: &BenchModel, of: SineOf, omega: f64) -> Result<Gains, CapabilityError> {
    let missing = |part| bench_model::simulate::SimulationError::MissingPart { part };
    let control = model.torque_control.ok_or_else(|| missing(Part::TorqueControl))?;
    match of {
        SineOf::Speed => {
            let pi = model.speed_controller.ok_or_else(|| missing(Part::SpeedController))?;
            let speed = model.speed_demand_to_speed(omega).ok_or_else(|| missing(Part::SpeedController))?;
            let drive = pi.hold(omega) * control.response(omega);
            let demand = speed / (drive * model.mechanics.torque_to_speed(omega));
            let shaft = demand * drive * model.mechanics.torque_to_shaft(omega);
            let engine = shaft / (Complex64::new(0.0, omega) * model.mechanics.engine_inertia_kg_m2);
            Ok(Gains {
                omega_rad_s: omega,
                followed: speed,
                dyno_speed: speed.norm(),
                engine_speed: engine.norm(),
                demand: demand.norm(),
                shaft: shaft.norm(),
                engine_torque: 0.0,
            })
        }
        SineOf::Torque => {
            let torque = control.response(omega);
            let (dyno, engine) = governed(inputs.engine, model, omega);
            let shaft = spring(model, omega) * (engine - dyno);
            Ok(Gains {
                omega_rad_s: omega,
                followed: torque,
                dyno_speed: (torque * dyno).norm(),
                engine_speed: (torque * engine).norm(),
                demand: 1.0,
                shaft: (torque * shaft).norm(),
                engine_torque: (torque * engine * governor(inputs.engine, omega)).norm(),
            })
        }
    }
}

/// K/(jω) + B.
fn spring(model: &BenchModel, omega: f64) -> Complex64 {
    let mechanics = &model.mechanics;
    Complex64::new(mechanics.damping_nm_s_per_rad, -mechanics.stiffness_nm_per_rad / omega)
}

/// Speeds of both ends for 1 Nm of T_d, with the engine in speed control.
fn governed(engine: &EngineParameters, model: &BenchModel, omega: f64) -> (Complex64, Complex64) {
    let mechanics = &model.mechanics;
    let spring = spring(model, omega);
    let control = governor(engine, omega);
    let of_dyno = Complex64::new(0.0, omega * mechanics.dyno_inertia_kg_m2) + spring;
    let of_engine = Complex64::new(0.0, omega * mechanics.engine_inertia_kg_m2) + spring + control;
    let determinant = of_dyno * of_engine - spring * spring;
    (-of_engine / determinant, -spring / determinant)
}

/// ω_e → −T_e of the engine's speed control, through its intake.
fn governor(engine: &EngineParameters, omega: f64) -> Complex64 {
    let integral = -engine.speed_control_integral_nm_per_rad / omega;
    Complex64::new(engine.speed_control_proportional_nm_s_per_rad, integral)
        / Complex64::new(1.0, omega * engine.intake_lag_s)
}
