//! Several models from files, all of one kind.

use std::path::PathBuf;

use crate::error::Error;
use crate::files::Files;
use crate::linear::NamedModel;
use crate::models::{Model, model_name};
use crate::replay::BenchModelFile;

/// Models of one kind.
#[derive(Debug, Clone)]
pub enum Models {
    /// Models of benches.
    Bench(Vec<BenchModelFile>),
    /// Linear models of any channels.
    Linear(Vec<NamedModel>),
}

impl Files {
    /// The models in files, all of one kind.
    ///
    /// # Errors
    /// Files of both kinds, or one that cannot be read.
    pub fn models(&self, paths: &[PathBuf]) -> Result<Models, Error> {
        let (mut benches, mut linear, mut first_linear) = (Vec::new(), Vec::new(), None);
        for path in paths {
            match self.model(path)? {
                Model::Bench(document) => benches.push(BenchModelFile { path: path.clone(), document: *document }),
                Model::Linear(document) => {
                    linear.push(NamedModel { name: model_name(path), document: *document });
                    first_linear = first_linear.or(Some(path));
                }
            }
        }
        match (benches.first(), first_linear) {
            (Some(bench), Some(linear)) => Err(Error::TwoKinds { bench: bench.path.clone(), linear: linear.clone() }),
            (Some(_), None) => Ok(Models::Bench(benches)),
            (None, _) => Ok(Models::Linear(linear)),
        }
    }
}
