//! Dead times beside dynamics, what other methods say, and what to make of it where they disagree.

mod excerpt;
mod facts;
mod level;
mod modelled;
mod others;

use dataset::Adjustment;
use ident::delay::ModelledDelay;
use ident::{Dataset, Experiment, IdentError};
use page::decimal::significant;
use page::{Align, Block, Page, Table, Tone};
use work::Context;

use crate::blocks::{finding, line};
use crate::level::LEVEL;
use level::DATED;
use modelled::Modelled;
use others::Others;

pub use facts::{ArxDelayFacts, Attempt, CandidateFacts, ClaimFacts, DelayEstimateFacts, DelayFacts, DelayModelFacts};

/// More data are read for intervals that could become shorter by this part.
const WORTHWHILE: f64 = 0.2;

/// Facts known about data before their delays are looked for.
#[derive(Debug, Clone, Copy)]
pub struct Known<'a> {
    /// Adjustments that brought the channels onto their clock.
    pub adjustments: &'a [Adjustment],
    /// The samples from one known output to the next, as the whole recordings have them; see [`spacing`].
    pub spacing: Option<usize>,
    /// True if that clock was asked for.
    pub clock_is_given: bool,
    /// True if it was stated how the inputs behave between their samples.
    pub between_is_given: bool,
}

/// The delays of data by all methods.
pub struct Delays {
    data: Dataset,
    clock_is_given: bool,
    others: Others,
    modelled: Modelled,
    /// Samples there are, and by what part they could shorten the intervals of dead times, where the delays are those
    /// of a part.
    part_of: Option<(usize, f64)>,
}

impl Delays {
    /// Delays of up to `longest` samples; Comparison and models are steps of the work. Those of long data come from the
    /// part in which the inputs vary most, unless it leaves one open or more data would sharpen it.
    ///
    /// # Errors
    /// Where the data are too short.
    pub fn of(data: Dataset, known: &Known<'_>, longest: usize, context: &Context) -> Result<Self, IdentError> {
        let dating = dating(known.adjustments, data.sample_time_s());
        for samples in excerpt::PARTS {
            if let Some(part) = excerpt::liveliest(&data, samples)?
                && let Ok(found) = Self::of_all(part, known, longest, context)
                && let Some(gain) = found.modelled.could_shrink_by(dating).filter(|gain| *gain < WORTHWHILE)
            {
                return Ok(Delays { part_of: Some((data.samples(), gain)), ..found });
            }
        }
        Self::of_all(data, known, longest, context)
    }

    fn of_all(data: Dataset, known: &Known<'_>, longest: usize, context: &Context) -> Result<Self, IdentError> {
        let comparing = context.step("comparing delays", 0);
        let others = Others::of(&data, known.spacing, longest)?;
        drop(comparing);
        let _step = context.step("fitting models with a delay", 0);
        let dating = dating(known.adjustments, data.sample_time_s());
        let options = ModelledDelay { longest, dating, level: LEVEL };
        let modelled = Modelled::of(&options, (&data, known.adjustments), &others, known.between_is_given);
        Ok(Delays { data, clock_is_given: known.clock_is_given, others, modelled, part_of: None })
    }

    /// Page of the result of each method, of the delays that are claimed, and of the doubts.
    pub fn page(&self) -> Page {
        let data = &self.data;
        let columns =
            [("method", Align::Left), ("samples", Align::Right), ("seconds", Align::Right), ("", Align::Left)];
        let mut table = Table::new(&columns);
        self.modelled.rows(data, &mut table);
        self.others.rows(data, &mut table);
        let mut all = vec![line(self.clock()), Block::Table(table)];
        all.extend(self.modelled.claims(data));
        all.extend(self.notes().iter().map(|note| finding(Tone::Plain, "note", note)));
        all.extend(self.doubts().iter().map(|doubt| finding(Tone::Caution, "doubt", doubt)));
        let figures = self.others.figures(data, |input| self.modelled.interval(input));
        all.extend(figures.into_iter().map(Block::figure));
        Page::new("Delay", all)
    }

    /// The same in numbers.
    pub fn facts(&self) -> DelayFacts {
        DelayFacts {
            sample_time_s: self.data.sample_time_s(),
            clock: self.clock(),
            delay: self.modelled.claim_facts(&self.data),
            models: self.modelled.facts(&self.data),
            arx: self.others.arx_facts(),
            impulse_response: self.others.impulse_response_facts(),
            phase: self.others.phase_facts(),
            arx_fraction: self.others.fraction_facts(),
            notes: self.notes(),
            doubts: self.doubts(),
        }
    }

    fn notes(&self) -> Vec<String> {
        let part = self.part_of.map(|(all, gain)| {
            let (part, percent) = (self.data.samples(), (100.0 * gain).ceil());
            format!(
                "found from the {part} of {all} samples in which the inputs vary most; with all of them no interval of a dead time would \
                 be more than {percent} % shorter"
            )
        });
        part.into_iter().chain(self.modelled.notes()).collect()
    }

    fn doubts(&self) -> Vec<String> {
        self.others.doubts(&self.data, |input| self.modelled.is_claimed(input))
    }

    /// Which clock was taken, and why.
    fn clock(&self) -> String {
        let every = significant(self.data.sample_time_s());
        match self.clock_is_given {
            true => format!("on the clock of {every} s that --sample-time gives"),
            false => format!("on the clock of the fastest channel, {every} s, so that nothing is filtered"),
        }
    }
}

/// The samples from one known output to the next, gaps left aside; `None` where they are not always as many.
pub fn spacing(data: &Dataset) -> Option<usize> {
    let known = |e: &Experiment| {
        let y = e.output(0).iter().enumerate();
        y.filter(|(_, v)| !v.is_nan()).map(|(i, _)| i).collect::<Vec<usize>>()
    };
    let all: Vec<Vec<usize>> = data.experiments().iter().map(known).collect();
    let steps = || all.iter().flat_map(|known| known.windows(2).map(|w| w[1] - w[0]));
    let least = steps().min()?;
    steps().all(|step| step % least == 0).then_some(least)
}

/// Standard uncertainty of instants, in samples: that of a stamp, uniform, and how far stamps lie off the clock.
fn dating(adjustments: &[Adjustment], sample_time_s: f64) -> f64 {
    let jitter_s = adjustments.iter().filter_map(|adjustment| match adjustment {
        Adjustment::Jitter { largest_s, .. } => Some(*largest_s),
        _ => None,
    });
    let jitter = jitter_s.fold(0.0, f64::max) / sample_time_s;
    ((DATED * DATED + jitter * jitter) / 3.0).sqrt()
}
