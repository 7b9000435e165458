//! What is in a file.

use super::value::Value;
use crate::StartTime;

/// What is in a file.
#[derive(Default)]
pub(super) struct Variables {
    /// The variables in the order of the file, with their names.
    pub(super) list: Vec<(String, Value)>,
    /// What time stamps with a date count from.
    pub(super) start_time: Option<StartTime>,
}
