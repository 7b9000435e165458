//! The bench that experiments are tried on: bench file, and study if there is one.

use std::path::Path;

use bench::BenchFile;
use bench::model::AssembledModel;
use bench::virtual_bench::StatedBench;

use crate::commands::study::read_bench;
use crate::error::CliError;
use crate::input;
use crate::terminal::Terminal;

/// Inertias that differ by more than this part are not the same.
const SAME_INERTIA: f64 = 1e-3;

/// A bench file, the model of a study, and the virtual bench of both.
pub(in crate::commands) struct Bench {
    pub(in crate::commands) file: BenchFile,
    pub(in crate::commands) assembled: Option<AssembledModel>,
    pub(in crate::commands) stated: StatedBench,
}

impl Bench {
    pub(in crate::commands) fn read(
        path: &Path,
        study: Option<&Path>,
        terminal: &mut Terminal,
    ) -> Result<Self, CliError> {
        let (file, _) = read_bench(path)?;
        let assembled = study.map(read_model).transpose()?;
        let stated = StatedBench::of(&file, assembled.as_ref().map(|assembled| &assembled.model))
            .map_err(|source| CliError::VirtualBench { path: path.to_owned(), source })?;
        if let (Some(assembled), Some(study)) = (&assembled, study) {
            let model = &assembled.model.mechanics;
            let differs = |a: f64, b: f64| (a - b).abs() > SAME_INERTIA * b;
            if differs(model.dyno_inertia_kg_m2, file.dynamometer_inertia_kg_m2)
                || differs(model.engine_inertia_kg_m2, file.engine_inertia_kg_m2)
            {
                terminal.warning(&format!(
                    "{}: the study was made with other inertias than {} states; stiffness and damping scale with them: run \
                     the study again",
                    study.display(),
                    path.display()
                ));
            }
        }
        Ok(Bench { file, assembled, stated })
    }
}

fn read_model(path: &Path) -> Result<AssembledModel, CliError> {
    let text = input::read_text(path, "a study.json as `dynoid study run` writes")?;
    report::model(&text).map_err(|source| CliError::StudyModel { path: path.to_owned(), source })
}
