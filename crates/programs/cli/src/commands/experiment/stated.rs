//! The bench that experiments are tried on: bench file, and study if there is one.

use std::path::Path;

use ::bench_model::disturbances::Disturbances;
use ::bench_model::document::{BenchModelDocument, Validity};
use ::bench_model::model::{AssembledModel, BenchModel};
use design::safety::FrictionSpread;
use dynoid::{Files, date};
use page::{Block, Page, Prose};
use rig::BenchFile;
use rig::experiment::ExperimentPlan;
use rig::facts::StatedInertia;
use virtual_bench::StatedBench;

use crate::commands::bench_model::{self, Kind};
use crate::error::CliError;
use crate::terminal::Terminal;

const WANTED: &str = "a model.json or study.json as `dynoid study` writes, or an FMU of dynoid";

/// Digits of a hash by which people compare files.
const HASH_DIGITS: usize = 12;
/// Inertias that differ by more than this part are not the same.
const SAME_INERTIA: f64 = 1e-3;

/// A bench file, the model of a study, and the virtual bench of both.
pub(in crate::commands) struct Bench {
    pub(in crate::commands) file: BenchFile,
    pub(in crate::commands) assembled: Option<AssembledModel>,
    pub(in crate::commands) stated: StatedBench,
    /// The range of the recordings that the model is from.
    pub(in crate::commands) validity: Validity,
    /// Which model it is, in words; none without a model.
    model_in_words: Option<String>,
}

impl Bench {
    pub(in crate::commands) fn read(
        path: &Path,
        study: Option<&Path>,
        terminal: &mut Terminal,
    ) -> Result<Self, CliError> {
        if dynoid::is_json(path) {
            let what = "this is a model file, not a bench file; give it with --model";
            return Err(CliError::Usage { what: format!("{}: {what}", path.display()) });
        }
        let file = dynoid::Bench::load(path, &terminal.files())?.into_file();
        let read = study.map(|path| read_model(path, &terminal.files())).transpose()?;
        let model_in_words = read.as_ref().map(|read| read.in_words.clone());
        let (assembled, validity) = read.map(|read| (read.assembled, read.validity)).unzip();
        let stated = StatedBench::of(&file, assembled.as_ref().map(|assembled| &assembled.model))
            .map_err(|source| CliError::VirtualBench { path: path.to_owned(), source })?
            .with_pulses(assembled.as_ref().and_then(|assembled| assembled.engine_pulses.as_ref()));
        if let (Some(assembled), Some(study)) = (&assembled, study) {
            let model = &assembled.model.mechanics;
            // Where an inertia is uncertain, the study estimates it within that.
            let doubt = |stated: StatedInertia| SAME_INERTIA.max(3.0 * stated.uncertainty_percent / 100.0);
            let differs = |a: f64, b: f64, within: f64| (a - b).abs() > within * b;
            if differs(model.dyno_inertia_kg_m2, file.dynamometer_inertia_kg_m2, doubt(file.dynamometer_inertia()))
                || differs(model.engine_inertia_kg_m2, file.engine_inertia_kg_m2, doubt(file.engine_inertia()))
            {
                terminal.warning(&format!(
                    "{}: the study was made with other inertias than {} states, and its own are used: run the study again \
                     where those of the bench file are right",
                    study.display(),
                    path.display()
                ));
            }
        }
        Ok(Bench { file, assembled, stated, validity: validity.unwrap_or_default(), model_in_words })
    }

    /// A page of predictions, with the bench, the model and the day at its end and at the top of each printed page.
    pub(in crate::commands) fn on_page(&self, page: Page) -> Page {
        let model = self.model_in_words.as_deref().unwrap_or("no model of a study");
        let (today, version) = (date::today(), env!("CARGO_PKG_VERSION"));
        let line = format!("{} · {model} · predicted on {today}, dynoid {version}", self.file.name);
        let origin = Block::note(Prose::verbatim(line.clone()));
        Page { running_head: line, blocks: page.blocks.into_iter().chain([origin]).collect(), ..page }
    }

    /// Friction of the dynamometer, as the bench file states it, as the model's run-outs show it, or as dynamometers
    /// have it.
    pub(in crate::commands) fn friction(&self) -> FrictionSpread {
        let estimated = self.assembled.as_ref().and_then(|assembled| assembled.dyno_friction.as_ref());
        FrictionSpread::of(&self.file, self.stated.parameters.drive.torque_limit_nm, estimated)
    }

    /// Errors of the encoder and ripple of the drive, as the recordings show them or as benches have them.
    pub(in crate::commands) fn disturbances(&self) -> Disturbances {
        self.assembled.as_ref().and_then(|assembled| assembled.disturbances).unwrap_or_else(Disturbances::assumed)
    }

    /// The linear model that predictions rest on, or in words why a plan cannot be predicted. Parts that the study
    /// lacks are those of the virtual bench; they are among the assumptions.
    pub(in crate::commands) fn model_for(&self, plan: &ExperimentPlan) -> Result<BenchModel, &'static str> {
        if plan.has_shaft { self.model_with_shaft() } else { Ok(self.any_model()) }
    }

    /// The linear model, or in words why there is none of this shaft.
    pub(in crate::commands) fn model_with_shaft(&self) -> Result<BenchModel, &'static str> {
        match self.stated.knows_shaft() {
            true => Ok(self.any_model()),
            false => Err(
                "the shaft is not known; add [shaft] with resonance = \"18 Hz\" (or stiffness) to the bench file, or \
                 give a study with --model",
            ),
        }
    }

    fn any_model(&self) -> BenchModel {
        self.stated.linear_model(self.assembled.as_ref().map(|assembled| &assembled.model))
    }
}

/// A model with what pages say of it.
struct ReadModel {
    assembled: AssembledModel,
    validity: Validity,
    in_words: String,
}

fn read_model(path: &Path, files: &Files) -> Result<ReadModel, CliError> {
    let text = bench_model::text(path, WANTED, files)?;
    match Kind::of(&text) {
        Kind::Linear => Err(CliError::IsLinearModel { path: path.to_owned() }),
        Kind::Other => Err(bench_model::no_model(path, &text, WANTED)),
        Kind::Bench | Kind::Study => {
            let found = report::model_with_validity(&text);
            let (assembled, validity) =
                found.map_err(|source| CliError::BenchModel { path: path.to_owned(), source })?;
            Ok(ReadModel { assembled, validity, in_words: in_words(path, &text) })
        }
    }
}

/// The file of a model, when and with which version it was made, and its hash.
fn in_words(path: &Path, text: &str) -> String {
    let provenance = BenchModelDocument::from_json(text).ok().map(|document| document.provenance);
    let made = provenance.map(|one| format!(" of {}, dynoid {}", one.date, one.dynoid_version)).unwrap_or_default();
    let hash: String = dynoid::sha256_of_text(text).chars().take(HASH_DIGITS).collect();
    format!("model {}{made}, SHA-256 {hash}…", path.display())
}
