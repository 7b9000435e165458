//! How often a band holds what happens, and how often a yes is wrong.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

/// One number of one run beside what was said of it.
pub(crate) struct Row {
    /// Which statistic of which test.
    pub(crate) of: (String, &'static str),
    /// The stated band of 90 %, its median, and what happened.
    pub(crate) band: (f64, f64),
    pub(crate) median: f64,
    pub(crate) happened: f64,
    /// Where a limit was said to be kept with 97 % or more: whether it was not.
    pub(crate) broken: Option<bool>,
}

impl Row {
    /// Tells whether the band holds the true value. A certain value is a band without width: rounding must not count.
    pub(crate) fn is_inside(&self) -> bool {
        let rounding = 1e-9 * self.happened.abs();
        (self.band.0 - rounding..=self.band.1 + rounding).contains(&self.happened)
    }
}

/// A yes of 97 % or more to a whole test, and whether a limit was reached all the same.
pub(crate) struct Yes {
    pub(crate) by: &'static str,
    pub(crate) test: &'static str,
    pub(crate) is_wrong: bool,
}

#[derive(Default)]
pub(crate) struct Tally {
    pub(crate) runs: usize,
    below: usize,
    above: usize,
    ratios: Vec<f64>,
    pub(crate) yes: usize,
    pub(crate) wrong: usize,
}

impl Tally {
    fn add(&mut self, row: &Row) {
        self.runs += 1;
        self.below += usize::from(!row.is_inside() && row.happened < row.band.0);
        self.above += usize::from(!row.is_inside() && row.happened > row.band.1);
        self.ratios.push(row.happened / row.median);
        self.yes += usize::from(row.broken.is_some());
        self.wrong += usize::from(row.broken == Some(true));
    }

    pub(crate) fn inside(&self) -> f64 {
        1.0 - (self.below + self.above) as f64 / self.runs.max(1) as f64
    }

    fn print(&mut self, name: &str) {
        self.ratios.sort_by(f64::total_cmp);
        let ratio = |part: f64| self.ratios[((self.ratios.len() - 1) as f64 * part) as usize];
        let percent = |count: usize| 100.0 * count as f64 / self.runs as f64;
        println!(
            "{name:<38} {:5} runs, inside {:5.1} %, below {:5.1} %, above {:5.1} %; over the median {:.3} {:.3} {:.3}; \
             yes {:4}, wrong {:4}",
            self.runs,
            100.0 * self.inside(),
            percent(self.below),
            percent(self.above),
            ratio(0.05),
            ratio(0.5),
            ratio(0.95),
            self.yes,
            self.wrong
        );
    }
}

/// Share of what happens that a band of 90 % should hold, and the least of any statistic.
pub(crate) const GOAL: RangeInclusive<f64> = 0.87..=0.93;
pub(crate) const LEAST: f64 = 0.8;

/// Prints the tables and what misses the goal; returns the tallies by statistic, over all tests.
pub(crate) fn tallies(rows: &[Row], answers: &[Yes]) -> BTreeMap<String, Tally> {
    let mut by_statistic: BTreeMap<String, Tally> = BTreeMap::new();
    let mut by_test: BTreeMap<String, Tally> = BTreeMap::new();
    for row in rows {
        by_statistic.entry(row.of.0.clone()).or_default().add(row);
        by_test.entry(format!("{}, {}", row.of.0, row.of.1)).or_default().add(row);
    }
    println!(
        "Bands of 90 %; 5, 50 and 95 % of what happened over the predicted median; limits said to be kept with 97 % or more:"
    );
    by_test.iter_mut().for_each(|(name, tally)| tally.print(name));
    println!();
    by_statistic.iter_mut().for_each(|(name, tally)| tally.print(name));
    let those = |is_so: fn(f64) -> bool| {
        let names = by_statistic.iter().filter(|(_, tally)| is_so(tally.inside())).map(|(name, _)| name.as_str());
        names.collect::<Vec<_>>().join(", ")
    };
    println!("\nless than {} % inside: {}", 100.0 * LEAST, those(|inside| inside < LEAST));
    println!("within {} … {} %: {}", 100.0 * GOAL.start(), 100.0 * GOAL.end(), those(|inside| GOAL.contains(&inside)));
    let sum = |of: fn(&Tally) -> usize| by_statistic.values().map(of).sum::<usize>();
    println!(
        "single limits said to be kept: {}, of these reached: {}\n",
        sum(|tally| tally.yes),
        sum(|tally| tally.wrong)
    );
    let mut verdicts: BTreeMap<(&str, &str), (usize, usize)> = BTreeMap::new();
    for yes in answers {
        let count = verdicts.entry((yes.by, yes.test)).or_default();
        count.0 += 1;
        count.1 += usize::from(yes.is_wrong);
    }
    for ((by, test), (yes, wrong)) in verdicts {
        println!("{by}, {test}: yes of 97 % or more on {yes} runs, a limit reached in {wrong}");
    }
    by_statistic
}
