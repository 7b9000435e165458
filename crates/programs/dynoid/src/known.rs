//! A bench as far as it is known: the bench that experiments and tests are tried on.

use std::path::{Path, PathBuf};

use bench_model::disturbances::Disturbances;
use bench_model::document::{BenchModelDocument, Validity};
use bench_model::model::{AssembledModel, BenchModel};
use design::safety::{BenchSpread, FrictionSpread, Prior};
use page::{Block, Page, Prose};
use rig::BenchFile;
use rig::engine_pulses::KnownPulses;
use rig::experiment::ExperimentPlan;
use rig::facts::StatedInertia;
use serde::Serialize;
use virtual_bench::{Assumption, StatedBench};

use crate::bench::Bench;
use crate::date;
use crate::error::{Error, NotPredicted};
use crate::files::Files;
use crate::mark::Kind;
use crate::models::no_model;
use crate::read::{is_json, sha256_of_text};

const WANTED: &str = "a model.json or study.json as `dynoid study` writes, or an FMU of dynoid";

/// Digits of a hash by which people compare files.
const HASH_DIGITS: usize = 12;
/// Inertias that differ by more than this part are not the same.
const SAME_INERTIA: f64 = 1e-3;

/// Source of the engine's firing pulses.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "from")]
pub enum PulsesFrom<'a> {
    /// The bench file.
    #[serde(rename = "bench file")]
    BenchFile,
    /// Recordings.
    #[serde(rename = "recordings")]
    Recordings {
        /// Which.
        recordings: &'a [String],
    },
    /// Usual values of the class.
    #[serde(rename = "prior")]
    Prior,
}

impl<'a> PulsesFrom<'a> {
    pub(crate) fn of(pulses: &'a KnownPulses) -> Self {
        match pulses {
            KnownPulses::Stated => PulsesFrom::BenchFile,
            KnownPulses::Estimated(pulses) => PulsesFrom::Recordings { recordings: &pulses.recordings },
            KnownPulses::Assumed(_) => PulsesFrom::Prior,
        }
    }
}

/// Benches that are drawn for a probability; equal seeds give equal results.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draws {
    /// Number of benches.
    pub benches: usize,
    /// Seed.
    pub seed: u64,
}

/// A bench as far as it is known: its bench file, the model of a study if there is one, and the virtual bench of both.
#[derive(Debug, Clone)]
pub struct KnownBench {
    path: PathBuf,
    file: BenchFile,
    assembled: Option<AssembledModel>,
    stated: StatedBench,
    validity: Validity,
    /// Which model it is, in words; none without a model.
    model_in_words: Option<String>,
    /// The file of the model where it rests on other inertias than the bench file states.
    of_other_inertias: Option<PathBuf>,
}

impl KnownBench {
    /// Reads a bench file, and the model of a study: a model.json, a study.json or an FMU of dynoid.
    ///
    /// # Errors
    /// A file that cannot be read, and a bench that cannot be simulated.
    pub fn load(path: &Path, model: Option<&Path>, files: &Files) -> Result<Self, Error> {
        if is_json(path) {
            return Err(Error::NotABench { path: path.to_owned() });
        }
        let bench = Bench::load(path, files)?;
        match model {
            None => Self::stated(&bench),
            Some(file) => {
                let read = read_model(file, files)?;
                let in_words = in_words(&file.display().to_string(), read.origin.as_ref(), Some(&read.text));
                let found = Self::with(&bench, Some((read.assembled, read.validity)))?;
                let of_other_inertias = found.has_other_inertias().then(|| file.to_owned());
                Ok(KnownBench { model_in_words: Some(in_words), of_other_inertias, ..found })
            }
        }
    }

    /// A bench of which no more is known than its bench file states.
    ///
    /// # Errors
    /// A bench that cannot be simulated.
    pub fn stated(bench: &Bench) -> Result<Self, Error> {
        Self::with(bench, None)
    }

    /// A bench with the model of a study.
    ///
    /// # Errors
    /// A bench that cannot be simulated.
    pub fn of(bench: &Bench, model: BenchModelDocument) -> Result<Self, Error> {
        let in_words = in_words("of the bench", Some(&model), None);
        let validity = model.validity;
        let found = Self::with(bench, Some((model.assembled(), validity)))?;
        Ok(KnownBench { model_in_words: Some(in_words), ..found })
    }

    fn with(bench: &Bench, model: Option<(AssembledModel, Validity)>) -> Result<Self, Error> {
        let (assembled, validity) = model.unzip();
        let (file, path) = (bench.file().clone(), bench.path().to_owned());
        let stated = StatedBench::of(&file, assembled.as_ref().map(|assembled| &assembled.model))
            .map_err(|source| Error::VirtualBench { path: path.clone(), source })?
            .with_pulses(assembled.as_ref().and_then(|assembled| assembled.engine_pulses.as_ref()));
        let validity = validity.unwrap_or_default();
        Ok(KnownBench { path, file, assembled, stated, validity, model_in_words: None, of_other_inertias: None })
    }

    /// Tells whether the model rests on other inertias than the bench file states.
    fn has_other_inertias(&self) -> bool {
        let Some(assembled) = &self.assembled else { return false };
        let (model, file) = (&assembled.model.mechanics, &self.file);
        // Where an inertia is uncertain, the study estimates it within that.
        let doubt = |stated: StatedInertia| SAME_INERTIA.max(3.0 * stated.uncertainty_percent / 100.0);
        let differs = |a: f64, b: f64, within: f64| (a - b).abs() > within * b;
        differs(model.dyno_inertia_kg_m2, file.dynamometer_inertia_kg_m2, doubt(file.dynamometer_inertia()))
            || differs(model.engine_inertia_kg_m2, file.engine_inertia_kg_m2, doubt(file.engine_inertia()))
    }

    /// A doubt about bench file and model together, in words.
    pub fn doubt(&self) -> Option<String> {
        let study = self.of_other_inertias.as_ref()?;
        Some(format!(
            "{}: the study was made with other inertias than {} states, and its own are used: run the study again where those \
             of the bench file are right",
            study.display(),
            self.path.display()
        ))
    }

    /// The bench file.
    pub fn file(&self) -> &BenchFile {
        &self.file
    }

    /// Place of the bench file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The model of a study.
    pub fn assembled(&self) -> Option<&AssembledModel> {
        self.assembled.as_ref()
    }

    /// The virtual bench, with what of it is stated and what assumed.
    pub fn virtual_bench(&self) -> &StatedBench {
        &self.stated
    }

    /// The range of the recordings that the model is from.
    pub fn validity(&self) -> Validity {
        self.validity
    }

    /// A page of predictions, with the bench, the model and the day at its end and at the top of each printed page.
    pub fn on_page(&self, page: Page) -> Page {
        let model = self.model_in_words.as_deref().unwrap_or("no model of a study");
        let (today, version) = (date::today(), env!("CARGO_PKG_VERSION"));
        let line = format!("{} · {model} · predicted on {today}, dynoid {version}", self.file.name);
        let origin = Block::note(Prose::verbatim(line.clone()));
        Page { running_head: line, blocks: page.blocks.into_iter().chain([origin]).collect(), ..page }
    }

    /// Friction of the dynamometer, as the bench file states it, as the model's run-outs show it, or as dynamometers
    /// have it.
    pub fn friction(&self) -> FrictionSpread {
        let estimated = self.assembled.as_ref().and_then(|assembled| assembled.dyno_friction.as_ref());
        FrictionSpread::of(&self.file, self.stated.parameters.drive.torque_limit_nm, estimated)
    }

    /// Errors of the encoder and ripple of the drive, as the recordings show them or as benches have them.
    pub fn disturbances(&self) -> Disturbances {
        self.assembled.as_ref().and_then(|assembled| assembled.disturbances).unwrap_or_else(Disturbances::assumed)
    }

    /// Differences of possible benches from the nominal one: the covariance of the study, or what is usual.
    pub fn spread(&self) -> BenchSpread<'_> {
        match &self.assembled {
            Some(assembled) => BenchSpread::Estimated(&assembled.uncertainty),
            None => BenchSpread::Prior(Prior::default()),
        }
    }

    /// Tells whether the speed control of the engine is assumed.
    pub(crate) fn assumes_engine(&self) -> bool {
        self.stated.assumptions.contains(&Assumption::Engine)
    }

    /// The linear model that predictions rest on. Parts that the study lacks are those of the virtual bench; they are
    /// among the assumptions.
    ///
    /// # Errors
    /// A plan with a shaft that is not known.
    pub fn model_for(&self, plan: &ExperimentPlan) -> Result<BenchModel, NotPredicted> {
        if plan.has_shaft { self.model_with_shaft() } else { Ok(self.any_model()) }
    }

    /// The linear model of the whole bench.
    ///
    /// # Errors
    /// A shaft that is not known.
    pub fn model_with_shaft(&self) -> Result<BenchModel, NotPredicted> {
        if self.stated.knows_shaft() { Ok(self.any_model()) } else { Err(NotPredicted::UnknownShaft) }
    }

    fn any_model(&self) -> BenchModel {
        self.stated.linear_model(self.assembled.as_ref().map(|assembled| &assembled.model))
    }

    pub(crate) fn refused(&self, reason: impl Into<NotPredicted>) -> Error {
        Error::NotPredicted { path: self.path.clone(), reason: reason.into() }
    }
}

/// A model with what pages say of it.
struct ReadModel {
    assembled: AssembledModel,
    validity: Validity,
    origin: Option<BenchModelDocument>,
    text: String,
}

fn read_model(path: &Path, files: &Files) -> Result<ReadModel, Error> {
    let text = files.model_text(path, WANTED)?;
    match Kind::of(&text) {
        Kind::Linear => Err(Error::IsLinearModel { path: path.to_owned() }),
        Kind::Other => Err(no_model(path, &text, WANTED)),
        Kind::Bench | Kind::Study => {
            let found = study::model_with_validity(&text);
            let (assembled, validity) = found.map_err(|source| Error::BenchModel { path: path.to_owned(), source })?;
            Ok(ReadModel { assembled, validity, origin: BenchModelDocument::from_json(&text).ok(), text })
        }
    }
}

/// Which model it is: its file, when and with which version it was made, and the hash of its text.
fn in_words(name: &str, document: Option<&BenchModelDocument>, text: Option<&str>) -> String {
    let provenance = document.map(|document| &document.provenance);
    let made = provenance.map(|one| format!(" of {}, dynoid {}", one.date, one.dynoid_version)).unwrap_or_default();
    let hash = text.map(|text| sha256_of_text(text).chars().take(HASH_DIGITS).collect::<String>());
    let hash = hash.map(|hash| format!(", SHA-256 {hash}…")).unwrap_or_default();
    format!("model {name}{made}{hash}")
}
