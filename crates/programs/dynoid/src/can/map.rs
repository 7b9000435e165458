//! Capability maps.

use capability::beyond::of_model;
use capability::gradient::{GradientPlace, gradients};
use capability::map::{CapabilityMap, MapInputs, SineOf, map};
use capability::wanted::{self, Wanted, WantedAnswer};
use capability::{Beyond, LimitOf};
use design::safety::FrictionSpread;
use page::Page;
use report::can::MapPage;
use rig::engine_pulses::KnownPulses;
use units::RPM_RAD_S;

use super::facts::{BeyondFacts, CapabilityFacts};
use crate::error::Error;
use crate::known::{Draws, KnownBench, PulsesFrom};

/// Frequencies of the table, Hz.
const FREQUENCIES_HZ: [f64; 19] =
    [0.1, 0.2, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 12.0, 14.0, 16.0, 18.0, 20.0, 25.0, 30.0, 40.0, 60.0, 100.0];
/// Frequencies of the figure in each of the three decades from 0.1 Hz on.
const IN_A_DECADE: u32 = 30;
/// Speeds, rpm, up to the limit.
const SPEEDS_RPM: [f64; 8] = [800.0, 1200.0, 1500.0, 2000.0, 3000.0, 4000.0, 5000.0, 6000.0];

/// Usual mean torque, Nm.
const TORQUE_NM: f64 = 50.0;

/// Choices of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct CapabilityOptions {
    /// The only speed, rpm; without it usual speeds up to the limit.
    pub speed_rpm: Option<f64>,
    /// Mean torque, Nm.
    pub torque_nm: f64,
    /// Sines and gradients that are wanted.
    pub wanted: Vec<Wanted>,
    /// Benches that are drawn.
    pub draws: Draws,
}

impl CapabilityOptions {
    /// The usual speeds and mean torque.
    pub fn of(draws: Draws) -> Self {
        CapabilityOptions { speed_rpm: None, torque_nm: TORQUE_NM, wanted: Vec::new(), draws }
    }
}

/// The largest sines over frequency and speed that a bench can do, and the largest gradients.
#[derive(Debug, Clone)]
pub struct Capability {
    bench: String,
    torque_nm: f64,
    maps: Vec<CapabilityMap>,
    gradients: Vec<GradientPlace>,
    wanted: Vec<WantedAnswer>,
    unchecked: Vec<LimitOf>,
    beyond: Vec<Beyond>,
    friction: FrictionSpread,
    pulses: KnownPulses,
}

impl Capability {
    /// Checks that there can be a map of a bench, before anything is asked of it.
    ///
    /// # Errors
    /// A bench that cannot be predicted.
    pub fn check(bench: &KnownBench) -> Result<(), Error> {
        bench.model_with_shaft().map(|_| ()).map_err(|reason| bench.refused(reason))
    }

    /// The map of a bench.
    ///
    /// # Errors
    /// A bench that cannot be predicted, and a speed that is not above zero.
    pub fn of(bench: &KnownBench, options: CapabilityOptions) -> Result<Self, Error> {
        let model = bench.model_with_shaft().map_err(|reason| bench.refused(reason))?;
        let (limits, stated) = (bench.file().limits, bench.virtual_bench());
        let CapabilityOptions { speed_rpm, torque_nm, wanted, draws } = options;
        let is_possible = |speed: &f64| limits.speed_rad_s.is_none_or(|limit| *speed < limit);
        let speeds: Vec<f64> = match speed_rpm {
            Some(rpm) if rpm > 0.0 => vec![rpm * RPM_RAD_S],
            Some(rpm) => return Err(Error::SpeedOfMap { rpm }),
            None => SPEEDS_RPM.into_iter().map(|rpm| rpm * RPM_RAD_S).filter(is_possible).collect(),
        };
        let inputs = MapInputs {
            model: &model,
            engine: &stated.parameters.engine,
            pulses: &stated.pulses,
            limits,
            spread: bench.spread(),
            friction: bench.friction(),
            torque_nm,
            samples: draws.benches,
            seed: draws.seed,
        };
        let failed = |error: capability::CapabilityError| bench.refused(error);
        let maps = [SineOf::Speed, SineOf::Torque].into_iter().map(|of| map(&inputs, of, &frequencies_hz(), &speeds));
        let maps = maps.collect::<Result<Vec<_>, _>>().map_err(failed)?;
        let gradients = gradients(&inputs, &speeds, &torques_nm(torque_nm, limits.torque_nm)).map_err(failed)?;
        let answers = wanted.into_iter().map(|wish| wanted::answer(&inputs, wish, &speeds));
        Ok(Capability {
            bench: bench.file().name.clone(),
            torque_nm,
            maps,
            gradients,
            wanted: answers.collect::<Result<Vec<_>, _>>().map_err(failed)?,
            unchecked: LimitOf::of_map(&limits).filter(|of| of.limit(&limits).is_none()).collect(),
            beyond: of_model(&bench.validity(), &speeds, &[torque_nm]),
            friction: inputs.friction,
            pulses: stated.pulses.clone(),
        })
    }

    /// The largest sines of speed and of torque.
    pub fn maps(&self) -> &[CapabilityMap] {
        &self.maps
    }

    /// The largest gradients.
    pub fn gradients(&self) -> &[GradientPlace] {
        &self.gradients
    }

    /// Limits that the bench file does not state, which the map does not count.
    pub fn unchecked(&self) -> &[LimitOf] {
        &self.unchecked
    }

    /// Answers to what is wanted.
    pub fn wanted(&self) -> &[WantedAnswer] {
        &self.wanted
    }

    /// Tells whether the bench can do all that is wanted. A yes that goes beyond the model is none, as for a test; one
    /// that leaves a limit out is one only if the caller `allows_unchecked` limits.
    pub fn is_yes(&self, allows_unchecked: bool) -> bool {
        let is_complete = self.beyond.is_empty() && (self.unchecked.is_empty() || allows_unchecked);
        self.wanted.is_empty() || is_complete && self.wanted.iter().all(WantedAnswer::is_yes)
    }

    /// The map as a page; [`KnownBench::on_page`] adds the bench.
    pub fn page(&self) -> Page {
        report::can::map(&MapPage {
            title: &format!("{}, mean torque {} Nm", self.bench, self.torque_nm),
            maps: &self.maps,
            in_table_hz: &FREQUENCIES_HZ,
            gradients: &self.gradients,
            wanted: &self.wanted,
            beyond: &self.beyond,
            friction: self.friction,
            pulses: &self.pulses,
        })
    }

    /// The map in numbers.
    pub fn facts(&self) -> CapabilityFacts<'_> {
        CapabilityFacts {
            bench: &self.bench,
            torque_nm: self.torque_nm,
            unchecked: &self.unchecked,
            beyond: self.beyond.iter().map(BeyondFacts::of).collect(),
            friction: self.friction,
            engine_pulses: PulsesFrom::of(&self.pulses),
            wanted: &self.wanted,
            maps: &self.maps,
            gradients: &self.gradients,
        }
    }
}

/// Frequencies of table and figure, growing, Hz.
fn frequencies_hz() -> Vec<f64> {
    let of_figure = (0..=3 * IN_A_DECADE).map(|k| 0.1 * 10_f64.powf(f64::from(k) / f64::from(IN_A_DECADE)));
    let mut all: Vec<f64> = of_figure.chain(FREQUENCIES_HZ).collect();
    all.sort_by(f64::total_cmp);
    all.dedup_by(|a, b| (*a - *b).abs() < 1e-9 * *a);
    all
}

/// Torques of the engine for gradients: the mean torque, none, and parts of the dynamometer's limit.
fn torques_nm(mean_nm: f64, limit_nm: Option<f64>) -> Vec<f64> {
    let parts = limit_nm.map_or(Vec::new(), |limit| vec![0.25 * limit, 0.5 * limit]);
    let mut torques: Vec<f64> = [0.0, mean_nm].into_iter().chain(parts).collect();
    torques.sort_by(f64::total_cmp);
    torques.dedup();
    torques
}
