//! Models whose frequency responses, step responses and poles are shown.

use std::path::{Path, PathBuf};

use bench_model::analysis;
use bench_model::document::BenchModelDocument;
use ident::{IdentError, ModelDocument};
use toolbox_report::models::{LoopMargins, Model as Shown};

use crate::error::Error;
use crate::files::Files;
use crate::models::{Model, model_name};

/// The linear models in files, with or without their noise models, for [`toolbox_report::models`]. A bench model is
/// taken as linear models. It has the margins of its speed loop, which is closed in it.
///
/// # Errors
/// A file that cannot be read, or holds no model.
pub fn models_in(paths: &[PathBuf], with_noise: bool, files: &Files) -> Result<Vec<Shown>, Error> {
    let mut all = Vec::new();
    for path in paths {
        let wrong = |error: IdentError| Error::ModelFile { path: path.clone(), reason: error.to_string() };
        for (name, document, margins) in read(path, files)? {
            let models = Shown::with_noise(&name, document, with_noise).map_err(wrong)?;
            all.extend(models.into_iter().map(|model| model.with_margins(margins)));
        }
    }
    Ok(all)
}

/// The models of a file: their names, and which loop their margins are of.
fn read(path: &Path, files: &Files) -> Result<Vec<(String, ModelDocument, LoopMargins)>, Error> {
    match files.model(path)? {
        Model::Linear(document) => Ok(vec![(model_name(path), *document, LoopMargins::OfModel)]),
        Model::Bench(bench) => of_bench(path, &bench),
    }
}

fn of_bench(path: &Path, bench: &BenchModelDocument) -> Result<Vec<(String, ModelDocument, LoopMargins)>, Error> {
    let speed_loop = analysis::margins(&bench.model).map_or(LoopMargins::None, |found| LoopMargins::Within {
        gain_db: found.gain_margin_db,
        phase_deg: found.phase_margin_deg,
        crossover_hz: found.crossover_hz,
    });
    let name = model_name(path);
    let models = export::toolbox_models(bench).map_err(|source| Error::Export { path: path.to_owned(), source })?;
    let named = |(mode, document): (&str, ModelDocument)| {
        let is_loop = document.inputs.iter().any(|input| input.name == "N_d*");
        (format!("{name} {mode}"), document, if is_loop { speed_loop } else { LoopMargins::None })
    };
    Ok(models.into_iter().map(named).collect())
}
