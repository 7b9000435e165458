//! From a recording and a bench file to an [`Experiment`]: SI, roles, one uniform clock a signal, and every doubt on
//! the way.

mod clock;
mod cut;
mod exchanged;
mod filtered;
mod label;
mod left_out;
mod log;
mod map;
mod physics;
mod rasters;
mod recognised;
mod run;
mod samples;
mod sign;
mod source;
mod stated;
mod torques;

use std::collections::BTreeMap;

use recording::Recording;

use crate::bench_file::{BenchFile, StretchUse};
use crate::diagnostics::Diagnostic;
use crate::experiment::{Experiment, ExperimentLabel};
use crate::role::Role;
use log::Log;
pub use physics::saturated_stretches;
pub use recognised::{LabelReason, recognised};
pub use run::prepare_run;
pub use sign::{believable, wrong_sign};
use signal::Signal;
use stated::{Purpose, Stated};

/// A recording of which nothing can be used.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PrepareError {
    /// No channel of the bench file is there and usable.
    #[error("{file}: no channel of the bench file can be used")]
    NothingUsable {
        /// The file.
        file: String,
        /// Why each channel cannot be used.
        diagnostics: Vec<Diagnostic>,
    },
    /// The recording is not what its label says.
    #[error("{file}: the recording is not what its label says")]
    Mislabelled {
        /// The file.
        file: String,
        /// Evidence against the label, and the other findings.
        diagnostics: Vec<Diagnostic>,
    },
    /// Gaps leave no time that all channels share.
    #[error("{file}: the channels share no uninterrupted stretch of time")]
    NoCommonStretch {
        /// The file.
        file: String,
        /// The gaps, and what else was found.
        diagnostics: Vec<Diagnostic>,
    },
}

/// Maps, converts, checks and mends one recording.
///
/// Each role of the bench file whose channel is there and usable becomes a signal in SI, with the sign of the role's
/// convention, on the uniform clock that its time stamps describe (rasters that start at different times stay so).
/// Samples that only repeat or interpolate others, and spikes, are left out. Gaps and runs of NaN of at most 20 ms or
/// five samples are interpolated; longer ones leave the longest stretch that is uninterrupted in every signal.
/// Stretches that the bench file leaves out, or keeps for validation, are such gaps, before anything looks at their
/// samples. What was refused, mended, cut or looks wrong is in the diagnostics.
///
/// # Errors
///
/// [`PrepareError`] if nothing usable is left; it holds the diagnostics that say why.
///
/// # Example
///
/// ```
/// # let bench: rig::BenchFile = "[bench]\nname = \"x\"\nvariant = \"load-cell\"\ncylinders = 4\ndynamometer_inertia = 0.6
/// # engine_inertia = 0.2\n[channels]\ndyno_speed = \"n\"\nengine_speed = \"ne\"\nair_gap_torque = \"t\"".parse()?;
/// let text = b"time [s],n [rpm]\n0,1200\n0.001,1200.1\n0.002,1200\n0.003,1200.2\n";
/// let recording = recording::decode("BS_T_NT.csv", text, &recording::Selection::All)?;
/// let (experiment, diagnostics) = rig::prepare("BS_T_NT.csv", &recording, &bench, "BS_T_NT".parse()?)?;
/// let speed = experiment.signal(rig::Role::DynoSpeed).map(|signal| signal.samples[0]);
/// assert_eq!(speed, Some(1200.0 * units::RPM_RAD_S));
/// assert_eq!(diagnostics.len(), 2); // the other two channels are missing
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn prepare(
    file: &str,
    recording: &Recording,
    bench_file: &BenchFile,
    label: ExperimentLabel,
) -> Result<(Experiment, Vec<Diagnostic>), PrepareError> {
    prepare_for(Purpose::Estimates, file, recording, bench_file, label)
}

/// The same of the stretches that the bench file keeps for validation; none of a recording without such stretches.
///
/// # Errors
///
/// Those of [`prepare`].
pub fn prepare_validation(
    file: &str,
    recording: &Recording,
    bench_file: &BenchFile,
    label: ExperimentLabel,
) -> Option<Result<(Experiment, Vec<Diagnostic>), PrepareError>> {
    let is_kept = bench_file.stretches_of(file).iter().any(|stretch| stretch.usage == StretchUse::Validate);
    is_kept.then(|| prepare_for(Purpose::Validation, file, recording, bench_file, label))
}

fn prepare_for(
    purpose: Purpose,
    file: &str,
    recording: &Recording,
    bench_file: &BenchFile,
    label: ExperimentLabel,
) -> Result<(Experiment, Vec<Diagnostic>), PrepareError> {
    let mut log = Log::new(file);
    log.reader_findings(recording);
    let stated = Stated::new(bench_file.stretches_of(file), purpose, recording);
    if !stated.is_within(recording, &mut log) {
        return Err(PrepareError::NothingUsable { file: file.to_owned(), diagnostics: log.diagnostics });
    }
    let recording = &*stated.kept(recording);
    let sources = map::sources(recording, bench_file, &label, &mut log);
    exchanged::check(&sources, &label, &mut log);
    let mut mended = BTreeMap::new();
    for source in &sources {
        let left_out = left_out::samples(source, &sources, &label, &mut log);
        if let Some(stretches) = clock::uniform_stretches(source, &left_out, &mut log)
            && samples::are_usable(source, &stretches, &label, bench_file, &mut log)
        {
            mended.insert(source.role, stretches);
        }
    }
    if mended.is_empty() {
        return Err(PrepareError::NothingUsable { file: file.to_owned(), diagnostics: log.diagnostics });
    }
    let Some(signals) = cut::longest_common(mended, &mut log) else {
        return Err(PrepareError::NoCommonStretch { file: file.to_owned(), diagnostics: log.diagnostics });
    };
    stated.note(span(&signals), &mut log);
    rasters::check(&sources, &signals, &mut log);
    let experiment = Experiment { file: file.to_owned(), label, signals };
    physics::check(&experiment, bench_file, &mut log);
    filtered::check(&experiment, bench_file, &mut log);
    torques::check(&experiment, bench_file, &mut log);
    if label::contradicts(&experiment, bench_file, &mut log) {
        return Err(PrepareError::Mislabelled { file: file.to_owned(), diagnostics: log.diagnostics });
    }
    Ok((experiment, log.diagnostics))
}

/// The time from the first sample to the last one, of all signals, s.
fn span(signals: &BTreeMap<Role, Signal>) -> (f64, f64) {
    let times = signals.values().flat_map(|signal| [signal.start_s, signal.end_s()]);
    times.fold((f64::INFINITY, f64::NEG_INFINITY), |(first, last), time_s| (first.min(time_s), last.max(time_s)))
}
