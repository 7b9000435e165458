//! Phases that a line of each cause would follow.

use std::f64::consts::TAU;

use rig::facts::Engine;

use super::angle::Angle;
use super::cause::Cause;

/// Orders are looked for up to this multiple of the firing order; up to the second, they modulate and are modulated.
const HIGHEST_FIRING: f64 = 6.0;
const STRONG_FIRING: f64 = 2.0;
/// Without an engine, what an encoder repeats with each turn is looked for up to multiples as of this firing order.
const WITHOUT_ENGINE: f64 = 2.0;
/// Frequencies of mains, Hz, and how many multiples of them are looked for.
pub(super) const MAINS_HZ: [f64; 2] = [50.0, 60.0];
const MAINS_MULTIPLES: u32 = 6;
/// The drive's ripple is this multiple of the mains.
pub(super) const RIPPLE: f64 = 2.0;
/// The mains, and what hangs on them, stray by this share.
const STRAY: f64 = 3e-3;

/// A phase to compare a signal with.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reference {
    pub(super) cause: Cause,
    pub(super) law: PhaseLaw,
}

/// How a phase runs: so many times the crank angle, and at a frequency beside.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct PhaseLaw {
    pub(super) order: f64,
    /// Hz.
    pub(super) frequency_hz: f64,
    /// How well that is known before the data show it, Hz.
    pub(super) tolerance_hz: f64,
}

impl PhaseLaw {
    /// The phase at an instant, rad.
    pub(super) fn phase(&self, angle: &Angle<'_>, time_s: f64) -> f64 {
        self.order * angle.at(time_s) + TAU * self.frequency_hz * time_s
    }

    /// The frequency at a speed, Hz.
    pub(super) fn at_hz(&self, turns_hz: f64) -> f64 {
        (self.order * turns_hz + self.frequency_hz).abs()
    }
}

impl Reference {
    fn order(cause: Cause, order: f64) -> Self {
        Reference { cause, law: PhaseLaw { order, frequency_hz: 0.0, tolerance_hz: 0.0 } }
    }

    pub(super) fn fixed(cause: Cause, frequency_hz: f64) -> Self {
        Reference { cause, law: PhaseLaw { order: 0.0, frequency_hz, tolerance_hz: 0.0 } }
    }
}

/// Where a frequency shows at a sample rate, Hz.
#[must_use]
pub fn folded_hz(frequency_hz: f64, rate_hz: f64) -> f64 {
    let rest = frequency_hz.rem_euclid(rate_hz);
    rest.min(rate_hz - rest)
}

/// Conditions on which the references of a signal depend.
#[derive(Debug, Clone, Copy)]
pub(super) struct Setting<'a> {
    /// None without the shaft.
    pub(super) engine: Option<Engine>,
    /// Speed of the engine, Hz.
    pub(super) turns_hz: f64,
    /// Demanded sines, Hz.
    pub(super) sines_hz: &'a [f64],
    /// How often the demand changes, Hz.
    pub(super) held_hz: Option<f64>,
    /// True where a demand answers to the engine's speed, as in the mode in which the engine controls it.
    pub(super) demand_answers: bool,
    /// The highest frequency that any signal shows, Hz.
    pub(super) highest_hz: f64,
}

impl Setting<'_> {
    /// All that a signal with a sample rate is compared with.
    pub(super) fn references(&self, rate_hz: f64) -> Vec<Reference> {
        let sines = self.sines_hz.iter().flat_map(|hz| self.of_sine(*hz));
        self.orders(rate_hz).chain(mains()).chain(self.of_orders()).chain(sines).collect()
    }

    /// References of a demand that the experimenter sets: nothing of the engine or the drive.
    pub(super) fn demanded(&self) -> Vec<Reference> {
        let is_demanded = |r: &Reference| matches!(r.cause, Cause::Demanded | Cause::HoldImage { .. });
        self.sines_hz.iter().flat_map(|hz| self.of_sine(*hz)).filter(is_demanded).collect()
    }

    /// Orders, those above half the sample rate where they fold to.
    fn orders(&self, rate_hz: f64) -> impl Iterator<Item = Reference> {
        let turns_hz = self.turns_hz;
        self.multiples(HIGHEST_FIRING).map(move |(order, is_firing)| {
            let from_hz = order * turns_hz;
            let cause = match from_hz > 0.5 * rate_hz {
                true => Cause::FoldedOrder { order, from_hz },
                false => Cause::Order { order, is_firing },
            };
            Reference::order(cause, order)
        })
    }

    /// Multiples of half the speed, as a working cycle has them, up to a multiple of the firing; and whether they are
    /// one of it. Without an engine, whole multiples.
    fn multiples(&self, highest: f64) -> impl Iterator<Item = (f64, bool)> {
        let firing = self.engine.map(Engine::firings_per_turn);
        let step = self.engine.map_or(1.0, |engine| 2.0 / f64::from(engine.strokes));
        let count = (highest * firing.unwrap_or(WITHOUT_ENGINE) / step).round() as usize;
        let is_firing = move |order: f64| firing.is_some_and(|firing| (order / firing).fract() == 0.0);
        (1..=count).map(move |k| (step * k as f64, is_firing(step * k as f64)))
    }

    /// Sidebands that a ripple gives a torque that swings with the engine, and images of the orders to which a demand
    /// answers.
    fn of_orders(&self) -> Vec<Reference> {
        let mut all = Vec::new();
        for (order, _) in self.multiples(STRONG_FIRING) {
            let of_hz = order * self.turns_hz;
            for mains_hz in MAINS_HZ {
                let ripple_hz = RIPPLE * mains_hz;
                let law = PhaseLaw { order, frequency_hz: ripple_hz, tolerance_hz: STRAY * ripple_hz };
                all.extend(both_sides(Cause::RippleSideband { of_hz, ripple_hz }, law));
            }
            if let Some(held_hz) = self.held_hz.filter(|_| self.demand_answers) {
                for frequency_hz in [held_hz, 2.0 * held_hz] {
                    let law = PhaseLaw { order, frequency_hz, tolerance_hz: 0.0 };
                    all.extend(both_sides(Cause::HoldImage { of_hz, held_hz }, law));
                }
            }
        }
        all
    }

    /// A demanded sine, its images by the hold, its sidebands of a ripple, and of the orders that it modulates.
    fn of_sine(&self, demanded_hz: f64) -> Vec<Reference> {
        let sides = move |centre_hz: f64| [centre_hz - demanded_hz, centre_hz + demanded_hz];
        let mut all = vec![Reference::fixed(Cause::Demanded, demanded_hz)];
        if let Some(held_hz) = self.held_hz {
            let multiples = (1..).map(|m| f64::from(m) * held_hz);
            let seen = multiples.take_while(|hz| hz - demanded_hz < self.highest_hz);
            let image = |hz| Reference::fixed(Cause::HoldImage { of_hz: demanded_hz, held_hz }, hz);
            all.extend(seen.flat_map(sides).map(image));
        }
        for ripple_hz in MAINS_HZ.map(|mains_hz| RIPPLE * mains_hz) {
            all.extend(sides(ripple_hz).map(|frequency_hz| Reference {
                cause: Cause::RippleSideband { of_hz: demanded_hz, ripple_hz },
                law: PhaseLaw { order: 0.0, frequency_hz, tolerance_hz: STRAY * ripple_hz },
            }));
        }
        for (order, _) in self.multiples(STRONG_FIRING).filter(|(_, is_firing)| *is_firing) {
            all.extend([-demanded_hz, demanded_hz].map(|frequency_hz| Reference {
                cause: Cause::OrderSideband { order, demanded_hz },
                law: PhaseLaw { order, frequency_hz, tolerance_hz: 0.0 },
            }));
        }
        all
    }
}

/// A law and the one on the other side of its frequency.
fn both_sides(cause: Cause, law: PhaseLaw) -> [Reference; 2] {
    [law.order, -law.order].map(|order| Reference { cause: cause.clone(), law: PhaseLaw { order, ..law } })
}

/// The mains and their multiples.
fn mains() -> impl Iterator<Item = Reference> {
    MAINS_HZ.into_iter().flat_map(|mains_hz| {
        (1..=MAINS_MULTIPLES).map(move |multiple| {
            let frequency_hz = f64::from(multiple) * mains_hz;
            let law = PhaseLaw { order: 0.0, frequency_hz, tolerance_hz: STRAY * frequency_hz };
            Reference { cause: Cause::Mains { multiple, mains_hz }, law }
        })
    })
}
