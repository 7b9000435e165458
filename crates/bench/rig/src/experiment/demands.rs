//! A plan's demands, update by update.

use recording::{Channel, Format, Raster, Recording};

use super::waveform::{Waveform, hold};
use super::{ControlMode, DEMAND_HOLD_S, ExperimentPlan, TorqueTarget, UPDATE_S};
use crate::random::Source;

/// Demands at every update (1 ms) of an experiment. SI. Each random one has a stream of its own, so that equal plan and
/// seed give equal bits.
///
/// # Example
/// ```
/// use rig::experiment::{Demands, ExperimentPlan};
/// let demands = Demands::of(&ExperimentPlan::step_t_tn(1200.0, 4.0), 1, 0.01);
/// assert_eq!((demands.dyno_torque_nm[1999], demands.dyno_torque_nm[2000]), (60.0, 85.0));
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Demands {
    /// ω_d* (NT) or ω_e* (TN), rad/s.
    pub speed_rad_s: Vec<f64>,
    /// T_d* or T_shaft* (TN), Nm.
    pub dyno_torque_nm: Vec<f64>,
    /// Engine torque demand (NT), Nm.
    pub engine_torque_nm: Vec<f64>,
    /// α_e, 0 … 1; empty where the engine gets a torque.
    pub throttle: Vec<f64>,
    /// η, 1 at the best ignition angle.
    pub ignition_efficiency: Vec<f64>,
}

impl Demands {
    /// The demands of a plan with a seed; those of the automation system (all but the speed) change only once in
    /// `hold_s`, see [`DEMAND_HOLD_S`](super::DEMAND_HOLD_S).
    pub fn of(plan: &ExperimentPlan, seed: u64, hold_s: f64) -> Self {
        let updates = plan.updates();
        let held_updates = (hold_s / UPDATE_S).round() as usize;
        let sample = |waveform: &Waveform, source: Source| waveform.sample(&mut source.stream(seed), UPDATE_S, updates);
        let held = |waveform: &Waveform, source| {
            let mut values = sample(waveform, source);
            hold(&mut values, held_updates);
            values
        };
        Self {
            speed_rad_s: sample(&plan.speed_rad_s, Source::Speed),
            dyno_torque_nm: held(&plan.dyno_torque_nm, Source::DynoTorque),
            engine_torque_nm: held(&plan.engine_torque_nm, Source::EngineTorque),
            throttle: plan.throttle.as_ref().map_or_else(Vec::new, |throttle| held(throttle, Source::Throttle)),
            ignition_efficiency: held(&plan.ignition_efficiency, Source::Ignition),
        }
    }
}

impl Demands {
    /// The demand file of a plan: speeds every millisecond, all others on the automation system's clock of
    /// [`DEMAND_HOLD_S`](super::DEMAND_HOLD_S), in the units people use. As [`free_form::plan`](super::free_form::plan)
    /// reads it, it gives these demands again.
    pub fn recording(&self, plan: &ExperimentPlan) -> Recording {
        let held = (DEMAND_HOLD_S / UPDATE_S).round() as usize;
        let updates = self.speed_rad_s.len();
        let raster = |step: usize, name: &str| Raster {
            time_s: (0..updates).step_by(step).map(|k| k as f64 * UPDATE_S).collect(),
            name: Some(name.to_owned()),
        };
        let channel = |demand: NamedDemand<'_>| {
            let (kind, step) = (demand.kind, if demand.kind.is_speed() { 1 } else { held });
            Channel {
                name: kind.name().to_owned(),
                unit: kind.unit().to_owned(),
                comment: String::new(),
                raster: usize::from(!kind.is_speed()),
                samples: demand.values.iter().step_by(step).map(|value| value / kind.si_per_unit()).collect(),
            }
        };
        let named = self.named(plan);
        let mut rasters = vec![raster(1, "speed demand")];
        if named.iter().any(|demand| !demand.kind.is_speed()) {
            rasters.push(raster(held, "torque demand"));
        }
        Recording {
            format: Format::Mdf { version: 410 },
            comment: Some(format!("{}, demands", plan.label)),
            start_time: None,
            rasters,
            channels: named.into_iter().map(channel).collect(),
            findings: Vec::new(),
        }
    }
}

/// A demand that a plan makes, under the name and unit people see.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedDemand<'a> {
    /// Kind of the demand.
    pub kind: DemandKind,
    /// At every update, SI.
    pub values: &'a [f64],
}

/// The demands there are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DemandKind {
    /// N_d* (NT).
    DynoSpeed,
    /// N_e* (TN).
    EngineSpeed,
    /// T_d* (TN).
    DynoTorque,
    /// T_shaft* (TN, in control of the shaft torque).
    ShaftTorque,
    /// The engine's torque (NT).
    EngineTorque,
    /// α_e (NT).
    Throttle,
    /// η.
    IgnitionEfficiency,
}

impl DemandKind {
    /// Every demand, in the order of demand files.
    pub const ALL: [DemandKind; 7] = [
        DemandKind::DynoSpeed,
        DemandKind::EngineSpeed,
        DemandKind::DynoTorque,
        DemandKind::ShaftTorque,
        DemandKind::EngineTorque,
        DemandKind::Throttle,
        DemandKind::IgnitionEfficiency,
    ];

    /// Its name in demand files.
    pub fn name(self) -> &'static str {
        match self {
            DemandKind::DynoSpeed => "dyno_speed_demand",
            DemandKind::EngineSpeed => "engine_speed_demand",
            DemandKind::DynoTorque => "dyno_torque_demand",
            DemandKind::ShaftTorque => "shaft_torque_demand",
            DemandKind::EngineTorque => "engine_torque_demand",
            DemandKind::Throttle => "throttle_demand",
            DemandKind::IgnitionEfficiency => "ignition_efficiency",
        }
    }

    /// Its unit in demand files.
    pub fn unit(self) -> &'static str {
        match self {
            DemandKind::DynoSpeed | DemandKind::EngineSpeed => "rpm",
            DemandKind::DynoTorque | DemandKind::ShaftTorque | DemandKind::EngineTorque => "Nm",
            DemandKind::Throttle => "%",
            DemandKind::IgnitionEfficiency => "1",
        }
    }

    /// Tells whether it is a speed, which may change every millisecond.
    pub fn is_speed(self) -> bool {
        matches!(self, DemandKind::DynoSpeed | DemandKind::EngineSpeed)
    }

    /// SI value of one unit.
    pub fn si_per_unit(self) -> f64 {
        match self {
            DemandKind::DynoSpeed | DemandKind::EngineSpeed => units::RPM_RAD_S,
            DemandKind::Throttle => 0.01,
            _ => 1.0,
        }
    }
}

impl Demands {
    /// The demands that matter in a plan's control mode; those that are never made are left out.
    pub fn named<'a>(&'a self, plan: &ExperimentPlan) -> Vec<NamedDemand<'a>> {
        let is_fired = plan.has_shaft && !plan.is_motored;
        let mut named = Vec::new();
        let mut add = |kind, values: &'a [f64]| named.push(NamedDemand { kind, values });
        match plan.label.mode {
            ControlMode::Nt => {
                add(DemandKind::DynoSpeed, &self.speed_rad_s);
                match (is_fired, self.throttle.is_empty()) {
                    (false, _) => {}
                    (true, true) => add(DemandKind::EngineTorque, &self.engine_torque_nm),
                    (true, false) => add(DemandKind::Throttle, &self.throttle),
                }
            }
            ControlMode::Tn => {
                add(DemandKind::EngineSpeed, &self.speed_rad_s);
                let kind = match plan.torque_target {
                    TorqueTarget::AirGap => DemandKind::DynoTorque,
                    TorqueTarget::Shaft => DemandKind::ShaftTorque,
                };
                add(kind, &self.dyno_torque_nm);
            }
        }
        if is_fired {
            add(DemandKind::IgnitionEfficiency, &self.ignition_efficiency);
        }
        named
    }
}
