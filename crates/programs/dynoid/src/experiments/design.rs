//! Designed experiments: demands, a picture of them, and the prediction for the bench.

use std::collections::BTreeMap;

use bench_model::disturbances::Disturbances;
use bench_model::friction::DynoFriction;
use bench_model::prediction::{Peak, PeakOf, Prediction, PredictionInputs, peak_errors, predict};
use dataset::on_one_clock;
use ident::Intersample;
use page::Page;
use recording::{Channel, Format, Raster, Recording};
use report::design::{Designed, reached};
use report::wording;
use rig::bench_file::Limits;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan, NamedDemand};
use rig::facts::Engine;
use rig::role::Role;
use serde::Serialize;
use units::RPM_RAD_S;
use virtual_bench::{Assumption, CHANNELS};
use work::Context;

use super::optimal::{OptimalExcitation, OptimalFacts};
use super::planned::Planned;
use crate::error::{Error, NotPredicted};
use crate::formats::FileFormat;
use crate::known::KnownBench;

/// Prediction with its errors.
#[derive(Debug, Clone)]
pub struct PredictedRun {
    prediction: Prediction,
    /// Standard errors of the peaks; empty without a study.
    errors: Vec<f64>,
    resonance_hz: Option<f64>,
}

impl PredictedRun {
    /// The prediction.
    pub fn prediction(&self) -> &Prediction {
        &self.prediction
    }

    /// Limits that it reaches, in words.
    pub fn warnings(&self) -> Vec<String> {
        reached(&self.prediction).collect()
    }
}

/// An experiment that is ready to be run: its demands, and what the bench will do.
#[derive(Debug, Clone)]
pub struct DesignedExperiment {
    plan: ExperimentPlan,
    demands: Demands,
    optimal: Option<OptimalExcitation>,
    predicted: Result<PredictedRun, NotPredicted>,
    has_study: bool,
    engine: Engine,
    limits: Limits,
    assumptions: Vec<Assumption>,
    /// Names that the bench file gives to channels.
    names: BTreeMap<Role, String>,
}

impl DesignedExperiment {
    /// Makes the demands of a plan with this seed, and predicts them where the bench is known well enough.
    pub fn of(bench: &KnownBench, planned: Planned, seed: u64, context: &Context) -> Self {
        let Planned { plan, optimal, .. } = planned;
        let demands = Demands::of(&plan, seed, DEMAND_HOLD_S);
        let name = |(role, mapping): (&Role, &rig::channels::ChannelMapping)| (*role, mapping.name.clone());
        DesignedExperiment {
            predicted: predicted(bench, &plan, &demands, context),
            has_study: bench.assembled().is_some(),
            engine: bench.file().engine(),
            limits: bench.file().limits,
            assumptions: bench.virtual_bench().assumed_for(&plan),
            names: bench.file().channels.iter().map(name).collect(),
            plan,
            demands,
            optimal,
        }
    }

    /// The prediction, or why there is none.
    pub fn predicted(&self) -> Result<&PredictedRun, &NotPredicted> {
        self.predicted.as_ref()
    }

    /// The demands, each on its own clock.
    pub fn recording(&self) -> Recording {
        self.demands.recording(&self.plan)
    }

    /// The demands as text has them: on the clock of the fastest, the slower ones held, as they are on the bench.
    ///
    /// # Errors
    /// Demands that cannot be brought onto one clock.
    pub fn table(&self) -> Result<Recording, Error> {
        let demands = self.recording();
        let step_s = |raster: &Raster| Some(raster.time_s.get(1)? - raster.time_s.first()?);
        let mut table = match demands.rasters.iter().filter_map(step_s).reduce(f64::min) {
            Some(step_s) if demands.rasters.len() > 1 => {
                on_one_clock("demands", demands, step_s, Intersample::ZeroOrderHold)?.recording
            }
            _ => demands,
        };
        // Text has one time column, and no place for the names of rasters; nothing of the demands is lost.
        FileFormat::Csv.fit(&mut table);
        Ok(table)
    }

    /// Predicted responses of the bench; none where nothing is predicted.
    pub fn responses(&self) -> Option<Recording> {
        let prediction = &self.predicted.as_ref().ok()?.prediction;
        let response = &prediction.response;
        let name = |role: Role| {
            let usual = CHANNELS.iter().find(|(other, _)| *other == role).map_or(role.key(), |(_, name)| name);
            format!("{}_predicted", self.names.get(&role).map_or(usual, String::as_str))
        };
        let channel = |name: String, unit: &str, si: f64, values: &[f64]| Channel {
            name,
            unit: unit.to_owned(),
            comment: String::new(),
            raster: 0,
            samples: values.iter().map(|value| value / si).collect(),
        };
        let mut channels = vec![
            channel(name(Role::DynoSpeed), "rpm", RPM_RAD_S, &response.dyno_speed_rad_s),
            channel(name(Role::DynoTorqueDemand), "Nm", 1.0, &response.torque_demand_nm),
            channel(name(Role::AirGapTorque), "Nm", 1.0, &response.air_gap_torque_nm),
        ];
        if prediction.has_shaft {
            channels.push(channel(name(Role::EngineSpeed), "rpm", RPM_RAD_S, &response.engine_speed_rad_s));
            channels.push(channel("ShaftTorque_predicted".to_owned(), "Nm", 1.0, &response.shaft_torque_nm));
        }
        let samples = response.dyno_speed_rad_s.len();
        let time_s = (0..samples).map(|k| k as f64 * prediction.sample_time_s).collect();
        Some(Recording {
            format: Format::Mdf { version: 410 },
            comment: Some(format!("{}, predicted by the bench model", self.plan.label)),
            start_time: None,
            rasters: vec![Raster { time_s, name: None }],
            channels,
            findings: Vec::new(),
        })
    }

    /// The experiment as a page.
    pub fn page(&self) -> Page {
        let known = self.predicted.as_ref().ok();
        let spectrum = self.demands.spectrum(&self.plan).ok().flatten();
        report::design::page(&Designed {
            plan: &self.plan,
            demands: &self.demands,
            spectrum: spectrum.as_ref(),
            engine: self.engine,
            resonance_hz: known.and_then(|known| known.resonance_hz),
            prediction: known.map(|known| &known.prediction),
            limits: self.limits,
            errors: known.map_or(&[], |known| &known.errors),
            assumptions: &self.assumptions,
            optimal: self.optimal.as_ref().map(OptimalExcitation::shown),
        })
    }

    /// The experiment in numbers.
    pub fn facts(&self) -> DesignFacts<'_> {
        let prediction = self.predicted.as_ref().ok().map(|found| PredictionFacts {
            from: if self.has_study { "study" } else { "bench file" },
            resonance_hz: found.resonance_hz,
            assumptions: &self.assumptions,
            peaks: found.prediction.peaks.iter().enumerate().map(|one| PeakFacts::of(one, &found.errors)).collect(),
        });
        DesignFacts {
            label: self.plan.label.to_string(),
            duration_s: self.plan.duration_s,
            demands: self.demands.named(&self.plan).iter().map(DemandFacts::of).collect(),
            prediction,
            optimal: self.optimal.as_ref().map(OptimalExcitation::facts),
        }
    }
}

/// The prediction, or why there is none.
fn predicted(
    bench: &KnownBench,
    plan: &ExperimentPlan,
    demands: &Demands,
    context: &Context,
) -> Result<PredictedRun, NotPredicted> {
    let model = bench.model_for(plan)?;
    let inputs = PredictionInputs {
        plan,
        demands,
        model: &model,
        engine: &bench.virtual_bench().parameters.engine,
        firing_seed: None,
        friction: DynoFriction::default(),
        disturbances: Disturbances::default(),
        limits: bench.file().limits,
    };
    let _step = context.step("predicting", 0);
    let prediction = predict(&inputs)?;
    let errors = bench.assembled().map(|assembled| peak_errors(&inputs, &assembled.uncertainty));
    let resonance_hz = plan.has_shaft.then(|| model.mechanics.resonance().frequency_hz);
    Ok(PredictedRun { prediction, errors: errors.unwrap_or_default(), resonance_hz })
}

/// Numbers of [`DesignedExperiment`].
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DesignFacts<'a> {
    label: String,
    duration_s: f64,
    demands: Vec<DemandFacts>,
    prediction: Option<PredictionFacts<'a>>,
    optimal: Option<OptimalFacts>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct DemandFacts {
    name: &'static str,
    unit: &'static str,
    lowest: f64,
    highest: f64,
}

impl DemandFacts {
    fn of(demand: &NamedDemand<'_>) -> Self {
        let si = demand.kind.si_per_unit();
        let range = demand.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        let (lowest, highest) = (range.0 / si, range.1 / si);
        DemandFacts { name: demand.kind.name(), unit: demand.kind.unit(), lowest, highest }
    }
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct PredictionFacts<'a> {
    from: &'static str,
    resonance_hz: Option<f64>,
    assumptions: &'a [Assumption],
    peaks: Vec<PeakFacts>,
}

#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
struct PeakFacts {
    of: PeakOf,
    symbol: &'static str,
    unit: &'static str,
    value: f64,
    time_s: f64,
    standard_error: Option<f64>,
    limit: Option<f64>,
    is_beyond_limit: bool,
}

impl PeakFacts {
    fn of((index, peak): (usize, &Peak), errors: &[f64]) -> Self {
        let (symbol, unit, si) = wording::peak(peak.of);
        PeakFacts {
            of: peak.of,
            symbol,
            unit,
            value: peak.value / si,
            time_s: peak.time_s,
            standard_error: errors.get(index).map(|error| error / si),
            limit: peak.limit.map(|limit| limit / si),
            is_beyond_limit: peak.is_beyond_limit(),
        }
    }
}
