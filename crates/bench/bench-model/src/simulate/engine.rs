//! The engine of a run: torque given, or asked for by its speed control, straight or in pulses.

use rig::bench_parameters::EngineParameters;

use super::firing::{FiringEngine, Firings};
use super::plant::Plant;
use crate::intake::Air;
use crate::simulate::error::SimulationError;
use crate::simulate::inputs::Inputs;

/// Engine speed control in TN mode, every sample: T_e = K_p (ω_e* − ω_e) + I, dI/dt = K_i (ω_e* − ω_e), ω_e as the
/// encoder reads it. The torque gets there straight, within a sample; that of an engine that fires, with the next
/// firing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EngineSpeedControl<'a> {
    /// ω_e*, rad/s.
    pub demand_rad_s: &'a [f64],
    /// K_p, Nm s/rad.
    pub proportional_nm_s_per_rad: f64,
    /// K_i, Nm/rad.
    pub integral_nm_per_rad: f64,
    /// I at the start, Nm.
    pub start_nm: f64,
    /// Air path that the torque passes before the engine gives it; `None`: nothing.
    pub air: Option<GovernedAir<'a>>,
}

/// Intake and ignition of an engine under speed control, see [`Air`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GovernedAir<'a> {
    /// The engine.
    pub engine: &'a EngineParameters,
    /// η at every sample, 1 at the best ignition angle.
    pub ignition_efficiency: &'a [f64],
}

/// The engine at work.
pub(super) struct Engine<'a> {
    given_nm: &'a [f64],
    governor: Option<Governor<'a>>,
    /// Torque that the governor gives now, Nm.
    governed_nm: f64,
    firings: Option<Firings<'a>>,
}

impl<'a> Engine<'a> {
    pub(super) fn of(
        inputs: &Inputs<'a>,
        control: Option<&EngineSpeedControl<'a>>,
        fires: Option<&FiringEngine<'a>>,
        speed_rad_s: f64,
    ) -> Result<Self, SimulationError> {
        let mut governor = control.map(|control| Governor::new(control, inputs)).transpose()?;
        let governed_nm = governor.as_mut().map_or(0.0, Governor::at_rest_nm);
        let level_nm = inputs.engine_torque_nm.first().copied().unwrap_or(0.0) + governed_nm;
        let firings = fires.map(|fires| Firings::new(fires, level_nm, speed_rad_s, inputs.sample_time_s));
        Ok(Engine { given_nm: inputs.engine_torque_nm, governor, governed_nm, firings })
    }

    /// T_e at both ends of the interval after sample `k`, Nm, straight in between.
    pub(super) fn update(&mut self, k: usize, reading_rad_s: f64, plant: &Plant<'_>) -> [f64; 2] {
        let asked_nm = self.governor.as_mut().map_or(0.0, |governor| governor.update(k, reading_rad_s));
        let now_nm = self.given_nm[k];
        if let Some(firings) = &mut self.firings {
            return firings.over(plant, now_nm + asked_nm);
        }
        let next_nm = self.given_nm.get(k + 1).copied().unwrap_or(now_nm);
        let ends_nm = [now_nm + self.governed_nm, next_nm + asked_nm];
        self.governed_nm = asked_nm;
        ends_nm
    }
}

/// Engine speed control at work.
struct Governor<'a> {
    control: EngineSpeedControl<'a>,
    sample_time_s: f64,
    integral_nm: f64,
    air: Option<(Air, &'a [f64])>,
}

impl<'a> Governor<'a> {
    fn new(control: &EngineSpeedControl<'a>, inputs: &Inputs<'_>) -> Result<Self, SimulationError> {
        let (expected, found) = (inputs.engine_torque_nm.len(), control.demand_rad_s.len());
        if expected != found {
            return Err(SimulationError::Length { what: "engine speed demand", expected, found });
        }
        if let Some(air) = &control.air
            && air.ignition_efficiency.len() != expected
        {
            let found = air.ignition_efficiency.len();
            return Err(SimulationError::Length { what: "ignition efficiency", expected, found });
        }
        let air =
            control.air.map(|of| (Air::new(of.engine, control.start_nm, inputs.sample_time_s), of.ignition_efficiency));
        Ok(Governor { control: *control, sample_time_s: inputs.sample_time_s, integral_nm: control.start_nm, air })
    }

    /// Torque that the engine gives before the first sample, Nm.
    fn at_rest_nm(&mut self) -> f64 {
        self.given_nm(0, self.integral_nm)
    }

    /// Torque that the engine gives when sample `k` asks for a torque, Nm.
    fn given_nm(&mut self, k: usize, asked_nm: f64) -> f64 {
        self.air.as_mut().map_or(asked_nm, |(air, efficiency)| air.update(asked_nm, efficiency[k]))
    }

    /// The torque that the engine gives for sample `k`, Nm.
    fn update(&mut self, k: usize, reading_rad_s: f64) -> f64 {
        let error_rad_s = self.control.demand_rad_s[k] - reading_rad_s;
        let torque_nm = self.control.proportional_nm_s_per_rad * error_rad_s + self.integral_nm;
        self.integral_nm += self.control.integral_nm_per_rad * self.sample_time_s * error_rad_s;
        self.given_nm(k, torque_nm)
    }
}
