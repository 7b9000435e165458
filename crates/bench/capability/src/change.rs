//! Changes of a test, of the controller and of the bench.

use bench_model::analysis::margins;
use bench_model::model::{BenchModel, FeedForwardGains};
use cycle::Reference;
use numerics::null::nan_if_null;
use rig::ControlMode;
use rig::experiment::Demands;
use serde::{Deserialize, Serialize};

use crate::demand::{CycleDemand, Demand};
use crate::outcome::CanInputs;

/// A plan is made slower by this factor at most.
const SLOWEST_PLAN: f64 = 8.0;
/// A cycle is made slower by this factor at most.
const SLOWEST_CYCLE: f64 = 2.0;
/// Changes of the demand are made smaller down to this part at least.
const SMALLEST: f64 = 0.05;
/// Corner of the weakest filter of the demands, Hz: it hardly changes them.
const WEAKEST_FILTER_HZ: f64 = 20.0;
/// Corner of the strongest filter of the demands, Hz.
const STRONGEST_FILTER_HZ: f64 = 0.1;
/// Gains change by this factor at most, up and down.
const GAINS: f64 = 4.0;
/// The stiffness of the shaft changes by this factor at most, up and down.
const SHAFT: f64 = 4.0;
/// The dynamometer's inertia becomes so many times as large at most.
const INERTIA: f64 = 3.0;
/// Gain margin that a change of the speed loop leaves at least, dB.
const GAIN_MARGIN_DB: f64 = 6.0;
/// Phase margin that a change of the speed loop leaves at least, °.
const PHASE_MARGIN_DEG: f64 = 30.0;

/// A change.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Change {
    /// The whole test takes this many times as long.
    Slower {
        /// Above 1.
        #[serde(deserialize_with = "nan_if_null")]
        factor: f64,
    },
    /// The demand changes by this part of what it did, about its first value.
    Smaller {
        /// 0 … 1.
        #[serde(deserialize_with = "nan_if_null")]
        factor: f64,
    },
    /// A low-pass of first order before the bench; the run is still judged by the demands without it.
    Filter {
        /// Its corner, Hz.
        #[serde(deserialize_with = "nan_if_null")]
        corner_hz: f64,
    },
    /// K_p and K_i of the speed controller times this.
    Gains {
        /// Above or below 1.
        #[serde(deserialize_with = "nan_if_null")]
        factor: f64,
    },
    /// The speed controller is fed forward the torque that accelerates an inertia.
    FeedForward {
        /// k_a, Nm s²/rad.
        #[serde(deserialize_with = "nan_if_null")]
        acceleration_nm_s2_per_rad: f64,
    },
    /// K times this.
    Stiffness {
        /// Above or below 1.
        #[serde(deserialize_with = "nan_if_null")]
        factor: f64,
    },
    /// J_d times this.
    DynoInertia {
        /// Above 1.
        #[serde(deserialize_with = "nan_if_null")]
        factor: f64,
    },
}

/// A kind of change, from none at 0 to the largest at 1.
pub(crate) type Kind = Box<dyn Fn(f64) -> Change + Sync>;

/// The kinds that a test allows, in the order in which people think of them.
pub(crate) fn kinds(inputs: &CanInputs<'_>) -> Vec<Kind> {
    let (is_cycle, is_nt) = match inputs.demand {
        Demand::Cycle(_) => (true, true),
        Demand::Plan(plan, _) => (false, plan.label.mode == ControlMode::Nt),
    };
    let slowest = if is_cycle { SLOWEST_CYCLE } else { SLOWEST_PLAN };
    let mut kinds: Vec<Kind> = vec![
        Box::new(move |share| Change::Slower { factor: slowest.powf(share) }),
        Box::new(|share| Change::Smaller { factor: 1.0 - share * (1.0 - SMALLEST) }),
        Box::new(|share| Change::Filter {
            corner_hz: WEAKEST_FILTER_HZ * (STRONGEST_FILTER_HZ / WEAKEST_FILTER_HZ).powf(share),
        }),
    ];
    if is_nt && inputs.model.speed_controller.is_some() {
        kinds.push(Box::new(|share| Change::Gains { factor: GAINS.powf(share) }));
        kinds.push(Box::new(|share| Change::Gains { factor: GAINS.powf(-share) }));
        let now = inputs.model.feed_forward.map_or(0.0, |gains| gains.acceleration_nm_s2_per_rad);
        let all = -accelerated_kg_m2(inputs, is_cycle);
        kinds
            .push(Box::new(move |share| Change::FeedForward { acceleration_nm_s2_per_rad: now + share * (all - now) }));
    }
    if inputs.demand.has_shaft() {
        kinds.push(Box::new(|share| Change::Stiffness { factor: SHAFT.powf(share) }));
        kinds.push(Box::new(|share| Change::Stiffness { factor: SHAFT.powf(-share) }));
    }
    kinds.push(Box::new(|share| Change::DynoInertia { factor: INERTIA.powf(share) }));
    kinds
}

/// The inertia that the dynamometer has to accelerate: in a cycle the engine accelerates its own.
fn accelerated_kg_m2(inputs: &CanInputs<'_>, is_cycle: bool) -> f64 {
    let mechanics = &inputs.model.mechanics;
    let engine = if is_cycle || !inputs.demand.has_shaft() { 0.0 } else { mechanics.engine_inertia_kg_m2 };
    mechanics.dyno_inertia_kg_m2 + engine
}

impl Change {
    /// Tells whether the speed loop keeps its margins where the change touches it, or gets no worse ones.
    pub(crate) fn keeps_margins(self, inputs: &CanInputs<'_>) -> bool {
        let changed = self.model(inputs.model);
        let is_touched = changed.speed_controller != inputs.model.speed_controller;
        !is_touched
            || margins(&changed)
                .is_some_and(|left| left.gain_margin_db >= GAIN_MARGIN_DB && left.phase_margin_deg >= PHASE_MARGIN_DEG)
    }

    /// Does something with the changed test and bench.
    pub(crate) fn with<R>(self, inputs: &CanInputs<'_>, work: impl FnOnce(&CanInputs<'_>) -> R) -> R {
        let model = self.model(inputs.model);
        let filter_hz = if let Change::Filter { corner_hz } = self { Some(corner_hz) } else { inputs.filter_hz };
        let inputs = CanInputs { model: &model, filter_hz, ..*inputs };
        if !matches!(self, Change::Slower { .. } | Change::Smaller { .. }) {
            return work(&inputs);
        }
        match inputs.demand {
            Demand::Cycle(cycle) => {
                let reference = self.reference(cycle.reference);
                let demand = Demand::Cycle(CycleDemand { reference: &reference, ..cycle });
                work(&CanInputs { demand, ..inputs })
            }
            Demand::Plan(plan, demands) => {
                let demands = self.demands(demands);
                let mut plan = plan.clone();
                if let Change::Slower { factor } = self {
                    plan.duration_s *= factor;
                }
                work(&CanInputs { demand: Demand::Plan(&plan, &demands), ..inputs })
            }
        }
    }

    fn model(self, model: &BenchModel) -> BenchModel {
        let mut changed = model.clone();
        match self {
            Change::Slower { .. } | Change::Smaller { .. } | Change::Filter { .. } => {}
            Change::Gains { factor } => {
                if let Some(pi) = &mut changed.speed_controller {
                    pi.proportional_nm_s_per_rad *= factor;
                    pi.integral_nm_per_rad *= factor;
                }
            }
            Change::FeedForward { acceleration_nm_s2_per_rad } => {
                let none = FeedForwardGains { speed_nm_s_per_rad: 0.0, acceleration_nm_s2_per_rad: 0.0, delay_s: 0.0 };
                let gains = changed.feed_forward.unwrap_or(none);
                changed.feed_forward = Some(FeedForwardGains { acceleration_nm_s2_per_rad, ..gains });
            }
            Change::Stiffness { factor } => changed.mechanics.stiffness_nm_per_rad *= factor,
            Change::DynoInertia { factor } => changed.mechanics.dyno_inertia_kg_m2 *= factor,
        }
        changed
    }

    fn reference(self, reference: &Reference) -> Reference {
        Reference {
            speed_rad_s: self.series(&reference.speed_rad_s),
            torque_nm: self.series(&reference.torque_nm),
            ..reference.clone()
        }
    }

    fn demands(self, demands: &Demands) -> Demands {
        Demands {
            speed_rad_s: self.series(&demands.speed_rad_s),
            dyno_torque_nm: self.series(&demands.dyno_torque_nm),
            engine_torque_nm: self.series(&demands.engine_torque_nm),
            throttle: self.series(&demands.throttle),
            ignition_efficiency: self.series(&demands.ignition_efficiency),
        }
    }

    /// A series that is stretched, straight between its values, or that changes less about its first value.
    fn series(self, values: &[f64]) -> Vec<f64> {
        let (Some(first), last) = (values.first(), values.len().saturating_sub(1)) else { return Vec::new() };
        match self {
            Change::Smaller { factor } => values.iter().map(|value| first + factor * (value - first)).collect(),
            Change::Slower { factor } => {
                let count = (values.len() as f64 * factor).round() as usize;
                let at = |k: usize| {
                    let place = (k as f64 / factor).min(last as f64);
                    let (low, share) = (place.floor() as usize, place.fract());
                    values[low] + share * (values[(low + 1).min(last)] - values[low])
                };
                (0..count).map(at).collect()
            }
            _ => values.to_vec(),
        }
    }
}
