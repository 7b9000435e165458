//! Encoders, load cell and the system's shaft torque.

use std::collections::VecDeque;

use faer::mat;
use lti::StateSpace;

use super::error::VirtualBenchError;
use super::noise::Random;
use super::parameters::SensorParameters;

/// Part of a step below which a time counts as a whole number of steps.
const WHOLE: f64 = 1e-6;

/// Angle and speed of one shaft end over the last gate, on the fine grid of the simulation.
#[derive(Debug, Clone)]
pub(super) struct Rotation {
    step_s: f64,
    /// (rad, rad/s), the newest last.
    points: VecDeque<(f64, f64)>,
}

impl Rotation {
    /// The shaft end turning at a constant speed up to now.
    pub(super) fn new(gate_s: f64, step_s: f64, angle_rad: f64, speed_rad_s: f64) -> Self {
        let steps = (gate_s / step_s).ceil() as usize + 2;
        let past = |back: usize| (angle_rad - back as f64 * step_s * speed_rad_s, speed_rad_s);
        Self { step_s, points: (0..=steps).rev().map(past).collect() }
    }

    /// One step on.
    pub(super) fn advance(&mut self, angle_rad: f64, speed_rad_s: f64) {
        self.points.pop_front();
        self.points.push_back((angle_rad, speed_rad_s));
    }

    /// Angle a while ago, rad, by the cubic through two points and their slopes.
    fn angle_before_rad(&self, age_s: f64) -> f64 {
        let newest = self.points.len() - 1;
        let age = (age_s / self.step_s).clamp(0.0, newest as f64);
        let nearest = age.round();
        if (age - nearest).abs() < WHOLE {
            return self.points[newest - nearest as usize].0;
        }
        let left = newest - age.ceil() as usize;
        let u = age.ceil() - age;
        let ((from, speed_from), (to, speed_to)) = (self.points[left], self.points[left + 1]);
        let (v, rise) = (1.0 - u, to - from);
        from + u * rise + u * v * (v * (speed_from * self.step_s - rise) - u * (speed_to * self.step_s - rise))
    }
}

/// Speed from an encoder: N = (θ̃(t) − θ̃(t − gate))/gate with θ̃ = θ + ε sin θ, plus noise, rounded.
#[derive(Debug, Clone)]
pub(super) struct Encoder {
    gate_s: f64,
    eccentricity: f64,
    noise_rad_s: f64,
    resolution_rad_s: f64,
    random: Random,
}

impl Encoder {
    pub(super) fn new(parameters: &SensorParameters, eccentricity: f64, random: Random) -> Self {
        Self {
            gate_s: parameters.gate_s,
            eccentricity,
            noise_rad_s: parameters.speed_noise_rad_s,
            resolution_rad_s: parameters.speed_resolution_rad_s,
            random,
        }
    }

    /// The reading now, rad/s.
    pub(super) fn read_rad_s(&mut self, rotation: &Rotation) -> f64 {
        let start_rad = rotation.angle_before_rad(self.gate_s);
        let end_rad = rotation.angle_before_rad(0.0);
        let error_rad = self.eccentricity * (end_rad.sin() - start_rad.sin());
        let mean_rad_s = (end_rad - start_rad + error_rad) / self.gate_s;
        let reading_rad_s = mean_rad_s + self.noise_rad_s * self.random.normal();
        rounded(reading_rad_s, self.resolution_rad_s)
    }
}

/// The nearest multiple of a resolution; the value itself where the resolution is zero.
pub(super) fn rounded(value: f64, resolution: f64) -> f64 {
    if resolution > 0.0 { (value / resolution).round() * resolution } else { value }
}

/// The load cell: e^{−s d} ω_0²/(s² + 2ζω_0 s + ω_0²), exact for torques that are linear within a step.
#[derive(Debug, Clone)]
pub(super) struct LoadCell {
    transition: [[f64; 2]; 2],
    from_start: [f64; 2],
    from_end: [f64; 2],
    /// Reading and its derivative, before the delay.
    state: [f64; 2],
    last_torque_nm: f64,
    /// Readings not yet delayed enough, the newest last.
    undelayed_nm: VecDeque<f64>,
    /// Steps in the delay, and the part of one step beyond them.
    delay_steps: usize,
    delay_rest: f64,
}

impl LoadCell {
    /// The cell at rest at a torque.
    pub(super) fn new(parameters: &SensorParameters, step_s: f64, torque_nm: f64) -> Result<Self, VirtualBenchError> {
        let natural = std::f64::consts::TAU * parameters.cell_resonance_hz;
        let a = mat![[0.0, 1.0], [-natural * natural, -2.0 * parameters.cell_damping_ratio * natural]];
        let b = mat![[0.0], [natural * natural]];
        let cell = StateSpace::new(a, b, mat![[1.0, 0.0]], mat![[0.0]], None)?.to_discrete_foh(step_s)?;
        let steps = parameters.cell_delay_s / step_s;
        let whole = (steps + WHOLE).floor();
        Ok(Self {
            transition: [[cell.a()[(0, 0)], cell.a()[(0, 1)]], [cell.a()[(1, 0)], cell.a()[(1, 1)]]],
            from_start: [cell.b0()[(0, 0)], cell.b0()[(1, 0)]],
            from_end: [cell.b1()[(0, 0)], cell.b1()[(1, 0)]],
            state: [torque_nm, 0.0],
            last_torque_nm: torque_nm,
            undelayed_nm: VecDeque::from(vec![torque_nm; whole as usize + 2]),
            delay_steps: whole as usize,
            delay_rest: (steps - whole).max(0.0),
        })
    }

    /// One step, at whose end the air-gap torque is `torque_nm`.
    pub(super) fn advance(&mut self, torque_nm: f64) {
        let [reading, slope] = self.state;
        self.state = [0, 1].map(|i| {
            self.transition[i][0] * reading
                + self.transition[i][1] * slope
                + self.from_start[i] * self.last_torque_nm
                + self.from_end[i] * torque_nm
        });
        self.last_torque_nm = torque_nm;
        self.undelayed_nm.push_back(self.state[0]);
        self.undelayed_nm.pop_front();
    }

    /// What the cell reads now, Nm; between steps of the grid the reading is linear.
    pub(super) fn reading_nm(&self) -> f64 {
        let newest = self.undelayed_nm.len() - 1;
        let later = self.undelayed_nm[newest - self.delay_steps];
        let earlier = self.undelayed_nm[newest - self.delay_steps - 1];
        later + (earlier - later) * self.delay_rest
    }
}

/// The system's own shaft torque: J_d times the difference quotient of the moving average of N_d, plus T_d,calc.
#[derive(Debug, Clone)]
pub(super) struct SystemShaftTorque {
    dyno_inertia_kg_m2: f64,
    update_s: f64,
    length: usize,
    /// Measured speeds of the last N updates before now, the newest last.
    speeds_rad_s: VecDeque<f64>,
}

impl SystemShaftTorque {
    pub(super) fn new(dyno_inertia_kg_m2: f64, update_s: f64, length: usize, speed_rad_s: f64) -> Self {
        Self { dyno_inertia_kg_m2, update_s, length, speeds_rad_s: VecDeque::from(vec![speed_rad_s; length]) }
    }

    /// One update with the measured speed and T_d,calc; returns the shaft torque, Nm. The average changes by
    /// (N_d,k − N_d,k−N)/N from one update to the next.
    pub(super) fn update(&mut self, speed_rad_s: f64, calc_torque_nm: f64) -> f64 {
        let oldest_rad_s = self.speeds_rad_s.pop_front().unwrap_or(speed_rad_s);
        self.speeds_rad_s.push_back(speed_rad_s);
        let acceleration_rad_s2 = (speed_rad_s - oldest_rad_s) / (self.length as f64 * self.update_s);
        self.dyno_inertia_kg_m2 * acceleration_rad_s2 + calc_torque_nm
    }
}
