//! The largest sine that a bench can be asked for, over frequency and speed.
//!
//! Short of its limits the bench is linear, so what a sine adds grows with its amplitude. A limit binds where the mean, the firing
//! pulses and the sine together reach it; in the worst case their peaks come at one moment, and the map takes that case.

use std::f64::consts::{PI, TAU};

use bench_model::model::BenchModel;
use design::safety::BenchSpread;
use numerics::{order, parallel};
use rig::bench_file::{DriveHeat, Limits};
use rig::bench_parameters::EngineParameters;
use rig::engine_pulses::KnownPulses;
use rig::random::Source;
use rig::results::Part;
use serde::Serialize;
use signal::Complex64;

use crate::error::CapabilityError;
use crate::extremes::LimitOf;
use crate::pulses::Pulses;

/// Changes of T_d* and of the speed count over these times, s.
const CHANGES_S: (f64, f64) = (0.01, 0.05);

/// Frequencies at which the response is looked at for bandwidths, less one.
const BANDWIDTH_STEPS: u32 = 400;

/// What the sine is demanded of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum SineOf {
    /// N_d* in speed control (NT).
    Speed,
    /// T_d* in torque control, engine in speed control (TN).
    Torque,
}

/// What a map rests on.
#[derive(Debug, Clone, Copy)]
pub struct MapInputs<'a> {
    /// The bench.
    pub model: &'a BenchModel,
    /// Its engine.
    pub engine: &'a EngineParameters,
    /// What is known of its firing pulses.
    pub pulses: &'a KnownPulses,
    /// What the bench must not exceed.
    pub limits: Limits,
    /// How benches differ from it.
    pub spread: BenchSpread<'a>,
    /// Mean torque, Nm.
    pub torque_nm: f64,
    /// Benches drawn.
    pub samples: usize,
    /// Seed of the draws.
    pub seed: u64,
}

/// One place of a map.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Place {
    /// Largest amplitude that 95 %, 50 % and 5 % of the benches can do, rad/s or Nm; infinite where no limit is stated.
    pub amplitude: [f64; 3],
    /// The limit that binds on the nominal bench; a sine that would stop it counts as one beyond the limit of the speed.
    pub binds: Option<LimitOf>,
}

/// Largest amplitudes over frequency and speed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CapabilityMap {
    /// Of what.
    pub of: SineOf,
    /// Frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    /// Speeds, rad/s.
    pub speed_rad_s: Vec<f64>,
    /// A row a speed, a place a frequency.
    pub places: Vec<Vec<Place>>,
    /// How fast the demand is followed.
    pub bandwidths: Bandwidths,
}

/// Up to which frequency a demand is followed, Hz: what 95 %, 50 % and 5 % of the benches reach, infinite beyond 300 Hz.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Bandwidths {
    /// Within ±10 % of the amplitude.
    pub ten_per_cent_hz: [f64; 3],
    /// Within ±3 dB.
    pub three_db_hz: [f64; 3],
    /// With a delay of the phase of at most 1 ms; 0.1 Hz where it is longer everywhere.
    pub one_ms_hz: [f64; 3],
    /// Delay at the lowest frequency, s: of 5 %, 50 % and 95 % of the benches it is shorter.
    pub delay_s: [f64; 3],
}

/// What 1 rad/s or 1 Nm of a demand makes of each quantity, at one frequency.
#[derive(Debug, Clone, Copy)]
struct Gains {
    /// The quantity demanded.
    followed: Complex64,
    dyno_speed: f64,
    engine_speed: f64,
    demand: f64,
    shaft: f64,
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
    let amplitudes = |model: &BenchModel, engine: &EngineParameters| {
        one_bench(&MapInputs { engine, ..*inputs }, model, of, frequency_hz, speed_rad_s)
    };
    let all = parallel::map(&benches, |(model, engine)| amplitudes(model, engine))
        .into_iter()
        .collect::<Result<Vec<_>, _>>()?;
    let nominal = amplitudes(inputs.model, inputs.engine)?;
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

/// The benches of a map, each with its engine.
pub(crate) fn benches(inputs: &MapInputs<'_>) -> Result<Vec<(BenchModel, EngineParameters)>, CapabilityError> {
    let mut random = Source::Safety.stream(inputs.seed);
    let draw = |_| {
        let model = inputs.spread.draw(inputs.model, &mut random).ok_or(CapabilityError::NoBench)?;
        let engine = inputs.pulses.draw(inputs.engine, model.mechanics.engine_inertia_kg_m2, &mut random);
        Ok((model, engine))
    };
    let benches: Vec<_> = (0..inputs.samples).map(draw).collect::<Result<_, CapabilityError>>()?;
    if benches.is_empty() { Err(CapabilityError::NoSamples) } else { Ok(benches) }
}

/// 5, 50 and 95 % of some values.
pub(crate) fn quantiles(mut values: Vec<f64>) -> [f64; 3] {
    values.sort_by(f64::total_cmp);
    [0.05, 0.5, 0.95].map(|share| order::quantile_of_sorted(&values, share).unwrap_or(f64::NAN))
}

fn bandwidths(
    inputs: &MapInputs<'_>,
    of: SineOf,
    benches: &[(BenchModel, EngineParameters)],
) -> Result<Bandwidths, CapabilityError> {
    let all = parallel::map(benches, |(model, _)| bandwidths_of(inputs, model, of));
    let all = all.into_iter().collect::<Result<Vec<[f64; 4]>, _>>()?;
    let [ten_per_cent_hz, three_db_hz, one_ms_hz, delay_s] =
        [0, 1, 2, 3].map(|k| quantiles(all.iter().map(|one| one[k]).collect()));
    Ok(Bandwidths { ten_per_cent_hz, three_db_hz, one_ms_hz, delay_s })
}

/// The first frequencies between 0.1 and 300 Hz at which the response leaves 10 %, 3 dB and 1 ms, and its delay at the lowest.
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
    model: &BenchModel,
    of: SineOf,
    frequency_hz: &[f64],
    speed_rad_s: &[f64],
) -> Result<Vec<(f64, Option<LimitOf>)>, CapabilityError> {
    let gains = frequency_hz.iter().map(|f| Ok((TAU * f, gains(inputs, model, of, TAU * f)?)));
    let gains = gains.collect::<Result<Vec<_>, CapabilityError>>()?;
    let range = speed_rad_s.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), w| (low.min(*w), high.max(*w)));
    let pulses = Pulses::of(model, inputs.engine, range, inputs.torque_nm);
    let rows = speed_rad_s.iter().flat_map(|speed| {
        let (high, low, slew) = pulses.around(inputs.torque_nm, inputs.torque_nm, *speed);
        let rest = Rest { speed: *speed, torque: inputs.torque_nm.abs(), shaft: high.abs().max(low.abs()), slew };
        gains.iter().map(move |(omega, gains)| rest.largest(gains, *omega, &inputs.limits))
    });
    Ok(rows.collect())
}

/// What the limits leave before the sine.
#[derive(Clone, Copy)]
struct Rest {
    speed: f64,
    torque: f64,
    /// With pulses.
    shaft: f64,
    slew: f64,
}

impl Rest {
    /// The largest amplitude, and the limit that binds.
    fn largest(&self, gains: &Gains, omega: f64, limits: &Limits) -> (f64, Option<LimitOf>) {
        let slope = |gain: f64, over_s: f64| gain * 2.0 * (0.5 * omega * over_s).min(0.5 * PI).sin() / over_s;
        let room = |of: LimitOf, rest: f64, gain: f64| {
            let limit = of.limit(limits)?;
            Some(((limit - rest).max(0.0) / gain, Some(of)))
        };
        let rooms = [
            room(LimitOf::ShaftTorque, self.shaft, gains.shaft),
            room(LimitOf::ShaftTorqueSlew, self.slew, gains.shaft * omega),
            room(LimitOf::TorqueDemand, self.torque, gains.demand),
            room(LimitOf::TorqueSlew, 0.0, slope(gains.demand, CHANGES_S.0)),
            room(LimitOf::Speed, self.speed, gains.dyno_speed.max(gains.engine_speed)),
            // The bench does not turn backwards.
            Some((self.speed / gains.dyno_speed, Some(LimitOf::Speed))),
            room(LimitOf::SpeedGradient, 0.0, slope(gains.dyno_speed, CHANGES_S.1)),
            limits.drive_heat.map(|heat| (self.of_heat(gains, omega, heat), Some(LimitOf::DriveHeat))),
            limits.power_w.map(|limit| (self.of_power(gains, limit), Some(LimitOf::Power))),
        ];
        rooms.into_iter().flatten().fold((f64::INFINITY, None), |least, one| if one.0 < least.0 { one } else { least })
    }

    /// A at which the drive stays at the heat of its continuous torque T_c: T² + 2 T a h_1 + a²/2 (1 + h_2) = T_c², a = A g_T, where h_n is
    /// what is left of the n-th harmonic of the loss after the time constant.
    fn of_heat(&self, gains: &Gains, omega: f64, heat: DriveHeat) -> f64 {
        let left = |n: f64| 1.0 / (n * omega * heat.time_constant_s).hypot(1.0);
        let (a, b) = (0.5 * (1.0 + left(2.0)), self.torque * left(1.0));
        let room = (heat.continuous_torque_nm.powi(2) - self.torque.powi(2)).max(0.0);
        room / (b + (b * b + a * room).sqrt()) / gains.demand
    }

    /// A with (T + A g_T)(ω + A g_ω) at the limit.
    fn of_power(&self, gains: &Gains, limit_w: f64) -> f64 {
        let a = gains.demand * gains.dyno_speed;
        let b = self.torque * gains.dyno_speed + self.speed * gains.demand;
        let left = (limit_w - self.torque * self.speed).max(0.0);
        2.0 * left / (b + (b * b + 4.0 * a * left).sqrt())
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
                followed: speed,
                dyno_speed: speed.norm(),
                engine_speed: engine.norm(),
                demand: demand.norm(),
                shaft: shaft.norm(),
            })
        }
        SineOf::Torque => {
            let torque = control.response(omega);
            let (dyno, engine) = governed(inputs.engine, model, omega);
            let shaft = spring(model, omega) * (engine - dyno);
            Ok(Gains {
                followed: torque,
                dyno_speed: (torque * dyno).norm(),
                engine_speed: (torque * engine).norm(),
                demand: 1.0,
                shaft: (torque * shaft).norm(),
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
    let intake = Complex64::new(1.0, omega * engine.intake_lag_s);
    let control = Complex64::new(
        engine.speed_control_proportional_nm_s_per_rad,
        -engine.speed_control_integral_nm_per_rad / omega,
    ) / intake;
    let of_dyno = Complex64::new(0.0, omega * mechanics.dyno_inertia_kg_m2) + spring;
    let of_engine = Complex64::new(0.0, omega * mechanics.engine_inertia_kg_m2) + spring + control;
    let determinant = of_dyno * of_engine - spring * spring;
    (-of_engine / determinant, -spring / determinant)
}
