//! The largest values of a cycle with firing pulses.
//!
//! Largest additions of pulses, as if every speed were held and every firing were a strong one, show where the largest
//! values can be. There the bench is simulated firing by firing, the most promising stretch first, until no other can
//! have a larger value.

use design::safety::AtResonance;

use crate::added::Added;
use crate::cycle_run::CycleGrid;
use crate::error::CapabilityError;
use crate::extremes::{Drive, LimitOf, Peak, peaks};
use crate::outcome::Drawn;
use crate::trace::Trace;

/// Length of a stretch, s.
const STRETCH_S: f64 = 6.0;
/// Stretches that are simulated at the most, for the time that they take. Stretches beyond have bounds below all of
/// these.
const MOST: usize = 12;

/// A stretch of a cycle.
struct Stretch {
    from: usize,
    to: usize,
    /// Upper bounds of all values.
    bounds: [Peak; LimitOf::COUNT],
    is_simulated: bool,
}

/// The bench in a cycle: its run without pulses, and what they add to each value at the most.
pub(crate) struct Firing<'a> {
    pub(crate) grid: &'a CycleGrid,
    pub(crate) bench: &'a Drawn,
    pub(crate) trace: &'a Trace,
    pub(crate) added: &'a [Added],
    pub(crate) near: &'a AtResonance<'a>,
    pub(crate) drive: &'a Drive,
}

impl Firing<'_> {
    /// Upper bounds of the largest values.
    pub(crate) fn bounds(&self) -> [Peak; LimitOf::COUNT] {
        peaks(self.trace, self.added, self.near, self.drive)
    }

    /// The largest values. Heat and stay at the resonance are of all the cycle, and hardly depend on the pulses' phase:
    /// theirs are the bounds.
    pub(crate) fn peaks(&self) -> Result<[Peak; LimitOf::COUNT], CapabilityError> {
        let (bounds, mut most) = (self.bounds(), peaks(self.trace, &[], self.near, self.drive));
        let is_of_all = |of: LimitOf| matches!(of, LimitOf::TimeAtResonance | LimitOf::DriveHeat);
        for of in LimitOf::ALL.into_iter().filter(|of| is_of_all(*of)) {
            most[of as usize] = bounds[of as usize];
        }
        let mut stretches = self.stretches();
        for _ in 0..MOST {
            let promise = |stretch: &Stretch| {
                let parts = stretch.bounds.iter().zip(&most).map(|(bound, most)| bound.value / most.value);
                parts.filter(|part| part.is_finite()).fold(0.0, f64::max)
            };
            let left = stretches.iter_mut().filter(|stretch| !stretch.is_simulated);
            let Some(next) = left.max_by(|a, b| promise(a).total_cmp(&promise(b))).filter(|next| promise(next) > 1.0)
            else {
                break;
            };
            next.is_simulated = true;
            let fired = self.grid.fired(self.bench, next.from, next.to)?;
            let found = peaks(&fired, &[], self.near, self.drive);
            for of in LimitOf::ALL.into_iter().filter(|of| !is_of_all(*of)) {
                let place = of as usize;
                most[place] = if found[place].value > most[place].value { found[place] } else { most[place] };
            }
        }
        Ok(most)
    }

    fn stretches(&self) -> Vec<Stretch> {
        let (count, length) = (self.added.len(), ((STRETCH_S / self.trace.step_s) as usize).max(1));
        let stretch = |from: usize| {
            let to = (from + length).min(count - 1);
            let bounds = peaks(&self.trace.part(from, to), &self.added[from..=to], self.near, self.drive);
            Stretch { from, to, bounds, is_simulated: false }
        };
        (0..count.saturating_sub(1)).step_by(length).map(stretch).collect()
    }
}
