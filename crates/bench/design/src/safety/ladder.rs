//! Sines of rising frequency, as an experiment plans them.

use rig::ControlMode;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan, TorqueTarget, UPDATE_S, Waveform};

/// The sines of a sine test of T_d*.
pub(crate) struct Ladder<'a> {
    pub(crate) frequencies_hz: &'a [f64],
    pub(super) amplitude_nm: f64,
    pub(super) mean_nm: f64,
    pub(super) dwell_s: f64,
    pub(super) hold: usize,
}

impl<'a> Ladder<'a> {
    /// Of a plan that demands them of T_d*, of a fired engine on a shaft; `None` for any other.
    pub(crate) fn of(plan: &'a ExperimentPlan) -> Option<Self> {
        let Waveform::SineLadder { mean, amplitude, frequencies_hz, dwell_s } = &plan.dyno_torque_nm else {
            return None;
        };
        let is_sine_test = plan.label.mode == ControlMode::Tn
            && plan.torque_target == TorqueTarget::AirGap
            && plan.has_shaft
            && !plan.is_motored
            && *amplitude != 0.0
            && !frequencies_hz.is_empty();
        is_sine_test.then(|| Ladder {
            frequencies_hz,
            amplitude_nm: amplitude.abs(),
            mean_nm: *mean,
            dwell_s: *dwell_s,
            hold: demand_samples(UPDATE_S),
        })
    }

    /// The sine that runs at an update: the one of the update at which T_d* last changed.
    pub(crate) fn rung(&self, update: usize) -> usize {
        let time_s = (update / self.hold * self.hold) as f64 * UPDATE_S;
        ((time_s / self.dwell_s + 1e-9).floor() as usize).min(self.frequencies_hz.len() - 1)
    }

    /// First update of each sine, and the end.
    pub(super) fn bounds(&self, updates: usize) -> Vec<usize> {
        (0..=self.frequencies_hz.len()).map(|rung| self.first(rung, updates)).collect()
    }

    pub(super) fn first(&self, rung: usize, updates: usize) -> usize {
        if rung == self.frequencies_hz.len() {
            return updates;
        }
        let near = ((rung as f64 * self.dwell_s / UPDATE_S) as usize).saturating_sub(2 * self.hold);
        (near..updates).find(|update| self.rung(*update) >= rung).unwrap_or(updates)
    }

    /// The demands with an amplitude of its own for each sine.
    pub(super) fn demands(&self, demands: &Demands, amplitudes_nm: &[f64]) -> Demands {
        let mut changed = demands.clone();
        for (update, torque) in changed.dyno_torque_nm.iter_mut().enumerate() {
            *torque = self.mean_nm + (*torque - self.mean_nm) * amplitudes_nm[self.rung(update)] / self.amplitude_nm;
        }
        changed
    }
}

/// Samples within which changes of T_d* count together: those between two demands of the automation system.
pub(crate) fn demand_samples(step_s: f64) -> usize {
    ((DEMAND_HOLD_S / step_s).round() as usize).max(1)
}
