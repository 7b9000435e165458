//! Plan of an experiment on a bench, with its duration.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};
use units::RPM_RAD_S;

use super::error::{PlanError, require, require_not_negative, require_positive};
use super::waveform::Waveform;
use super::{ControlMode, Excitation, ExperimentLabel, Test, UPDATE_S};
use crate::facts::Engine;

/// Which torque the dynamometer controls in TN mode.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TorqueTarget {
    /// T_d, the air-gap torque: the demand goes straight to the drive.
    #[default]
    AirGap,
    /// T_shaft, the shaft torque: a controller demands T_d* (thesis §3.2, third mode).
    Shaft,
}

/// Plan of an experiment on a bench, with its duration. The constructors give the experiments of the method with the
/// levels and times of the thesis' bench; every field may be changed afterwards.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ExperimentPlan {
    /// The experiment's label; its mode says who controls what.
    pub label: ExperimentLabel,
    /// Length of the recording, s.
    pub duration_s: f64,
    /// How long the bench runs at the plan's first demands before the recording starts, s.
    pub settling_s: f64,
    /// ω_d*, speed demand of the dynamometer (NT), rad/s. In TN it is the engine's.
    pub speed_rad_s: Waveform,
    /// T_d* or T_shaft*, the dynamometer's torque demand (TN), Nm.
    pub dyno_torque_nm: Waveform,
    /// Which of the two it is.
    #[serde(default)]
    pub torque_target: TorqueTarget,
    /// Engine torque demand (NT), Nm; it goes through the intake and is taken up firing by firing.
    pub engine_torque_nm: Waveform,
    /// α_e, throttle in place of the torque demand (NT), 0 … 1.
    #[serde(default)]
    pub throttle: Option<Waveform>,
    /// η, efficiency of the ignition angle, 1 at the best one; taken up firing by firing, past the intake.
    #[serde(default = "best_ignition")]
    pub ignition_efficiency: Waveform,
    /// True where the engine is motored instead of fired. Its torque is then that of the parameters.
    pub is_motored: bool,
    /// True where dynamometer and engine are connected.
    pub has_shaft: bool,
}

/// The best ignition angle throughout.
fn best_ignition() -> Waveform {
    Waveform::Constant { value: 1.0 }
}

impl ExperimentPlan {
    /// A plan without any demand beyond the speed, for a time in s.
    pub fn new(test: Test, excitation: Excitation, mode: ControlMode, speed_rpm: f64, duration_s: f64) -> Self {
        Self {
            label: ExperimentLabel { test, excitation, mode },
            duration_s,
            settling_s: 2.0,
            speed_rad_s: Waveform::Constant { value: speed_rpm * RPM_RAD_S },
            dyno_torque_nm: Waveform::Constant { value: 60.0 },
            torque_target: TorqueTarget::AirGap,
            engine_torque_nm: Waveform::Constant { value: 60.0 },
            throttle: None,
            ignition_efficiency: best_ignition(),
            is_motored: false,
            has_shaft: true,
        }
    }

    /// BS_T_NT: engine torque switched at random between 35 and 55 Nm (two ignition angles), at most every 80 ms and
    /// never within a firing; constant speed.
    pub fn bs_t_nt(speed_rpm: f64, duration_s: f64) -> Self {
        let engine_torque_nm = Waveform::RandomBinary { low: 35.0, high: 55.0, clock_s: 0.08 };
        Self { engine_torque_nm, ..Self::new(Test::Bs, Excitation::Torque, ControlMode::Nt, speed_rpm, duration_s) }
    }

    /// WhiteNoise_T_TN: white T_d* of 60 ± 12 Nm at the demand rate.
    pub fn white_noise_t_tn(speed_rpm: f64, duration_s: f64) -> Self {
        let dyno_torque_nm = Waveform::WhiteNoise { mean: 60.0, standard_deviation: 12.0 };
        Self {
            dyno_torque_nm,
            ..Self::new(Test::WhiteNoise, Excitation::Torque, ControlMode::Tn, speed_rpm, duration_s)
        }
    }

    /// Step_T_TN: T_d* steps between 60 and 85 Nm every 2 s.
    pub fn step_t_tn(speed_rpm: f64, duration_s: f64) -> Self {
        let dyno_torque_nm = Waveform::Square { first: 60.0, second: 85.0, dwell_s: 2.0 };
        Self { dyno_torque_nm, ..Self::new(Test::Step, Excitation::Torque, ControlMode::Tn, speed_rpm, duration_s) }
    }

    /// Ramp_N_NT: N_d* ramps to a level 800 rpm higher and back in 3 s, resting 5 s at each; the first ramp after 2 s.
    pub fn ramp_n_nt(speed_rpm: f64, duration_s: f64) -> Self {
        let low = speed_rpm * RPM_RAD_S;
        let high = (speed_rpm + 800.0) * RPM_RAD_S;
        let speed_rad_s = Waveform::Ramps { low, high, first_s: 2.0, ramp_s: 3.0, dwell_s: 5.0 };
        Self { speed_rad_s, ..Self::new(Test::Ramp, Excitation::Speed, ControlMode::Nt, speed_rpm, duration_s) }
    }

    /// Levels_N_NT: every 3 s N_d* leaves for a random level between the speed and 1800 rpm more, with a random slope
    /// of 100 to 1000 rpm/s.
    pub fn levels_n_nt(speed_rpm: f64, duration_s: f64) -> Self {
        let speed_rad_s = Waveform::RandomLevels {
            low: speed_rpm * RPM_RAD_S,
            high: (speed_rpm + 1800.0) * RPM_RAD_S,
            dwell_s: 3.0,
            lowest_slope_per_s: 100.0 * RPM_RAD_S,
            highest_slope_per_s: 1000.0 * RPM_RAD_S,
        };
        Self { speed_rad_s, ..Self::new(Test::Levels, Excitation::Speed, ControlMode::Nt, speed_rpm, duration_s) }
    }

    /// Unfired_N_NT: motored engine, N_d* switched at random between 12 rpm below and above the speed, at most every
    /// 80 ms.
    pub fn unfired_n_nt(speed_rpm: f64, duration_s: f64) -> Self {
        let speed_rad_s = Waveform::RandomBinary {
            low: (speed_rpm - 12.0) * RPM_RAD_S,
            high: (speed_rpm + 12.0) * RPM_RAD_S,
            clock_s: 0.08,
        };
        let plan = Self::new(Test::Unfired, Excitation::Speed, ControlMode::Nt, speed_rpm, duration_s);
        Self { speed_rad_s, is_motored: true, ..plan }
    }

    /// Sine_T_TN: T_d* = 60 Nm + 8 Nm sines of 1, 2, … 20 Hz, one after another, each for a twentieth of the time.
    pub fn sine_t_tn(speed_rpm: f64, duration_s: f64) -> Self {
        let dyno_torque_nm = Waveform::SineLadder {
            mean: 60.0,
            amplitude: 8.0,
            frequencies_hz: (1..=20).map(f64::from).collect(),
            dwell_s: duration_s / 20.0,
        };
        Self { dyno_torque_nm, ..Self::new(Test::Sine, Excitation::Torque, ControlMode::Tn, speed_rpm, duration_s) }
    }

    /// NoShaft_N_NT: shaft off, N_d* steps up by 150 rpm and back every 3 s.
    pub fn no_shaft_n_nt(speed_rpm: f64, duration_s: f64) -> Self {
        let first = speed_rpm * RPM_RAD_S;
        let second = (speed_rpm + 150.0) * RPM_RAD_S;
        let speed_rad_s = Waveform::Square { first, second, dwell_s: 3.0 };
        let plan = Self::new(Test::NoShaft, Excitation::Speed, ControlMode::Nt, speed_rpm, duration_s);
        Self { speed_rad_s, has_shaft: false, ..plan }
    }

    /// Where the engine's torque is switched faster than it fires at the plan's speed: the time of a level and that of
    /// a firing, s. A level that no cylinder takes up is lost.
    pub fn switches_within_a_firing(&self, engine: Engine) -> Option<(f64, f64)> {
        let (Waveform::RandomBinary { clock_s, .. }, Waveform::Constant { value }) =
            (&self.engine_torque_nm, &self.speed_rad_s)
        else {
            return None;
        };
        let firing_s = TAU / (value.abs() * engine.firings_per_turn());
        (*clock_s < firing_s && self.has_shaft && !self.is_motored).then_some((*clock_s, firing_s))
    }

    /// Updates of the controllers in the recording; at least one.
    pub fn updates(&self) -> usize {
        ((self.duration_s / UPDATE_S).round() as usize).max(1)
    }

    /// Checks times and waveforms.
    ///
    /// # Errors
    ///
    /// [`PlanError`] naming the first impossible value.
    pub fn check(&self) -> Result<(), PlanError> {
        require_positive("plan.duration_s", self.duration_s)?;
        require("plan.duration_s", self.duration_s, self.duration_s <= 1e4, "at most 10 000 s")?;
        require_not_negative("plan.settling_s", self.settling_s)?;
        require("plan.settling_s", self.settling_s, self.settling_s <= 1e4, "at most 10 000 s")?;
        self.speed_rad_s.check("plan.speed_rad_s")?;
        self.dyno_torque_nm.check("plan.dyno_torque_nm")?;
        self.engine_torque_nm.check("plan.engine_torque_nm")?;
        self.throttle.as_ref().map_or(Ok(()), |throttle| throttle.check("plan.throttle"))?;
        self.ignition_efficiency.check("plan.ignition_efficiency")
    }
}
