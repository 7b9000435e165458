//! The shaft's zero when nobody knows how late a speed is stamped.

use recording::Recording;
use rig::BenchFile;
use rig::bench_parameters::BenchParameters;
use rig::experiment::{ExperimentPlan, UPDATE_S};
use rig::results::{Estimate, Quantity};
use serde::Serialize;
use signal::distributions::interval;
use signal::filter::Sos;
use study::{Campaign, Prepared, Source, run};
use units::RPM_RAD_S;
use virtual_bench::simulate;

use super::error::EffectsError;
use super::sampled::sampled;

/// How late the engine's speed is stamped, s.
const SKEWS_S: [f64; 3] = [-0.5e-3, 0.0, 0.5e-3];
/// Length of each recording, s.
const DURATION_S: f64 = 20.0;
const SPEED_RPM: f64 = 1200.0;
/// Where the naive method splits its bands, Hz, and the order of its filters.
const CORNER_HZ: f64 = 30.0;
const FILTER_ORDER: usize = 4;
/// Samples at both ends that its filters have not settled in.
const SETTLING: usize = 500;
/// Confidence of the intervals.
const LEVEL: f64 = 0.95;

/// The zero −K/B of T_shaft/Δω = (K + Bs)/s, rad/s, over skews of a speed that are not known to who estimates it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ShaftZeros {
    /// How much later than it says the engine's speed is, s.
    pub skew_s: Vec<f64>,
    /// By least squares on one clock without heed of delays (thesis §6.3.5.2), by the band that was looked at.
    pub naive: Vec<NaiveZeros>,
    /// By a study of the same recordings, with the ends of its interval of 95 %.
    pub estimated: Vec<(f64, f64, f64)>,
    /// The truth.
    pub truth: f64,
}

/// The naive zeros of one band.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NaiveZeros {
    /// Which band.
    pub band: String,
    /// One for each skew, rad/s.
    pub zero: Vec<f64>,
}

impl ShaftZeros {
    /// Simulates a bench with a binary demand and with white noise, at each skew, and estimates the zero from both in
    /// both ways.
    ///
    /// # Errors
    /// As [`simulate`]; [`EffectsError::NoShaft`] where a study finds no shaft.
    pub fn of(bench: &BenchParameters, file: &BenchFile, seed: u64) -> Result<Self, EffectsError> {
        let filters = bands()?;
        let mut naive: Vec<NaiveZeros> =
            filters.iter().map(|(band, _)| NaiveZeros { band: (*band).to_owned(), zero: Vec::new() }).collect();
        let mut estimated = Vec::new();
        for skew_s in SKEWS_S {
            let recordings = skewed(bench, skew_s, seed)?;
            for (naive, (_, filter)) in naive.iter_mut().zip(&filters) {
                naive.zero.push(naive_zero(&recordings[0].1, bench, filter.as_ref())?);
            }
            estimated.push(studied(file, recordings, seed)?);
        }
        let mechanics = &bench.mechanics;
        let truth = -mechanics.shaft_stiffness_nm_per_rad / mechanics.shaft_damping_nm_s_per_rad;
        Ok(ShaftZeros { skew_s: SKEWS_S.to_vec(), naive, estimated, truth })
    }
}

/// The bands that the naive method looks at.
fn bands() -> Result<[(&'static str, Option<Sos>); 3], EffectsError> {
    let low = Sos::butterworth_lowpass(FILTER_ORDER, CORNER_HZ, UPDATE_S)?;
    let high = Sos::butterworth_highpass(FILTER_ORDER, CORNER_HZ, UPDATE_S)?;
    Ok([("naive, below 30 Hz", Some(low)), ("naive, all", None), ("naive, above 30 Hz", Some(high))])
}

fn skewed(bench: &BenchParameters, skew_s: f64, seed: u64) -> Result<[(&'static str, Recording); 2], EffectsError> {
    let mut bench = bench.clone();
    bench.clocks.engine_speed_skew_s = skew_s;
    let recorded = |plan: ExperimentPlan| simulate(&bench, &plan, seed);
    Ok([
        ("BS_T_NT_1200.mf4", recorded(ExperimentPlan::bs_t_nt(SPEED_RPM, DURATION_S))?),
        ("WhiteNoise_T_TN_1200.mf4", recorded(ExperimentPlan::white_noise_t_tn(SPEED_RPM, DURATION_S))?),
    ])
}

/// −K/B of a study, with the interval by the delta method.
fn studied(bench: &BenchFile, recordings: [(&str, Recording); 2], seed: u64) -> Result<(f64, f64, f64), EffectsError> {
    let source = |(file, recording): (&str, Recording)| Source {
        file: file.to_owned(),
        sha256: String::new(),
        recording: Ok(recording),
    };
    let recordings = Prepared::of(bench, recordings.into_iter().map(source).collect(), &work::Context::new());
    let campaign = Campaign { bench, bench_file: ("", ""), recordings, seed: Some(seed) };
    let study = run(campaign, &work::Context::new())?;
    study.shaft.estimated().and_then(|shaft| zero(&shaft.estimate)).ok_or(EffectsError::NoShaft)
}

fn zero(shaft: &Estimate) -> Option<(f64, f64, f64)> {
    let (k, b) = (shaft.place(Quantity::Stiffness)?, shaft.place(Quantity::Damping)?);
    let (stiffness, damping) = (shaft.parameters[k].value, shaft.parameters[b].value);
    let value = -stiffness / damping;
    let slopes = [(k, -1.0 / damping), (b, stiffness / (damping * damping))];
    let terms = slopes.iter().flat_map(|(i, s)| slopes.iter().map(move |(j, t)| s * t * shaft.covariance[*i][*j]));
    let standard_error = terms.sum::<f64>().max(0.0).sqrt();
    let (low, high) = interval(value, standard_error, shaft.parameters[k].degrees_of_freedom, LEVEL);
    Some((value, low, high))
}

/// T_shaft from differences of N_d and from T_d,calc, everything on the clock of N_d by interpolation, filtered, least
/// squares.
fn naive_zero(recording: &Recording, bench: &BenchParameters, filter: Option<&Sos>) -> Result<f64, EffectsError> {
    let (speed, _) = sampled(recording, "DynoSpeed");
    let speed: Vec<f64> = speed.iter().map(|n| n * RPM_RAD_S).collect();
    let last = speed.len().saturating_sub(1);
    let [engine, torque] =
        ["EngineSpeed", "DynoTorqueCalc"].map(|name| on_the_fast_clock(recording, name, speed.len()));
    let slip: Vec<f64> = engine.iter().zip(&speed).map(|(n, d)| n * RPM_RAD_S - d).collect();
    let mut twist = vec![0.0; slip.len()];
    for k in 1..slip.len() {
        twist[k] = twist[k - 1] + 0.5 * UPDATE_S * (slip[k] + slip[k - 1]);
    }
    let slope = |k: usize| (speed[(k + 1).min(last)] - speed[k.saturating_sub(1)]) / (2.0 * UPDATE_S);
    let inertia = bench.mechanics.dyno_inertia_kg_m2;
    let shaft: Vec<f64> = (0..speed.len()).map(|k| inertia * slope(k) + torque[k]).collect();
    let filtered = |mut x: Vec<f64>| {
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        x.iter_mut().for_each(|x| *x -= mean);
        filter.map_or_else(|| Ok(x.clone()), |filter| filter.filtfilt(&x))
    };
    let (y, twist, slip) = (filtered(shaft)?, filtered(twist)?, filtered(slip)?);
    let inner = SETTLING..y.len().saturating_sub(SETTLING);
    let dot = |x: &[f64], y: &[f64]| inner.clone().map(|k| x[k] * y[k]).sum::<f64>();
    let (aa, ab, bb) = (dot(&twist, &twist), dot(&twist, &slip), dot(&slip, &slip));
    let (ay, by) = (dot(&twist, &y), dot(&slip, &y));
    Ok(-(bb * ay - ab * by) / (aa * by - ab * ay))
}

/// A channel on the clock of N_d, straight between samples, at the times its stamps say.
fn on_the_fast_clock(recording: &Recording, name: &str, count: usize) -> Vec<f64> {
    let Some(channel) = recording.channel(name) else { return vec![f64::NAN; count] };
    let (x, time_s) = (&channel.samples, recording.time_s(channel).unwrap_or(&[]));
    let [first, second, ..] = time_s else { return vec![f64::NAN; count] };
    let at = |k: usize| {
        let place = ((k as f64 * UPDATE_S - first) / (second - first)).clamp(0.0, (x.len() - 2) as f64);
        let below = place.floor();
        x[below as usize] + (place - below) * (x[below as usize + 1] - x[below as usize])
    };
    (0..count).map(at).collect()
}
