//! State that all answers share.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::Value;

use crate::folder::Folder;
use crate::handles::Handles;
use crate::tries::Tries;

/// State that all answers share.
pub(crate) type Shared = Arc<Inner>;

#[derive(Debug)]
pub(crate) struct Inner {
    pub(crate) folder: Folder,
    pub(crate) program: Program,
    pub(crate) handles: Handles,
    pub(crate) predictions: Tries<dynoid::can::Tried>,
    pub(crate) proposals: Tries<dynoid::experiments::RatedExperiments>,
}

/// The program, whose commands the app runs.
#[derive(Debug, Clone)]
pub struct Program {
    /// The file to run: the program itself, or an interpreter.
    pub path: PathBuf,
    /// Words before those of a command, such as the module that an interpreter runs.
    pub before: Vec<String>,
    /// Its commands with their arguments: a list, in which each has its `words`.
    pub commands: Value,
}

impl Program {
    /// Tells whether a word begins one of its commands.
    pub(crate) fn has(&self, command: &str) -> bool {
        self.commands.as_array().into_iter().flatten().any(|each| each["words"][0] == command)
    }
}
