//! A model's innovations form with the data that drive it.

use std::borrow::Cow;

use lti::Innovations;

use crate::data::band_limited::{BandLimitedForm, REACH, with_courses};
use crate::{Dataset, IdentError, Intersample, LinearModel};

/// A model's innovations form with the data that it is driven by.
pub(crate) struct OnData<'a> {
    pub(crate) form: Innovations,
    pub(crate) data: Cow<'a, Dataset>,
    /// Rows at the beginning and at the end of each experiment that rest on a guess of the inputs beyond it.
    pub(crate) edges: (usize, usize),
}

impl<'a> OnData<'a> {
    /// A model on data whose inputs were zero before, where they are `at_rest`.
    pub(crate) fn new<M: LinearModel + ?Sized>(
        model: &M,
        data: &'a Dataset,
        at_rest: bool,
    ) -> Result<Self, IdentError> {
        let sample_time_s = data.sample_time_s();
        let band_limited = match data.intersample() {
            Intersample::BandLimited => model.band_limited(sample_time_s)?,
            _ => None,
        };
        let Some(BandLimitedForm { innovations, courses }) = band_limited else {
            let form = model.innovations(sample_time_s, data.intersample())?;
            return Ok(OnData { form, data: Cow::Borrowed(data), edges: (0, 0) });
        };
        let latest = courses.iter().map(|(_, delay)| *delay).fold(0.0, f64::max).ceil() as usize;
        let edges = (if at_rest { 0 } else { REACH + latest }, REACH);
        Ok(OnData { form: innovations, data: Cow::Owned(with_courses(data, &courses, at_rest)?), edges })
    }
}
