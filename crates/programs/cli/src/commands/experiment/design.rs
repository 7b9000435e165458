//! `dynoid experiment design`: demands, a picture of them, and what the bench will do.

use std::path::PathBuf;

use bench_model::disturbances::Disturbances;
use bench_model::friction::DynoFriction;
use bench_model::prediction::{Peak, Prediction, PredictionInputs, peak_errors, predict};
use dataset::on_one_clock;
use dynoid::{Error, FileFormat, Files, Mark, OutputFolder, Staging, check_replaceable};
use ident::Intersample;
use recording::{Channel, Format, Raster, Recording};
use report::design::{Designed, reached};
use report::wording;
use rig::experiment::{DEMAND_HOLD_S, Demands, ExperimentPlan};
use rig::role::Role;
use serde_json::json;
use units::RPM_RAD_S;
use virtual_bench::CHANNELS;

use super::optimal::{self, Optimal};
use super::planned::{self, Planned};
use super::stated::Bench;
use crate::cli::experiment::DesignArguments;
use crate::commands::result::{check_plot, stage_page};
use crate::error::{CliError, Outcome};
use crate::summary::shown;
use crate::terminal::Terminal;

/// Prediction with its errors.
struct Predicted {
    prediction: Prediction,
    /// Standard errors of the peaks; empty without a study.
    errors: Vec<f64>,
    resonance_hz: Option<f64>,
}

pub(crate) fn run(arguments: &DesignArguments, terminal: &mut Terminal) -> Result<Outcome, CliError> {
    let bench = Bench::read(&arguments.on.bench, arguments.on.plan.study.as_deref(), terminal)?;
    let (Planned { plan, speed_rpm }, optimal) = match &arguments.experiment {
        Some(experiment) => (planned::plan(experiment, &arguments.on.plan, terminal)?, None),
        None => optimal::plan(arguments, &bench, terminal).map(|(planned, optimal)| (planned, Some(optimal)))?,
    };
    let demands = Demands::of(&plan, arguments.on.plan.seed(), DEMAND_HOLD_S);
    let speed_rpm = speed_rpm.unwrap_or(demands.speed_rad_s[0] / RPM_RAD_S);
    let suffix = optimal.as_ref().map(Optimal::suffix).unwrap_or_default();
    let stem = format!("{}_{speed_rpm:.0}{suffix}", plan.label);
    let targets = Targets::new(arguments, &stem, &terminal.files())?;
    let doubts = planned::doubts(&plan, &bench.file);
    doubts.iter().for_each(|doubt| terminal.warning(doubt));
    let predicted = predicted(&bench, &plan, &demands, terminal);
    let mut staging = targets.stage(&bench, &plan, &demands, predicted.as_ref().ok(), &terminal.files())?;
    if let Ok(predicted) = &predicted {
        reached(&predicted.prediction).for_each(|warning| terminal.warning(&warning));
    }
    if let Err(reason) = &predicted {
        terminal.warning(&format!("nothing is predicted: {reason}"));
    }
    let known = predicted.as_ref().ok();
    let spectrum = demands.spectrum(&plan).ok().flatten();
    let page = report::design::page(&Designed {
        plan: &plan,
        demands: &demands,
        spectrum: spectrum.as_ref(),
        engine: bench.file.engine(),
        resonance_hz: known.and_then(|known| known.resonance_hz),
        prediction: known.map(|known| &known.prediction),
        limits: bench.file.limits,
        errors: known.map_or(&[], |known| &known.errors),
        assumptions: &bench.stated.assumed_for(&plan),
        optimal: optimal.as_ref().map(Optimal::shown),
    });
    stage_page(&targets.plot, &page, &mut staging, terminal)?;
    staging.finish()?;
    if arguments.on.result.json {
        let mut facts = facts(&bench, &plan, &demands, &targets, &predicted, &doubts);
        facts["optimal"] = json!(optimal.as_ref().map(Optimal::facts));
        terminal.json(&facts)?;
    } else if !terminal.is_quiet() {
        terminal.page(&page);
        let written = targets.all(predicted.is_ok()).into_iter();
        written.for_each(|path| terminal.line(&format!("written: {}", shown(path))));
    }
    Ok(Outcome::Done)
}

/// The files that are written.
struct Targets {
    csv: PathBuf,
    mf4: PathBuf,
    plot: PathBuf,
    predicted: PathBuf,
}

impl Targets {
    fn new(arguments: &DesignArguments, stem: &str, files: &Files) -> Result<Self, CliError> {
        let folder = &arguments.out;
        OutputFolder::check(folder, files)?;
        let file = |ending: &str| folder.join(format!("{stem}{ending}"));
        let plot = arguments.on.result.plot.clone().unwrap_or_else(|| file(".html"));
        let targets = Targets { csv: file(".csv"), mf4: file(".mf4"), plot, predicted: file("_predicted.mf4") };
        check_plot(&arguments.on.result, files)?;
        targets
            .all(true)
            .into_iter()
            .try_for_each(|target| check_replaceable(target, Some(&Mark::of_run(files)), files))?;
        Ok(targets)
    }

    /// Writes all but the picture, to get their names together with it.
    fn stage(
        &self,
        bench: &Bench,
        plan: &ExperimentPlan,
        demands: &Demands,
        predicted: Option<&Predicted>,
        files: &Files,
    ) -> Result<Staging, CliError> {
        if let Some(folder) = self.csv.parent() {
            std::fs::create_dir_all(folder).map_err(|source| Error::write(folder, source))?;
        }
        let recording = demands.recording(plan);
        // Text has one time column, and no place for the names of rasters; nothing of the demands is lost.
        let mut text = on_fastest_clock(recording.clone())?;
        FileFormat::Csv.fit(&mut text);
        let mut staging = Staging::of(files);
        FileFormat::Csv.stage(&text, &self.csv, &mut staging)?;
        FileFormat::Mf4.stage(&recording, &self.mf4, &mut staging)?;
        if let Some(predicted) = predicted {
            let responses = responses(bench, plan, &predicted.prediction);
            FileFormat::Mf4.stage(&responses, &self.predicted, &mut staging)?;
        }
        Ok(staging)
    }

    fn all(&self, has_prediction: bool) -> Vec<&PathBuf> {
        let predicted = has_prediction.then_some(&self.predicted);
        [Some(&self.csv), Some(&self.mf4), Some(&self.plot), predicted].into_iter().flatten().collect()
    }
}

/// All demands on the clock of the fastest; the slower ones are held, as they are on the bench.
fn on_fastest_clock(demands: Recording) -> Result<Recording, CliError> {
    let step_s = |raster: &Raster| Some(raster.time_s.get(1)? - raster.time_s.first()?);
    match demands.rasters.iter().filter_map(step_s).reduce(f64::min) {
        Some(step_s) if demands.rasters.len() > 1 => {
            Ok(on_one_clock("demands", demands, step_s, Intersample::ZeroOrderHold)?.recording)
        }
        _ => Ok(demands),
    }
}

/// The prediction, or in words why there is none.
fn predicted(
    bench: &Bench,
    plan: &ExperimentPlan,
    demands: &Demands,
    terminal: &Terminal,
) -> Result<Predicted, String> {
    let model = bench.model_for(plan).map_err(|reason| format!("{reason}; the demands were written"))?;
    let inputs = PredictionInputs {
        plan,
        demands,
        model: &model,
        engine: &bench.stated.parameters.engine,
        firing_seed: None,
        friction: DynoFriction::default(),
        disturbances: Disturbances::default(),
        limits: bench.file.limits,
    };
    let _step = terminal.work().step("predicting", 0);
    let prediction = predict(&inputs).map_err(|error| error.to_string())?;
    let errors = bench.assembled.as_ref().map(|assembled| peak_errors(&inputs, &assembled.uncertainty));
    let resonance_hz = plan.has_shaft.then(|| model.mechanics.resonance().frequency_hz);
    Ok(Predicted { prediction, errors: errors.unwrap_or_default(), resonance_hz })
}

/// Predicted responses of the bench, as a recording.
fn responses(bench: &Bench, plan: &ExperimentPlan, prediction: &Prediction) -> Recording {
    let response = &prediction.response;
    let name = |role: Role| {
        let usual = CHANNELS.iter().find(|(other, _)| *other == role).map_or(role.key(), |(_, name)| name);
        let stated = bench.file.channels.get(&role).map_or(usual, |mapping| mapping.name.as_str());
        format!("{stated}_predicted")
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
    Recording {
        format: Format::Mdf { version: 410 },
        comment: Some(format!("{}, predicted by the bench model", plan.label)),
        start_time: None,
        rasters: vec![Raster { time_s, name: None }],
        channels,
        findings: Vec::new(),
    }
}

fn facts(
    bench: &Bench,
    plan: &ExperimentPlan,
    demands: &Demands,
    targets: &Targets,
    predicted: &Result<Predicted, String>,
    doubts: &[String],
) -> serde_json::Value {
    let demand = |demand: rig::experiment::NamedDemand<'_>| {
        let si = demand.kind.si_per_unit();
        let range = demand.values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
        json!({"name": demand.kind.name(), "unit": demand.kind.unit(), "lowest": range.0 / si, "highest": range.1 / si})
    };
    let peak = |(index, peak): (usize, &Peak), errors: &[f64]| {
        let (symbol, unit, si) = wording::peak(peak.of);
        json!({"of": peak.of, "symbol": symbol, "unit": unit, "value": peak.value / si, "time_s": peak.time_s,
            "standard_error": errors.get(index).map(|error| error / si),
            "limit": peak.limit.map(|limit| limit / si), "is_beyond_limit": peak.is_beyond_limit()})
    };
    let prediction = predicted.as_ref().ok().map(|p| {
        json!({"from": if bench.assembled.is_some() { "study" } else { "bench file" }, "resonance_hz": p.resonance_hz,
            "assumptions": bench.stated.assumed_for(plan),
            "peaks": p.prediction.peaks.iter().enumerate().map(|one| peak(one, &p.errors)).collect::<Vec<_>>()})
    });
    json!({
        "label": plan.label.to_string(),
        "duration_s": plan.duration_s,
        "demands": demands.named(plan).into_iter().map(demand).collect::<Vec<_>>(),
        "doubts": doubts,
        "prediction": prediction,
        "not_predicted": predicted.as_ref().err(),
        "files": targets.all(predicted.is_ok()).into_iter().map(|path| shown(path)).collect::<Vec<_>>(),
    })
}
