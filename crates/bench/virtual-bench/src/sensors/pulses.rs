//! An incremental encoder's pulses, and the speed that a counter with a timer makes of them.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use numerics::random::Stream;
use rig::bench_parameters::PulseParameters;
use rig::experiment::UPDATE_S;

use super::Rotation;

/// Newton steps for the time of an edge; the angle is nearly linear between two steps of the bench.
const NEWTON_STEPS: usize = 3;

/// Slits passed and the time of the last one.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Edge {
    slit: i64,
    time_s: f64,
}

/// Speed as (slits passed between the last edges before the gate's two ends) · pitch over the time between these edges.
#[derive(Debug, Clone)]
pub(super) struct Pulses {
    pitch_rad: f64,
    /// Where each slit is beside its place, rad.
    slit_errors_rad: Vec<f64>,
    eccentricity: f64,
    jitter_rad: f64,
    timer_hz: f64,
    random: Stream,
    time_s: f64,
    /// The last edge before each reading in the gate, the oldest first.
    edges: VecDeque<Edge>,
    reading_rad_s: f64,
}

impl Pulses {
    /// The encoder of a shaft end that has turned at a constant speed.
    pub(super) fn new(
        parameters: &PulseParameters,
        gate_s: f64,
        eccentricity: f64,
        mut pattern: Stream,
        random: Stream,
        angle_rad: f64,
        speed_rad_s: f64,
    ) -> Self {
        let pitch_rad = TAU / f64::from(parameters.slits);
        let gates = ((gate_s / UPDATE_S).round() as usize).max(1);
        let slit = (angle_rad / pitch_rad).floor() as i64;
        let late_s = if speed_rad_s > 0.0 { (angle_rad - slit as f64 * pitch_rad) / speed_rad_s } else { 0.0 };
        let back = |k: usize| {
            let time_s = -(k as f64) * UPDATE_S;
            Edge { slit: slit - ((speed_rad_s * UPDATE_S * k as f64) / pitch_rad) as i64, time_s: time_s - late_s }
        };
        Self {
            pitch_rad,
            slit_errors_rad: (0..parameters.slits).map(|_| parameters.slit_error_rad * pattern.normal()).collect(),
            eccentricity,
            jitter_rad: parameters.edge_jitter_rad,
            timer_hz: parameters.timer_hz,
            random,
            time_s: 0.0,
            edges: (1..=gates).rev().map(back).collect(),
            reading_rad_s: speed_rad_s,
        }
    }

    /// The reading now; called once an update.
    pub(super) fn read_rad_s(&mut self, rotation: &Rotation) -> f64 {
        let first = self.edges.pop_front();
        let last = self.last_edge(rotation);
        let before = first.unwrap_or(last);
        self.edges.push_back(last);
        let (turned_rad, taken_s) = ((last.slit - before.slit) as f64 * self.pitch_rad, last.time_s - before.time_s);
        self.reading_rad_s = if turned_rad != 0.0 && taken_s > 0.0 {
            turned_rad / taken_s
        } else {
            // No edge: it cannot turn faster than a pitch in the time since the last one.
            let most = self.pitch_rad / (self.time_s - last.time_s).max(UPDATE_S);
            self.reading_rad_s.clamp(-most, most)
        };
        self.time_s += UPDATE_S;
        self.reading_rad_s
    }

    /// The angle as the disk shows it a while ago, rad: θ + ε sin θ.
    fn shown_rad(&self, rotation: &Rotation, age_s: f64) -> f64 {
        let angle_rad = rotation.angle_before_rad(age_s);
        angle_rad + self.eccentricity * angle_rad.sin()
    }

    fn place_rad(&self, slit: i64) -> f64 {
        let index = slit.rem_euclid(self.slit_errors_rad.len() as i64) as usize;
        slit as f64 * self.pitch_rad + self.slit_errors_rad[index]
    }

    /// The last edge before now; where none came since the last reading, that one's.
    fn last_edge(&mut self, rotation: &Rotation) -> Edge {
        let now_rad = self.shown_rad(rotation, 0.0);
        let nominal = (now_rad / self.pitch_rad).floor() as i64;
        let slit = (nominal - 1..=nominal + 1).rev().find(|slit| self.place_rad(*slit) <= now_rad).unwrap_or(nominal);
        if let Some(last) = self.edges.back().copied().filter(|last| last.slit == slit) {
            return last;
        }
        let place_rad = self.place_rad(slit) + self.jitter_rad * self.random.normal();
        let speed = rotation.speed_rad_s();
        let mut age_s = if speed == 0.0 { 0.0 } else { (now_rad - place_rad) / speed };
        for _ in 0..NEWTON_STEPS {
            let miss_rad = self.shown_rad(rotation, age_s) - place_rad;
            age_s += if speed == 0.0 { 0.0 } else { miss_rad / speed };
        }
        let time_s = self.time_s - age_s.clamp(0.0, UPDATE_S);
        Edge {
            slit,
            time_s: if self.timer_hz > 0.0 { (time_s * self.timer_hz).floor() / self.timer_hz } else { time_s },
        }
    }
}
