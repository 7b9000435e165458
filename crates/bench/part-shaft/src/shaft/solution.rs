//! One fit of the shaft's equation to a stretch of a recording.

use ident::Bounds;
use ident::frequency::{ErrorsInVariables, FrequencyFit, Prior};
use numerics::vector;
use rig::Role;
use rig::estimation::{EstimateError, ReadOut, transformed};
use rig::results::{Estimate, Parameter, Quantity, ResidualSpectrum, SharedError, Stretch};

use super::engine_side::EngineInertia;
use super::equation::{Dating, ShaftEquation};
use super::inputs::{LARGEST_SKEW_S, ShaftInputs};
use super::skew_search;
use super::spectra::{Spectra, turn_band_hz, whole_band_hz};
use crate::shaft::places;
use crate::shaft::places::COUNT;
use crate::shaft::term::Term;

/// A bin whose |error|²/σ² exceeds this many times the mean is taken for a line the model does not know: under the
/// model that happens once in e^20 bins.
const OUTLIER: f64 = 20.0;
/// Bins about an outlier that its line reaches.
const OUTLIER_REACH: usize = 4;
/// Times that outliers are looked for.
const OUTLIER_ROUNDS: usize = 3;
/// Frequencies this near, Hz, show what the equation leaves about one of them.
const LEVEL_REACH_HZ: f64 = 2.5;
/// Mean of |error|²/σ² about a frequency from which that counts as noise there: by chance it is never reached, with a
/// hundred bins about each frequency.
const RAISED: f64 = 2.0;
/// Standard uncertainty of the once-a-turn errors beforehand, as a part of the speed.
pub(crate) const ECCENTRICITY: f64 = 1e-3;
/// A second mass is determined by the first term of a series that holds up to its resonance; one below 40 Hz is no
/// small change.
const LARGEST_SECOND_MASS_S2: f64 = 1.6e-5;
/// A speed that varies less than this (standard deviation) excites nothing, rad/s.
const STILL_RAD_S: f64 = 1e-6;
/// Where the search for a dual-mass flywheel starts: J_2 in kg m², and K_2 over K.
const FLYWHEELS: [(f64, f64); 8] =
    [(0.02, 0.2), (0.02, 0.7), (0.02, 2.5), (0.1, 0.2), (0.1, 0.7), (0.1, 2.5), (0.3, 0.3), (0.3, 1.5)];
/// Damping of both springs there, as a part of the critical.
const START_DAMPING: f64 = 0.05;
/// An engine at rest has no firing interval; this slow it is as long as it may matter, rad/s.
pub(crate) const SLOWEST_RAD_S: f64 = 30.0;
/// Errors of the model of the signals, such as ripple beside its lines and pulses beside their multiples: standard
/// uncertainties, as parts of the values. From virtual benches over the whole class (seeds that the deep check does not
/// use).
const MODEL_ERRORS: [(Quantity, f64); 3] =
    [(Quantity::Stiffness, 8e-4), (Quantity::Damping, 4e-3), (Quantity::DynoInertia, 8e-4)];
/// The same of the skews, s.
const SKEW_ERROR_S: f64 = 1e-5;
/// Level of the residual spectrum's bound.
const BOUND_LEVEL: f64 = 0.99;

/// Adds to an estimate what the model of the signals does not hold.
fn add_model_errors(estimate: &mut Estimate) {
    for (quantity, part) in MODEL_ERRORS {
        let error = estimate.parameter(quantity).map_or(0.0, |found| part * found.value.abs());
        estimate.add_systematic(&[quantity], error);
    }
}

/// Uncertainties of K and B as the model of the signals is not exact: standard uncertainties.
pub(crate) fn model_errors(stiffness: f64, damping: f64) -> [f64; 2] {
    let part = |quantity| MODEL_ERRORS.iter().find(|(of, _)| *of == quantity).map_or(0.0, |(_, part)| *part);
    [part(Quantity::Stiffness) * stiffness.abs(), part(Quantity::Damping) * damping.abs()]
}

/// Where nothing fires nothing waits for the next firing: what answers to the other machine's speed, such as its
/// friction, does so within about this time, s.
pub(crate) const WITHOUT_FIRING_S: f64 = 1e-5;

/// Unknowns that a fit is to find.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Unknowns {
    /// K, B, gate and skews; J_d within its stated uncertainty.
    Shaft,
    /// K and B alone, as if time stamps were exact and speeds momentary.
    ShaftWithoutTiming,
    /// J_d too, as if nothing were known of it.
    ShaftAndInertia,
    /// As the shaft, with a term beyond it.
    ShaftAnd(Term),
}

impl Unknowns {
    fn term(self) -> Option<Term> {
        match self {
            Unknowns::ShaftAnd(term) => Some(term),
            _ => None,
        }
    }
}

/// Knowledge of the timing before a fit.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dated<'a> {
    /// By how much signals are dated earlier.
    pub(super) dating: Dating,
    /// From and to which frequency the signals are used.
    pub(super) band_hz: (f64, f64),
    /// Priors of parameters beside what the inputs say.
    pub(super) known: &'a [Prior],
    /// Where the search starts; the usual place where `None`.
    pub(super) from: Option<&'a [f64]>,
}

impl Dated<'_> {
    pub(super) fn as_recorded(inputs: &ShaftInputs<'_>) -> Self {
        Dated { dating: Dating::default(), band_hz: whole_band_hz(inputs), known: &[], from: None }
    }
}

/// A fit with what it was made from.
pub(super) struct Solution {
    pub(super) spectra: Spectra,
    pub(super) fit: FrequencyFit,
    excluded_hz: Vec<f64>,
    /// Standard uncertainty of the delay that the torque was computed with, s.
    delay_uncertainty_s: f64,
}

impl Solution {
    pub(super) fn of(inputs: &ShaftInputs<'_>, stretch: &Stretch, unknowns: Unknowns) -> Result<Self, EstimateError> {
        check_moved(inputs)?;
        let found = Self::from_a_fit_of(unknowns, inputs, stretch, unknowns);
        match unknowns {
            // A search that is free of J_d may end where the data do not determine it. It begins again where J_d is
            // held within what is stated.
            Unknowns::ShaftAndInertia => {
                found.or_else(|_| Self::from_a_fit_of(Unknowns::Shaft, inputs, stretch, unknowns))
            }
            _ => found,
        }
    }

    /// The fit that begins at one of the signals as they were recorded, dated by it.
    fn from_a_fit_of(
        first: Unknowns,
        inputs: &ShaftInputs<'_>,
        stretch: &Stretch,
        unknowns: Unknowns,
    ) -> Result<Self, EstimateError> {
        let recorded = Dated::as_recorded(inputs);
        let first = Self::dated(inputs, stretch, first, recorded)?;
        if unknowns == Unknowns::ShaftWithoutTiming {
            return Ok(first);
        }
        let theta = &first.fit.fit.parameters;
        let again = Dated { dating: Dating::of(theta), from: Some(theta), ..recorded };
        let found = Self::dated(inputs, stretch, unknowns, again)?;
        let at_limit = EstimateError::AtLimit { file: inputs.file.to_owned(), quantity: Quantity::Stiffness };
        if found.fit.fit.at_bound[places::K] { Err(at_limit) } else { Ok(found) }
    }

    pub(super) fn dated(
        inputs: &ShaftInputs<'_>,
        stretch: &Stretch,
        unknowns: Unknowns,
        Dated { dating, band_hz, known, from }: Dated<'_>,
    ) -> Result<Self, EstimateError> {
        let error = |source| EstimateError::Ident { file: inputs.file.to_owned(), source };
        let mut spectra = Spectra::new(inputs, (stretch.start_s, stretch.end_s), dating, band_hz)?;
        if let Some(wave) = unknowns.term().and_then(|term| term.wave(inputs, dating)) {
            spectra = spectra.with_wave(&wave).map_err(error)?;
        }
        let mut excluded_hz = Vec::new();
        let mut fit = solve(inputs, &spectra, &[], unknowns, known, from).map_err(error)?;
        // Outliers of a model known to be wrong say nothing about the data.
        if unknowns != Unknowns::ShaftWithoutTiming {
            for _ in 0..OUTLIER_ROUNDS {
                let lines = drop_outliers(&mut spectra, &fit);
                if lines.is_empty() {
                    break;
                }
                excluded_hz.extend(lines);
                fit = solve(inputs, &spectra, &[], unknowns, known, Some(&fit.fit.parameters)).map_err(error)?;
            }
            if let Some(weights) = weights(&spectra, &fit) {
                let unweighted = &fit.fit.parameters;
                fit = solve(inputs, &spectra, &weights, unknowns, known, Some(unweighted)).map_err(error)?;
            }
        }
        let delay_uncertainty_s = inputs.torque_control.map_or(0.0, |control| control.delay_uncertainty_s);
        Ok(Solution { spectra, fit, excluded_hz, delay_uncertainty_s })
    }

    pub(super) fn outputs(&self, outputs: &[ReadOut<'_>], stretch: &Stretch) -> Estimate {
        transformed(outputs, &self.fit.fit, &self.fit.covariance, self.fit.degrees_of_freedom, stretch)
    }

    pub(super) fn estimate(&self, stretch: &Stretch) -> Estimate {
        let mut outputs: Vec<ReadOut<'_>> = vec![
            (Quantity::Stiffness, &|t| t[places::K]),
            (Quantity::Damping, &|t| t[places::B]),
            (Quantity::EngineSpeedSkew, &|t| t[places::SKEW_ENGINE]),
            (Quantity::AirGapTorqueSkew, &|t| t[places::SKEW_TORQUE]),
            (Quantity::EncoderGates, &|t| t[places::GATE]),
        ];
        let is_estimated = |at: usize| self.fit.covariance[(at, at)] > 0.0;
        if is_estimated(places::FRICTION) {
            outputs.push((Quantity::FrictionSlope, &|t| t[places::FRICTION]));
        }
        if is_estimated(places::INERTIA) {
            outputs.push((Quantity::DynoInertia, &|t| t[places::INERTIA]));
        }
        let mut estimate = self.outputs(&outputs, stretch);
        add_model_errors(&mut estimate);
        estimate.add_systematic(&[Quantity::EngineSpeedSkew], SKEW_ERROR_S);
        estimate.add_systematic(&[Quantity::AirGapTorqueSkew], SKEW_ERROR_S.hypot(self.delay_uncertainty_s));
        estimate
    }

    /// K and B move with the mean m of a prior of variance u² by P/u², with P their covariance with its parameter.
    pub(super) fn shared_errors(&self, inputs: &ShaftInputs<'_>) -> Vec<SharedError> {
        let covariance = &self.fit.covariance;
        let lag_uncertainty_s = inputs.torque_control.map_or(0.0, |control| control.lag_uncertainty_s);
        let known = [
            (Quantity::DynoInertia, places::INERTIA, inputs.inertia_kg_m2.map_or(0.0, |(_, uncertainty)| uncertainty)),
            (Quantity::FrictionSlope, places::FRICTION, inputs.friction_slope_nm_s_per_rad.1),
            (Quantity::EncoderGates, places::GATE, inputs.gate_s.1),
            (Quantity::TorqueControlBandwidth, places::LAG, lag_uncertainty_s),
        ];
        let estimated = known.into_iter().filter(|(_, at, before)| *before > 0.0 && covariance[(*at, *at)] > 0.0);
        let share = |(known, at, before): (Quantity, usize, f64)| {
            // Where coloured errors make it less certain than it was beforehand, all of that counts as shared.
            let before = before.max(covariance[(at, at)].sqrt());
            SharedError { known, of_shaft: [places::K, places::B].map(|i| covariance[(i, at)] / before) }
        };
        estimated.map(share).collect()
    }

    /// The shaft's parameters, J_d where it was estimated, and J_e.
    pub(super) fn with_engine_inertia(&self, stretch: &Stretch, engine: &EngineInertia) -> Estimate {
        let mut quantities: Vec<(Quantity, usize)> =
            vec![(Quantity::Stiffness, places::K), (Quantity::Damping, places::B)];
        if self.fit.covariance[(places::INERTIA, places::INERTIA)] > 0.0 {
            quantities.push((Quantity::DynoInertia, places::INERTIA));
        }
        quantities.extend([
            (Quantity::EngineSpeedSkew, places::SKEW_ENGINE),
            (Quantity::AirGapTorqueSkew, places::SKEW_TORQUE),
            (Quantity::EncoderGates, places::GATE),
        ]);
        let (theta, known) = (&self.fit.fit.parameters, &self.fit.covariance);
        let entry = |quantity: Quantity, at: usize| {
            Parameter::new(quantity, theta[at], known[(at, at)].max(0.0).sqrt(), self.fit.degrees_of_freedom)
        };
        let mut parameters: Vec<Parameter> = quantities.iter().map(|(quantity, at)| entry(*quantity, *at)).collect();
        let error = engine.variance.sqrt();
        parameters.push(Parameter::new(
            Quantity::EngineInertia,
            engine.inertia_kg_m2,
            error,
            engine.degrees_of_freedom,
        ));
        let with_engine = |at: usize| engine.with_shaft[at];
        let row = |i: usize| quantities.iter().map(|(_, j)| known[(i, *j)]).chain([with_engine(i)]).collect();
        let mut covariance: Vec<Vec<f64>> = quantities.iter().map(|(_, i)| row(*i)).collect();
        covariance.push(quantities.iter().map(|(_, at)| with_engine(*at)).chain([engine.variance]).collect());
        let mut estimate = Estimate {
            parameters,
            covariance,
            stretches: vec![stretch.clone()],
            iterations: self.fit.fit.iterations,
            condition: self.fit.fit.condition,
        };
        add_model_errors(&mut estimate);
        estimate
    }

    pub(super) fn zero(&self, stretch: &Stretch) -> Result<Parameter, EstimateError> {
        let mut zero = self.outputs(&[(Quantity::ShaftZero, &|t| -t[places::K] / t[places::B])], stretch);
        let [of_stiffness, of_damping] = model_errors(1.0, 1.0);
        let error = zero.parameters.first().map_or(0.0, |zero| zero.value.abs() * of_stiffness.hypot(of_damping));
        zero.add_systematic(&[Quantity::ShaftZero], error);
        zero.parameters.pop().ok_or_else(|| EstimateError::Ident {
            file: stretch.file.clone(),
            source: ident::IdentError::TooFewSamples { samples: 0, parameters: 1 },
        })
    }

    pub(super) fn residual_spectrum(&self) -> ResidualSpectrum {
        let scale = self.fit.scale.sqrt();
        ResidualSpectrum {
            frequencies_hz: self.spectra.bins.iter().map(|k| self.spectra.window.frequency_hz(*k)).collect(),
            normalised_magnitude: self.fit.normalised.iter().map(|q| q / scale).collect(),
            // |e|²/σ² is exponentially distributed with mean one.
            bound: (-(1.0 - BOUND_LEVEL).ln()).sqrt(),
            excluded_hz: self.excluded_hz.clone(),
        }
    }
}

fn check_moved(inputs: &ShaftInputs<'_>) -> Result<(), EstimateError> {
    for (role, speed) in [(Role::DynoSpeed, inputs.dyno_speed), (Role::EngineSpeed, inputs.engine_speed)] {
        let standard_deviation = vector::standard_deviation(&speed.samples);
        if standard_deviation < STILL_RAD_S {
            return Err(EstimateError::WeakExcitation { file: inputs.file.to_owned(), role, standard_deviation });
        }
    }
    Ok(())
}

fn solve(
    inputs: &ShaftInputs<'_>,
    spectra: &Spectra,
    weights: &[f64],
    unknowns: Unknowns,
    known: &[Prior],
    from: Option<&[f64]>,
) -> Result<FrequencyFit, ident::IdentError> {
    let (gate, gate_uncertainty) = inputs.gate_s;
    let (inertia, inertia_uncertainty) = inputs.inertia_kg_m2.unwrap_or((0.0, 0.0));
    let mut start = [0.0; COUNT];
    (start[places::K], start[places::GATE]) = (starting_stiffness(spectra, inertia), gate);
    start[places::INERTIA] = inertia;
    let positive = Bounds::new(0.0, f64::INFINITY);
    let skew = Bounds::new(-LARGEST_SKEW_S, LARGEST_SKEW_S);
    let mut bounds = [Bounds::NONE; COUNT];
    bounds[..=places::B].fill(positive);
    bounds[places::SKEW_ENGINE..=places::SKEW_TORQUE].fill(skew);
    bounds[places::GATE] = Bounds::new(0.0, LARGEST_SKEW_S);
    bounds[places::INERTIA] = Bounds::new(inertia, inertia);
    bounds[places::FRICTION] = Bounds::new(0.0, 0.0);
    bounds[places::TERM] = Bounds::new(0.0, 0.0);
    let mut priors = vec![Prior { parameter: places::GATE, value: gate, standard_uncertainty: gate_uncertainty }];
    if inertia > 0.0 && unknowns != Unknowns::ShaftWithoutTiming {
        bounds[places::FRICTION] = Bounds::NONE;
        let (value, standard_uncertainty) = inputs.friction_slope_nm_s_per_rad;
        start[places::FRICTION] = value;
        priors.push(Prior { parameter: places::FRICTION, value, standard_uncertainty });
    }
    let (lag, lag_uncertainty) = inputs.torque_control.map_or((0.0, 0.0), |c| (c.lag_s, c.lag_uncertainty_s));
    (start[places::LAG], start[places::COMPUTED_LAG]) = (lag, lag);
    bounds[places::COMPUTED_LAG] = Bounds::new(lag, lag);
    let is_lag_known = lag_uncertainty == 0.0 || unknowns == Unknowns::ShaftWithoutTiming;
    bounds[places::LAG] = if is_lag_known { Bounds::new(lag, lag) } else { Bounds::new(0.0, LARGEST_SKEW_S) };
    bounds[places::DUAL_MASS[1]..=places::DUAL_MASS[2]].fill(Bounds::new(0.0, 0.0));
    match unknowns.term() {
        Some(Term::DualMass) => places::DUAL_MASS.iter().for_each(|i| bounds[*i] = positive),
        Some(Term::SecondMass) => bounds[places::TERM] = Bounds::new(-LARGEST_SECOND_MASS_S2, LARGEST_SECOND_MASS_S2),
        Some(_) => bounds[places::TERM] = Bounds::NONE,
        None => (),
    }
    match unknowns {
        Unknowns::Shaft | Unknowns::ShaftAnd(_) if inertia_uncertainty > 0.0 => {
            bounds[places::INERTIA] = positive;
            priors.push(Prior {
                parameter: places::INERTIA,
                value: inertia,
                standard_uncertainty: inertia_uncertainty,
            });
        }
        Unknowns::Shaft | Unknowns::ShaftAnd(_) => (),
        Unknowns::ShaftWithoutTiming => {
            start[places::GATE] = 0.0;
            bounds[places::SKEW_ENGINE..=places::GATE].fill(Bounds::new(0.0, 0.0));
            priors.clear();
        }
        Unknowns::ShaftAndInertia => bounds[places::INERTIA] = positive,
    }
    priors.retain(|prior| known.iter().all(|k| k.parameter != prior.parameter));
    priors.extend(known);
    if !is_lag_known {
        priors.push(Prior { parameter: places::LAG, value: lag, standard_uncertainty: lag_uncertainty });
    }
    let turns = [places::DYNO_TURN, places::ENGINE_TURN].into_iter().flatten();
    priors.extend(turns.map(|parameter| Prior { parameter, value: 0.0, standard_uncertainty: ECCENTRICITY }));
    let equation = ShaftEquation { dating: spectra.dating, term: unknowns.term() };
    let fit = |start: &[f64]| {
        ErrorsInVariables::new(&equation, &spectra.signals, spectra.window, &spectra.bins, &priors)
            .with_weights(weights)
            .fit(start, &bounds)
    };
    if let Some(from) = from {
        return fit(from);
    }
    let starts = match unknowns {
        Unknowns::ShaftWithoutTiming => vec![start],
        _ => with_skews(start, inputs, spectra),
    };
    match unknowns.term() {
        Some(Term::DualMass) => best_of(starts.into_iter().flat_map(flywheels).map(|start| fit(&start))),
        _ => best_of(starts.iter().map(|start| fit(start))),
    }
}

/// A start with the skews, K and B that fit best on a grid; several where they are rivals.
fn with_skews(start: [f64; COUNT], inputs: &ShaftInputs<'_>, spectra: &Spectra) -> Vec<[f64; COUNT]> {
    let known = skew_search::Known {
        inertia_kg_m2: start[places::INERTIA],
        gate_s: start[places::GATE],
        stiffness: start[places::K],
        turns_hz: turn_band_hz(inputs.dyno_speed),
    };
    let moved = |found: skew_search::Start| {
        let mut moved = start;
        (moved[places::K], moved[places::B]) = (found.stiffness, found.damping);
        (moved[places::SKEW_ENGINE], moved[places::SKEW_TORQUE]) = (found.engine_skew_s, found.torque_skew_s);
        moved
    };
    skew_search::starts(spectra, &known).into_iter().map(moved).collect()
}

/// The fit that leaves least of data and of what was known before; the last failure where all fail.
fn best_of(
    fits: impl Iterator<Item = Result<FrequencyFit, ident::IdentError>>,
) -> Result<FrequencyFit, ident::IdentError> {
    let better = |best: Result<FrequencyFit, ident::IdentError>, next: Result<FrequencyFit, ident::IdentError>| match (
        &best, &next,
    ) {
        (Ok(a), Ok(b)) if b.fit.cost < a.fit.cost => next,
        (Err(_), _) => next,
        _ => best,
    };
    let none = ident::IdentError::TooFewSamples { samples: 0, parameters: COUNT };
    fits.fold(Err(none), better)
}

/// Starts with a dual-mass flywheel, both springs together as stiff as the one of `start`.
fn flywheels(start: [f64; COUNT]) -> [[f64; COUNT]; FLYWHEELS.len()] {
    FLYWHEELS.map(|(mass, ratio)| {
        let mut with = start;
        let stiffness = start[places::K] * (1.0 + 1.0 / ratio);
        let damping = |stiffness: f64| 2.0 * START_DAMPING * (stiffness * mass).sqrt();
        (with[places::K], with[places::B]) = (stiffness, damping(stiffness));
        let [at_mass, at_stiffness, at_damping] = places::DUAL_MASS;
        (with[at_mass], with[at_stiffness], with[at_damping]) = (mass, ratio * stiffness, damping(ratio * stiffness));
        with
    })
}

/// K of a shaft without damping or skew, by least squares over the lowest third of the bins.
fn starting_stiffness(spectra: &Spectra, inertia: f64) -> f64 {
    let (mut product, mut power) = (0.0, f64::MIN_POSITIVE);
    for k in &spectra.bins[..spectra.bins.len().div_ceil(3)] {
        let of = |signal: usize, order: usize| spectra.signals[signal].modulated.orders[order][*k];
        let twist = of(1, 0) - of(0, 0);
        let rate = inertia * of(0, 2) + of(2, 1);
        product += (rate * twist.conj()).re;
        power += twist.norm_sqr();
    }
    (product / power).max(1.0)
}

/// Weights by which frequencies where the equation leaves more than the noise count less; none where it does so
/// nowhere.
fn weights(spectra: &Spectra, fit: &FrequencyFit) -> Option<Vec<f64>> {
    let (bins, reach) = (&spectra.bins, (LEVEL_REACH_HZ * spectra.window.duration_s) as usize);
    let (mut first, mut end, mut sum) = (0, 0, 0.0);
    let level = |k: &usize| {
        while end < bins.len() && bins[end] <= k + reach {
            sum += fit.normalised[end].powi(2);
            end += 1;
        }
        while bins[first] + reach < *k {
            sum -= fit.normalised[first].powi(2);
            first += 1;
        }
        (sum / (end - first) as f64).max(1.0)
    };
    let levels: Vec<f64> = bins.iter().map(level).collect();
    let is_raised = levels.iter().any(|level| *level > RAISED);
    is_raised.then(|| levels.iter().map(|level| level.powf(-0.5)).collect())
}

/// Removes bins that hold lines the model does not know, with their neighbours; returns the lines' frequencies.
fn drop_outliers(spectra: &mut Spectra, fit: &FrequencyFit) -> Vec<f64> {
    let limit = OUTLIER * fit.scale;
    let outliers: Vec<usize> =
        spectra.bins.iter().zip(&fit.normalised).filter(|(_, q)| **q * **q > limit).map(|(k, _)| *k).collect();
    spectra.bins.retain(|k| !outliers.iter().any(|o| k.abs_diff(*o) <= OUTLIER_REACH));
    let lines = outliers.chunk_by(|a, b| b - a <= 2 * OUTLIER_REACH);
    lines.map(|line| spectra.window.frequency_hz(line[line.len() / 2])).collect()
}
