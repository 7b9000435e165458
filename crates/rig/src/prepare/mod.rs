//! From a recording and a bench file to an [`Experiment`]: SI, roles, one uniform clock a signal, and every doubt on the way.

mod clock;
mod cut;
mod map;
mod physics;
mod rasters;
mod samples;
mod sign;

use std::collections::BTreeMap;

use recording::Recording;
use signal::Signal;

use crate::bench_file::BenchFile;
use crate::diagnostics::{Diagnostic, Finding, Place, Severity};
use crate::experiment::{Experiment, ExperimentLabel};
use crate::role::Role;
pub use physics::saturated_stretches;
pub use sign::wrong_sign;

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
/// Gaps and runs of NaN of at most 20 ms or five samples are interpolated; longer ones leave the longest stretch that is
/// uninterrupted in every signal. What was refused, mended, cut or looks wrong is in the diagnostics.
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
/// let text = b"time [s],n [rpm]\n0,1200\n0.1,1201\n0.2,1200\n0.3,1202\n";
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
    let mut log = Log::new(file);
    log.reader_findings(recording);
    let sources = map::sources(recording, bench_file, &label, &mut log);
    let mut mended = BTreeMap::new();
    for source in &sources {
        if let Some(stretches) = clock::uniform_stretches(source, &mut log)
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
    rasters::check(&sources, &signals, &mut log);
    let experiment = Experiment { file: file.to_owned(), label, signals };
    physics::check(&experiment, bench_file, &mut log);
    Ok((experiment, log.diagnostics))
}

/// The diagnostics of one file.
struct Log {
    file: String,
    diagnostics: Vec<Diagnostic>,
}

impl Log {
    fn new(file: &str) -> Self {
        Log { file: file.to_owned(), diagnostics: Vec::new() }
    }

    /// Notes a finding about the whole file.
    fn file(&mut self, severity: Severity, time_s: Option<f64>, finding: Finding) {
        let place = Place { file: Some(self.file.clone()), channel: None, time_s };
        self.diagnostics.push(Diagnostic { severity, place, finding });
    }

    /// Notes a finding about a channel.
    fn channel(&mut self, severity: Severity, channel: &str, time_s: Option<f64>, finding: Finding) {
        let place = Place { file: Some(self.file.clone()), channel: Some(channel.to_owned()), time_s };
        self.diagnostics.push(Diagnostic { severity, place, finding });
    }

    /// Takes over what the reader found.
    fn reader_findings(&mut self, recording: &Recording) {
        for finding in &recording.findings {
            let severity = if finding.is_loss() { Severity::Warning } else { Severity::Note };
            self.file(severity, None, Finding::ReaderDoubt { reason: finding.to_string() });
        }
    }
}

/// A role's channel as recorded, with the factor that makes it SI with the right sign.
struct Source<'r> {
    role: Role,
    channel: &'r str,
    raster: usize,
    time_s: &'r [f64],
    samples: &'r [f64],
    unit: units::Unit,
    factor: f64,
}

/// Uniformly sampled stretches of one channel in time order, in SI: several where long gaps interrupt it. At least one.
type Stretches = Vec<Signal>;

fn longest(stretches: &[Signal]) -> Option<&Signal> {
    stretches.iter().max_by(|a, b| a.duration_s().total_cmp(&b.duration_s()))
}
