//! Starting values from a model of higher order, less the poles that matter least.

use lti::{Complex64, polynomial};

use super::orders::Orders;
use super::segment::Segment;
use super::start::with_numerators;

/// The same structure with this many more poles, and numerator coefficients, in every denominator of the dynamics.
pub(super) fn raised(orders: &Orders, by: usize) -> Orders {
    let of_inputs = orders.nf.iter().any(|nf| *nf > 0);
    let more = |k: usize, n: usize| if of_inputs && orders.nf[k] == 0 { n } else { n + by };
    Orders {
        na: if of_inputs { orders.na } else { orders.na + by },
        nb: orders.nb.iter().enumerate().map(|(k, n)| more(k, *n)).collect(),
        nf: orders.nf.iter().map(|n| if *n > 0 { n + by } else { 0 }).collect(),
        ..orders.clone()
    }
}

/// θ of `orders` from that of a structure of more poles. One denominator after another loses poles, of all ways that
/// which, with all numerators and the initial states estimated anew, simulates the output best.
pub(super) fn lowered(
    orders: &Orders,
    above: &Orders,
    segments: &[Segment<'_>],
    theta: &[f64],
    estimate_states: bool,
) -> Option<Vec<f64>> {
    let (mut now, mut theta) = (above.clone(), theta.to_vec());
    for which in (0..orders.inputs()).map(Some).chain([None]) {
        let next = match which {
            Some(k) => {
                let mut next = now.clone();
                (next.nf[k], next.nb[k]) = (orders.nf[k], orders.nb[k]);
                next
            }
            None => Orders { na: orders.na, ..now.clone() },
        };
        let (from, to) = (denominator(&now, which), denominator(&next, which));
        let place = |denominator: &[f64]| {
            let mut placed = carried(&now, &theta, &next);
            placed[to.clone()].copy_from_slice(denominator);
            placed
        };
        let tried = shorter(&theta[from.clone()], from.len() - to.len());
        let refitted = tried.iter().filter_map(|d| with_numerators(&next, segments, &place(d), estimate_states));
        theta = refitted.min_by(|(a, _), (b, _)| a.total_cmp(b))?.1;
        now = next;
    }
    Some(theta)
}

/// Where `F` of an input, or `A`, is in θ.
fn denominator(orders: &Orders, input: Option<usize>) -> std::ops::Range<usize> {
    input.map_or(orders.a(), |k| orders.f(k))
}

/// The denominators that have as many coefficients in both structures, and zeros.
fn carried(from: &Orders, theta: &[f64], to: &Orders) -> Vec<f64> {
    let mut placed = vec![0.0; to.count()];
    for which in (0..from.inputs()).map(Some).chain([None]) {
        let (source, target) = (denominator(from, which), denominator(to, which));
        if source.len() == target.len() {
            placed[target].copy_from_slice(&theta[source]);
        }
    }
    placed
}

/// The polynomials `1 + p₁ q⁻¹ + …` that are left when `fewer` roots are taken away, two at most, complex ones in
/// pairs.
fn shorter(p: &[f64], fewer: usize) -> Vec<Vec<f64>> {
    let full: Vec<f64> = std::iter::once(1.0).chain(p.iter().copied()).collect();
    let Ok(roots) = polynomial::roots(&full) else { return Vec::new() };
    if fewer == 0 {
        return vec![p.to_vec()];
    }
    let upper: Vec<Complex64> = roots.into_iter().filter(|r| r.im >= 0.0).collect();
    let size = |i: usize| if upper[i].im > 0.0 { 2 } else { 1 };
    let mut taken: Vec<Vec<usize>> = (0..upper.len()).filter(|i| size(*i) == fewer).map(|i| vec![i]).collect();
    if fewer == 2 {
        let real: Vec<usize> = (0..upper.len()).filter(|i| size(*i) == 1).collect();
        taken.extend(real.iter().flat_map(|i| real.iter().filter(move |j| *j > i).map(move |j| vec![*i, *j])));
    }
    let left = |taken: &Vec<usize>| {
        let kept = (0..upper.len()).filter(|i| !taken.contains(i));
        let roots = kept.flat_map(|i| [upper[i], upper[i].conj()].into_iter().take(size(i)));
        polynomial::from_roots(&roots.collect::<Vec<_>>())[1..].to_vec()
    };
    taken.iter().map(left).collect()
}
