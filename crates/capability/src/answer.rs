//! The answer: many benches run the test, and every requirement and limit gets the share of benches that keep it.

use bench_model::model::BenchModel;
use bench_model::prediction::{PredictionError, PredictionInputs};
use cycle::{CycleError, Judged, Own, RequirementSet, Signal, Statistic, Validation};
use design::safety::{BenchSpread, Proportion, slowed};
use numerics::{order, parallel};
use rig::bench_file::Limits;
use rig::bench_parameters::EngineParameters;
use rig::facts::Engine;
use rig::random::Source;
use serde::Serialize;

use crate::cycle_run::CycleGrid;
use crate::demand::Demand;
use crate::error::CapabilityError;
use crate::extremes::{Firing, LimitOf, Peak, peaks, unbounded};
use crate::judged;
use crate::plan_run;
use crate::pulses::Pulses;
use crate::trace::Trace;

/// Times at which the spread of a course is kept.
const BAND_POINTS: usize = 400;
/// From this share of the benches on the answer is yes.
const YES: f64 = 0.95;
/// Up to this share it is no.
const NO: f64 = 0.5;

/// What an answer rests on.
#[derive(Debug, Clone, Copy)]
pub struct CanInputs<'a> {
    /// The test.
    pub demand: Demand<'a>,
    /// The bench.
    pub model: &'a BenchModel,
    /// Its engine.
    pub engine: &'a EngineParameters,
    /// What the bench must not exceed.
    pub limits: Limits,
    /// How benches differ from it.
    pub spread: BenchSpread<'a>,
    /// Share of the stated bandwidth that the engine's speed control (TN) has at least.
    pub slowest_engine_control: f64,
    /// Requirement sets that must be met.
    pub sets: &'a [RequirementSet],
    /// Requirements of one's own.
    pub own: &'a [Own],
    /// Benches drawn.
    pub samples: usize,
    /// Seed of the draws; equal seeds give equal results.
    pub seed: u64,
}

/// The answer in a word.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Answer {
    /// 95 % of the benches keep everything.
    Yes,
    /// More than half of them do.
    Perhaps,
    /// No more than half of them do.
    No,
}

/// One limit of the bench.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LimitVerdict {
    /// Of what.
    pub of: LimitOf,
    /// The limit stated, SI.
    pub limit: Option<f64>,
    /// The largest value on every bench, SI, growing.
    pub values: Vec<f64>,
    /// How often the limit is reached; `None` without one.
    pub reached: Option<Proportion>,
    /// When the largest value comes on the nominal bench, s.
    pub time_s: f64,
}

/// One number of a requirement set.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct StatisticVerdict {
    /// Of which signal.
    pub signal: Signal,
    /// Which number.
    pub statistic: Statistic,
    /// Its limits, SI.
    pub low: Option<f64>,
    /// Upper limit, SI.
    pub high: Option<f64>,
    /// Its value on every bench, SI, growing.
    pub values: Vec<f64>,
    /// How many benches keep the limit.
    pub kept: Proportion,
}

/// One requirement set.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SetVerdict {
    /// Its name.
    pub name: String,
    /// How many benches meet it.
    pub kept: Proportion,
    /// Its numbers.
    pub statistics: Vec<StatisticVerdict>,
    /// The nominal bench.
    pub nominal: Option<Validation>,
}

/// One requirement of one's own.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OwnVerdict {
    /// The requirement.
    pub own: Own,
    /// How many benches meet it.
    pub kept: Proportion,
    /// Its number on every bench, growing.
    pub values: Vec<f64>,
    /// Its limit.
    pub limit: f64,
    /// When the worst comes on the nominal bench, s.
    pub time_s: f64,
}

/// Where 90 % of the benches are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Bands {
    /// Times, s.
    pub time_s: Vec<f64>,
    /// 5 % and 95 % of the speed, rad/s.
    pub speed_rad_s: [Vec<f64>; 2],
    /// 5 % and 95 % of the torque that follows the demand, Nm.
    pub torque_nm: [Vec<f64>; 2],
}

/// What can be said of a test on a bench.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Verdict {
    /// In a word.
    pub answer: Answer,
    /// How many benches keep every limit and every requirement.
    pub kept: Proportion,
    /// How many are not stable.
    pub unstable: Proportion,
    /// The limits.
    pub limits: Vec<LimitVerdict>,
    /// Limits that are not stated.
    pub unchecked: Vec<LimitOf>,
    /// The requirement sets.
    pub sets: Vec<SetVerdict>,
    /// Requirements of one's own.
    pub own: Vec<OwnVerdict>,
    /// The nominal bench.
    #[serde(skip)]
    pub nominal: Trace,
    /// How the others spread.
    #[serde(skip)]
    pub bands: Bands,
}

impl LimitVerdict {
    /// The value that a share of the benches stays below, SI.
    pub fn quantile(&self, probability: f64) -> f64 {
        order::quantile_of_sorted(&self.values, probability).unwrap_or(f64::NAN)
    }
}

/// What one bench did.
struct Outcome {
    peaks: [Peak; 8],
    validations: Vec<Validation>,
    own: Vec<Judged>,
    is_unstable: bool,
    /// Speed and torque at the times of the bands.
    course: Vec<(f64, f64)>,
}

/// One bench that could be the one at hand.
struct Drawn {
    model: BenchModel,
    engine: EngineParameters,
    firing_seed: Option<u64>,
}

/// Answers. `progress` hears from any thread how many runs of how many are done.
///
/// # Errors
/// The nominal bench cannot be simulated, no samples, an uncertainty without possible benches, a requirement that cannot be
/// applied.
pub fn can(inputs: &CanInputs<'_>, progress: &(dyn Fn(u64, u64) + Sync)) -> Result<Verdict, CapabilityError> {
    if inputs.samples == 0 {
        return Err(CapabilityError::NoSamples);
    }
    let benches = benches(inputs)?;
    let grid = match &inputs.demand {
        Demand::Cycle(cycle) => Some(CycleGrid::of(cycle, inputs.model, inputs.engine)),
        Demand::Plan(..) => None,
    };
    let nominal = Drawn { model: inputs.model.clone(), engine: inputs.engine.clone(), firing_seed: Some(inputs.seed) };
    let trace = trace(inputs, grid.as_ref(), &nominal)?;
    let of_nominal = outcome(inputs, grid.as_ref(), &nominal, Ok(trace.clone()))?;
    let run = |bench: &Drawn| outcome(inputs, grid.as_ref(), bench, self::trace(inputs, grid.as_ref(), bench));
    let outcomes: Vec<Outcome> =
        parallel::map_with_progress(&benches, run, progress).into_iter().collect::<Result<_, _>>()?;
    Ok(verdict(inputs, &outcomes, &of_nominal, trace))
}

fn benches(inputs: &CanInputs<'_>) -> Result<Vec<Drawn>, CapabilityError> {
    let mut random = Source::Safety.stream(inputs.seed);
    let draw = |i: usize| {
        let model = inputs.spread.draw(inputs.model, &mut random).ok_or(CapabilityError::NoBench)?;
        let speed = random.between(inputs.slowest_engine_control, 1.0);
        let firing_seed = Some(inputs.seed.wrapping_add(i as u64));
        Ok(Drawn { model, engine: slowed(inputs.engine, speed), firing_seed })
    };
    (0..inputs.samples).map(draw).collect()
}

fn trace(inputs: &CanInputs<'_>, grid: Option<&CycleGrid>, bench: &Drawn) -> Result<Trace, CapabilityError> {
    let trace = match (&inputs.demand, grid) {
        (Demand::Plan(plan, demands), _) => plan_run::run(&PredictionInputs {
            plan,
            demands,
            model: &bench.model,
            engine: &bench.engine,
            firing_seed: bench.firing_seed,
            limits: inputs.limits,
        })?,
        (Demand::Cycle(_), Some(grid)) => grid.run(&bench.model)?,
        (Demand::Cycle(cycle), None) => CycleGrid::of(cycle, inputs.model, inputs.engine).run(&bench.model)?,
    };
    if trace.is_bounded() { Ok(trace) } else { Err(PredictionError::Unstable.into()) }
}

fn outcome(
    inputs: &CanInputs<'_>,
    grid: Option<&CycleGrid>,
    bench: &Drawn,
    trace: Result<Trace, CapabilityError>,
) -> Result<Outcome, CapabilityError> {
    let trace = match trace {
        Err(CapabilityError::Prediction(PredictionError::Unstable)) => return Ok(unstable()),
        other => other?,
    };
    let engine = Engine { cylinders: bench.engine.cylinder_factors.len() as u32, strokes: bench.engine.strokes };
    let firing = Firing {
        resonance_hz: bench.model.mechanics.resonance().frequency_hz,
        firings_per_turn: engine.firings_per_turn(),
    };
    let pulses = grid.map(|grid| (Pulses::of(&bench.model, &bench.engine, grid.range_rad_s()), grid));
    let with = pulses.as_ref().map(|(pulses, grid)| (pulses, grid.engine_nm.as_slice()));
    Ok(Outcome {
        peaks: peaks(&trace, with, &firing),
        validations: match judged::validations(&inputs.demand, &trace, inputs.sets) {
            Err(CapabilityError::Cycle(CycleError::NotFinite { .. })) => Vec::new(),
            other => other?,
        },
        own: judged::own(&trace, inputs.own),
        is_unstable: false,
        course: band_places(&trace).map(|k| (trace.speed_rad_s[k], trace.torque_nm[k])).collect(),
    })
}

fn unstable() -> Outcome {
    Outcome { peaks: unbounded(), validations: Vec::new(), own: Vec::new(), is_unstable: true, course: Vec::new() }
}

fn band_places(trace: &Trace) -> impl Iterator<Item = usize> {
    let count = trace.speed_rad_s.len();
    (0..BAND_POINTS.min(count)).map(move |k| k * count.saturating_sub(1) / (BAND_POINTS.min(count) - 1).max(1))
}

fn verdict(inputs: &CanInputs<'_>, outcomes: &[Outcome], nominal: &Outcome, trace: Trace) -> Verdict {
    let kept = proportion(outcomes, |outcome| keeps(inputs, outcome));
    let limits: Vec<LimitVerdict> = LimitOf::of_test(inputs.demand.has_shaft())
        .map(|of| limit_verdict(of, of.limit(&inputs.limits), outcomes, nominal))
        .collect();
    let answer = match kept.estimate {
        share if share >= YES => Answer::Yes,
        share if share > NO => Answer::Perhaps,
        _ => Answer::No,
    };
    Verdict {
        answer,
        kept,
        unstable: proportion(outcomes, |outcome| outcome.is_unstable),
        unchecked: limits.iter().filter(|one| one.limit.is_none()).map(|one| one.of).collect(),
        limits,
        sets: inputs.sets.iter().enumerate().map(|(k, set)| set_verdict((k, set), outcomes, nominal)).collect(),
        own: inputs.own.iter().enumerate().map(|(k, own)| own_verdict((k, own), outcomes, nominal)).collect(),
        bands: bands(&trace, outcomes),
        nominal: trace,
    }
}

/// Whether a bench keeps every limit and meets every requirement.
fn keeps(inputs: &CanInputs<'_>, outcome: &Outcome) -> bool {
    let reaches = |of: LimitOf| {
        let value = outcome.peaks[of as usize].value;
        of.limit(&inputs.limits).is_some_and(|limit| value >= limit && value > 0.0)
    };
    let meets = outcome.validations.len() == inputs.sets.len()
        && outcome.validations.iter().all(|validation| validation.passes)
        && outcome.own.len() == inputs.own.len()
        && outcome.own.iter().all(Judged::passes);
    !outcome.is_unstable && meets && !LimitOf::of_test(inputs.demand.has_shaft()).any(reaches)
}

fn proportion(outcomes: &[Outcome], is: impl Fn(&Outcome) -> bool) -> Proportion {
    Proportion::new(outcomes.iter().filter(|outcome| is(outcome)).count(), outcomes.len())
}

fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.sort_by(f64::total_cmp);
    values
}

fn limit_verdict(of: LimitOf, limit: Option<f64>, outcomes: &[Outcome], nominal: &Outcome) -> LimitVerdict {
    let value = |outcome: &Outcome| outcome.peaks[of as usize].value;
    LimitVerdict {
        of,
        limit,
        values: sorted(outcomes.iter().map(value).collect()),
        reached: limit.map(|limit| proportion(outcomes, |one| value(one) >= limit && value(one) > 0.0)),
        time_s: nominal.peaks[of as usize].time_s,
    }
}

fn set_verdict((place, set): (usize, &RequirementSet), outcomes: &[Outcome], nominal: &Outcome) -> SetVerdict {
    let of_nominal = nominal.validations.get(place);
    let statistic = |k: usize| {
        let first = &of_nominal?.checked[k];
        let one = |outcome: &Outcome| outcome.validations.get(place)?.checked.get(k).copied();
        Some(StatisticVerdict {
            signal: first.signal,
            statistic: first.statistic,
            low: first.low,
            high: first.high,
            values: sorted(outcomes.iter().filter_map(|outcome| Some(one(outcome)?.value)).collect()),
            kept: proportion(outcomes, |outcome| one(outcome).is_some_and(|one| one.passes)),
        })
    };
    SetVerdict {
        name: set.name.clone(),
        kept: proportion(outcomes, |outcome| outcome.validations.get(place).is_some_and(|one| one.passes)),
        statistics: (0..of_nominal.map_or(0, |one| one.checked.len())).filter_map(statistic).collect(),
        nominal: of_nominal.cloned(),
    }
}

fn own_verdict((place, own): (usize, &Own), outcomes: &[Outcome], nominal: &Outcome) -> OwnVerdict {
    let of_nominal = nominal.own.get(place);
    OwnVerdict {
        own: *own,
        kept: proportion(outcomes, |outcome| outcome.own.get(place).is_some_and(Judged::passes)),
        values: sorted(outcomes.iter().filter_map(|outcome| Some(outcome.own.get(place)?.value)).collect()),
        limit: of_nominal.map_or(f64::NAN, |one| one.limit),
        time_s: of_nominal.map_or(f64::NAN, |one| one.time_s),
    }
}

fn bands(trace: &Trace, outcomes: &[Outcome]) -> Bands {
    let places: Vec<usize> = band_places(trace).collect();
    let quantile = |k: usize, of: fn(&(f64, f64)) -> f64, probability: f64| {
        let values = sorted(outcomes.iter().filter_map(|outcome| outcome.course.get(k)).map(of).collect());
        order::quantile_of_sorted(&values, probability).unwrap_or(f64::NAN)
    };
    let band = |of: fn(&(f64, f64)) -> f64| {
        [0.05, 0.95].map(|probability| (0..places.len()).map(|k| quantile(k, of, probability)).collect())
    };
    Bands {
        time_s: places.iter().map(|k| trace.time_s(*k)).collect(),
        speed_rad_s: band(|point| point.0),
        torque_nm: band(|point| point.1),
    }
}
