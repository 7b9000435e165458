//! Black boxes of all orders on one recording.
//!
//! Output-error models with as many coefficients in B as in F are searched for from the data alone. All others start at
//! those of one coefficient less, and at the poles of the former, which takes a fraction of the time. The best are then
//! searched for from the data alone as well: what may be chosen is the lower of two minima.

use std::collections::{BTreeMap, HashMap, HashSet};

use numerics::parallel;
use work::Context;

use super::black_box::{Family, Scanned, Structure};
use super::orders::{Input, OrdersTried};
use super::record::Record;

/// Structures tried between two reports of progress.
const BATCH: usize = 16;
/// So many output-error models of each input are searched for once more: of the best by fit and of the best by
/// criterion.
const BEST: usize = 2;

/// Every structure that the data determine; each is a part of a step of the work.
pub(super) fn scan(record: &Record, orders: OrdersTried, context: &Context) -> Vec<Scanned> {
    let families = [Family::Arx, Family::OutputError];
    let pairs = families.into_iter().flat_map(|family| [Input::Demand, Input::Error].map(|input| (family, input)));
    let all: Vec<Structure> = pairs.flat_map(|(family, input)| Structure::all(family, input, orders)).collect();
    let mut scan = Scan { record, known: HashMap::new() };
    let step = context.step(format!("trying orders on {}", record.file), all.len() as u64);
    let mut advance = |structures: usize| step.advance(structures as u64);
    for stage in stages(&all).into_values() {
        scan.search(&stage, Scan::starts, &mut advance);
    }
    scan.search(&scan.best(), |_, _| Vec::new(), &mut advance);
    all.iter().filter_map(|structure| Some(scan.known.remove(structure)?.0)).collect()
}

/// Structures in an order in which each comes after those that it starts at.
fn stages(all: &[Structure]) -> BTreeMap<usize, Vec<Structure>> {
    let mut stages: BTreeMap<usize, Vec<Structure>> = BTreeMap::new();
    for structure in all {
        let stage = if starts_at_the_data(*structure) { 0 } else { structure.poles + structure.nb };
        stages.entry(stage).or_default().push(*structure);
    }
    stages
}

fn starts_at_the_data(structure: Structure) -> bool {
    structure.family == Family::Arx || structure.poles == structure.nb
}

/// Knowledge of the structures of one recording.
struct Scan<'a> {
    record: &'a Record,
    /// The worth of each, and its coefficients.
    known: HashMap<Structure, (Scanned, Vec<f64>)>,
}

impl Scan<'_> {
    /// Searches for these structures from their starts, and keeps what is better than what is known.
    fn search(
        &mut self,
        structures: &[Structure],
        starts: impl Fn(&Self, Structure) -> Vec<Vec<f64>> + Sync,
        advance: &mut dyn FnMut(usize),
    ) {
        for part in structures.chunks(BATCH) {
            let this = &*self;
            let tried = parallel::map(part, |structure| structure.scan(this.record, starts(this, *structure)));
            for (structure, one) in part.iter().zip(tried) {
                let Some(one) = one else { continue };
                if self.known.get(structure).is_none_or(|(before, _)| one.0.bic < before.bic) {
                    self.known.insert(*structure, one);
                }
            }
            advance(part.len());
        }
    }

    /// Coefficients of B and F of the structures beside this one, as many of each as this one has.
    fn starts(&self, of: Structure) -> Vec<Vec<f64>> {
        if starts_at_the_data(of) {
            return Vec::new();
        }
        let beside = [(of.poles, of.nb - 1), (of.poles - 1, of.nb), (of.poles, of.poles)];
        let start = |(poles, nb): (usize, usize)| {
            let (_, coefficients) = self.known.get(&Structure { poles, nb, ..of })?;
            let (b, f) = coefficients.split_at_checked(nb)?;
            let (mut b, mut f) = (b.to_vec(), f.to_vec());
            b.resize(of.nb, 0.0);
            f.resize(of.poles, 0.0);
            Some([b, f].concat())
        };
        beside.into_iter().filter_map(start).collect()
    }

    /// Output-error models that are among the best of their input, without those that were searched for from the data.
    fn best(&self) -> Vec<Structure> {
        let mut best = Vec::new();
        for input in [Input::Demand, Input::Error] {
            let is_own = |s: &Structure| s.family == Family::OutputError && s.input == input && !starts_at_the_data(*s);
            let own = || self.known.values().map(|(scanned, _)| scanned).filter(|scanned| is_own(&scanned.structure));
            let by_fit = own().filter_map(|scanned| Some((-scanned.fit_percent?, scanned.structure)));
            let by_bic = own().map(|scanned| (scanned.bic, scanned.structure));
            best.extend(least(by_fit.collect()).chain(least(by_bic.collect())));
        }
        let mut known = HashSet::new();
        best.retain(|structure| known.insert(*structure));
        best
    }
}

/// The first few by their number, the least first.
fn least(mut ranked: Vec<(f64, Structure)>) -> impl Iterator<Item = Structure> {
    let place = |s: Structure| (s.poles, s.nb, s.nk);
    ranked.sort_by(|(a, s), (b, t)| a.total_cmp(b).then(place(*s).cmp(&place(*t))));
    ranked.into_iter().map(|(_, structure)| structure).take(BEST)
}
