//! The cause of a line among those that its phase allows, by what the other signals show.

use rig::Role;

use super::advice;
use super::cause::Cause;
use super::opposition::is_of_two_masses;
use super::reference::{MAINS_HZ, RIPPLE, Reference, folded_hz};
use super::resonance::{BroadPeak, is_one};
use super::search::Found;
use crate::lines::found::{DRIFT_HZ, OF_THE_MASSES, SENSORS};
use crate::lines::shown::Shown;

/// The masses on a shaft of a bench resonate below this, Hz.
const HIGHEST_STRUCTURAL_HZ: f64 = 60.0;
/// A sideband is at most this share of what swings.
const RIPPLED: f64 = 0.1;
/// A torque follows its demand: of what T_d* holds it has at most this many times as much; and where nothing else adds
/// to it, what its control lets through: what changes that by less than half is not counted as a cause.
const FOLLOWED: f64 = 1.5;
const ADDED: f64 = 0.5;
/// Images that the torque control makes less than this share of show its bandwidth.
const DAMPED: f64 = 0.95;
/// Lines of two signals this many bins apart are one.
const ONE_LINE: f64 = 2.0;
/// An order is separated from another by a signal in which it is this many times as strong.
const CLEARLY: f64 = 4.0;

/// Joint evidence of the signals of a part.
pub(super) struct Naming<'a> {
    all: &'a [Shown],
    /// The demand that the experimenter sets.
    demand: Role,
    /// Mean speed, Hz.
    turns_hz: f64,
    /// The mains that the bench hangs on, Hz; none where that does not show.
    mains_hz: Option<f64>,
    /// The broad peak that the masses show most, Hz, and whether it has the mode of two masses on a shaft.
    hump: Option<(f64, bool)>,
    /// The bandwidth of the torque control, Hz.
    bandwidth_hz: Option<f64>,
}

impl<'a> Naming<'a> {
    pub(super) fn new(
        all: &'a [Shown],
        demand: Role,
        turns_hz: f64,
        (inertias_kg_m2, is_of_firing): ([f64; 2], impl Fn(f64) -> bool),
    ) -> Self {
        let (mains_hz, hump) = (mains_hz(all), hump(all, inertias_kg_m2, is_of_firing));
        let mut naming = Naming { all, demand, turns_hz, mains_hz, hump, bandwidth_hz: None };
        naming.bandwidth_hz = naming.bandwidth_hz();
        naming
    }

    /// The one cause, or several that the recording does not part.
    pub(super) fn of_line(&self, found: &Found, one: &Shown) -> Cause {
        if found.frequency_hz < DRIFT_HZ && self.is_in_the_demand(found) {
            return Cause::Demanded;
        }
        let mut causes: Vec<Reference> = found.causes.clone();
        causes.dedup_by(|a, b| a.cause == b.cause);
        causes.retain(|r| self.is_plausible(&r.cause, found.amplitude, one));
        causes = match (self.named_by_the_torque(&causes, one), self.asked_for(found, one)) {
            (Some(named), _) => named,
            (None, Some(asked)) => self.with_asked(causes, &asked, found.amplitude),
            (None, None) => causes,
        };
        // A multiple of the mains that folds onto a lower one is the weaker of the two.
        let lowest = causes.iter().filter_map(multiple_of_mains).min();
        causes.retain(|r| multiple_of_mains(r).is_none_or(|multiple| Some(multiple) == lowest));
        if let Some(demanded) = causes.iter().position(|r| r.cause == Cause::Demanded) {
            // What a sine's own images add to it where they fold onto it is little.
            causes = vec![causes.swap_remove(demanded)];
        }
        if let Some(order) = self.named_by_a_faster_signal(&causes, one.role) {
            causes = vec![order];
        }
        match &causes[..] {
            [] if self.is_in_the_demand(found) => Cause::Demanded,
            [] => Cause::Unknown,
            [one] => one.cause.clone(),
            several => Cause::Undecided {
                between: several.iter().map(|r| r.cause.clone()).collect(),
                repeat_at_rpm: advice::repeat_at_rpm(several, self.turns_hz, 1.0 / one.signal.sample_time_s),
            },
        }
    }

    /// Tells whether a cause can make a line as strong as this.
    fn is_plausible(&self, cause: &Cause, amplitude: f64, one: &Shown) -> bool {
        let anywhere = |hz: f64| self.all.iter().any(|shown| shown.lines.strength_at(hz) > 0.0);
        let is_other_mains = |hz: f64| self.mains_hz.is_some_and(|known| known != hz);
        match *cause {
            // A ripple that is there makes little of a torque swing.
            Cause::RippleSideband { of_hz, ripple_hz } => {
                !is_other_mains(ripple_hz / RIPPLE)
                    && amplitude < RIPPLED * self.swing_at(of_hz, one)
                    && anywhere(ripple_hz)
            }
            // An image is weaker than what it is one of.
            Cause::HoldImage { of_hz, .. } => amplitude < one.lines.strength_at(of_hz),
            // Higher multiples come with the ripple of a rectifier.
            Cause::Mains { multiple, mains_hz } => {
                !is_other_mains(mains_hz) && (multiple <= 2 || anywhere(RIPPLE * mains_hz))
            }
            _ => true,
        }
    }

    /// How strongly the torque of the drive swings at a frequency, as far as a signal shows it: that of the shaft less
    /// than that of the air gap, where the drive's ripple is.
    fn swing_at(&self, frequency_hz: f64, one: &Shown) -> f64 {
        let is_it = |shown: &&Shown| Role::TORQUES.contains(&one.role) && shown.role == Role::AirGapTorque;
        let in_the_air_gap = self.all.iter().find(is_it).map_or(0.0, |shown| shown.lines.strength_at(frequency_hz));
        in_the_air_gap.max(one.lines.strength_at(frequency_hz))
    }

    /// Part of a torque's line that the demand of torque itself holds, where that is enough for it: its cause and
    /// amplitude.
    fn asked_for(&self, found: &Found, one: &Shown) -> Option<(Reference, f64)> {
        let is_torque = self.demand == Role::DynoTorqueDemand && Role::TORQUES.contains(&one.role);
        let demand = self.all.iter().find(|shown| is_torque && shown.role == self.demand)?;
        let rate_hz = 1.0 / one.signal.sample_time_s;
        let is_here = |line: &&Found| {
            let apart_hz = folded_hz(line.frequency_hz, rate_hz) - found.frequency_hz;
            apart_hz.abs() < ONE_LINE / one.signal.duration_s()
        };
        // The strongest line comes first.
        let line = demand.lines.found.iter().find(is_here)?;
        let of_a_sine = || Reference::fixed(Cause::Demanded, line.frequency_hz);
        let cause = line.causes.first().cloned().unwrap_or_else(of_a_sine);
        (FOLLOWED * line.amplitude > found.amplitude).then_some((cause, line.amplitude))
    }

    /// Of an image and a sideband of the ripple, those that the torque of the drive has, which moves all else.
    fn named_by_the_torque(&self, causes: &[Reference], one: &Shown) -> Option<Vec<Reference>> {
        let is_open = one.role != Role::AirGapTorque && causes.iter().any(is_sideband);
        let image = causes.iter().find(|r| is_open && is_image(r))?;
        let torque = self.all.iter().find(|shown| shown.role == Role::AirGapTorque)?;
        let line = torque.lines.found.iter().find(|line| line.causes.contains(image))?;
        let has = |cause: &Cause| match self.of_line(line, torque) {
            Cause::Undecided { between, .. } => between.contains(cause),
            one => one == *cause,
        };
        let named: Vec<Reference> = causes.iter().filter(|r| has(&r.cause)).cloned().collect();
        (!named.is_empty()).then_some(named)
    }

    /// Causes of a line of a torque, beside what the demand holds of it.
    fn with_asked(&self, causes: Vec<Reference>, (asked, held): &(Reference, f64), amplitude: f64) -> Vec<Reference> {
        let let_through = held * self.bandwidth_hz.map_or(1.0, |hz| gain(asked.law.frequency_hz / hz));
        let is_alone = match self.bandwidth_hz {
            Some(_) => (amplitude - let_through).abs() < ADDED * let_through,
            None => amplitude < let_through,
        };
        if is_alone || asked.cause == Cause::Demanded {
            return vec![asked.clone()];
        }
        let others = causes.into_iter().filter(|r| r.cause != asked.cause);
        std::iter::once(asked.clone()).chain(others).collect()
    }

    /// The bandwidth of the torque control, as that of a lag: by what it leaves of the images of which nothing else
    /// makes a part.
    fn bandwidth_hz(&self) -> Option<f64> {
        let of = |role: Role| self.all.iter().find(|shown| shown.role == role);
        let (demand, torque) = (of(Role::DynoTorqueDemand)?, of(Role::AirGapTorque)?);
        let of_line = |line: &Found| {
            let [image] = &line.causes[..] else { return None };
            let held = demand.lines.found.iter().find(|held| is_image(image) && held.causes.contains(image))?;
            let left = line.amplitude / held.amplitude;
            (left < DAMPED).then(|| image.law.frequency_hz.abs() / (left.powi(-2) - 1.0).sqrt())
        };
        let mut found: Vec<f64> = torque.lines.found.iter().filter_map(of_line).collect();
        found.sort_by(f64::total_cmp);
        found.get(found.len() / 2).copied()
    }

    /// Of orders that fold onto each other, the one that stands out where N_d, the fastest signal, shows them apart.
    fn named_by_a_faster_signal(&self, causes: &[Reference], role: Role) -> Option<Reference> {
        let faster = self.all.iter().find(|shown| shown.role == Role::DynoSpeed && shown.role != role)?;
        let is_shown_apart = |r: &Reference| {
            matches!(r.cause, Cause::Order { .. } | Cause::FoldedOrder { .. })
                && r.law.at_hz(self.turns_hz) < faster.signal.nyquist_hz()
        };
        if causes.len() < 2 || !causes.iter().all(is_shown_apart) {
            return None;
        }
        // T_shaft is to N_d as frequency, N_e above the resonance as its square.
        let power = match role {
            Role::EngineSpeed => 2,
            Role::SystemShaftTorque | Role::FlangeTorque => 1,
            _ => 0,
        };
        let strength = |r: &&Reference| {
            let hz = r.law.at_hz(self.turns_hz);
            let of_it = faster.lines.found.iter().filter(|line| line.causes.iter().any(|c| c.law.order == r.law.order));
            of_it.map(|line| line.amplitude * hz.powi(power)).fold(0.0, f64::max)
        };
        let mut ranked: Vec<&Reference> = causes.iter().collect();
        ranked.sort_by(|a, b| strength(b).total_cmp(&strength(a)));
        (strength(&ranked[0]) > CLEARLY * strength(&ranked[1])).then(|| ranked[0].clone())
    }

    /// Tells whether the demand holds a line that no sine in it explains, such as what rounding gives it.
    fn is_in_the_demand(&self, found: &Found) -> bool {
        let mut demands = self.all.iter().filter(|shown| shown.role == self.demand);
        demands.any(|shown| shown.lines.strength_at(found.frequency_hz) > 0.0)
    }

    /// The cause of a broad peak; none where it has no known one.
    pub(super) fn of_peak(&self, peak: &BroadPeak, one: &Shown) -> Option<Cause> {
        if OF_THE_MASSES.contains(&one.role) {
            let is_it = |hz: f64| is_one(peak, &BroadPeak { frequency_hz: hz, ..*peak });
            return self.hump.filter(|(hz, _)| is_it(*hz)).map(|(_, is_of_the_shaft)| match is_of_the_shaft {
                true => Cause::StructuralResonance,
                false => Cause::BroadHump,
            });
        }
        let is_strongest = one.broad.iter().all(|other| other.excess <= peak.excess);
        let is_sensor = |(sensor, other): &&(Role, Role)| {
            *sensor == one.role && self.all.iter().any(|s| s.role == *other) && !shows(self.all, *other, peak)
        };
        SENSORS.iter().find(is_sensor).filter(|_| is_strongest).map(|_| Cause::SensorResonance)
    }
}

/// Gain of a lag at a multiple of its bandwidth.
fn gain(multiple: f64) -> f64 {
    1.0 / (1.0 + multiple * multiple).sqrt()
}

/// Which multiple of the mains it is.
fn multiple_of_mains(reference: &Reference) -> Option<u32> {
    match reference.cause {
        Cause::Mains { multiple, .. } => Some(multiple),
        _ => None,
    }
}

fn is_image(reference: &Reference) -> bool {
    matches!(reference.cause, Cause::HoldImage { .. })
}

fn is_sideband(reference: &Reference) -> bool {
    matches!(reference.cause, Cause::RippleSideband { .. })
}

/// The mains, Hz: a bench hangs on one, and its ripple shows which where no order covers it. None where it does not
/// show.
fn mains_hz(all: &[Shown]) -> Option<f64> {
    let shown = |hz: f64| {
        let is_it = |r: &Reference| match r.cause {
            Cause::Mains { multiple, mains_hz } => mains_hz == hz && f64::from(multiple) == RIPPLE,
            _ => false,
        };
        // Orders and images may be as strong; a multiple that folds onto the ripple, or a sideband of the other's, is
        // not.
        let is_weak = |r: &Reference| is_sideband(r) || matches!(r.cause, Cause::Mains { .. });
        let is_covered = |line: &Found| !line.causes.iter().all(is_weak);
        let lines = all.iter().filter(|one| Role::TORQUES.contains(&one.role)).flat_map(|one| &one.lines.found);
        let sizes = lines.filter(|line| line.causes.iter().any(is_it) && !is_covered(line));
        sizes.map(|line| line.amplitude).fold(0.0, f64::max)
    };
    MAINS_HZ.into_iter().filter(|hz| shown(*hz) > 0.0).max_by(|a, b| shown(*a).total_cmp(&shown(*b)))
}

/// Of the peaks that several of the signals show which the masses move, the one that stands out most in all of them
/// together, and whether N_d and N_e have the mode of two masses there; one that has it comes before those that do not.
/// Two masses on a shaft have one resonance; of the two of a dual-mass flywheel this is the stronger.
fn hump(all: &[Shown], inertias_kg_m2: [f64; 2], is_of_firing: impl Fn(f64) -> bool) -> Option<(f64, bool)> {
    let of_masses = || all.iter().filter(|shown| OF_THE_MASSES.contains(&shown.role));
    let excess = |peak: &BroadPeak| {
        let in_one = |shown: &Shown| {
            shown.broad.iter().filter(|other| is_one(other, peak)).map(|other| other.excess).fold(0.0, f64::max)
        };
        let seen: Vec<f64> = of_masses().map(in_one).filter(|excess| *excess > 0.0).collect();
        (seen.len() > 1).then(|| seen.iter().map(|excess| excess.ln()).sum::<f64>())
    };
    let is_possible = |peak: &&BroadPeak| peak.frequency_hz < HIGHEST_STRUCTURAL_HZ && !is_of_firing(peak.frequency_hz);
    let ranked = of_masses().flat_map(|shown| &shown.broad).filter(is_possible);
    let mut ranked: Vec<(f64, f64)> = ranked.filter_map(|peak| Some((peak.frequency_hz, excess(peak)?))).collect();
    ranked.sort_by(|a, b| b.1.total_cmp(&a.1));
    let left = |role: Role| all.iter().find(|shown| shown.role == role).map(|shown| &shown.lines.left);
    let is_of_the_shaft = |hz: f64| {
        let speeds = left(Role::DynoSpeed).zip(left(Role::EngineSpeed));
        speeds.is_some_and(|(dynamometer, engine)| is_of_two_masses(dynamometer, engine, inertias_kg_m2, hz))
    };
    let resonance = ranked.iter().find(|(hz, _)| is_of_the_shaft(*hz)).map(|(hz, _)| (*hz, true));
    resonance.or_else(|| ranked.first().map(|(hz, _)| (*hz, false)))
}

/// Tells whether a signal shows a broad peak.
fn shows(all: &[Shown], role: Role, peak: &BroadPeak) -> bool {
    all.iter().filter(|shown| shown.role == role).flat_map(|shown| &shown.broad).any(|other| is_one(other, peak))
}
