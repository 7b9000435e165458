//! A bench and what its recordings show.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use ::study::{NextOptions, Source, document};
use dynoid::facts::{
    EngineFacts, FrictionFacts, LinesFacts, ShaftFacts, SpeedControlFacts, StudyFacts, TorqueControlFacts,
    TorqueSignalsFacts,
};
use dynoid::{Error, Session, StudyFolder, StudyOptions, paths};
use part_lines::lines::over_speed;
use part_torque::model_comparison::OrdersTried;
use pyo3::prelude::*;
use report::wording;
use work::Context;

use crate::errors::Fault;
use crate::interrupt;
use crate::made::{Made, files};
use crate::recording::Recording;
use crate::studied::{FoundStudy, Studied};

/// Lines that a page shows of each signal; a result has all of them.
const LINES_SHOWN: usize = 8;

/// Files of recordings with the labels of their experiments, and doubts about others.
type Experiments = (Vec<(String, String)>, Vec<String>);

/// A bench file, and the recordings that it lists once they are read.
#[pyclass(frozen, module = "dynoid._dynoid")]
pub(crate) struct Bench {
    bench: dynoid::Bench,
    session: OnceLock<Session>,
}

impl Bench {
    /// The bench with its recordings, which are read when they are first needed.
    fn session(&self, context: &Context) -> Result<&Session, Error> {
        if let Some(session) = self.session.get() {
            return Ok(session);
        }
        let session = Session::open(self.bench.clone(), &files(false), context)?;
        Ok(self.session.get_or_init(|| session))
    }

    /// Shows a result of the recordings.
    fn show(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        threads: Option<usize>,
        find: impl FnOnce(&Session, &Context) -> Result<Made, Error> + Send,
    ) -> Result<Made, Fault> {
        Ok(interrupt::run(py, progress, threads, |context| {
            let step = context.step("analysis", 2);
            let session = self.session(&step)?;
            find(session, &step)
        })??)
    }

    /// Tries something on the bench, as far as it is known.
    pub(crate) fn attempt<T: Send>(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        threads: Option<usize>,
        attempt: impl FnOnce(&dynoid::Bench, &Context) -> Result<T, Error> + Send,
    ) -> Result<T, Fault> {
        Ok(interrupt::run(py, progress, threads, |context| attempt(&self.bench, context))??)
    }
}

#[pymethods]
impl Bench {
    #[new]
    fn new(py: Python<'_>, path: PathBuf, recordings: Option<Vec<Bound<'_, Recording>>>) -> Result<Self, Fault> {
        let bench = dynoid::Bench::load(&path, &files(false))?;
        let session = OnceLock::new();
        if let Some(given) = recordings {
            let source = |one: &Bound<'_, Recording>| -> PyResult<Source> {
                let (name, sha256) = one.get().source();
                let sha256 = sha256.known();
                // Named as the bench file would list it.
                let file = paths::name_in(Path::new(&name), &bench.folder());
                Ok(Source { file, sha256, recording: Ok(one.get().whole(py)?) })
            };
            let sources = given.iter().map(source).collect::<PyResult<Vec<_>>>()?;
            let prepared = interrupt::run(py, None, None, |context| Session::of(bench.clone(), sources, context))?;
            session.get_or_init(|| prepared);
        }
        Ok(Bench { bench, session })
    }

    /// Name of the bench.
    #[getter]
    fn name(&self) -> &str {
        &self.bench.file().name
    }

    /// Place of the bench file.
    #[getter]
    fn path(&self) -> String {
        self.bench.path().display().to_string()
    }

    /// Text of the bench file.
    #[getter]
    fn text(&self) -> &str {
        self.bench.text()
    }

    /// Files of the recordings that can be used with their experiments, and doubts about the others.
    fn recordings(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        threads: Option<usize>,
    ) -> Result<Experiments, Fault> {
        Ok(interrupt::run(py, progress, threads, |context| {
            let session = self.session(context)?;
            let used = session.experiments().iter().map(|one| (one.file.clone(), one.label.to_string()));
            Ok::<_, Error>((used.collect(), session.doubts().iter().map(wording::diagnostic).collect()))
        })??)
    }

    /// Studies the recordings, and writes the files of a study where a folder is given.
    fn study<'py>(
        &self,
        py: Python<'py>,
        out: Option<PathBuf>,
        full: bool,
        overwrite: bool,
        progress: Option<Py<PyAny>>,
        threads: Option<usize>,
    ) -> Result<(Studied<'py>, Option<Made>), Fault> {
        let (found, analyses) = interrupt::run(py, progress, threads, |context| {
            let options = StudyOptions { full, ..StudyOptions::default() };
            let folder =
                out.map(|out| StudyFolder::check(&self.bench, &out, options, &files(overwrite))).transpose()?;
            let step = context.step("study", 3);
            let session = self.session(&step)?;
            let origin = self.bench.origin();
            let (study, analyses) = match folder {
                Some(folder) => {
                    let written = folder.write(session, &step)?;
                    (written.study, written.analyses)
                }
                None if full => session.study_full(&step).map(|(study, analyses)| (study, Some(analyses)))?,
                None => (session.study(&step)?, None),
            };
            let full = analyses.map(|analyses| {
                let page = report::full_study(&study, &origin, &analyses);
                Made::whole(&StudyFacts::of(&study), page, &document::ANALYSES, &analyses)
            });
            Ok::<_, Error>((FoundStudy::of(&study, &origin)?, full.transpose()?))
        })??;
        Ok((found.into_python(py)?, analyses))
    }

    /// The lines of the spectra, and their causes.
    fn lines(&self, py: Python<'_>, progress: Option<Py<PyAny>>, threads: Option<usize>) -> Result<Made, Fault> {
        self.show(py, progress, threads, |session, context| {
            let found = session.lines(context);
            let signals = over_speed(&found);
            let page = report::pages::lines(&found, &signals, (LINES_SHOWN, false));
            Made::whole(&LinesFacts::of(&found, &signals), page, &document::LINES, &found)
        })
    }

    /// The torque signals against each other, and the shaft torque rebuilt.
    fn torque_signals(
        &self,
        py: Python<'_>,
        progress: Option<Py<PyAny>>,
        threads: Option<usize>,
    ) -> Result<Made, Fault> {
        self.show(py, progress, threads, |session, context| {
            let found = session.torque_signals(context);
            let page = report::pages::torque_signals(&found);
            Made::whole(&TorqueSignalsFacts::of(&found), page, &document::TORQUE_SIGNALS, &found)
        })
    }

    /// Models of the torque control, compared.
    fn torque_control(
        &self,
        py: Python<'_>,
        highest_order: usize,
        longest_delay: usize,
        progress: Option<Py<PyAny>>,
        threads: Option<usize>,
    ) -> Result<Made, Fault> {
        let orders = OrdersTried { highest: highest_order, longest_delay };
        self.show(py, progress, threads, |session, context| {
            let found = session.torque_control(orders, context)?;
            let page = report::pages::torque_control(&found);
            Made::whole(&TorqueControlFacts::of(&found), page, &document::TORQUE_CONTROL, &found)
        })
    }

    /// The speed controller and its feed-forward.
    fn controller(&self, py: Python<'_>, progress: Option<Py<PyAny>>, threads: Option<usize>) -> Result<Made, Fault> {
        self.show(py, progress, threads, |session, context| {
            let found = session.controller(context);
            let page = report::pages::controller(&found);
            Made::whole(&SpeedControlFacts::of(&found), page, &document::SPEED_CONTROL, &found)
        })
    }

    /// The shaft of every recording, and of all together.
    fn shaft(&self, py: Python<'_>, progress: Option<Py<PyAny>>, threads: Option<usize>) -> Result<Made, Fault> {
        self.show(py, progress, threads, |session, context| {
            let found = session.shaft(context);
            Made::whole(&ShaftFacts::of(&found), report::pages::shaft(&found), &document::SHAFT, &found)
        })
    }

    /// The engine's torque, rebuilt.
    fn engine(&self, py: Python<'_>, progress: Option<Py<PyAny>>, threads: Option<usize>) -> Result<Made, Fault> {
        self.show(py, progress, threads, |session, context| {
            let found = session.engine(context);
            Made::whole(&EngineFacts::of(&found), report::pages::engine(&found), &document::ENGINE_TORQUE, &found)
        })
    }

    /// Friction and inertia of the dynamometer.
    fn friction(&self, py: Python<'_>, progress: Option<Py<PyAny>>, threads: Option<usize>) -> Result<Made, Fault> {
        self.show(py, progress, threads, |session, _| {
            let (found, stated) = (session.friction()?, session.bench().file().dynamometer_inertia());
            let page = report::pages::friction(&found, stated);
            let made = Made::whole(&FrictionFacts::of(&found), page, &document::FRICTION, &found)?;
            Ok(made.with_notes(report::friction::doubts(&found, stated)))
        })
    }

    /// Gains from each further experiment.
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn next(
        &self,
        py: Python<'_>,
        speed: f64,
        duration: f64,
        enough: f64,
        seed: u64,
        progress: Option<Py<PyAny>>,
        threads: Option<usize>,
    ) -> Result<Made, Fault> {
        let options = NextOptions { speed_rpm: speed, duration_s: duration, enough, seed };
        self.attempt(py, progress, threads, |bench, context| {
            let step = context.step("looking for the next experiment", 3);
            let without;
            let session = match self.session(&step) {
                Err(Error::NothingMatches { .. } | Error::NoRecordingsListed { .. }) => {
                    without = Session::without_recordings(bench.clone());
                    &without
                }
                read => read?,
            };
            let found = session.next(options, &step)?;
            Made::whole(&found, report::pages::next(&found), &document::NEXT_EXPERIMENTS, &found)
        })
    }
}
