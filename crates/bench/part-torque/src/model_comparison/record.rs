//! A recording as the models of the torque control meet it.

use std::ops::Range;
use std::sync::Arc;

use ident::{Dataset, IdentError};
use rig::estimation::{EstimateError, liveliest_part, need};
use rig::results::{Stretch, Trace};
use rig::{Experiment, ExperimentLabel, Role};

use crate::TorqueControls;
use crate::model_comparison::excited::Excited;
use crate::model_comparison::orders::Input;
use crate::torque_control::{self, HeldDemand, SecondOrder, SecondOrderTest, TorqueControlFit, usable_samples};

/// Parts of a recording that models are estimated from, and chosen by; the rest is held out.
const SHARES: [f64; 2] = [0.5, 0.7];
/// How much of the held-out part is drawn, s.
const SHOWN_S: f64 = 0.5;
/// A sample of T_d,calc taken as the demand changes meets the new demand, for all that its stamp is rounded, in parts
/// of the demand's sample.
const ROUNDING: f64 = 1e-6;

/// T_d* and T_d,calc of one recording at the samples of T_d,calc, without means and ripple.
pub(super) struct Record {
    pub(super) excited: Excited,
    pub(super) file: String,
    pub(super) label: ExperimentLabel,
    pub(super) sample_time_s: f64,
    pub(super) control: Arc<TorqueControlFit>,
    /// None without a lag, or where no fit is found.
    pub(super) second_order: Option<SecondOrderTest>,
    pub(super) held: HeldDemand,
    pub(super) times_s: Vec<f64>,
    /// T_d* as it stands at the samples of T_d,calc, Nm.
    pub(super) demand: Vec<f64>,
    /// T_d,calc, Nm.
    pub(super) torque: Vec<f64>,
    usable: Vec<bool>,
}

impl Record {
    /// Fits delay and lag with the ripple, and takes the ripple out.
    pub(super) fn new(
        experiment: &Experiment,
        excited: Excited,
        controls: &TorqueControls<'_>,
        limit_nm: Option<f64>,
    ) -> Result<Self, EstimateError> {
        let control = controls.fit_unseparated(experiment)?;
        // The part that the fit is from.
        let experiment = &*liveliest_part(experiment, Role::DynoTorqueDemand);
        let demand = need(experiment, Role::DynoTorqueDemand)?;
        let torque = need(experiment, Role::AirGapTorque)?;
        let held = HeldDemand::new(demand, limit_nm);
        let times_s: Vec<f64> = (0..torque.len()).map(|i| torque.time_s(i)).collect();
        let late = ROUNDING * demand.sample_time_s;
        let smooth = |(t, y): (&f64, &f64)| control.model.without_ripple(*y, *t);
        let tested = || torque_control::second_order(experiment, &control, limit_nm).ok();
        let second_order = if control.has_lag() { tested() } else { None };
        let mut record = Record {
            excited,
            file: experiment.file.clone(),
            label: experiment.label.clone(),
            sample_time_s: torque.sample_time_s,
            demand: times_s.iter().map(|t| held.at(t + late)).collect(),
            torque: times_s.iter().zip(&torque.samples).map(smooth).collect(),
            usable: usable_samples(demand, torque, limit_nm),
            held,
            times_s,
            second_order,
            control,
        };
        let (demand_nm, torque_nm) = (record.mean(&record.demand), record.mean(&record.torque));
        record.demand.iter_mut().for_each(|u| *u -= demand_nm);
        record.torque.iter_mut().for_each(|y| *y -= torque_nm);
        Ok(record)
    }

    fn at(&self, share: f64) -> usize {
        (share * self.torque.len() as f64) as usize
    }

    /// Samples that all orders are estimated from.
    pub(super) fn first(&self) -> Range<usize> {
        0..self.at(SHARES[0])
    }

    /// Samples that they are chosen by.
    pub(super) fn second(&self) -> Range<usize> {
        self.at(SHARES[0])..self.at(SHARES[1])
    }

    /// Samples that the chosen are estimated from.
    pub(super) fn estimation(&self) -> Range<usize> {
        0..self.at(SHARES[1])
    }

    /// Samples that they are judged by.
    pub(super) fn held_out(&self) -> Range<usize> {
        self.at(SHARES[1])..self.torque.len()
    }

    /// The first of the held-out part of a series, to be drawn.
    pub(super) fn beginning(&self, values: &[f64]) -> Trace {
        let start = self.held_out().start;
        let end = (start + (SHOWN_S / self.sample_time_s) as usize).min(values.len());
        Trace {
            start_s: self.times_s.get(start).copied().unwrap_or(f64::NAN),
            sample_time_s: self.sample_time_s,
            values: values.get(start..end).map(<[f64]>::to_vec).unwrap_or_default(),
        }
    }

    pub(super) fn stretch(&self, range: Range<usize>) -> Stretch {
        let at = |i: usize| self.times_s.get(i).copied().unwrap_or(f64::NAN);
        Stretch { file: self.file.clone(), start_s: at(range.start), end_s: at(range.end.saturating_sub(1)) }
    }

    /// Mean over the usable samples of the estimation part.
    fn mean(&self, values: &[f64]) -> f64 {
        let used: Vec<f64> = self.usable_in(self.estimation()).map(|i| values[i]).collect();
        used.iter().sum::<f64>() / used.len().max(1) as f64
    }

    fn usable_in(&self, range: Range<usize>) -> impl Iterator<Item = usize> + '_ {
        range.filter(|i| self.usable[*i])
    }

    /// Input of a model: T_d*, or T_d* − T_d as measured.
    pub(super) fn input(&self, input: Input) -> Vec<f64> {
        match input {
            Input::Demand => self.demand.clone(),
            Input::Error => self.demand.iter().zip(&self.torque).map(|(u, y)| u - y).collect(),
        }
    }

    /// Data of a stretch; T_d,calc counts as missing where it cannot be used.
    pub(super) fn data(&self, input: Input, range: Range<usize>) -> Result<Dataset, IdentError> {
        let driving = self.input(input);
        let torque: Vec<f64> = range.clone().map(|i| if self.usable[i] { self.torque[i] } else { f64::NAN }).collect();
        Dataset::siso(self.sample_time_s, &driving[range], &torque)
    }

    /// Response T_d of a model, with its offset taken from the estimation part, as every model has one, Nm.
    pub(super) fn with_offset(&self, modelled: &[f64]) -> Vec<f64> {
        let left: Vec<f64> = self.torque.iter().zip(modelled).map(|(measured, modelled)| measured - modelled).collect();
        let offset = self.mean(&left);
        modelled.iter().map(|modelled| modelled + offset).collect()
    }

    /// Errors of a model of T_d over a stretch, Nm.
    pub(super) fn errors(&self, modelled: &[f64], range: Range<usize>) -> Vec<f64> {
        let modelled = self.with_offset(modelled);
        self.usable_in(range).map(|i| self.torque[i] - modelled[i]).collect()
    }

    /// Root of the mean squared T_d about its mean in a stretch, Nm.
    pub(super) fn spread_nm(&self, range: Range<usize>) -> f64 {
        let used: Vec<f64> = self.usable_in(range).map(|i| self.torque[i]).collect();
        let mean = used.iter().sum::<f64>() / used.len().max(1) as f64;
        rms(&used.iter().map(|y| y - mean).collect::<Vec<_>>())
    }

    /// T_d* one sample of T_d,calc ago: the bar.
    pub(super) fn one_sample_late(&self) -> Vec<f64> {
        let before = std::iter::once(self.demand.first().copied().unwrap_or(0.0));
        before.chain(self.demand.iter().copied()).take(self.demand.len()).collect()
    }

    /// T_d* a time ago, as it was between its samples.
    pub(super) fn delayed(&self, delay_s: f64) -> Vec<f64> {
        self.times_s.iter().map(|t| self.held.at(t - delay_s)).collect()
    }

    /// T_d* through a delay and a lag, exact between the samples.
    pub(super) fn lagged(&self, delay_s: f64, lag_rad_s: f64) -> Vec<f64> {
        SecondOrder { delay_s, lag_rad_s, term: 0.0 }.torque_at(&self.held, &self.times_s)
    }
}

/// Root mean square.
pub(super) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
