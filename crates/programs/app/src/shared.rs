//! State that all answers share.

use std::path::PathBuf;
use std::sync::Arc;

use crate::folder::Folder;
use crate::handles::Handles;

/// State that all answers share.
pub(crate) type Shared = Arc<Inner>;

#[derive(Debug)]
pub(crate) struct Inner {
    pub(crate) folder: Folder,
    pub(crate) program: Program,
    pub(crate) handles: Handles,
}

/// The program, whose commands the app runs.
#[derive(Debug, Clone)]
pub struct Program {
    /// The file to run: the program itself, or an interpreter.
    pub path: PathBuf,
    /// Words before those of a command, such as the module that an interpreter runs.
    pub before: Vec<String>,
    /// Its commands with their arguments, as JSON.
    pub commands: String,
}
