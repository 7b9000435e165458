//! The best shares of time for the bands of a spectrum.

use faer::Mat;

use super::information::{Judge, Judges, Line, add};
use super::task::{Criterion, DesignTask, Robustness};

/// Rounds at most; the gap that is left is reported.
const ROUNDS: usize = 20_000;
/// Gap at which the search ends.
const ENOUGH: f64 = 1e-4;
/// Models share what counts; in the worst case no share falls below this.
const SMALLEST_SHARE: f64 = 1e-9;

/// A band whose lines get equal parts of the cost.
#[derive(Debug, Clone)]
pub(super) struct Band {
    /// Places of its lines.
    pub(super) lines: Vec<usize>,
    /// Information of an experiment that spends all its time here, for each model.
    pub(super) information: Vec<Vec<f64>>,
}

/// Shares of the bands, and how far they can be from the best.
#[derive(Debug, Clone)]
pub(super) struct Shares {
    pub(super) share: Vec<f64>,
    pub(super) gap: f64,
    pub(super) rounds: usize,
}

/// Bands of neighbouring lines that the estimator uses.
///
/// A line may have the power 1/(2 cost), that of the largest sine that keeps all limits. A band that takes the share τ
/// of the time (or of the peak) gives each of its n lines τ/n of that. Powers of bands add up, their peaks do not where
/// one follows the other, as in a sweep.
pub(super) fn bands(task: &DesignTask, lines: &[Line]) -> Vec<Band> {
    let width = (task.resolution_hz * task.period_s).round().max(1.0) as usize;
    let used: Vec<usize> =
        (0..lines.len()).filter(|k| task.is_used(lines[*k].frequency_hz) && lines[*k].cost > 0.0).collect();
    let neighbours = used.chunk_by(|a, b| b - a == 1);
    neighbours.flat_map(|run| run.chunks(width)).map(|chunk| band(task, lines, chunk)).collect()
}

fn band(task: &DesignTask, lines: &[Line], places: &[usize]) -> Band {
    let size = lines[places[0]].information[0].len();
    let of_model = |model: usize| {
        let mut sum = vec![0.0; size];
        for k in places {
            let power = power_of(&lines[*k], 1.0, places.len());
            add(&mut sum, &lines[*k].information[model], task.duration_s * power);
        }
        sum
    };
    Band { lines: places.to_vec(), information: (0..task.models.len()).map(of_model).collect() }
}

/// Power of one of `count` lines of a band with a share.
pub(super) fn power_of(line: &Line, share: f64, count: usize) -> f64 {
    share / (2.0 * line.cost * count as f64)
}

/// Minimises the criterion over shares ξ ≥ 0 with Σ ξ = 1 by the multiplicative algorithm ξ_b ← ξ_b g_b^γ / Σ, with g_b
/// = −∂Ψ/∂ξ_b, γ = 1/2 for variances and 1 for the determinant. `Err` with the parameter that no spectrum determines.
///
/// The equivalence theorem says when it is there: Ψ is convex, so Ψ* ≥ Ψ + Σ ξ_b g_b − max g_b, and shares are the best
/// where max g_b = Σ ξ_b g_b. In the worst case of several models their weights μ, Σ μ = 1, are sought with the
/// shares: for any of them min_ξ Σ μ_s Ψ_s ≤ min_ξ max_s Ψ_s, which bounds the gap alike.
///
/// # Source
/// Kiefer & Wolfowitz, Canad. J. Math. 12 (1960) 363; Silvey, Titterington & Torsney, Comm. Statist. A 7 (1978) 1379;
/// Yu, Ann. Statist. 38 (2010) 1593.
pub(super) fn optimise(judges: &Judges, bands: &[Band], robustness: Robustness) -> Result<Shares, usize> {
    let models = judges.each.len();
    let mut weights = vec![1.0 / models as f64; models];
    let mut share = vec![1.0 / bands.len() as f64; bands.len()];
    let mut best = Shares { share: share.clone(), gap: f64::INFINITY, rounds: 0 };
    for round in 1..=ROUNDS {
        let state = State::of(judges, bands, &share, &weights)?;
        let gap = state.gap(judges, &share, &weights, robustness);
        if gap < best.gap {
            best = Shares { share: share.clone(), gap, rounds: round };
        }
        if best.gap < ENOUGH {
            break;
        }
        state.improve(judges, &mut share);
        if robustness == Robustness::Worst {
            state.reweigh(judges, &mut weights, round);
        }
    }
    Ok(best)
}

struct State {
    /// Ψ of each model.
    values: Vec<f64>,
    /// g of each band.
    gains: Vec<f64>,
}

impl State {
    fn of(judges: &Judges, bands: &[Band], share: &[f64], weights: &[f64]) -> Result<Self, usize> {
        let mut gains = vec![0.0; bands.len()];
        let mut values = Vec::with_capacity(weights.len());
        for (model, (judge, weight)) in judges.each.iter().zip(weights).enumerate() {
            let mut information = vec![0.0; judge.count * judge.count];
            for (band, share) in bands.iter().zip(share) {
                add(&mut information, &band.information[model], *share);
            }
            let judged = judge.judge(&information)?;
            values.push(judged.value);
            for (gain, band) in gains.iter_mut().zip(bands) {
                *gain += weight * trace(&judged.sensitivity, &band.information[model]);
            }
        }
        Ok(State { values, gains })
    }

    /// By what part Ψ can exceed the best; for the determinant, by how much its logarithm can.
    fn gap(&self, judges: &Judges, share: &[f64], weights: &[f64], robustness: Robustness) -> f64 {
        let mean: f64 = self.values.iter().zip(weights).map(|(v, w)| v * w).sum();
        let reached = match robustness {
            Robustness::Mean => mean,
            Robustness::Worst => self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        };
        let spent: f64 = self.gains.iter().zip(share).map(|(g, s)| g * s).sum();
        let largest = self.gains.iter().copied().fold(0.0, f64::max);
        let gap = reached - (mean + spent - largest);
        if is_variance(&judges.each) { gap / reached } else { gap }
    }

    fn improve(&self, judges: &Judges, share: &mut [f64]) {
        let root = is_variance(&judges.each);
        for (share, gain) in share.iter_mut().zip(&self.gains) {
            *share *= if root { gain.max(0.0).sqrt() } else { gain.max(0.0) };
        }
        normalise(share);
    }

    /// Models that fare worse count for more, by ever smaller steps.
    fn reweigh(&self, judges: &Judges, weights: &mut [f64], round: usize) {
        let worst = self.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let pace = 1.0 / (1.0 + round as f64 / 100.0).sqrt();
        for (weight, value) in weights.iter_mut().zip(&self.values) {
            let ratio = if is_variance(&judges.each) { value / worst } else { (value - worst).exp() };
            *weight = (*weight * ratio.powf(pace)).max(SMALLEST_SHARE);
        }
        normalise(weights);
    }
}

fn is_variance(judges: &[Judge]) -> bool {
    judges.first().is_some_and(|j| j.criterion == Criterion::RelativeVariance)
}

fn normalise(values: &mut [f64]) {
    let sum: f64 = values.iter().sum();
    values.iter_mut().for_each(|v| *v /= sum);
}

/// tr(Q M).
fn trace(sensitivity: &Mat<f64>, information: &[f64]) -> f64 {
    let n = sensitivity.nrows();
    (0..n).map(|i| (0..n).map(|j| sensitivity[(i, j)] * information[i * n + j]).sum::<f64>()).sum()
}
