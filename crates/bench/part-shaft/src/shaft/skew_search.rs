//! Where the search for the shaft starts: the skews beside which K and B leave least.
//!
//! A skew of half a period of what moves the bench fits nearly as well as none, with another K and B, so that a descent
//! from no skew at all may end at the wrong one. For given skews the equation is linear in K and B, which makes a grid
//! of skews cheap.

use std::ops::RangeInclusive;

use signal::Complex64;

use super::inputs::LARGEST_SKEW_S;
use super::places::{DYNO, ENGINE, TORQUE};
use super::spectra::Spectra;

/// Step of the grid, s: less than a quarter of the period at the highest frequency.
const STEP_S: f64 = 2e-3;
/// Finest step beside a minimum of the grid, s.
const FINEST_S: f64 = 1e-4;
/// Bins that are looked at.
const MOST_BINS: usize = 250;
/// Minima of the grid that are refined.
const REFINED: usize = 4;
/// |error|²/σ² of a bin that counts half: beyond it lies what the model does not know, such as a line of a sensor.
const HALF: f64 = 20.0;
/// Rounds of the least squares in which such bins lose their weight.
const ROUNDS: usize = 3;
/// A start that leaves this many times what the best leaves is no rival of it.
const RIVAL: f64 = 2.0;

/// Skews with the K and B that fit them best.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Start {
    pub(super) stiffness: f64,
    pub(super) damping: f64,
    pub(super) engine_skew_s: f64,
    pub(super) torque_skew_s: f64,
    cost: f64,
}

/// Knowledge beside skews, K and B.
#[derive(Debug, Clone)]
pub(super) struct Known {
    /// J_d, kg m²; zero behind a flange.
    pub(super) inertia_kg_m2: f64,
    /// Gate of the encoders, s.
    pub(super) gate_s: f64,
    /// About K, Nm/rad, to weigh the frequencies with.
    pub(super) stiffness: f64,
    /// Where the encoders' once-a-turn errors are, Hz: the search leaves this out.
    pub(super) turns_hz: RangeInclusive<f64>,
}

/// The starts to refine, the best first: at least one.
pub(super) fn starts(spectra: &Spectra, known: &Known) -> Vec<Start> {
    let bins = Bins::of(spectra, known);
    let half = (LARGEST_SKEW_S / STEP_S) as i32;
    let at = |i: i32, j: i32| bins.start(f64::from(i) * STEP_S, f64::from(j) * STEP_S);
    let side = (2 * half + 1) as usize;
    let grid: Vec<Start> =
        (-half..=half).flat_map(|i| (-half..=half).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect();
    let beside = |k: usize| {
        let (row, column) = (k / side, k % side);
        let rows = row.saturating_sub(1)..=(row + 1).min(side - 1);
        rows.flat_map(move |r| (column.saturating_sub(1)..=(column + 1).min(side - 1)).map(move |c| r * side + c))
    };
    let is_lowest = |k: &usize| beside(*k).all(|other| grid[other].cost >= grid[*k].cost);
    let mut minima: Vec<Start> = (0..grid.len()).filter(is_lowest).map(|k| grid[k]).collect();
    minima.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    minima.truncate(REFINED);
    let mut refined: Vec<Start> = minima.into_iter().map(|start| bins.refined(start)).collect();
    refined.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let least = refined.first().map_or(0.0, |start| start.cost);
    refined.retain(|start| start.cost <= RIVAL * least);
    refined
}

/// Some bins, with what the equation needs of them, weighted.
struct Bins(Vec<Bin>);

struct Bin {
    s: Complex64,
    /// J_d L_2{ω_d}.
    acceleration: Complex64,
    /// L_1 of the torque, gate and dating undone.
    torque: Complex64,
    /// L_0 and L_1 of ω_d.
    dyno: [Complex64; 2],
    /// L_0 and L_1 of ω_e, dating undone.
    engine: [Complex64; 2],
}

impl Bins {
    fn of(spectra: &Spectra, known: &Known) -> Self {
        let is_clean = |k: &&usize| !known.turns_hz.contains(&spectra.window.frequency_hz(**k));
        let clean: Vec<usize> = spectra.bins.iter().filter(is_clean).copied().collect();
        let stride = clean.len().div_ceil(MOST_BINS).max(1);
        Bins(clean.iter().step_by(stride).map(|k| Bin::of(spectra, *k, known)).collect())
    }

    /// K and B beside these skews.
    fn start(&self, engine_skew_s: f64, torque_skew_s: f64) -> Start {
        let turned = |bin: &Bin| -> (Complex64, [Complex64; 2]) {
            let later = Complex64::cis(bin.s.im * engine_skew_s);
            let rate = bin.acceleration + bin.torque * Complex64::cis(bin.s.im * torque_skew_s);
            (rate, std::array::from_fn(|n| later * bin.engine[n] - bin.dyno[n]))
        };
        let turned: Vec<(Complex64, [Complex64; 2])> = self.0.iter().map(turned).collect();
        let left = |(rate, twist): &(Complex64, [Complex64; 2]), [k, b]: [f64; 2]| {
            (rate - k * twist[0] - b * twist[1]).norm_sqr()
        };
        let mut shaft = None;
        for _ in 0..ROUNDS {
            work::checkpoint();
            let mut sums = Sums::default();
            for bin in &turned {
                // Geman and McClure's weight.
                let weight = shaft.map_or(1.0, |shaft| (1.0 + left(bin, shaft) / HALF).powi(-2));
                sums.add(weight, bin.0, bin.1);
            }
            shaft = Some(sums.solved());
        }
        let [stiffness, damping] = shaft.unwrap_or_default();
        let bounded = |error: f64| error / (1.0 + error / HALF);
        let cost = turned.iter().map(|bin| bounded(left(bin, [stiffness, damping]))).sum();
        Start { stiffness, damping, engine_skew_s, torque_skew_s, cost }
    }

    /// A descent over ever finer steps of the torque's skew, beside each of which that of N_e is sought anew. Low noise
    /// makes a narrow, crooked valley: steps in both at once end on its side.
    fn refined(&self, start: Start) -> Start {
        descent(start, STEP_S / 2.0, |best, step_s| {
            let beside = self.start(best.engine_skew_s, within(best.torque_skew_s + step_s));
            descent(beside, STEP_S / 4.0, |best, step_s| {
                self.start(within(best.engine_skew_s + step_s), best.torque_skew_s)
            })
        })
    }
}

/// Steps both ways as long as one is better, then half as far.
fn descent(start: Start, longest_s: f64, step: impl Fn(&Start, f64) -> Start) -> Start {
    let (mut best, mut step_s) = (start, longest_s);
    while step_s >= FINEST_S {
        let [back, forth] = [-step_s, step_s].map(|step_s| step(&best, step_s));
        let next = if back.cost < forth.cost { back } else { forth };
        if next.cost < best.cost {
            best = next;
        } else {
            step_s /= 2.0;
        }
    }
    best
}

fn within(skew_s: f64) -> f64 {
    skew_s.clamp(-LARGEST_SKEW_S, LARGEST_SKEW_S)
}

impl Bin {
    fn of(spectra: &Spectra, k: usize, known: &Known) -> Self {
        let s = Complex64::new(0.0, std::f64::consts::TAU * spectra.window.frequency_hz(k));
        let Known { inertia_kg_m2, gate_s, stiffness, .. } = *known;
        let density = |signal: usize| spectra.signals[signal].noise_density;
        let variance = (inertia_kg_m2 * s * s + stiffness).norm_sqr() * density(DYNO)
            + stiffness * stiffness * density(ENGINE)
            + s.norm_sqr() * density(TORQUE);
        let weight = 1.0 / (variance * spectra.window.energy_s()).sqrt().max(f64::MIN_POSITIVE);
        let of = |signal: usize, order: usize| weight * spectra.signals[signal].modulated.orders[order][k];
        let undated = |earlier_s: f64| Complex64::cis(-s.im * earlier_s);
        let dating = spectra.dating;
        let engine = undated(dating.engine_s);
        Bin {
            s,
            acceleration: inertia_kg_m2 * of(DYNO, 2),
            torque: of(TORQUE, 1) * undated(dating.torque_s + gate_s / 2.0),
            dyno: [of(DYNO, 0), of(DYNO, 1)],
            engine: [engine * of(ENGINE, 0), engine * of(ENGINE, 1)],
        }
    }
}

/// Sums of the weighted least squares of the rate of T_shaft on what K and B multiply.
#[derive(Default)]
struct Sums {
    products: [f64; 2],
    squares: [f64; 2],
    mixed: f64,
}

impl Sums {
    fn add(&mut self, weight: f64, rate: Complex64, twist: [Complex64; 2]) {
        for n in 0..2 {
            self.products[n] += weight * (rate * twist[n].conj()).re;
            self.squares[n] += weight * twist[n].norm_sqr();
        }
        self.mixed += weight * (twist[0] * twist[1].conj()).re;
    }

    /// K and B, neither negative.
    fn solved(&self) -> [f64; 2] {
        let ([p, q], [a, c]) = (self.products, self.squares);
        let determinant = a * c - self.mixed * self.mixed;
        let both = [(c * p - self.mixed * q) / determinant, (a * q - self.mixed * p) / determinant];
        if determinant > 0.0 && both.iter().all(|v| *v >= 0.0) {
            return both;
        }
        // One of them alone: what it takes off the sum of squares is its product squared over its square.
        let gain = |product: f64, square: f64| product.max(0.0).powi(2) / square;
        if gain(q, c) > gain(p, a) { [0.0, (q / c).max(0.0)] } else { [(p / a).max(0.0), 0.0] }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exact_sums_give_values_that_are_not_negative() {
        let mut sums = Sums::default();
        for i in 1..20 {
            let twist = Complex64::cis(0.7 * f64::from(i));
            let slope = Complex64::new(0.0, f64::from(i)) * twist;
            sums.add(0.5, 3.0 * twist + 0.2 * slope, [twist, slope]);
        }
        let [k, b] = sums.solved();
        assert!((k - 3.0).abs() < 1e-9 && (b - 0.2).abs() < 1e-9, "{k} {b}");
        let mut other = Sums::default();
        other.add(1.0, Complex64::new(-2.0, 1.0), [Complex64::ONE, Complex64::I]);
        assert_eq!(other.solved(), [0.0, 1.0]);
    }
}
