//! Signals that a judgement compares: those that its requirements use, and no others.

use std::path::Path;

use cycle::{Own, Sensor, Signal as Of};
use recording::{Recording, RecordingError, Selection};
use report::wording;
use rig::experiment::{ControlMode, Excitation, Test as Experimental};
use rig::{Diagnostic, Experiment, ExperimentLabel, Finding, PrepareError, Role, RunChannels, Severity, prepare_run};
use signal::Signal;
use work::Context;

use super::requirements::Requirements;
use super::test::{Test, What};
use crate::bench::bench_text;
use crate::error::Error;
use crate::files::Files;
use crate::find::InputFile;

/// Roles whose signal can be the torque of the shaft, the best first.
const SHAFT: [Role; 4] = [Role::FlangeTorque, Role::SystemShaftTorque, Role::LoadCellTorque, Role::AirGapTorque];

/// The signals of a recording that a judgement compares.
pub(super) struct Compared {
    pub(super) experiment: Experiment,
    /// The role of the speed that follows the demand, if a requirement uses it and it is there.
    pub(super) speed: Option<Role>,
    /// The role of the torque that follows the demand, if a requirement uses it and it is there.
    pub(super) torque: Option<Role>,
    /// The operator's demand, if a rule of omission uses it and it was recorded.
    pub(super) throttle: Option<Role>,
    /// The demand that shows when a cycle begins, if it was recorded.
    pub(super) demand: Option<Signal>,
    /// Left-out parts of the recording with the reasons, and its other faults, in words.
    pub(super) remarks: Vec<String>,
    /// Roles of the speed, the best first.
    speeds: &'static [Role],
}

impl Compared {
    /// Of a recording; the speed shows when the test `begins` where that is not stated.
    pub(super) fn of(
        run: &RunChannels,
        file: &InputFile,
        recording: &Recording,
        test: &Test,
        wanted: &Requirements,
        begins: bool,
    ) -> Result<Self, Error> {
        let path = &file.path;
        let label = label(test);
        let only = |roles: &[&[Role]]| prepare_run(&file.name, recording, run, roles, label.clone());
        let demand = (test.is_cycle() && begins).then(|| only(&[&[Role::DynoSpeedDemand]]).ok()).flatten();
        let demand = demand.and_then(|(experiment, _)| experiment.signal(Role::DynoSpeedDemand).cloned());
        let (speeds, torques) = followed(test);
        let (uses_speed, uses_torque) = (wanted.uses(Of::Speed) || begins, wanted.uses(Of::Torque));
        let throttle = [Role::Throttle];
        let has_omission = wanted.sets.iter().any(|set| set.omission);
        let mut roles: Vec<&[Role]> = Vec::new();
        roles.extend(uses_speed.then_some(speeds));
        roles.extend(uses_torque.then_some(torques));
        roles.extend(has_omission.then_some(&throttle[..]));
        roles.extend(wanted.own.iter().flat_map(|own| [of_sensor(own.sensor()), of_phase(own)]).flatten());
        let (experiment, diagnostics) = only(&roles).map_err(|error| unusable(error, path, &roles))?;
        let there = |uses: bool, roles: &[Role]| {
            roles.iter().copied().filter(|_| uses).find(|role| experiment.signal(*role).is_some())
        };
        let (speed, torque) = (there(uses_speed, speeds), there(uses_torque, torques));
        let refused = |reason: String| Error::NotAsTest { path: path.to_owned(), reason };
        for (is_used, found, roles) in
            [(wanted.uses(Of::Speed), speed, speeds), (wanted.uses(Of::Torque), torque, torques)]
        {
            if is_used && found.is_none() {
                return Err(refused(absent(roles)));
            }
        }
        let throttle = there(has_omission, &throttle);
        let remarks = diagnostics.iter().filter(|one| is_told(one)).map(wording::remark).collect();
        Ok(Compared { experiment, speed, torque, throttle, demand, remarks, speeds })
    }

    /// The speed that follows the demand.
    pub(super) fn speed(&self) -> Result<&Signal, String> {
        self.speed.and_then(|role| self.experiment.signal(role)).ok_or_else(|| absent(self.speeds))
    }

    /// The signal that a requirement of one's own is about.
    pub(super) fn of_own(&self, own: &Own) -> Result<&Signal, String> {
        let followed = if own.signal() == Of::Speed { self.speed } else { self.torque };
        let roles = of_sensor(own.sensor()).unwrap_or(followed.as_slice());
        roles.iter().find_map(|role| self.experiment.signal(*role)).ok_or_else(|| absent(roles))
    }

    /// When the signals begin that are compared, s.
    pub(super) fn first_sample_s(&self) -> f64 {
        let followed = [self.speed, self.torque].into_iter().flatten().find_map(|role| self.experiment.signal(role));
        followed.or(self.experiment.signals.values().next()).map_or(0.0, |signal| signal.start_s)
    }

    /// A reason with what was left out of the recording: that may be why.
    pub(super) fn explained(&self, reason: &str) -> String {
        let remarks = self.remarks.iter().map(String::as_str);
        let sentences = std::iter::once(reason).chain(remarks).map(|words| words.trim_end_matches('.'));
        sentences.collect::<Vec<_>>().join(". ")
    }
}

/// The channels of the bench file; nothing else of it is needed.
pub(super) fn run_channels(bench: &Path, files: &Files) -> Result<RunChannels, Error> {
    let read = bench_text(bench, files)?.parse();
    let run: RunChannels = read.map_err(|source| Error::BenchFile { path: bench.to_owned(), source })?;
    if run.channels.is_empty() {
        return Err(Error::NoChannelsNamed { path: bench.to_owned() });
    }
    Ok(run)
}

/// The channels of the bench file, or all where one of them is not there.
pub(super) fn recording(
    file: &InputFile,
    run: &RunChannels,
    files: &Files,
    context: &Context,
) -> Result<Recording, Error> {
    let step = context.step(format!("reading {}", file.name), 0);
    let names = run.channels.values().map(|channel| channel.name.clone()).collect::<Vec<_>>();
    let read = |which: Selection| files.read_recording(file, &which, None, &step);
    let found = match read(Selection::Names(names)) {
        Err(Error::Recording { source: RecordingError::NoSuchChannel { .. }, .. }) => read(Selection::All),
        other => other,
    };
    Ok(found?.recording)
}

fn label(test: &Test) -> ExperimentLabel {
    match &test.what {
        What::Plan { plan, .. } => plan.label.clone(),
        What::Cycle { .. } => ExperimentLabel::new(Experimental::FreeForm, Excitation::Speed, ControlMode::Nt),
    }
}

/// Tells whether a doubt says that something of the recording was left out, or must be known.
fn is_told(diagnostic: &Diagnostic) -> bool {
    diagnostic.severity >= Severity::Warning || matches!(diagnostic.finding, Finding::Spikes { .. })
}

/// Why nothing can be compared.
fn unusable(error: PrepareError, path: &Path, roles: &[&[Role]]) -> Error {
    let (PrepareError::NothingUsable { diagnostics, .. }
    | PrepareError::NoCommonStretch { diagnostics, .. }
    | PrepareError::Mislabelled { diagnostics, .. }) = error;
    let of = |severity: Severity| diagnostics.iter().find(|one| one.severity == severity);
    let worst = of(Severity::Error).or(of(Severity::Warning));
    let reason = worst.map_or_else(|| absent(&roles.concat()), wording::remark);
    Error::NotAsTest { path: path.to_owned(), reason }
}

/// That none of these roles can be used.
fn absent(roles: &[Role]) -> String {
    let keys: Vec<&str> = roles.iter().map(|role| role.key()).collect();
    format!("none of the channels {} is there and usable; name one in [channels]", keys.join(", "))
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
pub(super) fn mode(test: &Test) -> Option<ControlMode> {
    match &test.what {
        What::Plan { plan, .. } => Some(plan.label.mode),
        What::Cycle { .. } => None,
    }
}

/// The roles of a sensor that does not follow the demand.
fn of_sensor(sensor: Sensor) -> Option<&'static [Role]> {
    match sensor {
        Sensor::Speed | Sensor::Torque => None,
        Sensor::DynoSpeed => Some(&[Role::DynoSpeed]),
        Sensor::EngineSpeed => Some(&[Role::EngineSpeed]),
        Sensor::ShaftTorque => Some(&[Role::FlangeTorque, Role::SystemShaftTorque]),
        Sensor::TorqueDemand => Some(&[Role::DynoTorqueDemand]),
    }
}

/// The demand that a phase may refer to.
fn of_phase(own: &Own) -> Option<&'static [Role]> {
    match own {
        Own::Phase { signal: Of::Speed, .. } => Some(&[Role::DynoSpeedDemand]),
        Own::Phase { .. } => Some(&[Role::DynoTorqueDemand]),
        _ => None,
    }
}
