//! One structure fitted, with whatever ripple its errors show.

use faer::Mat;

use super::model::{DelayFault, DelayModel, LEAD, ModelledDelay, ROUNDING};
use super::ripple::Ripple;
use crate::continuous::estimate::{OutputFit, quantile};
use crate::continuous::record::Beginning;
use crate::continuous::{ContinuousTransferFunction, RationalChannel, TransferFunctionModel};
use crate::data::band_limited::Ground;
use crate::delay::DelayEstimate;
use crate::distributions::student_t_quantile;
use crate::validate::{Independence, ResidualReport, ResidualTest, TestData};
use crate::{Dataset, IdentError, NonlinearOptions};

/// Rounds in which ripple in proportion to the output is found from that output.
const ROUNDS: usize = 2;

/// Zeros of the model that shows whether inputs may have rested before the record.
const FIRST_ZEROS: usize = 1;
/// Poles of that model.
const FIRST_POLES: usize = 2;

/// Steps of a search that only has to show whether there is more to be found.
const GLANCE: usize = 30;

/// Confidence of tests of the errors.
const TESTED: f64 = 0.99;

pub(super) struct Structure<'a> {
    pub(super) options: &'a ModelledDelay,
    /// That of every model, so that all rest on the same rows.
    pub(super) beginning: Beginning,
    pub(super) zeros: usize,
    pub(super) poles: usize,
}

impl Structure<'_> {
    /// The model of data without ripple, its errors not tested, after a short search.
    pub(super) fn glance(&self, clean: &Dataset) -> Result<(DelayModel, TransferFunctionModel), IdentError> {
        let short = NonlinearOptions { iteration_limit: GLANCE, ..NonlinearOptions::default() };
        let found = self.with_ripple(clean, 0).with_search(short).fit_one(clean, 0, self.beginning, None)?;
        let own = self.start(&found, clean.inputs(), clean.inputs())?;
        Ok((self.described(clean, &found, Vec::new()), own))
    }

    /// The model, from a start where there is one, and the data without ripple.
    pub(super) fn fit(
        &self,
        data: &Dataset,
        start: Option<&TransferFunctionModel>,
    ) -> Result<(DelayModel, Dataset), IdentError> {
        let plain = self.with_ripple(data, 0);
        let mut found = plain.fit_one(data, 0, self.beginning, start)?;
        let mut clean = data.clone();
        let first = self.beginning.first;
        let ripple = Ripple::of(data, &errors(data, &found, first)?);
        for _ in 0..if ripple.lines_hz.is_empty() { 0 } else { ROUNDS } {
            let with = ripple.beside(data, &clean, &errors(&clean, &found, first)?)?;
            let start = self.start(&found, data.inputs(), with.inputs())?;
            found = self.with_ripple(data, with.inputs() - data.inputs()).fit_one(
                &with,
                0,
                self.beginning,
                Some(&start),
            )?;
            clean = ripple.removed(data, &with, &found)?;
        }
        let mut model = self.described(&clean, &found, ripple.lines_hz);
        let own = self.start(&found, data.inputs(), data.inputs())?;
        if model.loss > 0.0 {
            model.faults.extend(self.tested(&plain, &clean, &own)?);
        }
        Ok((model, clean))
    }

    /// Where the rows begin that models of these data rest on.
    pub(super) fn beginning(options: &ModelledDelay, data: &Dataset) -> Result<Beginning, IdentError> {
        let unknown = Beginning { first: options.longest + LEAD, is_held: false, is_refuted: false };
        let first = Structure { options, beginning: unknown, zeros: FIRST_ZEROS, poles: FIRST_POLES };
        first.with_ripple(data, 0).beginning(data)
    }

    /// The model with its intervals by profiles, at the better minimum that these may lead to.
    pub(super) fn profiled(&self, clean: &Dataset, model: &DelayModel) -> Result<DelayModel, IdentError> {
        let (plain, inputs) = (self.with_ripple(clean, 0), clean.inputs());
        let own = TransferFunctionModel::new(model.channels.clone(), inputs, Mat::identity(1, 1))?;
        let found = plain.profile_one(clean, 0, self.beginning, &own)?;
        let mut renewed = self.described(clean, &found, model.ripple_hz.clone());
        renewed.faults.extend(model.faults.iter().filter(|fault| !fault.is_of_search()));
        // Ripple has values of its own.
        renewed.free = model.free;
        Ok(renewed)
    }

    /// Structure of the estimate, with so many inputs more that only have a gain.
    fn with_ripple(&self, data: &Dataset, columns: usize) -> ContinuousTransferFunction {
        let inputs = data.inputs();
        let each = |own: usize| [vec![own; inputs], vec![0; columns]].concat();
        let longest_s = (self.options.longest + LEAD) as f64 * data.sample_time_s();
        let delays = [vec![(0.0, longest_s); inputs], vec![(0.0, 0.0); columns]].concat();
        ContinuousTransferFunction::per_input(each(self.zeros), each(self.poles))
            .with_delay_between(&delays)
            .with_offset()
    }

    /// The channels of the inputs, and gains of zero for those that are no inputs.
    fn start(
        &self,
        found: &OutputFit<RationalChannel>,
        inputs: usize,
        all: usize,
    ) -> Result<TransferFunctionModel, IdentError> {
        let mut channels = found.model.channels()[..inputs.min(found.model.channels().len())].to_vec();
        while channels.len() < all {
            channels.push(match found.model.channels().get(channels.len()) {
                Some(before) => before.clone(),
                None => RationalChannel::new(vec![0.0], Vec::new(), 0.0)?,
            });
        }
        Ok(TransferFunctionModel::new(channels, all, Mat::identity(1, 1))?)
    }

    fn described(&self, clean: &Dataset, found: &OutputFit<RationalChannel>, ripple_hz: Vec<f64>) -> DelayModel {
        let (minimum, inputs) = (&found.minimum, clean.inputs());
        let samples = minimum.residuals.len();
        let variance = variance(clean);
        let loss = (minimum.cost / samples.max(1) as f64).max(ROUNDING * variance);
        let (first, width) = (found.model.offsets(), self.zeros + 1 + self.poles);
        let mut faults = Vec::new();
        if !minimum.termination.converged() || !found.is_least {
            faults.push(DelayFault::NotConverged);
        }
        let mut model = DelayModel {
            zeros: self.zeros,
            poles: self.poles,
            dead_times: Vec::with_capacity(inputs),
            intervals: Vec::with_capacity(inputs),
            late_by: Vec::with_capacity(inputs),
            late_intervals: Vec::with_capacity(inputs),
            loss,
            fit_percent: 100.0 * (1.0 - (loss / variance.max(f64::MIN_POSITIVE)).sqrt()),
            ripple_hz,
            samples,
            faults,
            channels: found.model.channels()[..inputs].to_vec(),
            free: inputs * (self.zeros + self.poles + 2) + found.model.channels().len() - inputs + found.nuisance,
            inflation: self.inflation(found, inputs),
        };
        let reach = student_t_quantile(0.5 + 0.5 * self.options.level, found.degrees_of_freedom);
        for (input, at) in first.iter().take(inputs).map(|first| first + width).enumerate() {
            let samples_of = |seconds: f64| seconds / clean.sample_time_s();
            let samples = samples_of(minimum.parameters[at]) - LEAD as f64;
            let is_held = minimum.at_bound[at];
            // Profiles are taken at one level, and stretched to others.
            let errors = match found.ends.iter().find(|ends| ends.parameter == at) {
                Some(ends) => <[f64; 2]>::from(ends.about(found)).map(|end| samples_of(end) / quantile(found)),
                None if is_held => [f64::INFINITY; 2],
                None => [samples_of(root(found.covariance[(at, at)])); 2],
            };
            let [below, above] = errors.map(|error| reach * self.options.dated(error));
            let standard_error = self.options.dated(errors[0].max(errors[1]));
            let high = samples + above;
            if is_held && samples > 0.0 {
                model.faults.push(DelayFault::AtLongest { input, tried: self.options.longest });
            } else if high < 0.0 || is_held {
                model.faults.push(DelayFault::TooEarly { input });
            }
            model.dead_times.push(DelayEstimate { samples, standard_error });
            let within = |end: f64| end.clamp(0.0, self.options.longest as f64);
            model.intervals.push((within(samples - below), within(high)));
            let late = self.late_by(found, at - width, clean.sample_time_s());
            let about = |late: DelayEstimate| [-reach, reach].map(|z| late.samples + z * late.standard_error).into();
            model.late_intervals.push(late.map(about));
            model.late_by.push(late);
        }
        model
    }

    /// Faults that tests of the errors find.
    fn tested(
        &self,
        plain: &ContinuousTransferFunction,
        clean: &Dataset,
        own: &TransferFunctionModel,
    ) -> Result<Vec<DelayFault>, IdentError> {
        let found = plain.fit_one(clean, 0, self.beginning, Some(own))?;
        if found.minimum.cost <= ROUNDING * variance(clean) * found.minimum.residuals.len() as f64 {
            return Ok(Vec::new());
        }
        let fit = plain.fit_of(clean, self.beginning, &[found])?;
        let report = ResidualTest::default().run(&fit, &fit.without_levels(clean)?, TestData::Own);
        let dependences = |report: ResidualReport| report.independence[0].iter().flat_map(dependence).collect();
        Ok(report.map_or(vec![DelayFault::Untested], dependences))
    }

    /// The largest quotient of a variance and what it would be with white errors.
    fn inflation(&self, found: &OutputFit<RationalChannel>, inputs: usize) -> f64 {
        let white = found.minimum.cost / found.remaining();
        let own = inputs * (self.zeros + self.poles + 2);
        let quotient = |j: usize| found.covariance[(j, j)] / (white * found.minimum.unscaled_covariance[(j, j)]);
        (0..own).map(quotient).filter(|q| q.is_finite()).fold(1.0, f64::max)
    }

    /// `τ + a₁/a₀ − b₁/b₀` of the channel whose parameters begin at `first`; none of a gain.
    fn late_by(&self, found: &OutputFit<RationalChannel>, first: usize, sample_time_s: f64) -> Option<DelayEstimate> {
        if self.poles == 0 {
            return None;
        }
        let theta = &found.minimum.parameters;
        let (gain_at, rest_at, delay_at) =
            (first + self.zeros, first + self.zeros + self.poles, first + self.zeros + self.poles + 1);
        let (b0, a0) = (theta[gain_at], theta[rest_at]);
        let mut slopes = vec![(delay_at, 1.0)];
        let mut seconds = theta[delay_at];
        let a1 = if self.poles > 1 { theta[rest_at - 1] } else { 1.0 };
        seconds += a1 / a0;
        slopes.push((rest_at, -a1 / (a0 * a0)));
        if self.poles > 1 {
            slopes.push((rest_at - 1, 1.0 / a0));
        }
        if self.zeros > 0 {
            let b1 = theta[gain_at - 1];
            seconds -= b1 / b0;
            slopes.extend([(gain_at, b1 / (b0 * b0)), (gain_at - 1, -1.0 / b0)]);
        }
        let terms =
            slopes.iter().flat_map(|(i, s)| slopes.iter().map(move |(j, t)| s * t * found.covariance[(*i, *j)]));
        let standard_error = self.options.dated(root(terms.sum::<f64>()) / sample_time_s);
        let samples = seconds / sample_time_s - LEAD as f64;
        (samples.is_finite() && standard_error.is_finite()).then_some(DelayEstimate { samples, standard_error })
    }
}

/// The root of a variance; infinite where there is none.
fn root(variance: f64) -> f64 {
    if variance.is_finite() { variance.max(0.0).sqrt() } else { f64::INFINITY }
}

/// The errors of each experiment at its instants, NaN where there is none.
fn errors(data: &Dataset, found: &OutputFit<RationalChannel>, first: usize) -> Result<Vec<Vec<f64>>, IdentError> {
    let ground = Ground::new(data, false)?;
    let mut residuals = found.minimum.residuals.iter();
    let mut placed = |(t, y): (usize, &f64)| match y.is_nan() || t < first {
        true => f64::NAN,
        false => residuals.next().copied().unwrap_or(f64::NAN),
    };
    Ok(ground.data.experiments().iter().map(|e| e.output(0).iter().enumerate().map(&mut placed).collect()).collect())
}

/// The variance of the output about the mean of each experiment.
pub(super) fn variance(data: &Dataset) -> f64 {
    let (mut sum, mut rows) = (0.0, 0_usize);
    for experiment in data.experiments() {
        let known = || experiment.output(0).iter().filter(|v| !v.is_nan());
        let count = known().count();
        let mean = known().sum::<f64>() / count.max(1) as f64;
        sum += known().map(|v| (v - mean).powi(2)).sum::<f64>();
        rows += count;
    }
    sum / rows.max(1) as f64
}

pub(super) fn dependence(independence: &Independence) -> Option<DelayFault> {
    let (dynamics, feedback) = (&independence.dynamics, &independence.feedback);
    if !dynamics.passes(TESTED) {
        return Some(DelayFault::DynamicsMissing { p_value: dynamics.p_value });
    }
    (!feedback.passes(TESTED)).then_some(DelayFault::Feedback { p_value: feedback.p_value })
}
