//! Check that the channels of T_d* and T_d,calc are not exchanged: in torque control the demand is held, and the torque
//! follows it.

use crate::channels::evidence::{Samples, best_delay};
use crate::diagnostics::{Finding, Severity};
use crate::experiment::{ControlMode, ExperimentLabel};
use crate::prepare::log::Log;
use crate::prepare::source::Source;
use crate::role::Role;

/// A torque that rests for this share of its samples is held, as a demand is, and one that rests for less than the
/// other moves, as a real torque does. On 16 simulated benches T_d* rests for 0.9 of its samples in torque control, and
/// T_d,calc for none.
const HELD: f64 = 0.5;
const MOVES: f64 = 0.1;
/// A torque follows another if it is so much later, s, and if their changes have this correlation.
const LATER_S: f64 = 1e-3;
const FOLLOWS: f64 = 0.7;

/// Notes a T_d* that follows a T_d,calc that is held.
pub(super) fn check(sources: &[Source<'_>], label: &ExperimentLabel, log: &mut Log) {
    let of = |role: Role| sources.iter().find(|source| source.role == role);
    let (Some(demand), Some(torque)) = (of(Role::DynoTorqueDemand), of(Role::AirGapTorque)) else { return };
    if label.mode != ControlMode::Tn || resting(torque) < HELD || resting(demand) > MOVES {
        return;
    }
    if let Some(later_s) = follows(demand, torque).filter(|_| follows(torque, demand).is_none()) {
        let [demand, torque] = [demand, torque].map(|source| source.channel.to_owned());
        log.file(Severity::Error, None, Finding::TorquesExchanged { demand, torque, later_s });
    }
}

/// By how much a torque is later than the one that it follows, s.
fn follows<'r>(later: &Source<'r>, earlier: &Source<'r>) -> Option<f64> {
    let samples = |of: &Source<'r>| Samples { time_s: of.time_s, values: of.samples };
    let (later_s, correlation) = best_delay(samples(earlier), samples(later))?;
    (later_s >= LATER_S && correlation > FOLLOWS).then_some(later_s)
}

/// The share of samples that repeat the one before.
fn resting(source: &Source<'_>) -> f64 {
    let repeated = source.samples.windows(2).filter(|pair| pair[0] == pair[1]).count();
    repeated as f64 / source.samples.len().max(1) as f64
}
