//! Torque control and mechanics between two samples.

use faer::Mat;
use lti::StateSpace;
use rig::results::Part;

use super::ripple::{Ripple, between};
use crate::friction::DynoFriction;
use crate::model::{BenchModel, INSTANT, Mechanics, TorqueControlModel};
use crate::simulate::error::SimulationError;
use crate::simulate::inputs::{DynoInput, InitialState, Inputs};

/// ω_d, ω_e, Δθ, T_d, θ_d, θ_e.
pub(super) const STATES: usize = 6;
/// Torque demand at the lag (or T_d itself), T_e, ripple of T_d.
pub(super) const INPUTS: usize = 3;
/// T_d among the states.
pub(super) const TORQUE: usize = 3;

/// The controller's two outputs, v before its delay τ and the feed-forward, or in torque control T_d* as the latter.
pub(super) struct Streams {
    delayed_nm: Vec<f64>,
    immediate_nm: Vec<f64>,
    before_delayed_nm: f64,
    limit_nm: f64,
}

impl Streams {
    pub(super) fn new(samples: usize, start: &InitialState, limit_nm: Option<f64>) -> Self {
        Streams {
            delayed_nm: Vec::with_capacity(samples),
            immediate_nm: Vec::with_capacity(samples),
            before_delayed_nm: start.integrator_nm,
            limit_nm: limit_nm.unwrap_or(f64::INFINITY),
        }
    }

    /// Appends the outputs of an update; returns T_d* now, with v as old as `updates`.
    pub(super) fn push_controller(&mut self, pi_nm: f64, feed_forward_nm: f64, updates: f64) -> Option<f64> {
        self.delayed_nm.push(pi_nm);
        self.immediate_nm.push(feed_forward_nm);
        Some(self.demand(self.delayed_nm.len() - 1, samples_back(updates, 0.0), 0))
    }

    /// Appends a torque demand; returns it, limited.
    pub(super) fn push_demand(&mut self, demand_nm: f64) -> Option<f64> {
        self.before_delayed_nm = 0.0;
        self.delayed_nm.push(0.0);
        self.immediate_nm.push(demand_nm);
        Some(demand_nm.clamp(-self.limit_nm, self.limit_nm))
    }

    fn demand(&self, k: usize, delayed_back: usize, immediate_back: usize) -> f64 {
        let delayed = k.checked_sub(delayed_back).map_or(self.before_delayed_nm, |i| self.delayed_nm[i]);
        let immediate = self.immediate_nm[k.saturating_sub(immediate_back)];
        (delayed + immediate).clamp(-self.limit_nm, self.limit_nm)
    }
}

/// Which sample of a stream, counted back from the present one, is in force `position` samples after it when each takes
/// effect `delay` samples after its own.
pub(super) fn samples_back(delay: f64, position: f64) -> usize {
    (delay - position - INSTANT).ceil().max(0.0) as usize
}

/// A part of the sample interval within which the demand at the lag does not change.
#[derive(Debug, Clone)]
pub(super) struct Substep {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) delayed_back: usize,
    pub(super) immediate_back: usize,
    pub(super) transition: [[f64; STATES]; STATES],
    pub(super) first: [[f64; INPUTS]; STATES],
    pub(super) last: [[f64; INPUTS]; STATES],
}

/// The bench between samples.
pub(super) struct Plant<'a> {
    substeps: Vec<Substep>,
    ripple: Ripple<'a>,
    friction: DynoFriction,
    mechanics: Mechanics,
    has_lag: bool,
    x: [f64; STATES],
}

/// Motion that the encoders look at.
pub(super) struct Motion {
    pub(super) dyno_speed_rad_s: f64,
    pub(super) engine_speed_rad_s: f64,
    pub(super) dyno_angle_rad: f64,
    pub(super) engine_angle_rad: f64,
}

impl<'a> Plant<'a> {
    pub(super) fn new(
        model: &BenchModel,
        inputs: &Inputs<'_>,
        ripple: Ripple<'a>,
        friction: DynoFriction,
        start: &InitialState,
    ) -> Result<Self, SimulationError> {
        let ripple = if matches!(inputs.dyno, DynoInput::AirGapTorque(_)) { Ripple::NONE } else { ripple };
        let step = inputs.sample_time_s;
        let torque_control = match inputs.dyno {
            DynoInput::AirGapTorque(_) => None,
            _ => Some(model.torque_control.ok_or(SimulationError::MissingPart { part: Part::TorqueControl })?),
        };
        let substeps = Substep::of_a_sample(model, torque_control, step)?;
        let bandwidth = torque_control.and_then(|i| i.bandwidth_rad_s);
        let x = [start.dyno_speed_rad_s, start.engine_speed_rad_s, start.twist_rad, start.air_gap_torque_nm, 0.0, 0.0];
        Ok(Plant { substeps, ripple, friction, mechanics: model.mechanics, has_lag: bandwidth.is_some(), x })
    }

    pub(super) fn state(&self) -> Motion {
        Motion {
            dyno_speed_rad_s: self.x[0],
            engine_speed_rad_s: self.x[1],
            dyno_angle_rad: self.x[4],
            engine_angle_rad: self.x[5],
        }
    }

    /// dω_e/dt under a torque of the engine.
    pub(super) fn engine_acceleration_rad_s2(&self, engine_nm: f64) -> f64 {
        (engine_nm - self.shaft_torque_nm()) / self.mechanics.engine_inertia_kg_m2
    }

    pub(super) fn shaft_torque_nm(&self) -> f64 {
        self.mechanics.stiffness_nm_per_rad * self.x[2] + self.mechanics.damping_nm_s_per_rad * (self.x[1] - self.x[0])
    }

    /// T_d at sample `k`: the lag's state, or what takes the place of it, with the ripple.
    pub(super) fn air_gap_torque_nm(&self, inputs: &Inputs<'_>, streams: &Streams, k: usize) -> f64 {
        let smooth = match (inputs.dyno, self.substeps.first()) {
            (DynoInput::AirGapTorque(torque), _) => torque[k],
            (_, Some(first)) if !self.has_lag => streams.demand(k, first.delayed_back, first.immediate_back),
            _ => self.x[TORQUE],
        };
        smooth + self.ripple.upon(smooth, k, 0.0)
    }

    /// Moves on from sample `k` to the next, under a torque of the engine that is straight between these ends; beyond
    /// the last sample inputs stay. Friction is that of the speed at the sample.
    pub(super) fn advance(&mut self, inputs: &Inputs<'_>, streams: &Streams, k: usize, engine_nm: [f64; 2]) {
        let friction_nm = self.friction.torque_nm(self.x[0]);
        for substep in &self.substeps {
            let braking = |x: f64| match inputs.dyno {
                DynoInput::AirGapTorque(torque) => between(torque, k, x),
                _ => streams.demand(k, substep.delayed_back, substep.immediate_back),
            };
            let (from, to) = (substep.from, substep.to);
            let smooth = |state: f64, x: f64| if self.has_lag { state } else { braking(x) };
            let ripple = [
                self.ripple.upon(smooth(self.x[TORQUE], from), k, from),
                self.ripple.upon(smooth(substep.torque_after(self.x[TORQUE], braking(to)), to), k, to),
            ];
            let driving = |x: f64| engine_nm[0] + (engine_nm[1] - engine_nm[0]) * x;
            let input = |x: f64, ripple: f64| [braking(x), driving(x), ripple + friction_nm];
            self.x = substep.apply(&self.x, input(from, ripple[0]), input(to, ripple[1]));
        }
    }
}

impl Substep {
    /// All of a sample interval; without torque control the air-gap torque is the input.
    pub(super) fn of_a_sample(
        model: &BenchModel,
        torque_control: Option<TorqueControlModel>,
        step_s: f64,
    ) -> Result<Vec<Self>, SimulationError> {
        let system = continuous(&model.mechanics, torque_control.and_then(|i| i.bandwidth_rad_s))?;
        let delays = stream_delays(model, torque_control, step_s);
        let instants = boundaries(delays.0, delays.1);
        instants.windows(2).map(|w| Substep::new(&system, step_s, (w[0], w[1]), delays)).collect()
    }

    fn new(
        system: &StateSpace,
        step_s: f64,
        (from, to): (f64, f64),
        (delayed, immediate): (f64, f64),
    ) -> Result<Self, SimulationError> {
        let exact = system.to_discrete_foh((to - from) * step_s)?;
        Ok(Substep {
            from,
            to,
            delayed_back: samples_back(delayed, from),
            immediate_back: samples_back(immediate, from),
            transition: std::array::from_fn(|i| std::array::from_fn(|j| exact.a()[(i, j)])),
            first: std::array::from_fn(|i| std::array::from_fn(|j| exact.b0()[(i, j)])),
            last: std::array::from_fn(|i| std::array::from_fn(|j| exact.b1()[(i, j)])),
        })
    }

    /// The lag's torque at the end, which depends on nothing but itself and a demand that stays.
    fn torque_after(&self, torque_nm: f64, demand_nm: f64) -> f64 {
        self.transition[TORQUE][TORQUE] * torque_nm + (self.first[TORQUE][0] + self.last[TORQUE][0]) * demand_nm
    }

    pub(super) fn apply(&self, x: &[f64; STATES], u0: [f64; INPUTS], u1: [f64; INPUTS]) -> [f64; STATES] {
        std::array::from_fn(|i| {
            let free: f64 = (0..STATES).map(|j| self.transition[i][j] * x[j]).sum();
            let forced: f64 = (0..INPUTS).map(|j| self.first[i][j] * u0[j] + self.last[i][j] * u1[j]).sum();
            free + forced
        })
    }
}

/// Delays from the controller's streams to the lag, in samples: τ + d and d.
fn stream_delays(model: &BenchModel, torque_control: Option<TorqueControlModel>, step_s: f64) -> (f64, f64) {
    let immediate = torque_control.map_or(0.0, |i| i.delay_s.max(0.0));
    let delayed = immediate + model.speed_controller.map_or(0.0, |pi| pi.delay_s.max(0.0));
    (delayed / step_s, immediate / step_s)
}

/// Instants within a sample interval at which the demand at the lag may change, in samples, with both ends.
fn boundaries(delayed: f64, immediate: f64) -> Vec<f64> {
    let mut instants = vec![0.0, 1.0];
    for delay in [delayed, immediate] {
        let instant = delay - delay.floor();
        if instants.iter().all(|other: &f64| (other - instant).abs() > INSTANT) {
            instants.push(instant);
        }
    }
    instants.sort_by(f64::total_cmp);
    instants
}

/// The continuous system; without a lag the first input is T_d itself.
fn continuous(mechanics: &Mechanics, bandwidth_rad_s: Option<f64>) -> Result<StateSpace, lti::LtiError> {
    let (jd, je) = (mechanics.dyno_inertia_kg_m2, mechanics.engine_inertia_kg_m2);
    let (k, b) = (mechanics.stiffness_nm_per_rad, mechanics.damping_nm_s_per_rad);
    let mut a = Mat::zeros(STATES, STATES);
    let mut input = Mat::zeros(STATES, INPUTS);
    for (row, sign, inertia) in [(0, 1.0, jd), (1, -1.0, je)] {
        a[(row, 0)] = -sign * b / inertia;
        a[(row, 1)] = sign * b / inertia;
        a[(row, 2)] = sign * k / inertia;
    }
    a[(2, 0)] = -1.0;
    a[(2, 1)] = 1.0;
    a[(4, 0)] = 1.0;
    a[(5, 1)] = 1.0;
    input[(1, 1)] = 1.0 / je;
    input[(0, 2)] = -1.0 / jd;
    match bandwidth_rad_s {
        Some(bandwidth) => {
            a[(0, 3)] = -1.0 / jd;
            a[(3, 3)] = -bandwidth;
            input[(3, 0)] = bandwidth;
        }
        None => input[(0, 0)] = -1.0 / jd,
    }
    StateSpace::continuous(a, input, Mat::identity(STATES, STATES), Mat::zeros(STATES, INPUTS))
}
