//! The engine and its control.

use std::borrow::Cow;
use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};
use signal::Complex64;
use units::RPM_RAD_S;

use crate::bench_parameters::{ParameterError, SliderCrank, require, require_not_negative};

/// Points of a firing interval from which its Fourier series is made, at the least, ...
const FEWEST_PHASES: usize = 32;
/// ... and for each of its harmonics.
const PHASES_EACH: usize = 4;

/// One harmonic of the firing order.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Harmonic {
    /// Amplitude relative to the mean torque, 1.
    pub relative_amplitude: f64,
    /// Phase at the moment of firing, rad.
    pub phase_rad: f64,
}

/// A harmonic m of the working cycle: Re[(α + β L + γ ω²) e^{i m 2π θ/θ_cycle}], L the mean torque, ω the speed, θ the
/// crank's angle. Complex numbers are real and imaginary part. Gas torque grows with the load, compression is there
/// without it, and the torque of the reciprocating masses grows with ω².
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct CycleHarmonic {
    /// α, Nm.
    pub unloaded_nm: [f64; 2],
    /// β, 1.
    pub of_torque: [f64; 2],
    /// γ, Nm s².
    pub of_speed_nm_s2: [f64; 2],
}

impl CycleHarmonic {
    /// Its complex amplitude at a mean torque and a speed, Nm.
    pub fn at(&self, torque_nm: f64, speed_rad_s: f64) -> Complex64 {
        let part = |k: usize| {
            self.unloaded_nm[k] + self.of_torque[k] * torque_nm + self.of_speed_nm_s2[k] * speed_rad_s * speed_rad_s
        };
        Complex64::new(part(0), part(1))
    }
}

/// Engine with c cylinders and s strokes, firing at crank angles θ = sπ j/c. From firing j to the next,
/// T_e = T_j (1 + p Σ_n a_n cos(2n c θ/s + φ_n)), T_j = (level at firing j) · (factor of cylinder j mod c) · (1 + ε_j),
/// ε_j normal and independent. p is 1 when fired; a motored engine has p < 1, unit cylinder factors and no ε_j.
/// Firing frequency: f_cb = (2c/s) N_e/60 (thesis 2.1 for c = s = 4).
///
/// The level: the torque demanded, or that of the throttle map, T(α, ω_e), goes through the intake, 1/(1 + sτ), and
/// gives T_b at the best ignition angle. Ignition with efficiency η acts on the next firing:
/// level = T_b − (1 − η)(T_b − T_motored).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct EngineParameters {
    /// Torque of each cylinder relative to the level, in firing order; their number is the number of cylinders.
    pub cylinder_factors: Vec<f64>,
    /// Strokes of a working cycle, 2 or 4.
    pub strokes: u32,
    /// a_n, φ_n: harmonics of the firing order, first harmonic first.
    pub firing_harmonics: Vec<Harmonic>,
    /// Harmonics of the working cycle, the first first, in place of the cylinders' factors and the harmonics of the
    /// firing order: T_e is then T_j with all of them, p being 1. Empty: those.
    pub cycle_harmonics: Vec<CycleHarmonic>,
    /// Cylinders on a crankshaft in place of the harmonics; none: the harmonics.
    pub slider_crank: Option<SliderCrank>,
    /// Standard deviation of ε, 1.
    pub cycle_variation: f64,
    /// Mean torque of the motored engine, Nm (negative).
    pub motored_torque_nm: f64,
    /// p of the motored engine, 1.
    pub motored_pulsation: f64,
    /// Proportional gain of the engine's speed control (TN): torque per speed too low, Nm s/rad.
    pub speed_control_proportional_nm_s_per_rad: f64,
    /// Integral gain of the engine's speed control (TN), Nm/rad.
    pub speed_control_integral_nm_per_rad: f64,
    /// τ of the intake, s; zero: the charge follows at once.
    pub intake_lag_s: f64,
    /// Torque over throttle and speed.
    pub throttle_map: ThrottleMap,
}

/// The engine's torque at rest over throttle and speed, linear between the points of a grid and constant beyond it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ThrottleMap {
    /// α of the grid's rows, growing, 0 … 1.
    pub throttle: Vec<f64>,
    /// ω_e of its columns, growing, rad/s.
    pub speed_rad_s: Vec<f64>,
    /// Torque, one row a throttle, Nm.
    pub torque_nm: Vec<Vec<f64>>,
}

impl Default for ThrottleMap {
    /// A two-litre engine with natural intake.
    fn default() -> Self {
        let row = |torque_nm: [f64; 4]| torque_nm.to_vec();
        Self {
            throttle: vec![0.0, 0.05, 0.1, 0.2, 0.4, 1.0],
            speed_rad_s: [800.0, 2000.0, 4000.0, 6000.0].map(|n: f64| n * RPM_RAD_S).to_vec(),
            torque_nm: vec![
                row([5.0, -18.0, -28.0, -38.0]),
                row([60.0, 12.0, -14.0, -30.0]),
                row([105.0, 55.0, 10.0, -15.0]),
                row([140.0, 120.0, 72.0, 30.0]),
                row([155.0, 165.0, 145.0, 105.0]),
                row([160.0, 180.0, 190.0, 165.0]),
            ],
        }
    }
}

impl Default for EngineParameters {
    fn default() -> Self {
        let harmonic = |relative_amplitude, phase_rad| Harmonic { relative_amplitude, phase_rad };
        Self {
            cylinder_factors: vec![1.0, 0.93, 1.05, 0.98],
            strokes: 4,
            firing_harmonics: vec![harmonic(2.0, 0.3), harmonic(0.9, 1.1), harmonic(0.4, -0.5), harmonic(0.2, 0.2)],
            cycle_harmonics: Vec::new(),
            slider_crank: None,
            cycle_variation: 0.02,
            motored_torque_nm: -15.8,
            motored_pulsation: 0.2,
            speed_control_proportional_nm_s_per_rad: 2.0,
            speed_control_integral_nm_per_rad: 6.0,
            intake_lag_s: 0.0,
            throttle_map: ThrottleMap::default(),
        }
    }
}

impl EngineParameters {
    /// Crank angle of a working cycle, rad.
    pub fn cycle_rad(&self) -> f64 {
        f64::from(self.strokes) * PI
    }

    /// The complex amplitudes of the torque at the harmonics of the working cycle, the first first, Nm, of the engine
    /// fired with a mean torque at a speed. Unequal cylinders give harmonics below that of the firing. The cylinders on
    /// a crankshaft are no part of it.
    pub fn waves(&self, torque_nm: f64, speed_rad_s: f64) -> Vec<Complex64> {
        self.harmonics_of_cycle().iter().map(|harmonic| harmonic.at(torque_nm, speed_rad_s)).collect()
    }

    /// The harmonics of the working cycle, the first first: those given, or what the factors of the cylinders and the
    /// harmonics of the firing order make.
    pub fn harmonics_of_cycle(&self) -> Cow<'_, [CycleHarmonic]> {
        if !self.cycle_harmonics.is_empty() {
            return Cow::Borrowed(&self.cycle_harmonics);
        }
        let cylinders = self.cylinder_factors.len();
        let phases = FEWEST_PHASES.max(PHASES_EACH * self.firing_harmonics.len());
        let points = phases * cylinders;
        let torques: Vec<f64> = (0..points).map(|k| self.relative(k, phases)).collect();
        let harmonic = |m: usize| {
            let part =
                |(k, torque): (usize, &f64)| torque * Complex64::cis(-TAU * (m * k % points) as f64 / points as f64);
            let wave = torques.iter().enumerate().map(part).sum::<Complex64>() * 2.0 / points as f64;
            CycleHarmonic { of_torque: [wave.re, wave.im], ..CycleHarmonic::default() }
        };
        (1..=cylinders * self.firing_harmonics.len()).map(harmonic).collect()
    }

    /// The torque over its level, `k` of so many parts of a firing after the first cylinder fired.
    fn relative(&self, k: usize, phases: usize) -> f64 {
        let phase = TAU * k as f64 / phases as f64;
        let wave = |(harmonic, n): (&Harmonic, i32)| {
            harmonic.relative_amplitude * (f64::from(n) * phase + harmonic.phase_rad).cos()
        };
        self.cylinder_factors[k / phases] * (1.0 + self.firing_harmonics.iter().zip(1..).map(wave).sum::<f64>())
    }

    /// The cylinder whose part of the cycle a crank angle lies in, counted in firing order. A start that is drawn over
    /// the whole cycle so begins with any of them.
    pub fn cylinder_at(&self, angle_rad: f64) -> usize {
        let cylinders = self.cylinder_factors.len().max(1);
        let part = (angle_rad / self.cycle_rad() * cylinders as f64).floor();
        part.rem_euclid(cylinders as f64) as usize
    }

    pub(crate) fn check(&self) -> Result<(), ParameterError> {
        let cylinders = self.cylinder_factors.len();
        require("engine.cylinder_factors", cylinders as f64, cylinders > 0, "one factor for each cylinder")?;
        require("engine.strokes", f64::from(self.strokes), [2, 4].contains(&self.strokes), "2 or 4")?;
        for &factor in &self.cylinder_factors {
            require("engine.cylinder_factors", factor, true, "finite")?;
        }
        for harmonic in &self.firing_harmonics {
            require("engine.firing_harmonics", harmonic.relative_amplitude, true, "finite")?;
            require("engine.firing_harmonics", harmonic.phase_rad, true, "finite")?;
        }
        for harmonic in &self.cycle_harmonics {
            let CycleHarmonic { unloaded_nm, of_torque, of_speed_nm_s2 } = harmonic;
            let mut parts = unloaded_nm.iter().chain(of_torque).chain(of_speed_nm_s2);
            parts.try_for_each(|part| require("engine.cycle_harmonics", *part, true, "finite"))?;
        }
        require_not_negative("engine.cycle_variation", self.cycle_variation)?;
        require("engine.motored_torque_nm", self.motored_torque_nm, true, "finite")?;
        require("engine.motored_pulsation", self.motored_pulsation, true, "finite")?;
        let gain = self.speed_control_proportional_nm_s_per_rad;
        require_not_negative("engine.speed_control_proportional_nm_s_per_rad", gain)?;
        require_not_negative("engine.speed_control_integral_nm_per_rad", self.speed_control_integral_nm_per_rad)?;
        require_not_negative("engine.intake_lag_s", self.intake_lag_s)?;
        self.slider_crank.map_or(Ok(()), |crank| crank.check())?;
        self.throttle_map.check()
    }
}

impl ThrottleMap {
    fn check(&self) -> Result<(), ParameterError> {
        for (name, axis) in
            [("engine.throttle_map.throttle", &self.throttle), ("engine.throttle_map.speed_rad_s", &self.speed_rad_s)]
        {
            require(name, axis.len() as f64, !axis.is_empty(), "an axis of at least one point")?;
            axis.iter().try_for_each(|&value| require(name, value, true, "finite"))?;
            let falls = axis.windows(2).find(|pair| pair[1] <= pair[0]);
            falls.map_or(Ok(()), |pair| require(name, pair[1], false, "growing"))?;
        }
        let rows = self.torque_nm.len();
        require("engine.throttle_map.torque_nm", rows as f64, rows == self.throttle.len(), "one row a throttle")?;
        for row in &self.torque_nm {
            let columns = row.len();
            let fits = columns == self.speed_rad_s.len();
            require("engine.throttle_map.torque_nm", columns as f64, fits, "one column a speed")?;
            row.iter().try_for_each(|&torque| require("engine.throttle_map.torque_nm", torque, true, "finite"))?;
        }
        Ok(())
    }
}
