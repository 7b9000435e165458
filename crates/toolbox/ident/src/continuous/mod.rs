//! Continuous-time transfer functions from sampled data.

mod channel;
pub(crate) mod combine;
mod companion;
pub(crate) mod estimate;
mod followed;
mod initial;
mod joint;
mod model;
pub(crate) mod output_error;
pub(crate) mod past;
pub(crate) mod process;
mod profile;
mod projection;
pub(crate) mod record;
mod sampled;
mod srivc;
pub(crate) mod start;

use faer::Mat;

pub(crate) use sampled::response_to_powers;

pub use channel::{ContinuousChannel, Degrees};
pub use model::{ContinuousModel, ProcessSystem, RationalChannel, TransferFunctionModel};

use crate::data::band_limited::Ground;
use crate::{Bounds, Dataset, Fit, IdentError, Intersample, NonlinearOptions};
use combine::combine;
use estimate::{OutputFit, Settings, cost, fit_output, judge_at, lowest_model};
use fitting::{RefinedLimit, StructureError};
use output_error::Nuisance;
use past::{begun, with_ends};
use record::{Beginning, Record, records};
use start::Candidate;

/// An end of a range of delays has smaller errors than those found within it from this part of them on.
const LOWER: f64 = 1e-6;

/// How [`ContinuousTransferFunction`] comes to its estimate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TransferFunctionMethod {
    /// The smallest error of the simulated output, searched for from instrumental variables.
    #[default]
    OutputError,
    /// Simplified refined instrumental variables (SRIVC) until they settle, each round solved at once: as certain as
    /// the output error, and no search that could end in a local minimum. Of one input, with a known delay.
    InstrumentalVariables,
}

impl TransferFunctionMethod {
    fn name(self) -> &'static str {
        match self {
            TransferFunctionMethod::OutputError => "simulation error",
            TransferFunctionMethod::InstrumentalVariables => "refined instrumental variables (SRIVC)",
        }
    }
}

/// Estimates continuous-time transfer functions from sampled data, by minimising the error of the simulated output:
///
/// `y_i(t_k) = Σ_j [G_ij u_j](t_k) + e_i(t_k)`,
/// `G(s) = (b_m s^m + … + b₀) / (s^n + a_{n−1} s^{n−1} + … + a₀) · e^{−s·delay}`.
///
/// The model is sampled exactly under the inputs' [`Intersample`] behaviour, delays of any fraction of a sample
/// included. Band-limited inputs are followed between the samples, up to 0.45 of the sample rate; rows within 32
/// samples of an end of an experiment, where they rest on a guess of the inputs beyond it, are left out. Instrumental
/// variables give starting values, or the estimate ([`TransferFunctionMethod`]). Initial states are estimated. Inputs
/// that rest at first are taken to have rested before, unless the outputs refute that; then the samples before the
/// longest delay only serve as past inputs. Several outputs are estimated together, by the determinant of the
/// covariance of their errors, from an estimate of each; each stands by itself where outputs are sampled at different
/// instants, or with instrumental variables. The covariance allows for noise with the autocorrelation of the residuals.
///
/// # Example
/// ```
/// use ident::{ContinuousTransferFunction, Dataset};
/// // ẏ + 2 y = 3 u under a held input: y(k+1) = e^{−0.2} y(k) + 1.5 (1 − e^{−0.2}) u(k).
/// let u: Vec<f64> = (0..200).map(|k| f64::from((k * k) % 7 > 3)).collect();
/// let pole = (-0.2_f64).exp();
/// let mut y = vec![0.4];
/// for k in 0..199 {
///     y.push(pole * y[k] + 1.5 * (1.0 - pole) * u[k]);
/// }
/// let fit = ContinuousTransferFunction::new(0, 1).fit(&Dataset::siso(0.1, &u, &y)?)?;
/// let g = fit.model.transfer_function(0, 0)?;
/// assert!((g.num()[0] - 3.0).abs() < 1e-8 && (g.den()[1] - 2.0).abs() < 1e-8);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Young & Jakeman (1980), Int. J. Control 31 (SRIVC); Garnier & Wang (eds.), *Identification of Continuous-time Models
/// from Sampled Data*, 2008; Ljung 1999, §10.2 (the minimisation), (7.89) (several outputs).
#[derive(Debug, Clone, PartialEq)]
pub struct ContinuousTransferFunction {
    numerator_degree: Vec<usize>,
    poles: Vec<usize>,
    delay_s: Vec<(f64, f64)>,
    integrators: usize,
    offset: bool,
    at_rest: bool,
    unstable: bool,
    method: TransferFunctionMethod,
    search: NonlinearOptions,
}

impl ContinuousTransferFunction {
    /// The same degree of the numerator and the same number of poles from every input, no delay.
    pub fn new(numerator_degree: usize, poles: usize) -> Self {
        Self::per_input(vec![numerator_degree], vec![poles])
    }

    /// Degrees of numerators and numbers of poles, one an input.
    pub fn per_input(numerator_degree: Vec<usize>, poles: Vec<usize>) -> Self {
        ContinuousTransferFunction {
            numerator_degree,
            poles,
            delay_s: vec![(0.0, 0.0)],
            integrators: 0,
            offset: false,
            at_rest: false,
            unstable: false,
            method: TransferFunctionMethod::default(),
            search: NonlinearOptions::default(),
        }
    }

    /// A known delay from each input, in seconds; one value stands for all inputs.
    #[must_use]
    pub fn with_delay(self, delay_s: &[f64]) -> Self {
        ContinuousTransferFunction { delay_s: delay_s.iter().map(|d| (*d, *d)).collect(), ..self }
    }

    /// A delay to be found between two bounds in seconds, one pair an input; one pair stands for all inputs.
    #[must_use]
    pub fn with_delay_between(self, delay_s: &[(f64, f64)]) -> Self {
        ContinuousTransferFunction { delay_s: delay_s.to_vec(), ..self }
    }

    /// Of the poles from each input, this many are known to be at zero.
    #[must_use]
    pub fn with_integrators(self, integrators: usize) -> Self {
        ContinuousTransferFunction { integrators, ..self }
    }

    /// Estimates a constant on the outputs of each experiment besides.
    #[must_use]
    pub fn with_offset(self) -> Self {
        ContinuousTransferFunction { offset: true, ..self }
    }

    /// Takes the system as at rest, and its inputs as zero, before each experiment.
    #[must_use]
    pub fn from_rest(self) -> Self {
        ContinuousTransferFunction { at_rest: true, ..self }
    }

    /// Lets poles be unstable.
    #[must_use]
    pub fn allow_unstable(self) -> Self {
        ContinuousTransferFunction { unstable: true, ..self }
    }

    /// By another method.
    #[must_use]
    pub fn by(self, method: TransferFunctionMethod) -> Self {
        ContinuousTransferFunction { method, ..self }
    }

    /// How far and how exactly to search.
    #[must_use]
    pub fn with_search(self, search: NonlinearOptions) -> Self {
        ContinuousTransferFunction { search, ..self }
    }

    /// Estimates the model.
    ///
    /// # Errors
    /// [`IdentError::Length`] where the options do not fit the number of inputs; [`IdentError::Structure`] for a
    /// numerator of higher degree than its denominator, more integrators than poles, delays that are no range, or what
    /// instrumental variables do not take;
    /// [`IdentError::Missing`] for a gap in an input (gaps in outputs are left out); [`IdentError::Constant`];
    /// [`IdentError::TooFewSamples`]; [`IdentError::RankDeficient`] where the data do not determine every parameter, as
    /// with too many poles.
    pub fn fit(&self, data: &Dataset) -> Result<Fit<TransferFunctionModel>, IdentError> {
        let options = self.spread(data)?;
        let ground = Ground::new(data, self.at_rest)?;
        let part = |output: usize, beginning| options.search_to_the_ends(&ground, output, beginning);
        let (beginning, parts) = begun(&ground, options.first_sample(data), options.settings(), part)?;
        let parts = with_ends(&ground, beginning, parts, options.settings())?;
        let fit = combine(&ground, beginning, &parts, options.settings())?;
        Ok(fit.made_by(self.method.name(), data))
    }

    /// Where the rows begin that an estimate rests on, and what it takes for the inputs before.
    pub(crate) fn beginning(&self, data: &Dataset) -> Result<Beginning, IdentError> {
        let (options, ground) = (self.spread(data)?, Ground::new(data, self.at_rest)?);
        let part = |output: usize, beginning| options.search(&ground, output, beginning, None);
        Ok(begun(&ground, options.first_sample(data), options.settings(), part)?.0)
    }

    /// The estimate for one output, from a model of it or from starting values of its own.
    pub(crate) fn fit_one(
        &self,
        data: &Dataset,
        output: usize,
        beginning: Beginning,
        start: Option<&TransferFunctionModel>,
    ) -> Result<OutputFit<RationalChannel>, IdentError> {
        self.spread(data)?.search(&Ground::new(data, self.at_rest)?, output, beginning, start)
    }

    /// The same from a model of it, with the ends of its delays by their profile.
    pub(crate) fn profile_one(
        &self,
        data: &Dataset,
        output: usize,
        beginning: Beginning,
        start: &TransferFunctionModel,
    ) -> Result<OutputFit<RationalChannel>, IdentError> {
        let found = self.fit_one(data, output, beginning, Some(start))?;
        let ground = Ground::new(data, self.at_rest)?;
        Ok(profile::profiled(ground.plain, &records(&ground, output, beginning)?, found, self.settings()))
    }

    /// [`Self::fit`] from what was found for each output.
    pub(crate) fn fit_of(
        &self,
        data: &Dataset,
        beginning: Beginning,
        parts: &[OutputFit<RationalChannel>],
    ) -> Result<Fit<TransferFunctionModel>, IdentError> {
        combine(&Ground::new(data, self.at_rest)?, beginning, parts, self.settings())
    }

    fn search(
        &self,
        ground: &Ground<'_>,
        output: usize,
        beginning: Beginning,
        start: Option<&TransferFunctionModel>,
    ) -> Result<OutputFit<RationalChannel>, IdentError> {
        let (data, records) = (ground.plain, records(ground, output, beginning)?);
        self.check_length(&records)?;
        if self.method == TransferFunctionMethod::InstrumentalVariables {
            let settled = start::settle(&self.structure(data, &self.known_delays(data)), &records)?;
            let model = self.model_of(&settled.candidate, data.sample_time_s())?;
            return judge_at(data, &records, &model, &self.bounds(), self.settings(), settled.termination());
        }
        let starts = start.map_or_else(|| self.starts(data, &records), |start| Ok(vec![start.clone()]))?;
        fit_output(data, &records, &starts, &self.bounds(), self.settings())
    }

    /// The estimate for one output that no end of a range of delays goes below: a minimum over a range is none above
    /// that at its ends. A search over the range misses it where the poles are far away there, because the delay leaves
    /// the end before they have gone so far.
    fn search_to_the_ends(
        &self,
        ground: &Ground<'_>,
        output: usize,
        beginning: Beginning,
    ) -> Result<OutputFit<RationalChannel>, IdentError> {
        let found = self.search(ground, output, beginning, None);
        if self.delay_s.iter().all(|(low_s, high_s)| low_s == high_s) {
            return found;
        }
        let (data, records) = (ground.plain, records(ground, output, beginning)?);
        let delays_s = match &found {
            Ok(found) => found.model.channels().iter().map(RationalChannel::delay_s).collect(),
            Err(_) => self.delay_s.iter().map(|(low_s, _)| *low_s).collect::<Vec<f64>>(),
        };
        let costs = self.at_ends(data, &records, &delays_s).into_iter().filter_map(|end| {
            let cost = cost(data, &records, &end, self.settings())?;
            Some((cost, end))
        });
        let least = found.as_ref().map_or(f64::INFINITY, |found| found.minimum.cost);
        // Its parameters may not be determined, which is no reason for another model with larger errors.
        match costs.min_by(|x, y| x.0.total_cmp(&y.0)).filter(|(cost, _)| *cost < (1.0 - LOWER) * least) {
            Some((_, end)) => fit_output(data, &records, &[end], &self.bounds(), self.settings()),
            None => found,
        }
    }

    /// The least errors at either end of each range of delays, with the others held at these.
    fn at_ends(&self, data: &Dataset, records: &[Record<'_>], delays_s: &[f64]) -> Vec<TransferFunctionModel> {
        let t = data.sample_time_s();
        let mut found = Vec::new();
        for (k, (low_s, high_s)) in self.delay_s.iter().enumerate().filter(|(_, (low_s, high_s))| low_s < high_s) {
            for end_s in [*low_s, *high_s] {
                let mut held = self.clone();
                held.delay_s[k] = (end_s, end_s);
                let mut delays: Vec<f64> = delays_s.iter().map(|delay_s| delay_s / t).collect();
                delays[k] = end_s / t;
                let starts = start::candidates(&held.structure(data, &delays), records).unwrap_or_default();
                let starts: Vec<_> = starts.iter().filter_map(|c| held.model_of(c, t).ok()).collect();
                found.extend(lowest_model(data, records, &starts, &held.bounds(), self.settings()));
            }
        }
        found
    }

    /// The options with one entry an input.
    fn spread(&self, data: &Dataset) -> Result<Self, IdentError> {
        let inputs = data.inputs();
        let options = ContinuousTransferFunction {
            numerator_degree: one_each("numerator degrees", &self.numerator_degree, inputs)?,
            poles: one_each("numbers of poles", &self.poles, inputs)?,
            delay_s: one_each("delays", &self.delay_s, inputs)?,
            ..self.clone()
        };
        options.check(data.intersample())?;
        Ok(options)
    }

    fn check(&self, intersample: Intersample) -> Result<(), IdentError> {
        for (m, n) in self.numerator_degree.iter().zip(&self.poles) {
            for (what, found) in [("zeros", *m), ("integrators", self.integrators)] {
                if found > *n {
                    return Err(StructureError::TooMany { what, found, most: *n }.into());
                }
            }
        }
        check_delays(&self.delay_s)?;
        self.check_method()?;
        let proper = self.numerator_degree.iter().zip(&self.poles).zip(&self.delay_s);
        let jumps = intersample == Intersample::ZeroOrderHold;
        if jumps && proper.into_iter().any(|((m, n), (low, high))| m == n && low < high) {
            return Err(StructureError::DelayNotSearchable.into());
        }
        Ok(())
    }

    fn check_method(&self) -> Result<(), IdentError> {
        let refuse = |limit| Err(StructureError::Refined(limit).into());
        if self.method == TransferFunctionMethod::OutputError {
            return Ok(());
        }
        if self.numerator_degree.len() > 1 {
            return refuse(RefinedLimit::Inputs);
        }
        if self.delay_s.iter().any(|(low, high)| low < high) {
            return refuse(RefinedLimit::SearchedDelay);
        }
        if self.at_rest || self.unstable {
            return refuse(RefinedLimit::RestOrUnstable);
        }
        Ok(())
    }

    fn settings(&self) -> Settings {
        let nuisance = Nuisance { initial_state: !self.at_rest, offset: self.offset };
        Settings { nuisance, stable: !self.unstable, search: self.search }
    }

    fn first_sample(&self, data: &Dataset) -> usize {
        if self.at_rest { 0 } else { first_sample(&self.delay_s, data.sample_time_s()) }
    }

    fn check_length(&self, records: &[Record<'_>]) -> Result<(), IdentError> {
        let parameters = self.numerator_degree.iter().zip(&self.poles).map(|(m, n)| m + 1 + n).sum::<usize>();
        let nuisance = records.len() * self.poles.iter().sum::<usize>();
        let samples = records.iter().map(Record::rows).sum();
        if samples <= parameters + nuisance {
            return Err(IdentError::TooFewSamples { samples, parameters: parameters + nuisance });
        }
        Ok(())
    }

    fn bounds(&self) -> Vec<Bounds> {
        let mut bounds = Vec::new();
        for ((m, n), (low, high)) in self.numerator_degree.iter().zip(&self.poles).zip(&self.delay_s) {
            bounds.extend(vec![Bounds::NONE; m + 1 + n - self.integrators]);
            bounds.extend(vec![Bounds::new(0.0, 0.0); self.integrators]);
            bounds.push(Bounds::new(*low, *high));
        }
        bounds
    }

    /// The lower bound of each delay, in samples.
    fn known_delays(&self, data: &Dataset) -> Vec<f64> {
        self.delay_s.iter().map(|(low, _)| low / data.sample_time_s()).collect()
    }

    fn structure<'a>(&'a self, data: &Dataset, delays: &'a [f64]) -> srivc::Structure<'a> {
        srivc::Structure {
            degrees: &self.numerator_degree,
            delays,
            poles: self.poles.iter().copied().max().unwrap_or(0),
            integrators: self.integrators,
            offset: self.offset,
            intersample: data.intersample(),
        }
    }

    fn starts(&self, data: &Dataset, records: &[Record<'_>]) -> Result<Vec<TransferFunctionModel>, IdentError> {
        let t = data.sample_time_s();
        let delays: Vec<(f64, f64)> = self.delay_s.iter().map(|(low, high)| (low / t, high / t)).collect();
        let known = self.known_delays(data);
        let structure = self.structure(data, &known);
        let searched = delays.iter().any(|(low, high)| low < high);
        let candidates = if searched {
            start::candidates_over_delays(&structure, records, &delays)?
        } else {
            start::candidates(&structure, records)?
        };
        candidates.iter().map(|c| self.model_of(c, t)).collect()
    }

    /// A starting value in units of samples as a model in SI. An input with fewer poles than the common denominator
    /// keeps the slowest.
    fn model_of(&self, candidate: &Candidate, t: f64) -> Result<TransferFunctionModel, IdentError> {
        let mut channels = Vec::with_capacity(self.poles.len());
        for (k, n) in self.poles.iter().enumerate() {
            let (a, gain) = slowest(&candidate.estimate.a, *n)?;
            let scale = |power: usize| t.powi(power as i32 - *n as i32);
            let b = &candidate.estimate.b[k];
            let num: Vec<f64> = (0..b.len()).rev().map(|j| gain * b[j] * scale(j)).collect();
            let den: Vec<f64> = (0..*n).rev().map(|j| a[j] * scale(j)).collect();
            channels.push(RationalChannel::new(num, den, candidate.delays[k] * t)?);
        }
        Ok(TransferFunctionModel::new(channels, self.poles.len(), Mat::identity(1, 1))?)
    }
}

/// The slowest `n` poles of a monic polynomial in ascending powers, and what the numerator must be multiplied by for
/// the gain at rest to stay.
fn slowest(a: &[f64], n: usize) -> Result<(Vec<f64>, f64), IdentError> {
    if n == a.len() {
        return Ok((a.to_vec(), 1.0));
    }
    let descending: Vec<f64> = std::iter::once(1.0).chain(a.iter().rev().copied()).collect();
    let mut poles = lti::polynomial::roots(&descending)?;
    poles.sort_by(|p, q| p.norm().total_cmp(&q.norm()).then(p.im.abs().total_cmp(&q.im.abs())));
    let gain = poles[n..].iter().map(|p| 1.0 / p.norm()).product();
    let mut kept = lti::polynomial::from_roots(&poles[..n]);
    kept.reverse();
    kept.pop();
    Ok((kept, gain))
}

/// One entry an input, from as many or from one for all.
pub(crate) fn one_each<T: Clone>(what: &'static str, given: &[T], inputs: usize) -> Result<Vec<T>, IdentError> {
    match given {
        [all] => Ok(vec![all.clone(); inputs]),
        _ if given.len() == inputs => Ok(given.to_vec()),
        _ => Err(IdentError::Length { what, expected: inputs, found: given.len() }),
    }
}

pub(crate) fn check_delays(delay_s: &[(f64, f64)]) -> Result<(), IdentError> {
    let is_none = |(low, high): &&(f64, f64)| !(*low >= 0.0 && low <= high && high.is_finite());
    match delay_s.iter().find(is_none) {
        None => Ok(()),
        Some(&(low_s, high_s)) => {
            Err(StructureError::Bounds { what: "the delay", low_s, high_s, positive: false }.into())
        }
    }
}

/// The first sample at which every delayed input is known.
pub(crate) fn first_sample(delay_s: &[(f64, f64)], sample_time_s: f64) -> usize {
    let longest = delay_s.iter().map(|(_, high)| high / sample_time_s).fold(0.0, f64::max);
    (longest - 1e-9).ceil().max(0.0) as usize
}
