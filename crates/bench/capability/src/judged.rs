//! Requirements on one run.

use cycle::{Course, Feedback, Judged, Own, Reference, RequirementSet, Samples, Sensor, Signal, Validation, validate};

use crate::demand::Demand;
use crate::error::CapabilityError;
use crate::trace::Trace;

/// The validations of a run by each requirement set.
pub(crate) fn validations(
    demand: &Demand<'_>,
    trace: &Trace,
    sets: &[RequirementSet],
) -> Result<Vec<Validation>, CapabilityError> {
    if sets.is_empty() {
        return Ok(Vec::new());
    }
    let feedback = Feedback {
        start_s: trace.start_s,
        sample_time_s: trace.step_s,
        speed_rad_s: trace.speed_rad_s.clone(),
        torque_nm: trace.torque_nm.clone(),
        demand: None,
    };
    let own;
    let reference = match demand {
        Demand::Cycle(cycle) => cycle.reference,
        Demand::Plan(..) => {
            own = demanded(trace);
            &own
        }
    };
    sets.iter().map(|set| Ok(validate(reference, &feedback, set)?)).collect()
}

/// Demands of a run.
fn demanded(trace: &Trace) -> Reference {
    let (speed, torque) = (trace.speed_demand_rad_s.clone(), trace.torque_demand_nm.clone());
    Reference { step_s: trace.step_s, ..Reference::of_itself(trace.start_s, speed, torque) }
}

/// One's own requirements on a run.
pub(crate) fn own(trace: &Trace, own: &[Own]) -> Vec<Judged> {
    let judge = |own: &Own| {
        let judged = own.judge(&course(trace, own));
        Judged { time_s: trace.start_s + judged.time_s, ..judged }
    };
    own.iter().map(judge).collect()
}

/// Checks that a run can be judged by one's own requirements.
pub(crate) fn check_own(trace: &Trace, own: &[Own]) -> Result<(), CapabilityError> {
    Ok(own.iter().try_for_each(|own| own.check(&course(trace, own)))?)
}

fn course<'a>(trace: &'a Trace, own: &Own) -> Course<'a> {
    let value = match own.sensor() {
        Sensor::Speed => &trace.speed_rad_s,
        Sensor::Torque => &trace.torque_nm,
        Sensor::DynoSpeed => &trace.dyno_speed_rad_s,
        Sensor::EngineSpeed => &trace.engine_speed_rad_s,
        Sensor::ShaftTorque => &trace.shaft_torque_nm,
        Sensor::TorqueDemand => &trace.dyno_demand_nm,
    };
    let demand = match own.signal() {
        Signal::Speed => &trace.speed_demand_rad_s,
        Signal::Torque | Signal::Power => &trace.torque_demand_nm,
    };
    let held = Samples { start_s: 0.0, sample_time_s: trace.step_s, values: demand, is_held: true };
    Course { sample_time_s: trace.step_s, demand, value, timed_demand: trace.is_demand_held.then_some(held) }
}
