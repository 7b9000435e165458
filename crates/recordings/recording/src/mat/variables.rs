//! Contents of a file.

use super::dataset::Dataset;
use super::value::Value;
use crate::StartTime;

/// Contents of a file.
#[derive(Default)]
pub(super) struct Variables {
    /// The variables in the order of the file, with their names.
    pub(super) list: Vec<(String, Value)>,
    /// Origin of time stamps with a date.
    pub(super) start_time: Option<StartTime>,
    /// The datasets whose numbers are not read yet.
    pub(super) datasets: Vec<Dataset>,
}
