//! Damages of recordings.

use recording::{Channel, Raster, Recording};
use signal::filter::Sos;

use super::Brought;

pub(super) const DYNO_SPEED: &str = "DynoSpeed";
pub(super) const ENGINE_SPEED: &str = "EngineSpeed";
pub(super) const SPEED_DEMAND: &str = "DynoSpeedDemand";
pub(super) const TORQUE_DEMAND: &str = "DynoTorqueDemand";
pub(super) const CALC: &str = "DynoTorqueCalc";
pub(super) const CELL: &str = "DynoTorqueMeas";
pub(super) const SHAFT: &str = "ShaftTorqueCalc";
pub(super) const ALL: [&str; 7] = [DYNO_SPEED, ENGINE_SPEED, SPEED_DEMAND, TORQUE_DEMAND, CALC, CELL, SHAFT];
pub(super) const SPEEDS: [&str; 3] = [DYNO_SPEED, ENGINE_SPEED, SPEED_DEMAND];
pub(super) const TORQUES: [&str; 4] = [TORQUE_DEMAND, CALC, CELL, SHAFT];

impl Brought {
    pub(super) fn each(&mut self, work: impl Fn(&mut Recording)) {
        self.recordings.iter_mut().for_each(|(_, recording)| work(recording));
    }

    /// Changes the samples of these channels in every recording.
    pub(super) fn samples(&mut self, names: &[&str], work: impl Fn(&mut Vec<f64>)) {
        self.each(|recording| {
            let of = |channel: &&mut Channel| names.contains(&channel.name.as_str());
            recording.channels.iter_mut().filter(of).for_each(|channel| work(&mut channel.samples));
        });
    }

    pub(super) fn scaled(&mut self, names: &[&str], factor: f64) {
        self.samples(names, |samples| samples.iter_mut().for_each(|x| *x *= factor));
    }

    pub(super) fn unit(&mut self, names: &[&str], unit: &str) {
        self.each(|recording| {
            let of = |channel: &&mut Channel| names.contains(&channel.name.as_str());
            recording.channels.iter_mut().filter(of).for_each(|channel| channel.unit = unit.to_owned());
        });
    }

    /// Gives two channels each other's name.
    pub(super) fn swapped(&mut self, a: &str, b: &str) {
        self.each(|recording| {
            for channel in &mut recording.channels {
                if channel.name == a {
                    channel.name = b.to_owned();
                } else if channel.name == b {
                    channel.name = a.to_owned();
                }
            }
        });
    }

    /// Changes the time stamps of the rasters of these channels.
    pub(super) fn times(&mut self, names: &[&str], work: impl Fn(f64) -> f64) {
        self.each(|recording| {
            let of = |channel: &&Channel| names.contains(&channel.name.as_str());
            let mut rasters: Vec<usize> = recording.channels.iter().filter(of).map(|c| c.raster).collect();
            rasters.sort_unstable();
            rasters.dedup();
            for raster in rasters {
                recording.rasters[raster].time_s.iter_mut().for_each(|t| *t = work(*t));
            }
        });
    }

    /// Gives channels a raster of their own, made from theirs.
    pub(super) fn resampled(&mut self, names: &[&str], work: impl Fn(&[f64], &[f64]) -> (Vec<f64>, Vec<f64>)) {
        self.each(|recording| {
            for i in 0..recording.channels.len() {
                if !names.contains(&recording.channels[i].name.as_str()) {
                    continue;
                }
                let (time_s, samples) =
                    work(&recording.rasters[recording.channels[i].raster].time_s, &recording.channels[i].samples);
                recording.rasters.push(Raster { time_s, name: None });
                recording.channels[i].raster = recording.rasters.len() - 1;
                recording.channels[i].samples = samples;
            }
        });
    }

    /// A slow channel held or interpolated up to a fast raster.
    pub(super) fn raised(&mut self, names: &[&str], step_s: f64, interpolates: bool) {
        self.resampled(names, |time_s, x| {
            let (first, last) = (time_s[0], time_s[time_s.len() - 1]);
            let count = ((last - first) / step_s) as usize;
            let times: Vec<f64> = (0..count).map(|i| first + i as f64 * step_s).collect();
            let old_s = (last - first) / (time_s.len() - 1) as f64;
            let value = |t: &f64| {
                let position = (t - first) / old_s + 1e-9;
                let index = (position as usize).min(x.len() - 2);
                let share = if interpolates { position - index as f64 - 1e-9 } else { 0.0 };
                x[index] + share * (x[index + 1] - x[index])
            };
            let values = times.iter().map(value).collect();
            (times, values)
        });
    }

    /// Every sample of the raster `step_s` without a filter.
    pub(super) fn thinned(&mut self, names: &[&str], step_s: f64) {
        self.resampled(names, |time_s, x| {
            let old_s = (time_s[time_s.len() - 1] - time_s[0]) / (time_s.len() - 1) as f64;
            let every = ((step_s / old_s).round() as usize).max(1);
            (time_s.iter().step_by(every).copied().collect(), x.iter().step_by(every).copied().collect())
        });
    }

    /// A low-pass filter of the logger, at the raster of each channel.
    pub(super) fn filtered(&mut self, names: &[&str], order: usize, cutoff_hz: f64) {
        self.resampled(names, |time_s, x| {
            let step_s = (time_s[time_s.len() - 1] - time_s[0]) / (time_s.len() - 1) as f64;
            let Ok(filter) = Sos::butterworth_lowpass(order, cutoff_hz, step_s) else {
                return (time_s.to_vec(), x.to_vec());
            };
            let mut state = filter.state_at_level(x[0]);
            (time_s.to_vec(), filter.filter(x, &mut state))
        });
    }

    pub(super) fn file(&mut self, test: &str) -> &mut (String, Recording) {
        self.recordings.iter_mut().find(|(file, _)| file.starts_with(test)).unwrap()
    }

    pub(super) fn renamed(&mut self, test: &str, name: &str) {
        self.file(test).0 = name.to_owned();
    }

    /// Gives two files each other's content.
    pub(super) fn exchanged(&mut self, a: &str, b: &str) {
        let of_a = self.file(a).1.clone();
        let of_b = std::mem::replace(&mut self.file(b).1, of_a);
        self.file(a).1 = of_b;
    }
}

/// Tells whether something of this probability happens at a sample: uniform numbers from a hash.
pub(super) fn happens(i: usize, probability: f64) -> bool {
    0.5 * (bench_testkit::recordings::noise(i, 9) + 1.0) < probability
}
