//! A run that was recorded, judged.

use std::f64::consts::TAU;
use std::path::Path;

use cycle::{
    Course, Feedback, Own, Reference, RequirementSet, Samples, Signal as Of, Validation, find_start, validate,
};
use page::Page;
use report::can::{AlignedOn, JudgedOwn, RecordedRun, Referred, ScalesOf};
use report::wording;
use rig::Role;
use rig::experiment::{ControlMode, UPDATE_S};
use signal::Signal;
use units::RPM_RAD_S;
use work::Context;

use super::compared::{self, Compared, mode};
use super::facts::{JudgedOwnFacts, JudgedSetFacts, RunFacts};
use super::requirements::Requirements;
use super::test::{Test, What};
use crate::error::Error;
use crate::files::Files;
use crate::find::InputFile;
use crate::paths;

/// Time between samples of what is compared second by second, s: at least 5 Hz are asked for.
const STEP_S: f64 = 0.1;

/// A recorded run of a test, judged.
#[derive(Debug, Clone)]
pub struct JudgedRun {
    file: String,
    test: String,
    start_s: f64,
    aligned_on: AlignedOn,
    speed: Option<String>,
    torque: Option<String>,
    has_demand: bool,
    referred: Referred,
    remarks: Vec<String>,
    sets: Vec<(RequirementSet, Validation)>,
    own: Vec<JudgedOwn>,
    sample_time_s: f64,
    time_s: Vec<f64>,
    /// Demanded and measured speed and torque.
    speed_rad_s: Option<(Vec<f64>, Vec<f64>)>,
    torque_nm: Option<(Vec<f64>, Vec<f64>)>,
}

impl JudgedRun {
    /// Reads the recording of a run, whose channels a bench file names, and judges it by the requirements. The speed
    /// shows when the test begins where no `start_s` states it.
    ///
    /// # Errors
    /// Nothing to judge by, a file that cannot be read, and a recording that is no run of the test.
    pub fn read(
        bench: &Path,
        recording: &Path,
        test: &Test,
        wanted: &Requirements,
        start_s: Option<f64>,
        files: &Files,
        context: &Context,
    ) -> Result<Self, Error> {
        if wanted.sets.is_empty() && wanted.own.is_empty() {
            return Err(Error::NothingToJudgeBy { test: test.title().to_owned() });
        }
        let run = compared::run_channels(bench, files)?;
        let file = InputFile { path: recording.to_owned(), name: paths::with_slashes(recording) };
        let recording = compared::recording(&file, &run, files, context)?;
        let compared = Compared::of(&run, &file, &recording, test, wanted, start_s.is_none())?;
        Self::of(compared, test, wanted, start_s).map_err(|reason| Error::NotAsTest { path: file.path.clone(), reason })
    }

    fn of(compared: Compared, test: &Test, wanted: &Requirements, start_s: Option<f64>) -> Result<Self, String> {
        let refused = |reason: String| compared.explained(&reason);
        let reference = reference(test);
        let (start_s, aligned_on) = start(start_s, test, &reference, &compared).map_err(refused)?;
        let feedback = feedback(&compared, start_s).map_err(refused)?;
        let judge = |set: &RequirementSet| validate(&reference, &feedback, set).map(|found| (set.clone(), found));
        let sets = wanted.sets.iter().map(judge).collect::<Result<Vec<_>, _>>();
        let sets = sets.map_err(|error| refused(error.to_string()))?;
        let judge = |own: &Own| judged(own, test, &reference, &compared, start_s);
        let own = wanted.own.iter().map(judge).collect::<Result<Vec<_>, String>>().map_err(refused)?;
        let (time_s, wanted_speed, wanted_torque) = shown(&feedback, test, &reference);
        Ok(JudgedRun {
            test: test.title().to_owned(),
            start_s,
            aligned_on,
            speed: compared.speed.map(wording::role),
            torque: compared.torque.map(wording::role),
            has_demand: compared.throttle.is_some(),
            referred: Referred { scales: reference.scales, of: scales_of(test) },
            sets,
            own,
            sample_time_s: feedback.sample_time_s,
            time_s,
            speed_rad_s: compared.speed.map(|_| (wanted_speed, feedback.speed_rad_s)),
            torque_nm: compared.torque.map(|_| (wanted_torque, feedback.torque_nm)),
            file: compared.experiment.file,
            remarks: compared.remarks,
        })
    }

    /// Requirement sets, judged.
    pub fn sets(&self) -> &[(RequirementSet, Validation)] {
        &self.sets
    }

    /// Requirements of one's own, judged.
    pub fn own(&self) -> &[JudgedOwn] {
        &self.own
    }

    /// Tells whether everything is met.
    pub fn passes(&self) -> bool {
        self.shown().passes()
    }

    /// The judgement as a page.
    pub fn page(&self) -> Page {
        report::can::recorded(&self.shown())
    }

    /// The judgement in numbers.
    pub fn facts(&self) -> RunFacts<'_> {
        RunFacts {
            test: &self.test,
            file: &self.file,
            passes: self.passes(),
            start_s: self.start_s,
            speed: &self.speed,
            torque: &self.torque,
            limits_refer_to: self.referred,
            remarks: &self.remarks,
            requirements: self.sets.iter().map(JudgedSetFacts::of).collect(),
            own: self.own.iter().map(JudgedOwnFacts::of).collect(),
        }
    }

    fn shown(&self) -> RecordedRun<'_> {
        RecordedRun {
            file: &self.file,
            test: &self.test,
            start_s: self.start_s,
            aligned_on: self.aligned_on,
            signals: (self.speed.clone(), self.torque.clone()),
            has_demand: self.has_demand,
            sample_time_s: self.sample_time_s,
            referred: self.referred,
            remarks: &self.remarks,
            sets: &self.sets,
            own: &self.own,
            time_s: &self.time_s,
            speed_rad_s: self.speed_rad_s.as_ref().map(both),
            torque_nm: self.torque_nm.as_ref().map(both),
        }
    }
}

fn both((wanted, measured): &(Vec<f64>, Vec<f64>)) -> (&[f64], &[f64]) {
    (wanted, measured)
}

/// Reference of limits in per cent.
fn scales_of(test: &Test) -> ScalesOf {
    let has_map = matches!(&test.what, What::Cycle { map: Some(_), .. });
    match (has_map, test.idle_rpm.is_some()) {
        (true, true) => ScalesOf::MapAndStatedIdle,
        (true, false) => ScalesOf::Map,
        (false, true) => ScalesOf::CycleAndStatedIdle,
        (false, false) => ScalesOf::Cycle,
    }
}

/// Reference that the test demands.
fn reference(test: &Test) -> Reference {
    match &test.what {
        What::Cycle { reference, .. } => reference.clone(),
        What::Plan { plan, demands } => {
            let torque = match plan.label.mode {
                ControlMode::Nt => &demands.engine_torque_nm,
                ControlMode::Tn => &demands.dyno_torque_nm,
            };
            let mut of_itself = Reference::of_itself(0.0, demands.speed_rad_s.clone(), torque.clone());
            if let Some(idle_rpm) = test.idle_rpm {
                of_itself.scales.idle_rad_s = idle_rpm * RPM_RAD_S;
            }
            Reference { step_s: UPDATE_S, ..of_itself }
        }
    }
}

/// When the test begins in the recording.
fn start(
    given_s: Option<f64>,
    test: &Test,
    reference: &Reference,
    compared: &Compared,
) -> Result<(f64, AlignedOn), String> {
    if let Some(start_s) = given_s {
        return Ok((start_s, AlignedOn::Given));
    }
    if let What::Plan { .. } = test.what {
        return Ok((compared.first_sample_s(), AlignedOn::FirstSample));
    }
    let found = |signal: &Signal| find_start(reference, (signal.start_s, signal.sample_time_s, &signal.samples));
    // A demand that was recorded in part shows nothing.
    let by_demand = compared.demand.as_ref().and_then(|demand| found(demand).ok());
    if let Some(start_s) = by_demand {
        return Ok((start_s, AlignedOn::SpeedDemand));
    }
    let speed = compared.speed()?;
    found(speed).map(|start_s| (start_s, AlignedOn::Speed)).map_err(|error| error.to_string())
}

/// Means over a tenth of a second, or the samples of a slower signal, on the clock of the test. What no requirement
/// uses is zero.
fn feedback(compared: &Compared, start_s: f64) -> Result<Feedback, String> {
    let of = |role: Option<Role>| role.and_then(|role| compared.experiment.signal(role));
    let (speed, torque, throttle) = (of(compared.speed), of(compared.torque), of(compared.throttle));
    let signals = || [speed, torque, throttle].into_iter().flatten();
    let step_s = signals().map(|signal| signal.sample_time_s).fold(STEP_S, f64::max);
    let from_s = signals().map(|signal| signal.start_s).fold(f64::NEG_INFINITY, f64::max);
    let to_s = signals().map(Signal::end_s).fold(f64::INFINITY, f64::min);
    let count = ((to_s - from_s) / step_s).floor();
    if signals().next().is_none() {
        return Ok(Feedback {
            start_s: 0.0,
            sample_time_s: step_s,
            speed_rad_s: vec![],
            torque_nm: vec![],
            demand: None,
        });
    }
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
    let or_zero = |signal: Option<&Signal>| signal.map_or_else(|| vec![0.0; count as usize + 1], means);
    Ok(Feedback {
        start_s: from_s - start_s,
        sample_time_s: step_s,
        speed_rad_s: or_zero(speed),
        torque_nm: or_zero(torque),
        demand: throttle.map(means),
    })
}

/// Speed and torque that the test asks for at a time on its own clock.
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
    compared: &Compared,
    start_s: f64,
) -> Result<JudgedOwn, String> {
    let signal = compared.of_own(own)?;
    let lasts_s = test.demand().duration_s();
    let begins_s = start_s + reference.start_s;
    let part = signal.slice(begins_s, begins_s + lasts_s);
    let recorded = recorded_demand(compared, own, mode(test)).map(|demand| demand.slice(begins_s, begins_s + lasts_s));
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

/// A recorded demand on a clock that begins at a time. On the raster of its own updates it changes at its samples; on a
/// slower one it changed somewhere in between.
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

/// The demand that a phase refers to, where it was recorded.
fn recorded_demand<'a>(compared: &'a Compared, own: &Own, mode: Option<ControlMode>) -> Option<&'a Signal> {
    let role = match (own, mode) {
        (Own::Phase { signal: Of::Speed, .. }, None | Some(ControlMode::Nt)) => Role::DynoSpeedDemand,
        (Own::Phase { signal: Of::Torque, .. }, Some(ControlMode::Tn)) => Role::DynoTorqueDemand,
        _ => return None,
    };
    compared.experiment.signal(role)
}

/// The sample of a signal at a time, or that of its end.
fn held(signal: &Signal, time_s: f64) -> f64 {
    let place = ((time_s - signal.start_s) / signal.sample_time_s + 1e-6).floor().max(0.0) as usize;
    signal.samples[place.min(signal.len() - 1)]
}

/// Times on the clock of the test, with what it asks for.
fn shown(feedback: &Feedback, test: &Test, reference: &Reference) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
    let time_s: Vec<f64> =
        (0..feedback.speed_rad_s.len()).map(|k| feedback.start_s + k as f64 * feedback.sample_time_s).collect();
    let (speed, torque) = time_s.iter().map(|time| wanted_at(test, reference, *time)).unzip();
    (time_s, speed, torque)
}
