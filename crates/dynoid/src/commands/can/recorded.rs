//! A run that was recorded, judged.

use std::f64::consts::TAU;
use std::path::Path;

use cycle::{
    Course, Feedback, Own, Reference, RequirementSet, Samples, Sensor, Signal as Of, Validation, find_start, validate,
};
use report::can::{AlignedOn, JudgedOwn, RecordedRun};
use report::wording;
use rig::experiment::{ControlMode, Excitation, Test as Experimental, UPDATE_S};
use rig::{Experiment, ExperimentLabel, PrepareError, Role, Severity, prepare};
use serde_json::json;
use signal::Signal;

use super::test::{Test, What};
use super::wanted::Wanted;
use crate::cli::can::CanArguments;
use crate::commands::result::show;
use crate::commands::study::read_bench;
use crate::error::{CliError, Outcome};
use crate::input::{self, InputFile};
use crate::paths;
use crate::terminal::Terminal;

/// Time between samples of what is compared second by second, s: at least 5 Hz are asked for.
const STEP_S: f64 = 0.1;

/// Roles whose signal can be the torque of the shaft, the best first.
const SHAFT: [Role; 4] = [Role::FlangeTorque, Role::SystemShaftTorque, Role::LoadCellTorque, Role::AirGapTorque];

pub(super) fn run(
    arguments: &CanArguments,
    test: &Test,
    wanted: &Wanted,
    file: &Path,
    terminal: &mut Terminal,
) -> Result<Outcome, CliError> {
    let refused = |reason: String| CliError::NotAsTest { path: file.to_owned(), reason };
    if wanted.sets.is_empty() && wanted.own.is_empty() {
        let what = format!(
            "{}: nothing to judge the recording by. This test has no requirement set of its own: name one with --by, or give a \
             requirement with --require",
            test.title
        );
        return Err(CliError::Usage { what });
    }
    let experiment = experiment(arguments, test, file, terminal)?;
    let (speeds, torques) = followed(test);
    let (speed_role, speed) = first(&experiment, speeds).map_err(refused)?;
    let (torque_role, torque) = first(&experiment, torques).map_err(refused)?;
    let reference = reference(test);
    let (start_s, aligned_on) = start(arguments, test, &reference, &experiment, speed).map_err(refused)?;
    let throttle = experiment.signal(Role::Throttle);
    let feedback = feedback(speed, torque, throttle, start_s).map_err(refused)?;
    let judge = |set: &RequirementSet| validate(&reference, &feedback, set).map(|found| (set.clone(), found));
    let sets =
        wanted.sets.iter().map(judge).collect::<Result<Vec<_>, _>>().map_err(|error| refused(error.to_string()))?;
    let signal = |own: &Own| if own.signal() == Of::Speed { speed } else { torque };
    let judge = |own: &Own| judged(own, test, &reference, (&experiment, signal(own)), start_s);
    let own = wanted.own.iter().map(judge).collect::<Result<Vec<_>, String>>().map_err(refused)?;
    let (time_s, wanted_speed, wanted_torque) = shown(&feedback, test, &reference);
    let within = time_s.len();
    let run = RecordedRun {
        file: &experiment.file,
        test: &test.title,
        start_s,
        aligned_on,
        signals: (&wording::role(speed_role), &wording::role(torque_role)),
        has_demand: throttle.is_some(),
        sets: &sets,
        own: &own,
        time_s: &time_s,
        speed_rad_s: (&wanted_speed, &feedback.speed_rad_s[..within]),
        torque_nm: (&wanted_torque, &feedback.torque_nm[..within]),
    };
    let passes = run.passes();
    show(&arguments.on.result, || report::can::recorded(&run), || facts(&run, &sets, &own), terminal)?;
    Ok(if passes { Outcome::Done } else { Outcome::NotSafe })
}

/// The recording by roles, in SI; what is wrong with it is warned of.
fn experiment(
    arguments: &CanArguments,
    test: &Test,
    path: &Path,
    terminal: &mut Terminal,
) -> Result<Experiment, CliError> {
    let (bench, _) = read_bench(&arguments.on.bench)?;
    if bench.channels.is_empty() {
        return Err(CliError::NoChannelsNamed { path: arguments.on.bench.clone() });
    }
    let file = InputFile { path: path.to_owned(), name: paths::with_slashes(path) };
    let progress = terminal.long(&format!("reading {}", file.name));
    let names = bench.channels.values().map(|channel| channel.name.clone()).collect::<Vec<_>>();
    let read =
        input::read_recording(&file, &recording::Selection::Names(names), None, &|done, all| progress.at(done, all));
    let read = match read {
        Err(CliError::Recording { source: recording::RecordingError::NoSuchChannel { .. }, .. }) => {
            input::read_recording(&file, &recording::Selection::All, None, &|done, all| progress.at(done, all))
        }
        other => other,
    };
    drop(progress);
    let label = match &test.what {
        What::Plan { plan, .. } => plan.label.clone(),
        What::Cycle { .. } => ExperimentLabel::new(Experimental::FreeForm, Excitation::Speed, ControlMode::Nt),
    };
    match prepare(&file.name, &read?.recording, &bench, label) {
        Ok((experiment, diagnostics)) => {
            let errors = diagnostics.iter().filter(|one| one.severity == Severity::Error);
            errors.for_each(|one| terminal.warning(&wording::remark(one)));
            Ok(experiment)
        }
        Err(
            PrepareError::NothingUsable { diagnostics, .. }
            | PrepareError::NoCommonStretch { diagnostics, .. }
            | PrepareError::Mislabelled { diagnostics, .. },
        ) => {
            let worst = diagnostics.iter().find(|one| one.severity == Severity::Error).or(diagnostics.first());
            let reason = worst.map_or_else(|| "nothing in it can be used".to_owned(), wording::remark);
            Err(CliError::NotAsTest { path: path.to_owned(), reason })
        }
    }
}

fn first<'a>(experiment: &'a Experiment, roles: &[Role]) -> Result<(Role, &'a Signal), String> {
    let found = roles.iter().find_map(|role| Some((*role, experiment.signal(*role)?)));
    found.ok_or_else(|| {
        let keys: Vec<&str> = roles.iter().map(|role| role.key()).collect();
        format!("none of the channels {} is there and usable; name one in [channels]", keys.join(", "))
    })
}

/// What the test asks for.
fn reference(test: &Test) -> Reference {
    match &test.what {
        What::Cycle { reference, .. } => reference.clone(),
        What::Plan { plan, demands } => {
            let torque = match plan.label.mode {
                ControlMode::Nt => &demands.engine_torque_nm,
                ControlMode::Tn => &demands.dyno_torque_nm,
            };
            let of_itself = Reference::of_itself(0.0, demands.speed_rad_s.clone(), torque.clone());
            Reference { step_s: UPDATE_S, ..of_itself }
        }
    }
}

/// When the test begins in the recording.
fn start(
    arguments: &CanArguments,
    test: &Test,
    reference: &Reference,
    experiment: &Experiment,
    speed: &Signal,
) -> Result<(f64, AlignedOn), String> {
    if let Some(start_s) = arguments.start {
        return Ok((start_s, AlignedOn::Given));
    }
    if let What::Plan { .. } = test.what {
        return Ok((speed.start_s, AlignedOn::FirstSample));
    }
    let (signal, on) = match experiment.signal(Role::DynoSpeedDemand) {
        Some(demand) => (demand, AlignedOn::SpeedDemand),
        None => (speed, AlignedOn::Speed),
    };
    find_start(reference, (signal.start_s, signal.sample_time_s, &signal.samples))
        .map(|start_s| (start_s, on))
        .map_err(|error| error.to_string())
}

/// Means over a tenth of a second, or the samples of a slower signal, on the clock of the test.
fn feedback(speed: &Signal, torque: &Signal, throttle: Option<&Signal>, start_s: f64) -> Result<Feedback, String> {
    let signals = || [Some(speed), Some(torque), throttle].into_iter().flatten();
    let step_s = signals().map(|signal| signal.sample_time_s).fold(STEP_S, f64::max);
    let from_s = signals().map(|signal| signal.start_s).fold(f64::NEG_INFINITY, f64::max);
    let to_s = signals().map(Signal::end_s).fold(f64::INFINITY, f64::min);
    let count = ((to_s - from_s) / step_s).floor();
    if count.is_nan() || count < 3.0 {
        return Err("speed and torque share too little time".to_owned());
    }
    let means = |signal: &Signal| -> Vec<f64> {
        let mean = |k: usize| {
            let middle_s = from_s + k as f64 * step_s;
            let cell = signal.slice(middle_s - 0.5 * step_s, middle_s + 0.5 * step_s);
            cell.mean().unwrap_or_else(|| {
                let place = ((middle_s - signal.start_s) / signal.sample_time_s).round().max(0.0) as usize;
                signal.samples[place.min(signal.len() - 1)]
            })
        };
        (0..=count as usize).map(mean).collect()
    };
    Ok(Feedback {
        start_s: from_s - start_s,
        sample_time_s: step_s,
        speed_rad_s: means(speed),
        torque_nm: means(torque),
        demand: throttle.map(means),
    })
}

/// What the test asks for at a time on its own clock: speed and torque.
fn wanted_at(test: &Test, reference: &Reference, time_s: f64) -> (f64, f64) {
    match &test.what {
        What::Cycle { .. } => (reference.speed_at(time_s), reference.torque_at(time_s)),
        What::Plan { plan, demands } => {
            let place =
                ((time_s / UPDATE_S).round().max(0.0) as usize).min(demands.speed_rad_s.len().saturating_sub(1));
            let torque = match plan.label.mode {
                ControlMode::Nt => demands.engine_torque_nm[place],
                ControlMode::Tn => demands.dyno_torque_nm[place],
            };
            (demands.speed_rad_s[place], torque)
        }
    }
}

/// One's own requirement on the signal's own clock, while the test lasts.
fn judged(
    own: &Own,
    test: &Test,
    reference: &Reference,
    (experiment, signal): (&Experiment, &Signal),
    start_s: f64,
) -> Result<JudgedOwn, String> {
    let signal = at_sensor(experiment, own.sensor()).unwrap_or(Ok(signal))?;
    let lasts_s = test.demand().duration_s();
    let begins_s = start_s + reference.start_s;
    let part = signal.slice(begins_s, begins_s + lasts_s);
    let recorded =
        recorded_demand(experiment, own, mode(test)).map(|demand| demand.slice(begins_s, begins_s + lasts_s));
    let recorded = recorded.filter(|demand| !demand.is_empty());
    let wanted = |k: usize| {
        let (speed, torque) = wanted_at(test, reference, part.time_s(k) - start_s);
        let asked = if own.signal() == Of::Speed { speed } else { torque };
        recorded.as_ref().map_or(asked, |demand| held(demand, part.time_s(k)))
    };
    let demand: Vec<f64> = (0..part.len()).map(wanted).collect();
    let course = Course {
        sample_time_s: part.sample_time_s,
        demand: &demand,
        value: &part.samples,
        timed_demand: recorded.as_ref().map(|demand| timed(demand, part.start_s)).or_else(|| {
            let start_s = start_s - part.start_s;
            planned(own, test).map(|values| Samples { start_s, sample_time_s: UPDATE_S, values, is_held: true })
        }),
    };
    own.check(&course).map_err(|error| error.to_string())?;
    let mut judged = own.judge(&course);
    judged.time_s += part.start_s - start_s;
    let raster = match (own, &recorded) {
        // A demand changed at any time since the sample before.
        (Own::Phase { frequency_hz, .. }, Some(demand)) => Some(0.5 * TAU * frequency_hz * demand.sample_time_s),
        _ => None,
    };
    let scatter = own.scatter(&course);
    let uncertain_by = (raster.is_some() || scatter.is_some()).then(|| raster.unwrap_or(0.0) + scatter.unwrap_or(0.0));
    Ok(JudgedOwn { own: *own, judged, uncertain_by })
}

/// A recorded demand on a clock that begins at a time. On the raster of its own updates it changes at its samples; on a slower one it
/// changed somewhere in between.
fn timed(demand: &Signal, zero_s: f64) -> Samples<'_> {
    Samples {
        start_s: demand.start_s - zero_s,
        sample_time_s: demand.sample_time_s,
        values: &demand.samples,
        is_held: demand.sample_time_s < 1.5 * UPDATE_S,
    }
}

/// The demands of a plan, update by update.
fn planned<'a>(own: &Own, test: &'a Test) -> Option<&'a [f64]> {
    let What::Plan { plan, demands } = &test.what else { return None };
    Some(match (own.signal(), plan.label.mode) {
        (Of::Speed, _) => &demands.speed_rad_s,
        (_, ControlMode::Nt) => &demands.engine_torque_nm,
        (_, ControlMode::Tn) => &demands.dyno_torque_nm,
    })
}

/// Roles of the speed and of the torque that follow the demands of a test, the best first: as in a prediction.
fn followed(test: &Test) -> (&'static [Role], &'static [Role]) {
    let (engine, dyno) = (&[Role::EngineSpeed, Role::DynoSpeed], &[Role::DynoSpeed, Role::EngineSpeed]);
    match mode(test) {
        Some(ControlMode::Nt) => (dyno, &SHAFT),
        Some(ControlMode::Tn) => (engine, &[Role::AirGapTorque, Role::LoadCellTorque, Role::SystemShaftTorque]),
        None => (engine, &SHAFT),
    }
}

/// The mode of a plan.
fn mode(test: &Test) -> Option<ControlMode> {
    match &test.what {
        What::Plan { plan, .. } => Some(plan.label.mode),
        What::Cycle { .. } => None,
    }
}

/// The demand that a phase refers to, where it was recorded.
fn recorded_demand<'a>(experiment: &'a Experiment, own: &Own, mode: Option<ControlMode>) -> Option<&'a Signal> {
    match (own, mode) {
        (Own::Phase { signal: Of::Speed, .. }, None | Some(ControlMode::Nt)) => {
            experiment.signal(Role::DynoSpeedDemand)
        }
        (Own::Phase { signal: Of::Torque, .. }, Some(ControlMode::Tn)) => experiment.signal(Role::DynoTorqueDemand),
        _ => None,
    }
}

/// The sample of a signal at a time, or that of its end.
fn held(signal: &Signal, time_s: f64) -> f64 {
    let place = ((time_s - signal.start_s) / signal.sample_time_s + 1e-6).floor().max(0.0) as usize;
    signal.samples[place.min(signal.len() - 1)]
}

/// The signal of a sensor with a role of its own.
fn at_sensor(experiment: &Experiment, sensor: Sensor) -> Option<Result<&Signal, String>> {
    let roles: &[Role] = match sensor {
        Sensor::Speed | Sensor::Torque => return None,
        Sensor::DynoSpeed => &[Role::DynoSpeed],
        Sensor::EngineSpeed => &[Role::EngineSpeed],
        Sensor::ShaftTorque => &[Role::FlangeTorque, Role::SystemShaftTorque],
        Sensor::TorqueDemand => &[Role::DynoTorqueDemand],
    };
    Some(first(experiment, roles).map(|(_, signal)| signal))
}

/// Times on the clock of the test, with what it asks for.
fn shown(feedback: &Feedback, test: &Test, reference: &Reference) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let time_s: Vec<f64> =
        (0..feedback.speed_rad_s.len()).map(|k| feedback.start_s + k as f64 * feedback.sample_time_s).collect();
    let (speed, torque) = time_s.iter().map(|time| wanted_at(test, reference, *time)).unzip();
    (time_s, speed, torque)
}

fn facts(run: &RecordedRun<'_>, sets: &[(RequirementSet, Validation)], own: &[JudgedOwn]) -> serde_json::Value {
    let set = |(set, validation): &(RequirementSet, Validation)| json!({"name": set.name, "paragraph": set.paragraph, "year": set.year, "text_seen": set.seen, "result": validation});
    let one = |one: &JudgedOwn| {
        let judged = one.judged;
        json!({"requirement": report::can::own(&one.own), "value": judged.value, "limit": judged.limit,
            "uncertain_by": one.uncertain_by, "passes": judged.passes(), "time_s": judged.time_s})
    };
    json!({
        "test": run.test,
        "file": run.file,
        "passes": run.passes(),
        "start_s": run.start_s,
        "speed": run.signals.0,
        "torque": run.signals.1,
        "requirements": sets.iter().map(set).collect::<Vec<_>>(),
        "own": own.iter().map(one).collect::<Vec<_>>(),
    })
}
