//! A conversion as the file describes it.

use std::collections::HashMap;
use std::sync::Arc;

use crate::Obstacle;
use crate::conversion::Conversion;

/// Conversions by their place in the file, and whether the raw values are integers.
pub(super) type Known = HashMap<(u64, bool), Option<Converted>>;

/// A conversion as the file describes it.
#[derive(Debug, Clone)]
pub(super) struct Converted {
    pub(super) name: Arc<str>,
    pub(super) unit: Arc<str>,
    pub(super) conversion: Result<Arc<Conversion>, Obstacle>,
}
