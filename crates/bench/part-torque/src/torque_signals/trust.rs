//! T_d,calc held against the load cell at rest: offset, gain, drift.

use faer::Mat;
use ident::{IdentError, least_squares};
use numerics::null::nan_if_null;
use rig::results::{Parameter, Quantity};
use rig::{Experiment, Role};
use serde::{Deserialize, Serialize};
use signal::Signal;

/// Length of the blocks whose means are compared, s.
const BLOCK_S: f64 = 0.5;
/// About as late as a load cell is, s.
const EDGE_S: f64 = 0.012;
/// A block in which the mean of T_d,calc moves from one half to the other by more than this, Nm, ...
const AT_REST_NM: f64 = 5.0;
/// ... and by more than this part of the mean, is not near rest.
const AT_REST_PART: f64 = 0.05;
/// Fewest blocks.
const FEWEST: usize = 12;
/// The mean torques show a gain where they differ by more than this, Nm.
const APART_NM: f64 = 5.0;
/// A drift is looked for over at least this, s.
const LASTING_S: f64 = 60.0;
/// An error of gain up to which T_d,calc can be trusted.
const TOLERATED_GAIN: f64 = 0.01;
/// An error of offset up to which T_d,calc can be trusted, Nm.
const TOLERATED_OFFSET_NM: f64 = 1.0;

/// T_d,calc − T_d,meas = o + g (T_d,meas − T̄) + d (t − t̄) + τ ΔT on means over stretches near rest, ΔT being by how
/// much T_d,calc rises from end to end over the length: what a load cell that is late by τ has not seen yet.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TrustCheck {
    /// o at T̄.
    pub offset: Parameter,
    /// g; none where all torques are alike.
    pub gain: Option<Parameter>,
    /// τ, s.
    pub lateness: Parameter,
    /// d within a recording; none where none lasts long enough.
    pub drift: Option<Parameter>,
    /// T̄, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub middle_nm: f64,
    /// Lowest and highest mean torque seen, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub torques_nm: (f64, f64),
    /// The means compared: T_d,meas, and T_d,calc less it, Nm.
    #[serde(deserialize_with = "nan_if_null")]
    pub blocks: Vec<(f64, f64)>,
    /// Verdict of the check.
    pub verdict: Trust,
}

/// Trust in T_d,calc at rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Trust {
    /// Its error is within 1 % and 1 Nm, and the data are sharp enough to say so.
    Trusted,
    /// Its error is beyond that.
    Off,
    /// The data do not decide.
    Undecided,
}

struct Block {
    measured_nm: f64,
    /// ΔT over the length of the block, Nm/s.
    rise_nm_per_s: f64,
    apart_nm: f64,
    /// Since the middle of the recording, s.
    since_s: f64,
}

/// Compares T_d,calc with the load cell; `None` where no recording has both, or too little of them is at rest.
///
/// # Errors
/// Numbers that do not allow a regression.
pub(super) fn check(experiments: &[&Experiment]) -> Result<Option<TrustCheck>, IdentError> {
    let blocks: Vec<Block> = experiments.iter().flat_map(|experiment| blocks(experiment)).collect();
    if blocks.len() < FEWEST {
        return Ok(None);
    }
    let count = blocks.len() as f64;
    let middle_nm = blocks.iter().map(|b| b.measured_nm).sum::<f64>() / count;
    let ends = |f: fn(&Block) -> f64| {
        blocks.iter().map(f).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let torques_nm = ends(|b| b.measured_nm);
    let lasting = ends(|b| b.since_s);
    let has_gain = torques_nm.1 - torques_nm.0 > APART_NM;
    let has_drift = lasting.1 - lasting.0 > LASTING_S;
    let columns: Vec<fn(&Block, f64) -> f64> = [
        Some((|_: &Block, _: f64| 1.0) as fn(&Block, f64) -> f64),
        Some(|b: &Block, _: f64| b.rise_nm_per_s),
        has_gain.then_some(|b: &Block, middle: f64| b.measured_nm - middle),
        has_drift.then_some(|b: &Block, _: f64| b.since_s),
    ]
    .into_iter()
    .flatten()
    .collect();
    let phi = Mat::from_fn(blocks.len(), columns.len(), |i, j| columns[j](&blocks[i], middle_nm));
    let target: Vec<f64> = blocks.iter().map(|b| b.apart_nm).collect();
    let fit = least_squares(phi.as_ref(), &target)?;
    let covariance = fit.covariance();
    let parameter = |quantity, at: usize| {
        Parameter::new(quantity, fit.parameters[at], covariance[(at, at)].sqrt(), fit.degrees_of_freedom())
    };
    let offset = parameter(Quantity::TorqueOffset, 0);
    let gain = has_gain.then(|| parameter(Quantity::TorqueGainError, 2));
    let drift = has_drift.then(|| parameter(Quantity::TorqueDrift, 2 + usize::from(has_gain)));
    Ok(Some(TrustCheck {
        verdict: verdict(&offset, gain.as_ref()),
        offset,
        lateness: parameter(Quantity::LoadCellLateness, 1),
        gain,
        drift,
        middle_nm,
        torques_nm,
        blocks: blocks.iter().map(|b| (b.measured_nm, b.apart_nm)).collect(),
    }))
}

fn verdict(offset: &Parameter, gain: Option<&Parameter>) -> Trust {
    let within = |p: &Parameter, most: f64| p.interval.0 > -most && p.interval.1 < most;
    let beyond = |p: &Parameter, most: f64| p.interval.0 > most || p.interval.1 < -most;
    match gain {
        _ if beyond(offset, TOLERATED_OFFSET_NM) => Trust::Off,
        Some(gain) if beyond(gain, TOLERATED_GAIN) => Trust::Off,
        Some(gain) if within(gain, TOLERATED_GAIN) && within(offset, TOLERATED_OFFSET_NM) => Trust::Trusted,
        _ => Trust::Undecided,
    }
}

/// Means over the blocks of a recording that are near rest.
fn blocks(experiment: &Experiment) -> Vec<Block> {
    let signal = |role| experiment.signal(role);
    let (Some(calculated), Some(measured)) = (signal(Role::AirGapTorque), signal(Role::LoadCellTorque)) else {
        return Vec::new();
    };
    let from = calculated.start_s.max(measured.start_s) + EDGE_S;
    let to = calculated.end_s().min(measured.end_s()) - EDGE_S;
    let count = ((to - from) / BLOCK_S).max(0.0) as usize;
    let mean = |x: &Signal, from: f64, to: f64| x.slice(from, to).mean();
    // What a late cell has not seen yet at an instant, and what comes next.
    let before = |t: f64| mean(calculated, t - EDGE_S, t);
    let jump = |t: f64| Some(mean(calculated, t, t + EDGE_S)? - before(t)?);
    let block = |k: usize| {
        let (start, end) = (from + k as f64 * BLOCK_S, from + (k + 1) as f64 * BLOCK_S);
        let half = 0.5 * (start + end);
        let moved = mean(calculated, half, end)? - mean(calculated, start, half)?;
        let measured_nm = mean(measured, start, end)?;
        let most = AT_REST_NM.max(AT_REST_PART * measured_nm.abs());
        let is_near_rest = [moved, jump(start)?, jump(end)?].iter().all(|change| change.abs() < most);
        let block = Block {
            measured_nm,
            rise_nm_per_s: (before(end)? - before(start)?) / BLOCK_S,
            apart_nm: mean(calculated, start, end)? - measured_nm,
            since_s: half - 0.5 * (from + to),
        };
        is_near_rest.then_some(block)
    };
    (0..count).filter_map(block).collect()
}
