//! The answer: many benches run the test, and every requirement and limit gets the share of benches that keep it.

use std::sync::atomic::{AtomicUsize, Ordering};

use bench_model::prediction::{PredictionError, PredictionInputs};
use cycle::{CycleError, Judged, Validation};
use design::safety::{AtResonance, slowed};
use numerics::parallel;
use rig::experiment::{Demands, ExperimentPlan};
use rig::random::Source;

use crate::cycle_run::CycleGrid;
use crate::demand::Demand;
use crate::error::CapabilityError;
use crate::extremes::{LimitOf, Peak, peaks, unbounded};
use crate::filter;
use crate::judged;
use crate::outcome::{CanInputs, Drawn, Outcome, keeps_limits, meets_sets};
use crate::plan_run;
use crate::pulses::Pulses;
use crate::trace::Trace;
use crate::verdict::{Verdict, band_places, is_share_of_yes, verdict};

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
    let driven = Driven::of(inputs);
    let nominal = nominal(inputs);
    let trace = driven.trace(inputs, &nominal)?;
    judged::check_own(&trace, inputs.own)?;
    let of_nominal = outcome(inputs, &driven, &nominal, Ok(trace.clone()))?;
    let run = |bench: &Drawn| outcome(inputs, &driven, bench, driven.trace(inputs, bench));
    let outcomes: Vec<Outcome> =
        parallel::map_with_progress(&benches, run, progress).into_iter().collect::<Result<_, _>>()?;
    Ok(verdict(inputs, (&benches, &outcomes), &of_nominal, trace))
}

/// Whether the nominal bench keeps everything and the answer is a yes: as [`can`] says, but no bench runs that can change it no more.
pub(crate) fn is_yes(inputs: &CanInputs<'_>) -> Result<bool, CapabilityError> {
    let driven = Driven::of(inputs);
    if !keeps_all(inputs, &driven, &nominal(inputs))? {
        return Ok(false);
    }
    let benches = benches(inputs)?;
    let misses = AtomicUsize::new(0);
    let is_no = |misses: usize| !is_share_of_yes(benches.len() - misses, benches.len());
    let run = |bench: &Drawn| {
        if is_no(misses.load(Ordering::Relaxed)) {
            return Ok(());
        }
        let misses_one = !keeps_all(inputs, &driven, bench)?;
        misses.fetch_add(usize::from(misses_one), Ordering::Relaxed);
        Ok(())
    };
    parallel::map(&benches, run).into_iter().collect::<Result<(), CapabilityError>>()?;
    Ok(!is_no(misses.into_inner()))
}

/// Whether the nominal bench keeps everything.
pub(crate) fn nominal_keeps(inputs: &CanInputs<'_>) -> Result<bool, CapabilityError> {
    keeps_all(inputs, &Driven::of(inputs), &nominal(inputs))
}

/// Whether a bench keeps every limit and meets every requirement; what costs most is looked at last.
fn keeps_all(inputs: &CanInputs<'_>, driven: &Driven<'_>, bench: &Drawn) -> Result<bool, CapabilityError> {
    let trace = match driven.trace(inputs, bench) {
        Err(CapabilityError::Prediction(PredictionError::Unstable)) => return Ok(false),
        other => other?,
    };
    Ok(keeps_limits(inputs, &peaks_of(inputs, driven, bench, &trace))
        && judged::own(&trace, inputs.own).iter().all(Judged::passes)
        && meets_sets(inputs, &validations(inputs, &trace)?))
}

fn nominal(inputs: &CanInputs<'_>) -> Drawn {
    Drawn {
        model: inputs.model.clone(),
        engine: inputs.engine.clone(),
        engine_speed: 1.0,
        firing_seed: Some(inputs.seed),
    }
}

fn benches(inputs: &CanInputs<'_>) -> Result<Vec<Drawn>, CapabilityError> {
    let mut random = Source::Safety.stream(inputs.seed);
    let draw = |i: usize| {
        let model = inputs.spread.draw(inputs.model, &mut random).ok_or(CapabilityError::NoBench)?;
        let speed = random.between(inputs.slowest_engine_control, 1.0);
        let firing_seed = Some(inputs.seed.wrapping_add(i as u64));
        Ok(Drawn { model, engine: slowed(inputs.engine, speed), engine_speed: speed, firing_seed })
    };
    (0..inputs.samples).map(draw).collect()
}

/// What benches are driven by.
enum Driven<'a> {
    Cycle(CycleGrid),
    /// With the demands that the bench gets, if they are other ones.
    Plan(&'a ExperimentPlan, &'a Demands, Option<Demands>),
}

impl<'a> Driven<'a> {
    fn of(inputs: &CanInputs<'a>) -> Self {
        match inputs.demand {
            Demand::Cycle(cycle) => Driven::Cycle(CycleGrid::of(&cycle, inputs.model, inputs.engine, inputs.filter_hz)),
            Demand::Plan(plan, demands) => {
                Driven::Plan(plan, demands, inputs.filter_hz.map(|corner_hz| filter::demands(demands, corner_hz)))
            }
        }
    }

    fn grid(&self) -> Option<&CycleGrid> {
        match self {
            Driven::Cycle(grid) => Some(grid),
            Driven::Plan(..) => None,
        }
    }

    fn trace(&self, inputs: &CanInputs<'_>, bench: &Drawn) -> Result<Trace, CapabilityError> {
        let trace = match self {
            Driven::Cycle(grid) => grid.run(&bench.model)?,
            Driven::Plan(plan, asked, filtered) => {
                let prediction = PredictionInputs {
                    plan,
                    demands: filtered.as_ref().unwrap_or(asked),
                    model: &bench.model,
                    engine: &bench.engine,
                    firing_seed: bench.firing_seed,
                    limits: inputs.limits,
                };
                plan_run::run(&prediction, asked)?
            }
        };
        if trace.is_bounded() { Ok(trace) } else { Err(PredictionError::Unstable.into()) }
    }
}

fn outcome(
    inputs: &CanInputs<'_>,
    driven: &Driven<'_>,
    bench: &Drawn,
    trace: Result<Trace, CapabilityError>,
) -> Result<Outcome, CapabilityError> {
    let trace = match trace {
        Err(CapabilityError::Prediction(PredictionError::Unstable)) => return Ok(unstable()),
        other => other?,
    };
    Ok(Outcome {
        peaks: peaks_of(inputs, driven, bench, &trace),
        validations: validations(inputs, &trace)?,
        own: judged::own(&trace, inputs.own),
        is_unstable: false,
        course: band_places(&trace).map(|k| (trace.speed_rad_s[k], trace.torque_nm[k])).collect(),
    })
}

/// None of a run with values that are no numbers.
fn validations(inputs: &CanInputs<'_>, trace: &Trace) -> Result<Vec<Validation>, CapabilityError> {
    match judged::validations(&inputs.demand, trace, inputs.sets) {
        Err(CapabilityError::Cycle(CycleError::NotFinite { .. })) => Ok(Vec::new()),
        other => other,
    }
}

fn peaks_of(inputs: &CanInputs<'_>, driven: &Driven<'_>, bench: &Drawn, trace: &Trace) -> [Peak; LimitOf::COUNT] {
    let plan = if let Demand::Plan(plan, _) = inputs.demand { Some(plan) } else { None };
    let near = AtResonance::of(&bench.model.mechanics, &bench.engine, plan);
    let pulses = driven.grid().map(|grid| (Pulses::of(&bench.model, &bench.engine, grid.range_rad_s()), grid));
    let with = pulses.as_ref().map(|(pulses, grid)| (pulses, grid.engine_nm.as_slice()));
    peaks(trace, with, &near, &inputs.limits)
}

fn unstable() -> Outcome {
    Outcome { peaks: unbounded(), validations: Vec::new(), own: Vec::new(), is_unstable: true, course: Vec::new() }
}
