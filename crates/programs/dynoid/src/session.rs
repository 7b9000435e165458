//! A bench with its recordings, and what they show.

use bench_model::document::BenchModelDocument;
use numerics::parallel::current_num_threads;
use part_controller::speed_controller::SpeedControl;
use part_engine::EngineTorque;
use part_friction::Friction;
use part_lines::lines::RecordingLines;
use part_shaft::shaft_analysis::ShaftAnalysis;
use part_torque::model_comparison::{ModelComparison, OrdersTried};
use part_torque::torque_signals::TorqueSignals;
use rig::{BenchFile, Diagnostic, Experiment};
use study::{Analyses, Campaign, NextExperiments, NextOptions, Prepared, Source, Study, StudyError, next_experiments};
use work::Context;

use crate::bench::Bench;
use crate::error::Error;
use crate::files::Files;
use crate::find::{InputFile, listed};
use crate::limits::OtherLimits;
use crate::{analyses, date};

/// A bench with recordings that were checked and brought into SI.
#[derive(Debug)]
pub struct Session {
    bench: Bench,
    recordings: Prepared,
    seed: Option<u64>,
}

impl Session {
    /// Reads and prepares the recordings that the bench lists. They are a step of the work with two parts each. As many
    /// are decoded at a time as are prepared at once.
    ///
    /// # Errors
    /// No recordings, or a file that cannot be read. One that cannot be decoded is left out, and [`Session::doubts`]
    /// has the reason.
    pub fn open(bench: Bench, files: &Files, context: &Context) -> Result<Self, Error> {
        files.is_on(bench.path(), &bench.file().recordings.files);
        let found = listed(bench.path(), &bench.file().recordings.files)?;
        let step = context.step("reading", 2 * found.len() as u64);
        let mut session = Self::without_recordings(bench);
        let read = |input: &InputFile| {
            let reading = step.step(format!("reading {}", input.name), 0);
            files.read_source(input, session.bench.file(), &reading)
        };
        let mut recordings = Prepared::default();
        for some in found.chunks(current_num_threads()) {
            let sources = some.iter().map(read).collect::<Result<_, _>>()?;
            recordings.add(session.bench.file(), sources, &step);
        }
        session.recordings = recordings;
        Ok(session)
    }

    /// Prepares recordings that are in memory.
    pub fn of(bench: Bench, sources: Vec<Source>, context: &Context) -> Self {
        let recordings = Prepared::of(bench.file(), sources, context);
        Session { recordings, ..Self::without_recordings(bench) }
    }

    /// A bench of which nothing is recorded yet.
    pub fn without_recordings(bench: Bench) -> Self {
        Session { bench, recordings: Prepared::default(), seed: None }
    }

    /// The same, of recordings that were simulated with this seed.
    pub fn with_seed(self, seed: Option<u64>) -> Self {
        Session { seed, ..self }
    }

    /// The bench.
    pub fn bench(&self) -> &Bench {
        &self.bench
    }

    /// The recordings that can be used.
    pub fn experiments(&self) -> &[Experiment] {
        self.recordings.experiments()
    }

    /// Doubts about the recordings, and why some cannot be used.
    pub fn doubts(&self) -> &[Diagnostic] {
        self.recordings.diagnostics()
    }

    /// The recordings, prepared.
    pub(crate) fn prepared(&self) -> Prepared {
        self.recordings.clone()
    }

    /// The bench file with other limits.
    pub(crate) fn limited(&self, other: &OtherLimits) -> Result<BenchFile, Error> {
        let path = || self.bench.path().to_owned();
        let limits = other.in_place_of(&self.bench.file().limits);
        let limits = limits.map_err(|reason| Error::NotPredicted { path: path(), reason })?;
        let mut file = self.bench.file().clone();
        file.limits = limits;
        Ok(file)
    }

    /// The campaign of this session, for a function that studies it.
    fn with_campaign<T>(&self, study: impl FnOnce(Campaign<'_>) -> Result<T, StudyError>) -> Result<T, Error> {
        let name = self.bench.name();
        let campaign = Campaign {
            bench: self.bench.file(),
            bench_file: (&name, self.bench.text()),
            recordings: self.recordings.clone(),
            seed: self.seed,
        };
        study(campaign).map_err(|error| Error::of_study(self.bench.path(), error))
    }

    /// Estimates every part that the recordings allow, and judges the model on what it has not seen.
    ///
    /// # Errors
    /// No recording that can be used.
    pub fn study(&self, context: &Context) -> Result<Study, Error> {
        self.with_campaign(|campaign| study::run(campaign, context)).map(dated)
    }

    /// The same study, and all analyses beside it.
    ///
    /// # Errors
    /// Those of [`Session::study`].
    pub fn study_full(&self, context: &Context) -> Result<(Study, Analyses), Error> {
        let found = self.with_campaign(|campaign| study::run_full(campaign, context));
        found.map(|(study, analyses)| (dated(study), analyses))
    }

    /// The bench model of the recordings, for which all is estimated that a study needs.
    ///
    /// # Errors
    /// Recordings that give none.
    pub fn bench_model(&self, context: &Context) -> Result<BenchModelDocument, Error> {
        let model = self.model(&self.study(context)?);
        model.ok_or_else(|| Error::NoModelOfBench { path: self.bench.path().to_owned() })
    }

    /// The bench model of a study, if it has one.
    pub fn model(&self, study: &Study) -> Option<BenchModelDocument> {
        study::bench_model(study, self.bench.origin(), &report::wording::MODEL_WORDS)
    }

    /// The lines of the spectra of each recording, and their causes.
    pub fn lines(&self, context: &Context) -> Vec<RecordingLines> {
        analyses::lines(self.experiments(), self.bench.file(), context)
    }

    /// The torque signals against each other, and the shaft torque rebuilt.
    pub fn torque_signals(&self, context: &Context) -> TorqueSignals {
        analyses::torque_signals(self.experiments(), self.bench.file(), context)
    }

    /// Models of the torque control, compared.
    ///
    /// # Errors
    /// No recording from which they can be estimated.
    pub fn torque_control(&self, orders: OrdersTried, context: &Context) -> Result<ModelComparison, Error> {
        Ok(analyses::torque_control(self.experiments(), self.bench.file(), orders, context)?)
    }

    /// The speed controller and its feed-forward.
    pub fn controller(&self, context: &Context) -> SpeedControl {
        analyses::controller(self.experiments(), self.bench.file(), context)
    }

    /// The shaft of every recording, and of all together.
    pub fn shaft(&self, context: &Context) -> ShaftAnalysis {
        analyses::shaft(self.experiments(), self.bench.file(), context)
    }

    /// The engine's torque, rebuilt.
    pub fn engine(&self, context: &Context) -> EngineTorque {
        analyses::engine(self.experiments(), self.bench.file(), context)
    }

    /// Friction and inertia of the dynamometer, from the recordings without shaft.
    ///
    /// # Errors
    /// No recording that shows them.
    pub fn friction(&self) -> Result<Friction, Error> {
        Ok(analyses::friction(self.experiments(), self.bench.file())?)
    }

    /// Gains from each further experiment; there may be no recordings yet.
    ///
    /// # Errors
    /// A bench of which too little is known to try anything on.
    pub fn next(&self, options: NextOptions, context: &Context) -> Result<NextExperiments, Error> {
        let found = next_experiments(self.bench.file(), self.recordings.clone(), options, context);
        found.map_err(|error| Error::of_next(self.bench.path(), error))
    }
}

/// A study of today.
fn dated(mut study: Study) -> Study {
    study.provenance.studied_on = Some(date::today());
    study
}
