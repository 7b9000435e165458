//! Requirements on one run.

use cycle::{Course, Feedback, Judged, Own, Reference, RequirementSet, Signal, Validation, validate};

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
            own = seconds(trace);
            &own
        }
    };
    sets.iter().map(|set| Ok(validate(reference, &feedback, set)?)).collect()
}

/// What a run demands at each whole second.
fn seconds(trace: &Trace) -> Reference {
    let apart = ((1.0 / trace.step_s).round() as usize).max(1);
    let at_seconds = |values: &[f64]| values.iter().step_by(apart).copied().collect::<Vec<_>>();
    Reference::of_itself(trace.start_s, at_seconds(&trace.speed_demand_rad_s), at_seconds(&trace.torque_demand_nm))
}

/// One's own requirements on a run.
pub(crate) fn own(trace: &Trace, own: &[Own]) -> Vec<Judged> {
    let judge = |own: &Own| {
        let (demand, value) = match own.signal() {
            Signal::Speed => (&trace.speed_demand_rad_s, &trace.speed_rad_s),
            Signal::Torque | Signal::Power => (&trace.torque_demand_nm, &trace.torque_nm),
        };
        let judged = own.judge(&Course { sample_time_s: trace.step_s, demand, value });
        Judged { time_s: trace.start_s + judged.time_s, ..judged }
    };
    own.iter().map(judge).collect()
}
