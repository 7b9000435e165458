//! Encoders, T_d,calc and the load cell, read each millisecond.

use std::collections::VecDeque;
use std::f64::consts::TAU;

use crate::bench;
use crate::random::Random;

/// Time between readings, s.
const READ_S: f64 = 1e-3;

/// Readings of the sensors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reading {
    pub(crate) dyno_rad_s: f64,
    pub(crate) engine_rad_s: f64,
    pub(crate) computed_nm: f64,
    pub(crate) cell_nm: f64,
}

/// All of them.
pub(crate) struct Sensors {
    encoders: [Encoder; 2],
    /// Readings of the load cell on their way.
    cell: VecDeque<f64>,
    torque_noise_nm: f64,
    random: Random,
}

impl Sensors {
    /// At a time, with angle and speed of dynamometer and engine.
    pub(crate) fn new(
        parameters: &bench::Sensors,
        time_s: f64,
        motions: [(f64, f64); 2],
        cell_nm: f64,
        mut random: Random,
    ) -> Self {
        let phases_rad = [random.between(0.0, TAU), random.between(0.0, TAU)];
        let encoder = |place: usize| {
            let disk = Disk {
                error_rad: parameters.pitch_error_rad[place],
                phase_rad: phases_rad[place],
                pitch_rad: parameters.slits.map(|slits| TAU / f64::from(slits)),
            };
            Encoder {
                last: disk.seen(time_s - READ_S, motions[place].0 - READ_S * motions[place].1, motions[place].1),
                disk,
                noise_rad_s: parameters.speed_noise_rad_s,
                step_rad_s: parameters.speed_step_rad_s,
            }
        };
        Sensors {
            encoders: [encoder(0), encoder(1)],
            cell: VecDeque::from(vec![cell_nm; parameters.cell_delay_ms]),
            torque_noise_nm: parameters.torque_noise_nm,
            random,
        }
    }

    pub(crate) fn read(&mut self, time_s: f64, motions: [(f64, f64); 2], air_gap_nm: f64, cell_nm: f64) -> Reading {
        let [dyno, engine] = &mut self.encoders;
        self.cell.push_back(cell_nm);
        Reading {
            dyno_rad_s: dyno.read(time_s, motions[0], &mut self.random),
            engine_rad_s: engine.read(time_s, motions[1], &mut self.random),
            computed_nm: air_gap_nm + self.torque_noise_nm * self.random.normal(),
            cell_nm: self.cell.pop_front().unwrap_or(cell_nm),
        }
    }
}

/// An encoder: the angle passed since the last reading, over the time of it.
struct Encoder {
    disk: Disk,
    /// Time and angle of the last reading.
    last: (f64, f64),
    noise_rad_s: f64,
    step_rad_s: f64,
}

struct Disk {
    /// Once-a-turn error, rad, and its phase.
    error_rad: f64,
    phase_rad: f64,
    /// Angle from slit to slit, rad; none: it shows every angle.
    pitch_rad: Option<f64>,
}

impl Encoder {
    fn read(&mut self, time_s: f64, (angle_rad, speed_rad_s): (f64, f64), random: &mut Random) -> f64 {
        let seen = self.disk.seen(time_s, angle_rad, speed_rad_s);
        let mean_rad_s = (seen.1 - self.last.1) / (seen.0 - self.last.0);
        self.last = seen;
        let noisy_rad_s = mean_rad_s + self.noise_rad_s * random.normal();
        (noisy_rad_s / self.step_rad_s).round() * self.step_rad_s
    }
}

impl Disk {
    /// Time, s, and angle, rad, of what was seen last: the angle itself, or the last slit, when it passed.
    fn seen(&self, time_s: f64, angle_rad: f64, speed_rad_s: f64) -> (f64, f64) {
        let shown_rad = angle_rad + self.error_rad * (angle_rad + self.phase_rad).sin();
        let Some(pitch_rad) = self.pitch_rad else { return (time_s, shown_rad) };
        let slit_rad = (shown_rad / pitch_rad).floor() * pitch_rad;
        (time_s - (shown_rad - slit_rad) / speed_rad_s, slit_rad)
    }
}
