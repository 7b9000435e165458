//! Delays of the torque signals against the torque demand and against the bend in N_d (thesis §5.3, Table 5.1).

mod filter;
mod load_cell;
mod routes;

use std::ops::RangeInclusive;

use ident::distributions::interval;
use rig::estimation::{EstimateError, timing_floor_s};
use rig::results::{DelayRoute, Parameter, Quantity, SignalDelay, Timing};
use rig::{ControlMode, Experiment, Finding, Role};
use signal::derivative::central_difference;
use signal::{Signal, SignalError};

pub use self::filter::{Difference, Filter, FilterCandidate, ShaftFilter};
use self::load_cell::LoadCell;
use self::routes::{Curvature, Measured, correlation_peak, on_one_raster, phase_slope};
use crate::torque_control::{self, TorqueControlFit, stretch_of, usable_signal};

/// Band of the phase slope of signals that follow T_d itself, Hz.
const FOLLOWING_HZ: RangeInclusive<f64> = 0.5..=20.0;
/// Band in which a torque flange is compared with T_d + J_d dω_d/dt, Hz.
const FLANGE_HZ: RangeInclusive<f64> = 1.0..=40.0;
/// Band in which the dynamometer's own inertia takes nearly all of T_d, Hz.
const INERTIA_HZ: RangeInclusive<f64> = 50.0..=90.0;
/// A delay less certain than this, s, is not known.
const KNOWN_S: f64 = 2e-3;
/// Possible error of the phase slope: it takes lag and ringing for delay in its own way, s.
const PHASE_SLOPE_OFF_S: f64 = 3e-4;
/// Possible error of the correlation peak: it does so too, in another way, s.
const PEAK_OFF_S: f64 = 1.5e-3;
/// Level of the routes' intervals.
const LEVEL: f64 = 0.95;
/// Below this mean coherence the phase against the bend says nothing.
const COHERENT: f64 = 0.8;

/// Estimates the delay of T_d,calc, T_d,meas, T_d,shaft,calc and the torque flange, as far as recorded.
///
/// The experiment is WhiteNoise_T_TN, else Step_T_TN, else BS_T_NT. Routes against T_d*, held between its samples:
/// - *parametric*: τ + 1/a of `torque_control` for T_d,calc, and for T_d,meas the load cell behind it
///   (τ + 1/a + τ_cell + 2ζ/ω_n); needs `torque_control`;
/// - *phase slope*: of the cross-spectrum with T_d*, weighted by coherence, less half a sample for the hold;
/// - *correlation peak*: to a fraction of a sample, less half a sample for the hold.
///
/// `against_demand` is the first of these that applies; the peak stays a route. Shaft torques follow T_d* through the
/// whole driveline, which is no delay: they have none of these. Against the bend in N_d, where coherence allows (an
/// open loop, TN, and a demand that reaches so high): T_d,calc by the phase of −J_d dω_d/dt against the modelled T_d at
/// 50…90 Hz, where inertia dominates (negative: N_d, a mean over its gate, comes later than T_d); T_d,meas from there
/// by its own delay; T_d,shaft,calc by the moving average found in it, (N − 1)/2 samples of N_d; the flange by its
/// phase against T_d + J_d dω_d/dt.
///
/// Delays in s, positive when later; `dynamometer_inertia_kg_m2` is J_d.
///
/// # Errors
/// No experiment of these kinds, no T_d*, or signals too short or not finite.
///
/// # Source
/// Glans & Kärnell 2018, §5.3; Ljung 1999, §6.4 (cross-spectra).
pub fn estimate(
    experiments: &[&Experiment],
    torque_control: Option<&TorqueControlFit>,
    dynamometer_inertia_kg_m2: f64,
) -> Result<Timing, EstimateError> {
    let experiment = torque_control::choose(experiments).ok_or_else(|| EstimateError::MissingSignal {
        file: experiments.first().map_or_else(String::new, |e| e.file.clone()),
        role: Role::DynoTorqueDemand,
    })?;
    let demand = usable_signal(experiment, Role::DynoTorqueDemand)?;
    let bench = Bench { experiment, demand, torque_control, inertia_kg_m2: dynamometer_inertia_kg_m2 };
    let present = Role::TORQUES.into_iter().filter(|role| experiment.signal(*role).is_some());
    Ok(Timing { delays: present.map(|role| bench.delay_of(role)).collect::<Result<_, _>>()? })
}

/// Data that every delay is measured with.
struct Bench<'a> {
    experiment: &'a Experiment,
    demand: &'a Signal,
    torque_control: Option<&'a TorqueControlFit>,
    inertia_kg_m2: f64,
}

impl Bench<'_> {
    fn delay_of(&self, role: Role) -> Result<SignalDelay, EstimateError> {
        let signal = usable_signal(self.experiment, role)?;
        let failed = |source: SignalError| EstimateError::Signal { file: self.experiment.file.clone(), source };
        let cell = if role == Role::LoadCellTorque { self.load_cell(signal) } else { None };
        let average = if role == Role::SystemShaftTorque { shaft_filter(self.experiment) } else { None };
        let parametric = match role {
            Role::AirGapTorque => self.total_delay(),
            _ => cell.as_ref().map(|c| c.total.clone()),
        };
        let (slope, peak) = self.model_free(role, signal).map_err(failed)?;
        let of_model = parametric.as_ref().map(|p| DelayRoute {
            name: "parametric".to_owned(),
            delay_s: p.value,
            interval_s: Some(p.interval),
            systematic_s: 0.0,
        });
        let free = [("phase slope", slope, PHASE_SLOPE_OFF_S), ("correlation peak", peak, PEAK_OFF_S)];
        let free = free.into_iter().filter_map(|(name, measured, off)| Some(route(name, measured?, off)));
        Ok(SignalDelay {
            role,
            against_demand: parametric
                .or_else(|| slope.map(|m| parameter(Quantity::DelayAgainstDemand, m.off_by(PHASE_SLOPE_OFF_S)))),
            against_speed_bend: self.against_bend(role, cell.as_ref(), average.as_ref()),
            routes: of_model.into_iter().chain(free).collect(),
            moving_average_length: average.as_ref().and_then(ShaftFilter::moving_average_length),
            dynamics: cell.map(|c| c.dynamics),
            stretch: stretch_of(self.experiment, signal, 0..signal.len()),
        })
    }

    /// The torque control, where its estimate lies at a minimum inside its bounds that the data show.
    fn settled_torque_control(&self) -> Option<&TorqueControlFit> {
        let settled = |fit: &&TorqueControlFit| {
            let total = fit.result.delay_and_lag.parameters.get(2);
            total.is_some_and(|total| total.standard_error < KNOWN_S)
                && !fit.diagnostics.iter().any(|d| matches!(d.finding, Finding::NotConverged { .. }))
        };
        self.torque_control.filter(settled)
    }

    fn total_delay(&self) -> Option<Parameter> {
        self.settled_torque_control()?.result.delay_and_lag.parameters.get(2).cloned()
    }

    fn load_cell(&self, cell: &Signal) -> Option<LoadCell> {
        let fit = self.settled_torque_control()?;
        let covariance = &fit.result.delay_and_lag.covariance;
        let entry = |i: usize, j: usize| covariance.get(i)?.get(j).copied();
        let known = [[entry(0, 0)?, entry(0, 1)?], [entry(1, 0)?, entry(1, 1)?]];
        let stretch = stretch_of(self.experiment, cell, 0..cell.len());
        let found = load_cell::fit(self.demand, cell, &fit.model, known, &stretch).ok()?;
        found.usable.then_some(found)
    }

    /// Phase slope and correlation peak against the held demand.
    fn model_free(&self, role: Role, signal: &Signal) -> Result<(Option<Measured>, Option<Measured>), SignalError> {
        if !matches!(role, Role::AirGapTorque | Role::LoadCellTorque) {
            return Ok((None, None));
        }
        let hold_s = 0.5 * self.demand.sample_time_s;
        let (demand, moved) = on_one_raster(self.demand, signal)?;
        // The samples lead the held demand by half a sample, which is not the signal's delay.
        let slope = phase_slope(&demand, &moved, FOLLOWING_HZ.into_inner(), Curvature::Cubic)?;
        let slope = slope.map(|m| Measured { delay_s: m.delay_s - hold_s, ..m });
        let peak = correlation_peak(&demand, &moved)?.map(|m| Measured { delay_s: m.delay_s - hold_s, ..m });
        Ok((slope, peak))
    }

    fn against_bend(&self, role: Role, cell: Option<&LoadCell>, average: Option<&ShaftFilter>) -> Option<Parameter> {
        let measured = match role {
            Role::AirGapTorque => self.air_gap_against_bend(),
            Role::LoadCellTorque => self.load_cell_against_bend(cell?),
            Role::SystemShaftTorque => self.average_against_bend(average?),
            _ => self.flange_against_bend(role),
        };
        let dated_s = timing_floor_s(self.demand.sample_time_s);
        let dated = |m: Measured| Measured { standard_error_s: m.standard_error_s.hypot(dated_s), ..m };
        measured.map(|m| parameter(Quantity::DelayAgainstSpeedBend, dated(m)))
    }

    /// J_d dω_d/dt on the raster of N_d.
    fn acceleration_torque(&self) -> Option<Signal> {
        let speed = self.experiment.signal(Role::DynoSpeed)?;
        let slope = central_difference(&speed.samples, speed.sample_time_s).ok()?;
        Some(speed.with_samples(slope.iter().map(|s| self.inertia_kg_m2 * s).collect()))
    }

    /// How much later T_d is than −J_d dω_d/dt at high frequency.
    fn air_gap_against_bend(&self) -> Option<Measured> {
        if self.experiment.label.mode != ControlMode::Tn {
            return None;
        }
        let torque = self.torque_control?.model.air_gap_torque(self.demand);
        let bend = self.acceleration_torque()?.map(|v| -v);
        let (torque, bend) = on_one_raster(&torque, &bend).ok()?;
        let later = phase_slope(&torque, &bend, INERTIA_HZ.into_inner(), Curvature::Hyperbolic).ok().flatten()?;
        (later.coherence >= COHERENT).then_some(Measured { delay_s: -later.delay_s, ..later })
    }

    fn load_cell_against_bend(&self, cell: &LoadCell) -> Option<Measured> {
        let air_gap = self.air_gap_against_bend()?;
        let (late, early) = (&cell.total, self.total_delay()?);
        let error = late.standard_error.hypot(early.standard_error);
        Some(Measured {
            delay_s: air_gap.delay_s + late.value - early.value,
            standard_error_s: air_gap.standard_error_s.hypot(error),
            ..air_gap
        })
    }

    /// The length is a whole number: the standard error is that of a rounded sample.
    fn average_against_bend(&self, average: &ShaftFilter) -> Option<Measured> {
        let step_s = self.experiment.signal(Role::DynoSpeed)?.sample_time_s;
        Some(Measured {
            delay_s: average.best.delay_s,
            standard_error_s: step_s / 12f64.sqrt(),
            degrees_of_freedom: f64::INFINITY,
            coherence: 1.0,
        })
    }

    /// How much later the flange is than T_d + J_d dω_d/dt.
    fn flange_against_bend(&self, role: Role) -> Option<Measured> {
        let torque = self.torque_control?.model.air_gap_torque(self.demand);
        let (mut shaft, torque) = on_one_raster(&self.acceleration_torque()?, &torque).ok()?;
        shaft.samples.iter_mut().zip(&torque.samples).for_each(|(s, t)| *s += t);
        let (shaft, flange) = on_one_raster(&shaft, self.experiment.signal(role)?).ok()?;
        let later = phase_slope(&shaft, &flange, FLANGE_HZ.into_inner(), Curvature::Cubic).ok().flatten()?;
        (later.coherence >= COHERENT).then_some(later)
    }
}

/// The filter inside T_d,shaft,calc; none where it, N_d or T_d,calc was not recorded, or nothing explains it.
#[must_use]
pub fn shaft_filter(experiment: &Experiment) -> Option<ShaftFilter> {
    let signal = |role| experiment.signal(role);
    let (speed, torque) = (signal(Role::DynoSpeed)?, signal(Role::AirGapTorque)?);
    filter::detect(speed, torque, signal(Role::SystemShaftTorque)?).ok().flatten()
}

fn route(name: &str, m: Measured, systematic_s: f64) -> DelayRoute {
    let bounds = interval(m.delay_s, m.standard_error_s, m.degrees_of_freedom, LEVEL);
    DelayRoute {
        name: name.to_owned(),
        delay_s: m.delay_s,
        interval_s: m.standard_error_s.is_finite().then_some(bounds),
        systematic_s,
    }
}

fn parameter(quantity: Quantity, m: Measured) -> Parameter {
    Parameter::new(quantity, m.delay_s, m.standard_error_s, m.degrees_of_freedom)
}
