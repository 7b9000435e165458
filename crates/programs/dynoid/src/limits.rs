//! Limits that people move, in place of those that the bench file states.

use std::collections::BTreeMap;

use capability::LimitOf;
use report::can::limit_of;
use rig::bench_file::Limits;
use serde::{Deserialize, Serialize};

use crate::error::NotPredicted;

/// Limits in place of those that the bench file states, in the units of the facts; none where nothing is to limit.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct OtherLimits(pub BTreeMap<LimitOf, Option<f64>>);

impl OtherLimits {
    /// Limits with these in their place.
    pub(crate) fn in_place_of(&self, stated: &Limits) -> Result<Limits, NotPredicted> {
        let mut limits = *stated;
        for (of, limit) in &self.0 {
            let (name, _, si) = limit_of(*of);
            if limit.is_some_and(|limit| !(limit.is_finite() && limit > 0.0)) {
                return Err(NotPredicted::NoLimit { name });
            }
            limits = of.with(limits, limit.map(|limit| limit * si));
        }
        Ok(limits)
    }
}

/// A limit that can be moved.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct MovableFacts {
    of: LimitOf,
    /// Its key in the table `[limits]` of a bench file.
    key: &'static str,
    name: &'static str,
    unit: &'static str,
    stated: Option<f64>,
    /// A larger one needs another run.
    largest: Option<f64>,
    has_course: bool,
}

impl MovableFacts {
    /// The limit of a quantity, with the largest one that needs no other run, SI.
    pub(crate) fn of(of: LimitOf, limits: &Limits, largest: Option<f64>) -> Self {
        let (name, unit, si) = limit_of(of);
        let in_unit = |limit: Option<f64>| limit.map(|limit| limit / si);
        let (stated, largest) = (in_unit(of.limit(limits)), in_unit(largest));
        MovableFacts { of, key: of.key(), name, unit, stated, largest, has_course: of != LimitOf::TimeAtResonance }
    }

    /// All limits that a test with a shaft can have, but the heat of the drive.
    pub(crate) fn all(limits: &Limits) -> Vec<Self> {
        let all = LimitOf::ALL.into_iter().filter(|of| *of != LimitOf::DriveHeat);
        all.map(|of| MovableFacts::of(of, limits, None)).collect()
    }
}
