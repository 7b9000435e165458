//! The bench that experiments are tried on: bench file, and study if there is one.

use std::path::Path;

use ::bench_model::document::Validity;
use ::bench_model::model::{AssembledModel, BenchModel};
use design::safety::FrictionSpread;
use rig::BenchFile;
use rig::experiment::ExperimentPlan;
use rig::facts::StatedInertia;
use virtual_bench::StatedBench;

use crate::commands::bench_model::{self, Kind};
use crate::commands::study::read_bench;
use crate::error::CliError;
use crate::input;
use crate::terminal::Terminal;

const WANTED: &str = "a model.json or study.json as `dynoid study` writes, or an FMU of dynoid";

/// Inertias that differ by more than this part are not the same.
const SAME_INERTIA: f64 = 1e-3;

/// A bench file, the model of a study, and the virtual bench of both.
pub(in crate::commands) struct Bench {
    pub(in crate::commands) file: BenchFile,
    pub(in crate::commands) assembled: Option<AssembledModel>,
    pub(in crate::commands) stated: StatedBench,
    /// The range of the recordings that the model is from.
    pub(in crate::commands) validity: Validity,
}

impl Bench {
    pub(in crate::commands) fn read(
        path: &Path,
        study: Option<&Path>,
        terminal: &mut Terminal,
    ) -> Result<Self, CliError> {
        if input::is_json(path) {
            let what = "this is a model file, not a bench file; give it with --model";
            return Err(CliError::Usage { what: format!("{}: {what}", path.display()) });
        }
        let (file, _) = read_bench(path)?;
        let (assembled, validity) = study.map(read_model).transpose()?.unzip();
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
        Ok(Bench { file, assembled, stated, validity: validity.unwrap_or_default() })
    }

    /// Friction of the dynamometer, as the bench file states it or as dynamometers have it.
    pub(in crate::commands) fn friction(&self) -> FrictionSpread {
        FrictionSpread::of(&self.file, self.stated.parameters.drive.torque_limit_nm)
    }

    /// The linear model that predictions rest on, or in words why a plan cannot be predicted. Parts that the study lacks are
    /// those of the virtual bench; they are among the assumptions.
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

fn read_model(path: &Path) -> Result<(AssembledModel, Validity), CliError> {
    let text = bench_model::text(path, WANTED)?;
    match Kind::of(&text) {
        Kind::Linear => Err(CliError::IsLinearModel { path: path.to_owned() }),
        Kind::Other => Err(bench_model::no_model(path, &text, WANTED)),
        Kind::Bench | Kind::Study => {
            let found = report::model_with_validity(&text);
            found.map_err(|source| CliError::BenchModel { path: path.to_owned(), source })
        }
    }
}
