//! Encoders, load cell, flange, computed torques.

use serde::{Deserialize, Serialize};
use units::RPM_RAD_S;

use crate::bench_parameters::{ParameterError, require, require_not_negative, require_positive};

/// Root mean square, over encoders, of the amplitude of the once-a-turn error, in parts of the speed: a disc that runs
/// out by some hundredths of a millimetre.
pub const ONCE_A_TURN: f64 = 3e-4;

/// Sensors. An encoder reads the mean speed over a gate that ends at the time stamp: N = (θ̃(t) − θ̃(t − gate))/gate
/// with θ̃ = θ + ε sin θ, plus white noise, rounded. The load cell reads the air-gap torque late and through ω_0²/(s² +
/// 2ζω_0 s + ω_0²). The system's shaft torque is T_d,calc + J_d dN̄_d/dt, with N̄_d the moving average of N_d over N
/// updates (1 ms each) and a backward difference for its derivative: the inertia part is late by (N − 1)/2 ms, T_d,calc
/// is not (thesis, figure 3.3 and the text below it). A bench with a flange (TB) has neither load cell nor shaft torque
/// of its own.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorParameters {
    /// Gate over which speed is averaged, s.
    pub gate_s: f64,
    /// ε of the dynamometer's encoder: its once-a-turn relative speed error, 1.
    pub dyno_eccentricity: f64,
    /// ε of the engine's encoder, 1.
    pub engine_eccentricity: f64,
    /// Standard deviation of the white noise of measured speeds, rad/s.
    pub speed_noise_rad_s: f64,
    /// Measured speeds are rounded to multiples of this, rad/s; zero: not rounded.
    pub speed_resolution_rad_s: f64,
    /// The recorded T_d* is rounded to multiples of this, Nm; zero: not rounded. The drive gets it unrounded.
    pub demand_resolution_nm: f64,
    /// Standard deviation of the white noise of T_d,calc, Nm.
    pub calc_noise_nm: f64,
    /// Delay of the load cell, s.
    pub cell_delay_s: f64,
    /// Natural frequency ω_0/2π of the load cell, Hz.
    pub cell_resonance_hz: f64,
    /// Damping ratio ζ of the load cell, 1.
    pub cell_damping_ratio: f64,
    /// Standard deviation of the white noise of the load cell, Nm.
    pub cell_noise_nm: f64,
    /// N of the moving average in the system's shaft torque.
    pub moving_average: usize,
    /// The encoders' pulses; none: the mean over the gate as it is.
    pub pulses: Option<PulseParameters>,
    /// The torque flange at the dynamometer's end of the shaft.
    pub flange: FlangeParameters,
}

/// Both encoders as disks with slits, read by a counter and a timer: N = slits passed · pitch over the time between the
/// last edges before the two ends of the gate, which is a whole number of milliseconds. Between slits it knows nothing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PulseParameters {
    /// Slits of the disk.
    pub slits: u32,
    /// Standard deviation of the places of the slits, which stay, rad.
    pub slit_error_rad: f64,
    /// Standard deviation of the jitter of every edge, rad.
    pub edge_jitter_rad: f64,
    /// Clock of the timer, Hz; zero: exact times.
    pub timer_hz: f64,
}

impl Default for PulseParameters {
    /// 1024 slits (thesis §3.4.3) and a timer of 10 MHz.
    fn default() -> Self {
        Self { slits: 1024, slit_error_rad: 5e-6, edge_jitter_rad: 2e-6, timer_hz: 1e7 }
    }
}

/// A torque flange: T_shaft late and through ω_0²/(s² + 2ζω_0 s + ω_0²), plus white noise, rounded.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct FlangeParameters {
    /// Delay, s.
    pub delay_s: f64,
    /// Natural frequency ω_0/2π of its amplifier's filter, Hz.
    pub resonance_hz: f64,
    /// Damping ratio ζ of the filter, 1.
    pub damping_ratio: f64,
    /// Standard deviation of the white noise, Nm.
    pub noise_nm: f64,
    /// Readings are rounded to multiples of this, Nm; zero: not rounded.
    pub resolution_nm: f64,
}

impl Default for FlangeParameters {
    fn default() -> Self {
        Self { delay_s: 0.0005, resonance_hz: 1000.0, damping_ratio: 0.87, noise_nm: 0.05, resolution_nm: 0.01 }
    }
}

impl Default for SensorParameters {
    fn default() -> Self {
        Self {
            gate_s: 0.001,
            dyno_eccentricity: 0.0002,
            engine_eccentricity: 0.0003,
            speed_noise_rad_s: 0.03 * RPM_RAD_S,
            speed_resolution_rad_s: 0.01 * RPM_RAD_S,
            demand_resolution_nm: 0.01,
            calc_noise_nm: 0.15,
            cell_delay_s: 0.008,
            cell_resonance_hz: 75.0,
            cell_damping_ratio: 0.25,
            cell_noise_nm: 0.0,
            moving_average: 16,
            pulses: None,
            flange: FlangeParameters::default(),
        }
    }
}

impl SensorParameters {
    /// The same sensors without noise, rounding, pulses and once-a-turn errors; gates, delays and resonance stay.
    #[must_use]
    pub fn without_errors(self) -> Self {
        Self {
            dyno_eccentricity: 0.0,
            engine_eccentricity: 0.0,
            speed_noise_rad_s: 0.0,
            speed_resolution_rad_s: 0.0,
            demand_resolution_nm: 0.0,
            calc_noise_nm: 0.0,
            cell_noise_nm: 0.0,
            pulses: None,
            flange: FlangeParameters { noise_nm: 0.0, resolution_nm: 0.0, ..self.flange },
            ..self
        }
    }
}

impl SensorParameters {
    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        require("sensors.gate_s", self.gate_s, self.gate_s >= 1e-5 && self.gate_s <= 1.0, "between 10 µs and 1 s")?;
        require("sensors.dyno_eccentricity", self.dyno_eccentricity, true, "finite")?;
        require("sensors.engine_eccentricity", self.engine_eccentricity, true, "finite")?;
        require_not_negative("sensors.speed_noise_rad_s", self.speed_noise_rad_s)?;
        require_not_negative("sensors.speed_resolution_rad_s", self.speed_resolution_rad_s)?;
        require_not_negative("sensors.demand_resolution_nm", self.demand_resolution_nm)?;
        require_not_negative("sensors.calc_noise_nm", self.calc_noise_nm)?;
        let delay = self.cell_delay_s;
        require("sensors.cell_delay_s", delay, (0.0..=1.0).contains(&delay), "between 0 and 1 s")?;
        require_positive("sensors.cell_resonance_hz", self.cell_resonance_hz)?;
        require_positive("sensors.cell_damping_ratio", self.cell_damping_ratio)?;
        require_not_negative("sensors.cell_noise_nm", self.cell_noise_nm)?;
        let average = self.moving_average;
        require("sensors.moving_average", average as f64, (1..=1000).contains(&average), "between 1 and 1000")?;
        self.pulses.map_or(Ok(()), |pulses| pulses.check())?;
        self.flange.check()
    }
}

impl PulseParameters {
    fn check(&self) -> Result<(), ParameterError> {
        let slits = f64::from(self.slits);
        require("sensors.pulses.slits", slits, (1..=100_000).contains(&self.slits), "between 1 and 100 000")?;
        let most = 0.1 * std::f64::consts::TAU / slits;
        for (name, value) in [
            ("sensors.pulses.slit_error_rad", self.slit_error_rad),
            ("sensors.pulses.edge_jitter_rad", self.edge_jitter_rad),
        ] {
            require(name, value, (0.0..=most).contains(&value), "between 0 and a tenth of the pitch")?;
        }
        require_not_negative("sensors.pulses.timer_hz", self.timer_hz)
    }
}

impl FlangeParameters {
    fn check(&self) -> Result<(), ParameterError> {
        let delay = self.delay_s;
        require("sensors.flange.delay_s", delay, (0.0..=1.0).contains(&delay), "between 0 and 1 s")?;
        require_positive("sensors.flange.resonance_hz", self.resonance_hz)?;
        require_positive("sensors.flange.damping_ratio", self.damping_ratio)?;
        require_not_negative("sensors.flange.noise_nm", self.noise_nm)?;
        require_not_negative("sensors.flange.resolution_nm", self.resolution_nm)
    }
}
