//! Process models from sampled data.

mod ranges;
mod start;

use faer::Mat;
use lti::ProcessModel;

use self::ranges::{Asked, Ranges, Usual};
use crate::continuous::combine::combine;
use crate::continuous::estimate::{OutputFit, Settings, fit_output};
use crate::continuous::output_error::Nuisance;
use crate::continuous::past::{begun, with_ends};
use crate::continuous::record::{Beginning, Record, records};
use crate::continuous::{ContinuousChannel, ProcessSystem, check_delays, first_sample, one_each};
use crate::data::band_limited::Ground;
use crate::{Bounds, Dataset, Fit, IdentError, Intersample, NonlinearOptions, Parametric};
use fitting::StructureError;

/// Longest delay searched at first, in samples, ...
const FIRST_DELAY_SAMPLES: f64 = 30.0;
/// ... and as a part of the record.
const FIRST_DELAY_PART: f64 = 0.1;
/// A delay that ends there is searched for over so many times as long ...
const LONGER: f64 = 3.0;
/// ... up to this part of the record.
const LONGEST_DELAY: f64 = 1.0 / 3.0;
/// Shortest lag searched by default, in samples. A shorter one has no effect that the samples show.
const SHORTEST_LAG_SAMPLES: f64 = 0.01;
/// Longest lag searched by default, in lengths of the record. A longer one is an integrator.
const LONGEST_LAG_RECORDS: f64 = 10.0;

/// Estimates process models, gain, lags, zero and delay, by minimising the error of the simulated output:
///
/// `y_i(t_k) = Σ_j [G_ij u_j](t_k) + e_i(t_k)`, `G(s) = K (1 + T_z s) / Π(1 + T_p s) · e^{−T_d s}`, see
/// [`ProcessModel`].
///
/// Band-limited inputs are followed between the samples, up to 0.45 of the sample rate; rows within 32 samples of an
/// end of an experiment, where they rest on a guess of the inputs beyond it, are left out. The model is sampled
/// exactly, and the delay is a continuous parameter found below a sample. The search starts from the best of a grid of
/// delays and lags. Initial states are estimated. Inputs that rest at first are taken to have rested before, unless the
/// outputs refute that; then the samples before the longest delay only serve as past inputs. Several outputs are
/// estimated together, by the determinant of the covariance of their errors, unless they are sampled at different
/// instants. The covariance allows for noise with the autocorrelation of the residuals.
///
/// # Example
/// ```
/// use ident::{Dataset, ProcessFit};
/// // 2/(1 + 0.5 s) e^{−0.3 s}, a step at t = 0, sampled every 0.1 s.
/// let u = vec![1.0; 60];
/// let y: Vec<f64> = (0..60).map(|k| 0.1 * f64::from(k) - 0.3).map(|t| 2.0 * (1.0 - (-2.0 * t.max(0.0)).exp())).collect();
/// let (before, rest) = (vec![0.0; 20], vec![0.0; 20]);
/// let data = Dataset::siso(0.1, &[before, u].concat(), &[rest, y].concat())?;
/// let fit = ProcessFit::named("P1D")?.with_delay_between(&[(0.0, 1.0)]).fit(&data)?;
/// let model = fit.model.channel(0, 0)?;
/// assert!((model.gain() - 2.0).abs() < 1e-8 && (model.delay_s().unwrap() - 0.3).abs() < 1e-8);
/// # Ok::<(), ident::IdentError>(())
/// ```
///
/// # Source
/// Ljung 1999, §4.2 and §10.2; Åström & Hägglund (2006), *Advanced PID Control*, ch. 2.
#[derive(Debug, Clone, PartialEq)]
pub struct ProcessFit {
    structure: Vec<ProcessModel>,
    delay_s: Option<Vec<(f64, f64)>>,
    lag_s: Option<(f64, f64)>,
    offset: bool,
    at_rest: bool,
    held: Vec<(String, f64)>,
    bounds: Vec<(String, Bounds)>,
    search: NonlinearOptions,
}

impl ProcessFit {
    /// The structure in the customary letters: `P` and the number of poles (0 to 3) beside an integrator, then in any
    /// order `D` for a delay, `Z` for a zero, `U` for two poles that may be complex, `I` for an integrator; for every
    /// input the same.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for another name, or `U` with fewer than two poles.
    pub fn named(name: &str) -> Result<Self, IdentError> {
        Ok(Self::per_input(vec![structure(name)?]))
    }

    /// A structure for each input: the models' numbers do not matter, only which of them there are.
    pub fn per_input(structure: Vec<ProcessModel>) -> Self {
        ProcessFit {
            structure,
            delay_s: None,
            lag_s: None,
            offset: false,
            at_rest: false,
            held: Vec::new(),
            bounds: Vec::new(),
            search: NonlinearOptions::default(),
        }
    }

    /// Bounds of the delay in seconds, one pair an input or one for all. If none are given it is searched from 0 to 30
    /// samples, a tenth of the record at most; where it ends at that limit, up to a third of the record.
    #[must_use]
    pub fn with_delay_between(self, delay_s: &[(f64, f64)]) -> Self {
        ProcessFit { delay_s: Some(delay_s.to_vec()), ..self }
    }

    /// Bounds of every lag in seconds; a hundredth of a sample to ten times the record if none are given.
    #[must_use]
    pub fn with_lags_between(self, low_s: f64, high_s: f64) -> Self {
        ProcessFit { lag_s: Some((low_s, high_s)), ..self }
    }

    /// Estimates a constant on the outputs of each experiment besides.
    #[must_use]
    pub fn with_offset(self) -> Self {
        ProcessFit { offset: true, ..self }
    }

    /// Takes the system as at rest, and its inputs as zero, before each experiment.
    #[must_use]
    pub fn from_rest(self) -> Self {
        ProcessFit { at_rest: true, ..self }
    }

    /// Holds one parameter at a value, such as a known gain at rest; its name is that of the model's
    /// [`parameter_names`](crate::Parametric::parameter_names), such as `K` or, with several inputs, `K[2]`.
    ///
    /// # Example
    /// ```
    /// // 2/(1 + 0.5 s) with its gain known; a tenth of its settling would leave the gain open.
    /// let y: Vec<f64> = (0..6).map(|k| 2.0 * (1.0 - (-0.02 * f64::from(k)).exp())).collect();
    /// let (u, y) = ([vec![0.0; 5], vec![1.0; 6]].concat(), [vec![0.0; 5], y].concat());
    /// let data = ident::Dataset::siso(0.01, &u, &y)?;
    /// let fit = ident::ProcessFit::named("P1")?.hold("K", 2.0).from_rest().fit(&data)?;
    /// assert!(fit.parameters()[0] == 2.0 && (fit.parameters()[1] - 0.5).abs() < 1e-8);
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    #[must_use]
    pub fn hold(mut self, parameter: impl Into<String>, value: f64) -> Self {
        self.held.push((parameter.into(), value));
        self
    }

    /// Searches one parameter from `low` to `high`, in place of its usual bounds: those of lags and delay above, and 0
    /// to 10 for a damping ratio; gain and zero have none. Starting values beyond are moved to the bound. Names are
    /// those of [`hold`](Self::hold).
    ///
    /// # Example
    /// ```
    /// let y: Vec<f64> = (0..60).map(|k| 2.0 * (1.0 - (-0.2 * f64::from(k)).exp())).collect();
    /// let (u, y) = ([vec![0.0; 5], vec![1.0; 60]].concat(), [vec![0.0; 5], y].concat());
    /// let data = ident::Dataset::siso(0.1, &u, &y)?;
    /// let fit = ident::ProcessFit::named("P1")?.with_bounds("Tp1", 0.6, 5.0).from_rest().fit(&data)?;
    /// // The true value is 0.5.
    /// assert!(fit.parameters()[1] == 0.6 && fit.is_at_bound(1) && fit.standard_errors()[1].is_nan());
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    #[must_use]
    pub fn with_bounds(mut self, parameter: impl Into<String>, low: f64, high: f64) -> Self {
        self.bounds.push((parameter.into(), Bounds::new(low, high)));
        self
    }

    /// How far and how exactly to search.
    #[must_use]
    pub fn with_search(self, search: NonlinearOptions) -> Self {
        ProcessFit { search, ..self }
    }

    /// Estimates the models.
    ///
    /// # Errors
    /// [`IdentError::Length`] where the options do not fit the number of inputs; [`IdentError::Structure`] for bounds
    /// that are no range or that no process has, a zero and no pole, or a parameter that there is not;
    /// [`IdentError::Missing`] for a gap in an input (gaps in outputs are left out); [`IdentError::Constant`];
    /// [`IdentError::TooFewSamples`]; [`IdentError::RankDeficient`] where the data do not determine every parameter.
    /// Two lags that come out equal are no error: no data separate those, and they are put a little apart.
    pub fn fit(&self, data: &Dataset) -> Result<Fit<ProcessSystem>, IdentError> {
        let record = data.experiments().iter().map(|e| e.len()).max().unwrap_or(0) as f64;
        let mut longest = FIRST_DELAY_SAMPLES.min((FIRST_DELAY_PART * record).floor());
        let ground = Ground::new(data, self.at_rest)?;
        let mut found = self.search_to(&ground, longest)?;
        while self.delay_s.is_none() && ends_at(&found.1, longest * data.sample_time_s()) {
            let longer = (LONGER * longest).min((LONGEST_DELAY * record).floor());
            let Some(further) = (longer > longest).then(|| self.search_to(&ground, longer).ok()).flatten() else {
                break;
            };
            longest = longer;
            // On the same rows a longer range cannot be worse, but for a search that went astray.
            found = if is_above(&further.1, &found.1) { found } else { further };
        }
        let (beginning, parts) = found;
        let parts = with_ends(&ground, beginning, parts, self.settings())?;
        Ok(combine(&ground, beginning, &parts, self.settings())?.made_by("simulation error", data))
    }

    /// The estimates of all outputs with delays of at most so many samples where they have no other bounds, without
    /// profiles.
    fn search_to(&self, ground: &Ground<'_>, longest_delay: f64) -> Result<(Beginning, Parts), IdentError> {
        let ranges = self.ranges(ground.plain, longest_delay)?;
        let longest = |r: &Ranges| first_sample(&r.delay_s, ground.plain.sample_time_s());
        let reached = if self.at_rest { 0 } else { ranges.iter().map(longest).max().unwrap_or(0) };
        let part = |output: usize, beginning| search(ground, output, beginning, &ranges[output], self.settings());
        begun(ground, reached, self.settings(), part)
    }

    fn settings(&self) -> Settings {
        let nuisance = Nuisance { initial_state: !self.at_rest, offset: self.offset };
        Settings { nuisance, stable: true, search: self.search }
    }

    /// Ranges that are searched for each output.
    fn ranges(&self, data: &Dataset, longest_delay: f64) -> Result<Vec<Ranges>, IdentError> {
        let structure = one_each("structures", &self.structure, data.inputs())?;
        let t = data.sample_time_s();
        let longest = data.experiments().iter().map(|e| e.len()).max().unwrap_or(0) as f64;
        let delay_s =
            one_each("delays", self.delay_s.as_deref().unwrap_or(&[(0.0, longest_delay * t)]), data.inputs())?;
        let lag_s = self.lag_s.unwrap_or((SHORTEST_LAG_SAMPLES * t, LONGEST_LAG_RECORDS * longest.max(1.0) * t));
        if !(lag_s.0 > 0.0 && lag_s.0 < lag_s.1 && lag_s.1.is_finite()) {
            let (low_s, high_s) = lag_s;
            return Err(StructureError::Bounds { what: "the lags", low_s, high_s, positive: true }.into());
        }
        check_delays(&delay_s)?;
        let (usual, jumps) = (Usual { delay_s, lag_s }, data.intersample() == Intersample::ZeroOrderHold);
        let asked = self.asked(&structure, data.outputs())?;
        let each = asked.chunks(asked.len() / data.outputs().max(1));
        each.map(|asked| Ranges::new(structure.clone(), &usual, asked, jumps)).collect()
    }

    /// Request for every parameter of every output.
    fn asked(&self, structure: &[ProcessModel], outputs: usize) -> Result<Vec<Asked>, IdentError> {
        let channels = structure.iter().cycle().take(structure.len() * outputs).cloned().collect();
        let names = ProcessSystem::new(channels, structure.len(), Mat::identity(outputs, outputs))?.parameter_names();
        let mut asked: Vec<Asked> = names.iter().map(|name| Asked { name: name.clone(), ..Asked::default() }).collect();
        let place = |name: &String| {
            let unknown = || StructureError::UnknownParameter { name: name.clone(), parameters: names.clone() };
            names.iter().position(|n| n == name).ok_or_else(unknown)
        };
        for (name, value) in &self.held {
            let index = place(name)?;
            if !value.is_finite() {
                return Err(IdentError::NotFinite { what: "the value of a parameter to be held", index });
            }
            asked[index].held = Some(*value);
        }
        for (name, bounds) in &self.bounds {
            asked[place(name)?].bounds = Some(*bounds);
        }
        Ok(asked)
    }
}

/// The estimates of all outputs.
type Parts = Vec<OutputFit<ProcessModel>>;

/// The estimate for one output.
fn search(
    ground: &Ground<'_>,
    output: usize,
    beginning: Beginning,
    ranges: &Ranges,
    settings: Settings,
) -> Result<OutputFit<ProcessModel>, IdentError> {
    let (data, bounds) = (ground.plain, ranges.bounds());
    let records = records(ground, output, beginning)?;
    let samples = records.iter().map(Record::rows).sum();
    if samples <= 2 * bounds.len() {
        return Err(IdentError::TooFewSamples { samples, parameters: 2 * bounds.len() });
    }
    let starts = start::candidates(ranges, data, &records, settings)?;
    fit_output(data, &records, &starts, bounds, settings)
}

/// Returns true if a delay ended at the upper end of the searched range.
fn ends_at(parts: &[OutputFit<ProcessModel>], longest_s: f64) -> bool {
    let ends = |part: &OutputFit<ProcessModel>| {
        let delays = part.model.channels().iter().zip(part.model.offsets());
        let mut delays = delays.filter_map(|(channel, first)| Some(first + channel.delay_parameter()?));
        delays.any(|j| part.minimum.at_bound[j] && part.minimum.parameters[j] == longest_s)
    };
    parts.iter().any(ends)
}

/// Returns true if estimates on the same rows have larger errors than others, by the product of their mean squares.
fn is_above(parts: &[OutputFit<ProcessModel>], others: &[OutputFit<ProcessModel>]) -> bool {
    let both = || parts.iter().zip(others);
    let excess = |(part, other): (&OutputFit<_>, &OutputFit<_>)| (part.minimum.cost / other.minimum.cost).ln();
    both().all(|(part, other)| part.minimum.residuals.len() == other.minimum.residuals.len())
        && both().map(excess).sum::<f64>() > 0.0
}

fn structure(name: &str) -> Result<ProcessModel, IdentError> {
    let unknown = StructureError::ProcessName { name: name.to_owned() };
    let mut letters = name.chars();
    let poles = match (letters.next(), letters.next().and_then(|c| c.to_digit(10))) {
        (Some('P'), Some(poles @ 0..=3)) => poles as usize,
        _ => return Err(unknown.into()),
    };
    let rest = letters.as_str();
    if rest.chars().any(|c| !"DZUI".contains(c)) {
        return Err(unknown.into());
    }
    let pair = rest.contains('U');
    let lags = poles.checked_sub(if pair { 2 } else { 0 });
    let lags = lags.ok_or(unknown)?;
    let mut model = ProcessModel::new(1.0)?.with_lags(vec![1.0; lags])?;
    if pair {
        model = model.with_pair(1.0, 0.5)?;
    }
    if rest.contains('Z') {
        model = model.with_zero(0.0)?;
    }
    if rest.contains('D') {
        model = model.with_delay(0.0)?;
    }
    Ok(if rest.contains('I') { model.with_integrator() } else { model })
}
