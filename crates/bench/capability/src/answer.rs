//! The answer: many benches run the test, and every requirement and limit gets the share of benches that keep it.

use bench_model::disturbances::Disturbances;
use bench_model::prediction::{PredictionError, PredictionInputs};
use bench_model::simulate::LoopMode;
use cycle::{CycleError, Judged, Validation};
use design::safety::{AtResonance, slowed};
use numerics::parallel;
use rig::ControlMode;
use rig::experiment::{Demands, ExperimentPlan};
use rig::random::Source;

use crate::added::Added;
use crate::courses;
use crate::cycle_run::CycleGrid;
use crate::demand::Demand;
use crate::error::CapabilityError;
use crate::extremes::{Drive, LimitOf, Peak, TORQUE_CHANGE_S, peaks, unbounded};
use crate::filter;
use crate::fired::Firing;
use crate::following::Following;
use crate::judged;
use crate::outcome::{CanInputs, Drawn, Outcome, keeps_limits, meets_sets};
use crate::plan_run;
use crate::pulses::Pulses;
use crate::trace::Trace;
use crate::verdict::band_places;

/// Standard deviations that the largest sample of noise has at the most: one of 10 000.
const MOST_NOISE: f64 = 4.0;

/// Tells whether the nominal bench keeps everything.
pub(crate) fn nominal_keeps(inputs: &CanInputs<'_>) -> Result<bool, CapabilityError> {
    keeps_all(inputs, &Driven::of(inputs), &nominal(inputs))
}

/// The benches of an answer, each of which can run on its own.
pub(crate) struct Trial<'a, 'b> {
    inputs: &'b CanInputs<'a>,
    driven: Driven<'a>,
    benches: Vec<Drawn>,
}

impl<'a, 'b> Trial<'a, 'b> {
    pub(crate) fn of(inputs: &'b CanInputs<'a>) -> Result<Self, CapabilityError> {
        Ok(Trial { inputs, driven: Driven::of(inputs), benches: benches(inputs)? })
    }

    /// Returns for each of some benches whether it keeps everything.
    pub(crate) fn keep(&self, places: &[usize]) -> Result<Vec<bool>, CapabilityError> {
        let keeps = |place: &usize| keeps_all(self.inputs, &self.driven, &self.benches[*place]);
        parallel::map(places, keeps).into_iter().collect()
    }
}

/// Tells whether a bench keeps every limit and meets every requirement; what costs most is looked at last.
fn keeps_all(inputs: &CanInputs<'_>, driven: &Driven<'_>, bench: &Drawn) -> Result<bool, CapabilityError> {
    let trace = match driven.trace(inputs, bench) {
        Err(CapabilityError::Prediction(PredictionError::Unstable)) => return Ok(false),
        other => other?,
    };
    let meets_all = judged::own(&trace, inputs.own).iter().all(Judged::passes)
        && meets_sets(inputs.sets, &validations(inputs, &trace)?);
    if !meets_all {
        return Ok(false);
    }
    // Bounds that keep the limits spare the simulation of the firings.
    let keeps = |peaks: &[Peak; LimitOf::COUNT]| keeps_limits(inputs.demand.has_shaft(), &inputs.limits, peaks);
    let enough = |firing: &Firing<'_>| match firing.bounds() {
        bounds if keeps(&bounds) => Ok(bounds),
        _ => firing.peaks(),
    };
    match with_pulses(inputs, driven, bench, &trace, enough) {
        Err(CapabilityError::Prediction(PredictionError::Unstable)) => Ok(false),
        other => Ok(keeps(&other?)),
    }
}

pub(crate) fn nominal(inputs: &CanInputs<'_>) -> Drawn {
    Drawn {
        model: inputs.model.clone(),
        engine: inputs.engine.clone(),
        engine_speed: 1.0,
        friction: inputs.friction.middle(),
        disturbances: inputs.disturbances,
        following: Following::EXACT,
        firing_seed: Some(inputs.seed),
    }
}

pub(crate) fn benches(inputs: &CanInputs<'_>) -> Result<Vec<Drawn>, CapabilityError> {
    let mut random = Source::Safety.stream(inputs.seed);
    let mut of_friction = Source::Friction.stream(inputs.seed);
    let mut of_disturbances = Source::Disturbances.stream(inputs.seed);
    let mut of_following = Source::EngineTorque.stream(inputs.seed);
    let largest_nm = largest_demanded_nm(inputs);
    let draw = |i: usize| {
        let model = inputs.spread.draw(inputs.model, &mut random).ok_or(CapabilityError::NoBench)?;
        let speed = random.between(inputs.slowest_engine_control, 1.0);
        let engine = inputs.pulses.draw(inputs.engine, model.mechanics.engine_inertia_kg_m2, &mut random);
        let firing_seed = Some(inputs.seed.wrapping_add(i as u64));
        let friction = inputs.friction.draw(&mut of_friction);
        let disturbances = inputs.disturbances.draw(&mut of_disturbances);
        // An engine that controls its speed gives what that asks for.
        let following = match largest_nm {
            Some(largest_nm) => inputs.following.draw(largest_nm, &mut of_following),
            None => Following::EXACT,
        };
        let engine = following.slower(&slowed(&engine, speed));
        Ok(Drawn { model, engine, engine_speed: speed, friction, disturbances, following, firing_seed })
    };
    (0..inputs.samples).map(draw).collect()
}

impl CanInputs<'_> {
    /// Tells whether the test demands a torque of the engine.
    pub fn is_torque_demanded(&self) -> bool {
        largest_demanded_nm(self).is_some()
    }
}

/// The largest torque that is demanded of the engine, Nm; none where no torque is.
fn largest_demanded_nm(inputs: &CanInputs<'_>) -> Option<f64> {
    let largest = |torques: &[f64]| torques.iter().fold(0.0_f64, |most, torque| most.max(torque.abs()));
    match inputs.demand {
        Demand::Cycle(cycle) => Some(largest(&cycle.reference.torque_nm)),
        Demand::Plan(plan, demands) => {
            let is_demanded = plan.label.mode == ControlMode::Nt && plan.has_shaft && !plan.is_motored;
            is_demanded.then(|| largest(&demands.engine_torque_nm))
        }
    }
}

/// Inputs that drive the benches.
pub(crate) enum Driven<'a> {
    Cycle(CycleGrid),
    /// With the demands that the bench gets, if they are other ones.
    Plan(&'a ExperimentPlan, &'a Demands, Option<Demands>),
}

impl<'a> Driven<'a> {
    pub(crate) fn of(inputs: &CanInputs<'a>) -> Self {
        match inputs.demand {
            Demand::Cycle(cycle) => Driven::Cycle(CycleGrid::of(&cycle, inputs.model, inputs.filter_hz)),
            Demand::Plan(plan, demands) => {
                Driven::Plan(plan, demands, inputs.filter_hz.map(|corner_hz| filter::demands(demands, corner_hz)))
            }
        }
    }

    pub(crate) fn trace(&self, inputs: &CanInputs<'_>, bench: &Drawn) -> Result<Trace, CapabilityError> {
        let trace = match self {
            Driven::Cycle(grid) => grid.run(bench)?,
            Driven::Plan(plan, asked, filtered) => {
                let demands = bench.following.demands(filtered.as_ref().unwrap_or(asked));
                let prediction = PredictionInputs {
                    plan,
                    demands: &demands,
                    model: &bench.model,
                    engine: &bench.engine,
                    firing_seed: bench.firing_seed,
                    friction: bench.friction,
                    disturbances: bench.disturbances,
                    limits: inputs.limits,
                };
                plan_run::run(&prediction, asked)?
            }
        };
        if trace.is_bounded() { Ok(trace) } else { Err(PredictionError::Unstable.into()) }
    }
}

pub(crate) fn outcome(
    inputs: &CanInputs<'_>,
    driven: &Driven<'_>,
    bench: &Drawn,
    trace: Result<Trace, CapabilityError>,
    with_courses: bool,
) -> Result<Outcome, CapabilityError> {
    let trace = match trace {
        Err(CapabilityError::Prediction(PredictionError::Unstable)) => return Ok(unstable()),
        other => other?,
    };
    let peaks = match with_pulses(inputs, driven, bench, &trace, |firing| firing.peaks()) {
        Err(CapabilityError::Prediction(PredictionError::Unstable)) => return Ok(unstable()),
        other => other?,
    };
    Ok(Outcome {
        peaks,
        validations: validations(inputs, &trace)?,
        own: judged::own(&trace, inputs.own),
        is_unstable: false,
        course: band_places(&trace).map(|k| (trace.speed_rad_s[k], trace.torque_nm[k])).collect(),
        limited: if with_courses { courses::of(&trace, &drive(inputs, bench)) } else { Vec::new() },
    })
}

/// None of a run with values that are no numbers.
fn validations(inputs: &CanInputs<'_>, trace: &Trace) -> Result<Vec<Validation>, CapabilityError> {
    match judged::validations(&inputs.demand, trace, inputs.sets) {
        Err(CapabilityError::Cycle(CycleError::NotFinite { .. })) => Ok(Vec::new()),
        other => other,
    }
}

/// The largest values of a run, those of a cycle from its firings; a plan's run has its pulses.
fn with_pulses(
    inputs: &CanInputs<'_>,
    driven: &Driven<'_>,
    bench: &Drawn,
    trace: &Trace,
    of_cycle: impl Fn(&Firing<'_>) -> Result<[Peak; LimitOf::COUNT], CapabilityError>,
) -> Result<[Peak; LimitOf::COUNT], CapabilityError> {
    let plan = if let Demand::Plan(plan, _) = inputs.demand { Some(plan) } else { None };
    let near = &AtResonance::of(&bench.model.mechanics, &bench.engine, plan);
    let drive = &drive(inputs, bench);
    match driven {
        Driven::Plan(..) => Ok(peaks(trace, &[], near, drive)),
        Driven::Cycle(grid) => of_cycle(&Firing { grid, bench, trace, added: &added(grid, bench, trace), near, drive }),
    }
}

fn drive(inputs: &CanInputs<'_>, bench: &Drawn) -> Drive {
    Drive { torque_limit_nm: bench.model.torque_limit_nm, heat: inputs.limits.drive_heat }
}

/// Largest additions of pulses to each value of a cycle's run.
fn added(grid: &CycleGrid, bench: &Drawn, trace: &Trace) -> Vec<Added> {
    let engine_nm = grid.given_nm(bench);
    let most_nm = engine_nm.iter().fold(0.0_f64, |most, torque| most.max(torque.abs()));
    let pulses = Pulses::of(&bench.model, &bench.engine, LoopMode::Speed, grid.range_rad_s(), most_nm);
    let at = |(engine_nm, speed): (&f64, &f64)| {
        let of_pulses = pulses.at(*engine_nm, *speed);
        of_pulses.with(&of_encoder(bench, *speed), |one, other| one + other)
    };
    engine_nm.iter().zip(&trace.engine_speed_rad_s).map(at).collect()
}

/// Addition of the errors of the encoder at the most through the gain of the speed controller.
fn of_encoder(bench: &Drawn, speed_rad_s: f64) -> Added {
    let gain = bench.model.speed_controller.map_or(0.0, |pi| pi.proportional_nm_s_per_rad);
    let Disturbances { speed_noise_rad_s, once_a_turn, .. } = bench.disturbances;
    let demand_nm = gain.abs() * (once_a_turn * speed_rad_s.abs() + MOST_NOISE * speed_noise_rad_s);
    Added { demand_nm, demand_slew_nm_per_s: 2.0 * demand_nm / TORQUE_CHANGE_S, ..Added::default() }
}

fn unstable() -> Outcome {
    Outcome {
        peaks: unbounded(),
        validations: Vec::new(),
        own: Vec::new(),
        is_unstable: true,
        course: Vec::new(),
        limited: Vec::new(),
    }
}
