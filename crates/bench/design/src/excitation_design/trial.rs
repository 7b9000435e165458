//! A demand tried on the models: its peaks over time, its power over frequency.

use bench_model::model::BenchModel;
use bench_model::simulate::{DynoInput, InitialState, Inputs, Response, simulate};
use signal::Complex64;
use signal::spectrum::fft_real;

use super::information::{Judged, Judges, Line, lines};
use super::task::{DesignTask, ExcitedDemand, Robustness};
use crate::excitation_design::error::DesignError;
use crate::excitation_design::peaks::{LimitedQuantity, Peaks};

/// Step of the simulation at most, s.
const LONGEST_STEP_S: f64 = 1e-3;

/// Values of a demand about its operating point, each held, one period of them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct HeldDemand {
    pub(super) values: Vec<f64>,
}

/// Deviations from the operating point over time.
struct Deviations {
    response: Response,
    /// Samples of the simulation in a step of the demand.
    samples_per_step: usize,
}

/// Tries demands; keeps the lines of periods it has met.
pub(super) struct Trials<'a> {
    task: &'a DesignTask,
    pub(super) judges: Judges,
    known: Vec<(usize, Vec<Line>)>,
}

impl<'a> Trials<'a> {
    pub(super) fn new(task: &'a DesignTask) -> Self {
        Trials { task, judges: Judges::new(task), known: Vec::new() }
    }

    /// Lines that a demand with a period of so many steps has in the estimator's band.
    fn lines(&mut self, steps: usize) -> Result<&[Line], DesignError> {
        let place = match self.known.iter().position(|(n, _)| *n == steps) {
            Some(place) => place,
            None => {
                let found = lines(self.task, steps as f64 * self.task.hold_s, self.task.estimated_hz);
                self.known.push((steps, found.ok_or(DesignError::MissingPart { part: "part its demand needs" })?));
                self.known.len() - 1
            }
        };
        Ok(&self.known[place].1)
    }

    /// The criterion over all models after an experiment with a demand.
    pub(super) fn criterion(&mut self, demand: &HeldDemand) -> Result<f64, DesignError> {
        let models = 0..self.task.models.len();
        let values = models.map(|m| Ok(self.judged(demand, m)?.value)).collect::<Result<Vec<f64>, DesignError>>()?;
        Ok(match self.task.robustness {
            Robustness::Mean => values.iter().sum::<f64>() / values.len() as f64,
            Robustness::Worst => values.into_iter().fold(f64::NEG_INFINITY, f64::max),
        })
    }

    /// Returns how well one model's parameters would be known after an experiment with a demand, its images beyond half
    /// its rate included.
    pub(super) fn judged(&mut self, demand: &HeldDemand, model: usize) -> Result<Judged, DesignError> {
        let steps = demand.values.len();
        let spectrum = fft_real(&demand.values)?;
        let task = self.task;
        self.lines(steps)?;
        let lines = self.known.iter().find(|(n, _)| *n == steps).map_or(&[][..], |(_, lines)| lines.as_slice());
        let period_s = steps as f64 * task.hold_s;
        let power = |line: &Line| {
            let k = (line.frequency_hz * period_s).round() as usize % steps;
            let amplitude = 2.0 / steps as f64 * spectrum[k.min(steps - k)].norm();
            0.5 * amplitude * amplitude
        };
        let powers: Vec<f64> = lines.iter().map(power).collect();
        self.judges.after(task, model, lines, &powers)
    }
}

impl HeldDemand {
    /// Σ A cos(2πkt/P + φ) at the steps of a period.
    pub(super) fn of_lines(
        steps: usize,
        harmonics: &[usize],
        amplitudes: &[f64],
        phases_rad: &[f64],
    ) -> Result<Self, DesignError> {
        let mut spectrum = vec![Complex64::ZERO; steps / 2 + 1];
        for ((harmonic, amplitude), phase) in harmonics.iter().zip(amplitudes).zip(phases_rad) {
            spectrum[*harmonic] = Complex64::from_polar(0.5 * steps as f64 * amplitude, *phase);
        }
        Ok(HeldDemand { values: signal::spectrum::inverse_fft_real(spectrum, steps)? })
    }

    /// The largest deviations from rest under any model of a task, over `repeats` periods from rest.
    pub(super) fn peaks(&self, task: &DesignTask, repeats: usize) -> Result<Peaks, DesignError> {
        let mut all = Peaks::default();
        for model in &task.models {
            all = all.or_larger(self.peaks_on(task, model, repeats)?);
        }
        Ok(all)
    }

    /// The same under one model.
    pub(super) fn peaks_on(&self, task: &DesignTask, model: &BenchModel, repeats: usize) -> Result<Peaks, DesignError> {
        let Deviations { response, .. } = self.simulated(task, model, repeats)?;
        let largest = |x: &[f64]| x.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
        let air_gap_nm = largest(&response.air_gap_torque_nm);
        Ok(Peaks {
            shaft_torque_nm: largest(&response.shaft_torque_nm),
            air_gap_torque_nm: match task.excited {
                ExcitedDemand::Torque => air_gap_nm,
                ExcitedDemand::Speed => air_gap_nm.max(largest(&response.torque_demand_nm)),
            },
            speed_rad_s: largest(&response.dyno_speed_rad_s),
            demand: largest(&self.values),
        })
    }

    /// The step of the period at which the bench, once it swings periodically, passes nearest to rest: a start there
    /// disturbs least.
    pub(super) fn quietest_step(&self, task: &DesignTask, model: &BenchModel) -> Result<usize, DesignError> {
        let steps = self.values.len();
        let Deviations { response, samples_per_step } = self.simulated(task, model, 2)?;
        let second = |x: &[f64]| {
            let period = &x[x.len() - steps * samples_per_step..];
            let mean = period.iter().sum::<f64>() / period.len() as f64;
            let square = period.iter().map(|v| (v - mean).powi(2)).sum::<f64>().max(f64::MIN_POSITIVE);
            let at = |k: usize| (period[k * samples_per_step] - mean).powi(2) / square;
            (0..steps).map(at).collect::<Vec<f64>>()
        };
        let signals = [&response.shaft_torque_nm, &response.air_gap_torque_nm, &response.dyno_speed_rad_s];
        let signals = signals.map(|x| second(x));
        let unrest = |k: usize| signals.iter().map(|s| s[k]).sum::<f64>();
        Ok((0..steps).min_by(|a, b| unrest(*a).total_cmp(&unrest(*b))).unwrap_or(0))
    }

    /// The same period from another step on.
    pub(super) fn started_at(mut self, step: usize) -> Self {
        self.values.rotate_left(step);
        self
    }

    pub(super) fn scaled(mut self, factor: f64) -> Self {
        self.values.iter_mut().for_each(|v| *v *= factor);
        self
    }

    fn simulated(&self, task: &DesignTask, model: &BenchModel, repeats: usize) -> Result<Deviations, DesignError> {
        let step_s = match (task.excited, &model.speed_controller) {
            (ExcitedDemand::Speed, Some(controller)) => controller.sample_time_s,
            _ => task.hold_s / (task.hold_s / LONGEST_STEP_S - 1e-9).ceil(),
        };
        let samples_per_step = (task.hold_s / step_s).round().max(1.0) as usize;
        if (samples_per_step as f64 * step_s - task.hold_s).abs() > 1e-6 * task.hold_s {
            return Err(DesignError::Task {
                requirement: "the demand must be held for whole updates of the controller",
            });
        }
        let held = self.values.iter().flat_map(|v| std::iter::repeat_n(*v, samples_per_step));
        let one: Vec<f64> = held.collect();
        let mut all: Vec<f64> = std::iter::repeat_n(&one, repeats).flatten().copied().collect();
        // An experiment starts at its mean, where the bench has settled.
        all.iter_mut().take(samples_per_step).for_each(|first| *first = 0.0);
        // Deviations are linear in the demand as long as the torque control is not at its limit, which is not for the
        // design.
        let unlimited = BenchModel { torque_limit_nm: None, ..model.clone() };
        let dyno = match task.excited {
            ExcitedDemand::Torque => DynoInput::TorqueDemand(&all),
            ExcitedDemand::Speed => DynoInput::SpeedDemand(&all),
        };
        let engine = vec![0.0; all.len()];
        let inputs = Inputs { sample_time_s: step_s, engine_torque_nm: &engine, dyno };
        let response = simulate(&unlimited, &inputs, &InitialState::steady(model, 0.0, 0.0))?;
        Ok(Deviations { response, samples_per_step })
    }
}

impl Peaks {
    fn in_order(&self) -> [f64; 4] {
        [self.shaft_torque_nm, self.air_gap_torque_nm, self.speed_rad_s, self.demand]
    }

    fn or_larger(self, other: Self) -> Self {
        Peaks {
            shaft_torque_nm: self.shaft_torque_nm.max(other.shaft_torque_nm),
            air_gap_torque_nm: self.air_gap_torque_nm.max(other.air_gap_torque_nm),
            speed_rad_s: self.speed_rad_s.max(other.speed_rad_s),
            demand: self.demand.max(other.demand),
        }
    }

    /// The largest peak over its limit, and which it is.
    pub(super) fn binding(&self, task: &DesignTask) -> (f64, LimitedQuantity) {
        let names = [
            LimitedQuantity::ShaftTorque,
            LimitedQuantity::AirGapTorque,
            LimitedQuantity::Speed,
            LimitedQuantity::Demand,
        ];
        let parts = self.in_order().into_iter().zip(task.limits.in_order()).zip(names);
        let parts = parts.filter_map(|((peak, limit), name)| Some((peak / limit?, name)));
        parts.fold((0.0, LimitedQuantity::ShaftTorque), |a, b| if b.0 > a.0 { b } else { a })
    }
}
