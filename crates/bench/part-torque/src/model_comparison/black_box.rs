//! Black boxes of the torque control: ARX and output error of many orders, from T_d* (6.8) and from T_d* − T_d (6.3).

use std::f64::consts::TAU;

use ident::distributions::interval;
use ident::uncertainty::{Ellipse, UncertainRoot};
use ident::{Arx, Criteria, Fit, IdentError, NonlinearOptions, OutputError};
use lti::polynomial::{add, multiply};
use lti::{Complex64, LtiError, PolynomialModel};
use numerics::null::nan_if_null;
use rig::estimation::INTERVAL_LEVEL;
use rig::results::{Parameter, Quantity};
use serde::{Deserialize, Serialize};

use super::orders::Input;
use super::record::{Record, rms};
use crate::model_comparison::orders::OrdersTried;

/// How exactly structures are searched that only may be chosen.
const ROUGHLY: NonlinearOptions = NonlinearOptions { iteration_limit: 20, step_tolerance: 1e-4, cost_tolerance: 1e-6 };
/// Level of the ellipses about poles and zeros.
pub const ELLIPSE_LEVEL: f64 = 0.95;
/// 1 + b_0 below this: the loop closes upon itself within a sample.
const NO_LOOP: f64 = 1e-6;

/// Where a black box is asked for delay and gain, Hz: within what a demand held 10 ms excites, above slow drifts.
pub const ASKED_HZ: f64 = 10.0;

/// Kind of noise that a black box models.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Family {
    /// A y = B u + e.
    Arx,
    /// y = B/F u + e.
    OutputError,
}

/// A family, what drives it, and its orders.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Structure {
    /// ARX or output error.
    pub family: Family,
    /// T_d* or T_d* − T_d.
    pub input: Input,
    /// Poles: coefficients of A, or of F.
    pub poles: usize,
    /// Coefficients of B.
    pub nb: usize,
    /// Delay, samples.
    pub nk: usize,
}

/// How a black box follows T_d* once its loop is closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum Closed {
    /// It settles.
    Stable,
    /// It runs away.
    Unstable,
    /// T_d depends on itself within the sample with 1 + b_0 = 0: what was found is T_d = T_d* − (T_d* − T_d), no model.
    Circular,
}

/// A structure and its worth on data it was not estimated from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Scanned {
    /// The structure.
    pub structure: Structure,
    /// Number of coefficients.
    pub parameters: usize,
    /// How it follows T_d*.
    pub closed: Closed,
    /// Fit of its simulation from T_d* alone on the stretch that it is chosen by, %; none where it does not settle.
    pub fit_percent: Option<f64>,
    /// The same with T_d* − T_d as measured fed in, %: holds T_d itself, and flatters.
    pub fed_percent: Option<f64>,
    /// Bayesian information criterion on the estimation stretch.
    #[serde(deserialize_with = "nan_if_null")]
    pub bic: f64,
}

/// A coefficient of a black box's polynomials.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Coefficient {
    /// As the polynomials name it.
    pub symbol: String,
    /// Estimate.
    #[serde(deserialize_with = "nan_if_null")]
    pub value: f64,
    /// Standard error.
    #[serde(deserialize_with = "nan_if_null")]
    pub standard_error: f64,
    /// 95 % interval.
    #[serde(deserialize_with = "nan_if_null")]
    pub interval: (f64, f64),
}

/// Why a structure was chosen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum ChosenBy {
    /// Best fit on data it was not estimated from.
    Fit,
    /// Least Bayesian information criterion.
    Bic,
}

/// A pole or zero with its region.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Root {
    /// Real part.
    #[serde(deserialize_with = "nan_if_null")]
    pub re: f64,
    /// Imaginary part.
    #[serde(deserialize_with = "nan_if_null")]
    pub im: f64,
    /// Edge of the 95 % ellipse; empty where there is none, as for a root that its uncertainty carries into another.
    #[serde(deserialize_with = "nan_if_null")]
    pub ellipse: Vec<[f64; 2]>,
}

/// A black box that was chosen, estimated from all but the held-out part.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BlackBox {
    /// Its structure.
    pub structure: Structure,
    /// Why it was chosen.
    pub chosen_by: Vec<ChosenBy>,
    /// Coefficients.
    pub coefficients: Vec<Coefficient>,
    /// Poles in z, of the model as it is estimated, its loop open.
    pub poles: Vec<Root>,
    /// Zeros in z.
    pub zeros: Vec<Root>,
    /// How it follows T_d*.
    pub closed: Closed,
    /// Its delay from T_d* to T_d at 10 Hz, −arg/ω, s; none where it does not settle.
    pub delay: Option<Parameter>,
    /// Its gain from T_d* to T_d at 10 Hz.
    pub gain: Option<Parameter>,
    /// Bandwidth of its slowest mode, −ln(p)/T, where that is one real pole, rad/s.
    pub lag_rad_s: Option<f64>,
    /// From T_d* to T_d; none where that does not settle.
    pub(super) follows: Option<Way>,
}

/// Numerator and denominator in powers of q⁻¹, the denominator's first coefficient one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub(super) struct Way {
    num: Vec<f64>,
    den: Vec<f64>,
}

impl Way {
    fn of(model: &PolynomialModel) -> Option<Self> {
        let equation = model.equations().first()?;
        let monic = |p: &[Vec<f64>]| -> Vec<f64> { std::iter::once(1.0).chain(p.iter().flatten().copied()).collect() };
        Some(Way { num: equation.delayed_b(0), den: multiply(&monic(&equation.a), &monic(&equation.f)) })
    }

    /// From T_d* where this was from T_d* − T_d: B/(A + B) (6.3).
    fn closed(self) -> Option<Self> {
        let length = self.num.len().max(self.den.len());
        let padded =
            |p: &[f64]| p.iter().copied().chain(std::iter::repeat_n(0.0, length - p.len())).collect::<Vec<_>>();
        let den = add(&padded(&self.den), &padded(&self.num));
        let first = *den.first()?;
        (first.abs() > NO_LOOP).then(|| Way {
            num: self.num.iter().map(|b| b / first).collect(),
            den: den.iter().map(|a| a / first).collect(),
        })
    }

    fn is_stable(&self) -> Result<bool, LtiError> {
        Ok(lti::polynomial::roots(&self.den)?.iter().all(|p| p.norm() < 1.0))
    }

    /// From rest.
    pub(super) fn response(&self, input: &[f64]) -> Vec<f64> {
        let mut output: Vec<f64> = Vec::with_capacity(input.len());
        for t in 0..input.len() {
            let driven: f64 = self.num.iter().take(t + 1).enumerate().map(|(k, b)| b * input[t - k]).sum();
            let own: f64 = self.den.iter().enumerate().skip(1).take(t).map(|(k, a)| a * output[t - k]).sum();
            output.push(driven - own);
        }
        output
    }

    /// Gain and delay (−arg/ω, s) at 10 Hz.
    fn asked(&self, sample_time_s: f64) -> [f64; 2] {
        let omega = TAU * ASKED_HZ;
        let at = |p: &[f64]| -> Complex64 {
            p.iter().enumerate().map(|(k, c)| Complex64::cis(-omega * sample_time_s * k as f64) * *c).sum()
        };
        let gain = at(&self.num) / at(&self.den);
        [gain.norm(), -gain.arg() / omega]
    }

    /// Bandwidth of the slowest mode where that is a real pole in (0, 1), rad/s.
    fn lag_rad_s(&self, sample_time_s: f64) -> Option<f64> {
        let poles = lti::polynomial::roots(&self.den).ok()?;
        let slowest = poles.iter().max_by(|p, q| p.norm().total_cmp(&q.norm()))?;
        (slowest.im == 0.0 && slowest.re > 0.0 && slowest.re < 1.0).then(|| -slowest.re.ln() / sample_time_s)
    }
}

impl Structure {
    /// Every structure of a family and an input.
    pub(super) fn all(family: Family, input: Input, tried: OrdersTried) -> Vec<Structure> {
        let OrdersTried { highest, longest_delay } = tried;
        let orders = (1..=highest).flat_map(|poles| (1..=highest).map(move |nb| (poles, nb)));
        orders
            .flat_map(|(poles, nb)| (0..=longest_delay).map(move |nk| Structure { family, input, poles, nb, nk }))
            .collect()
    }

    fn fit(
        &self,
        record: &Record,
        range: std::ops::Range<usize>,
        search: NonlinearOptions,
        starts: Vec<Vec<f64>>,
    ) -> Result<Fit<PolynomialModel>, IdentError> {
        let data = record.data(self.input, range)?;
        let output_error = || OutputError::new(self.nb, self.poles, self.nk).with_search(search).starting_at(starts);
        match self.family {
            Family::Arx => Arx::new(self.poles, self.nb, self.nk).fit(&data),
            Family::OutputError => output_error().fit(&data),
        }
    }

    /// From T_d*, and how it settles.
    fn follows(&self, model: &PolynomialModel) -> (Closed, Option<Way>) {
        let open = Way::of(model);
        let way = match self.input {
            Input::Demand => open,
            Input::Error => open.and_then(Way::closed),
        };
        match way {
            None => (Closed::Circular, None),
            Some(way) if way.is_stable().unwrap_or(false) => (Closed::Stable, Some(way)),
            Some(_) => (Closed::Unstable, None),
        }
    }

    /// Estimates it from the first stretch, the search begun at the best of these starts, and simulates the second;
    /// with its coefficients. None where the data do not determine it.
    pub(super) fn scan(&self, record: &Record, starts: Vec<Vec<f64>>) -> Option<(Scanned, Vec<f64>)> {
        let fit = self.fit(record, record.first(), ROUGHLY, starts).ok()?;
        let (closed, follows) = self.follows(&fit.model);
        let percent = |modelled: &[f64]| {
            let error = rms(&record.errors(modelled, record.second()));
            100.0 * (1.0 - error / record.spread_nm(record.second()))
        };
        let fed = (self.input == Input::Error)
            .then(|| Way::of(&fit.model).filter(|way| way.is_stable().unwrap_or(false)))
            .flatten();
        let scanned = Scanned {
            structure: *self,
            parameters: fit.free_parameters,
            closed,
            fit_percent: follows.map(|way| percent(&way.response(&record.demand))),
            fed_percent: fed.map(|way| percent(&way.response(&record.input(Input::Error)))),
            // The same number of samples for all: the first few, which lack some of their past, tell no order.
            bic: Criteria::of(fit.loss, fit.free_parameters, record.first().len(), 1).bic,
        };
        Some((scanned, fit.parameters()))
    }

    /// Estimates it from all but the held-out part.
    pub(super) fn estimate(&self, record: &Record, chosen_by: Vec<ChosenBy>) -> Option<BlackBox> {
        let fit = self.fit(record, record.estimation(), NonlinearOptions::default(), Vec::new()).ok()?;
        let (closed, follows) = self.follows(&fit.model);
        let freedom = fit.degrees_of_freedom;
        let named = fit.model.coefficient_names().into_iter().zip(fit.parameters()).zip(fit.standard_errors());
        let coefficients = named.map(|((symbol, value), standard_error)| Coefficient {
            symbol,
            value,
            standard_error,
            interval: interval(value, standard_error, freedom, INTERVAL_LEVEL),
        });
        let asked = follows.is_some().then(|| self.asked(&fit, record.sample_time_s)).flatten();
        Some(BlackBox {
            structure: *self,
            chosen_by,
            coefficients: coefficients.collect(),
            poles: roots(fit.poles(0, 0)),
            zeros: roots(fit.zeros(0, 0)),
            closed,
            delay: asked.as_ref().map(|[_, delay]| delay.clone()),
            gain: asked.map(|[gain, _]| gain),
            lag_rad_s: follows.as_ref().and_then(|way| way.lag_rad_s(record.sample_time_s)),
            follows,
        })
    }

    fn asked(&self, fit: &Fit<PolynomialModel>, sample_time_s: f64) -> Option<[Parameter; 2]> {
        let gain_and_delay = |model: &PolynomialModel| {
            Ok(self.follows(model).1.map_or([f64::NAN; 2], |way| way.asked(sample_time_s)).to_vec())
        };
        let derived = fit.derive(gain_and_delay).ok()?;
        let errors = derived.standard_errors();
        let parameter = |quantity: Quantity, k: usize| {
            Parameter::new(quantity, derived.values[k], errors[k], derived.degrees_of_freedom)
        };
        Some([parameter(Quantity::BlackBoxGain, 0), parameter(Quantity::BlackBoxDelay, 1)])
    }
}

fn roots(found: Result<Vec<UncertainRoot>, IdentError>) -> Vec<Root> {
    let region = |root: &UncertainRoot, ellipse: Ellipse| -> Vec<[f64; 2]> {
        let is_drawn = ellipse.semi_major.is_finite() && ellipse.semi_major > 0.0 && !root.near_multiple;
        if !is_drawn {
            return Vec::new();
        }
        ellipse.points(60).iter().map(|z| [z.re, z.im]).collect()
    };
    let root = |root: &UncertainRoot| Root {
        re: root.value.re,
        im: root.value.im,
        ellipse: region(root, root.ellipse(ELLIPSE_LEVEL)),
    };
    found.unwrap_or_default().iter().map(root).collect()
}
