//! Encoders, load cell, flange, computed torques: what the bench reads of itself every millisecond.

mod encoder;
mod pulses;
mod rotation;
mod rounding;
mod system_shaft;
mod torque;

use numerics::random::Stream;
use rig::bench_parameters::BenchParameters;
use rig::experiment::UPDATE_S;
use rig::facts::BenchVariant;
use rig::random::Source;

use super::error::VirtualBenchError;
use super::train::Train;
use encoder::{Encoder, EncoderStreams};
use rotation::Rotation;
pub(crate) use rounding::rounded;
use system_shaft::SystemShaftTorque;
use torque::{SensorDynamics, TorqueSensor};

/// Readings of the sensors at one update.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Readings {
    pub(super) dyno_speed_rad_s: f64,
    pub(super) engine_speed_rad_s: f64,
    pub(super) calc_torque_nm: f64,
    pub(super) cell_torque_nm: f64,
    /// T_shaft as the bench knows it: its own, or the flange's.
    pub(super) shaft_torque_nm: f64,
}

const DYNO_STREAMS: EncoderStreams =
    EncoderStreams { noise: Source::DynoEncoder, edges: Source::DynoEdges, slits: Source::DynoSlits };
const ENGINE_STREAMS: EncoderStreams =
    EncoderStreams { noise: Source::EngineEncoder, edges: Source::EngineEdges, slits: Source::EngineSlits };

/// All sensors of a bench.
#[derive(Debug, Clone)]
pub(super) struct Sensors {
    dyno_rotation: Rotation,
    engine_rotation: Rotation,
    dyno_encoder: Encoder,
    engine_encoder: Encoder,
    calc_noise_nm: f64,
    calc_random: Stream,
    cell: TorqueSensor,
    cell_noise_nm: f64,
    cell_random: Stream,
    system_shaft: SystemShaftTorque,
    flange: Option<Flange>,
}

/// A torque sensor with its noise and rounding.
#[derive(Debug, Clone)]
struct Flange {
    sensor: TorqueSensor,
    noise_nm: f64,
    resolution_nm: f64,
    random: Stream,
}

impl Sensors {
    /// The sensors of a bench at rest.
    pub(super) fn new(
        parameters: &BenchParameters,
        train: &Train,
        air_gap_nm: f64,
        step_s: f64,
        seed: u64,
    ) -> Result<Self, VirtualBenchError> {
        let sensors = &parameters.sensors;
        let rotation = |angle_rad, speed_rad_s| Rotation::new(sensors.gate_s, step_s, angle_rad, speed_rad_s);
        let speed = train.dyno_speed_rad_s();
        let encoder =
            |eccentricity, streams, angle_rad| Encoder::new(sensors, eccentricity, streams, seed, angle_rad, speed);
        let inertia = parameters.mechanics.dyno_inertia_kg_m2;
        let cell = SensorDynamics {
            delay_s: sensors.cell_delay_s,
            resonance_hz: sensors.cell_resonance_hz,
            damping_ratio: sensors.cell_damping_ratio,
        };
        Ok(Self {
            dyno_rotation: rotation(train.dyno_angle_rad(), speed),
            engine_rotation: rotation(train.engine_angle_rad(), train.engine_speed_rad_s()),
            dyno_encoder: encoder(sensors.dyno_eccentricity, DYNO_STREAMS, train.dyno_angle_rad()),
            engine_encoder: encoder(sensors.engine_eccentricity, ENGINE_STREAMS, train.engine_angle_rad()),
            calc_noise_nm: sensors.calc_noise_nm,
            calc_random: Source::CalcTorque.stream(seed),
            cell: TorqueSensor::new(cell, step_s, air_gap_nm)?,
            cell_noise_nm: sensors.cell_noise_nm,
            cell_random: Source::LoadCell.stream(seed),
            system_shaft: SystemShaftTorque::new(inertia, UPDATE_S, sensors.moving_average, speed),
            flange: match parameters.variant {
                BenchVariant::LoadCell => None,
                BenchVariant::TorqueFlange => Some(Flange::new(parameters, train, step_s, seed)?),
            },
        })
    }

    /// One step of the bench on.
    pub(super) fn advance(&mut self, train: &Train, air_gap_nm: f64) {
        self.dyno_rotation.advance(train.dyno_angle_rad(), train.dyno_speed_rad_s());
        self.engine_rotation.advance(train.engine_angle_rad(), train.engine_speed_rad_s());
        match &mut self.flange {
            Some(flange) => flange.sensor.advance(train.shaft_torque_nm()),
            None => self.cell.advance(air_gap_nm),
        }
    }

    /// Returns the readings of the bench now, with the air-gap torque as the drive computes it.
    pub(super) fn read(&mut self, computed_nm: f64) -> Readings {
        let dyno_speed_rad_s = self.dyno_encoder.read_rad_s(&self.dyno_rotation);
        let calc_torque_nm = computed_nm + self.calc_noise_nm * self.calc_random.normal();
        let own_shaft_nm = self.system_shaft.update(dyno_speed_rad_s, calc_torque_nm);
        Readings {
            dyno_speed_rad_s,
            engine_speed_rad_s: self.engine_encoder.read_rad_s(&self.engine_rotation),
            calc_torque_nm,
            cell_torque_nm: self.cell.reading_nm() + self.cell_noise_nm * self.cell_random.normal(),
            shaft_torque_nm: self.flange.as_mut().map_or(own_shaft_nm, Flange::read_nm),
        }
    }
}

impl Flange {
    fn new(parameters: &BenchParameters, train: &Train, step_s: f64, seed: u64) -> Result<Self, VirtualBenchError> {
        let flange = parameters.sensors.flange;
        let dynamics = SensorDynamics {
            delay_s: flange.delay_s,
            resonance_hz: flange.resonance_hz,
            damping_ratio: flange.damping_ratio,
        };
        Ok(Self {
            sensor: TorqueSensor::new(dynamics, step_s, train.shaft_torque_nm())?,
            noise_nm: flange.noise_nm,
            resolution_nm: flange.resolution_nm,
            random: Source::Flange.stream(seed),
        })
    }

    fn read_nm(&mut self) -> f64 {
        rounded(self.sensor.reading_nm() + self.noise_nm * self.random.normal(), self.resolution_nm)
    }
}
