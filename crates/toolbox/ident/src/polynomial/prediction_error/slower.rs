//! Starting values for signals sampled much faster than the system moves: dynamics are sought at a slower rate, where
//! the samples differ by more than the noise, and brought back.

use std::borrow::Cow;

use lti::{Complex64, polynomial};

use super::orders::Orders;
use super::segment::Segment;

/// The data with blocks of `factor` samples replaced by their means, which keeps a linear relation between them.
pub(super) fn slowed(segments: &[Segment<'_>], factor: usize) -> Vec<Segment<'static>> {
    let mean = |x: &[f64]| -> Cow<'static, [f64]> {
        x.chunks_exact(factor).map(|block| block.iter().sum::<f64>() / factor as f64).collect()
    };
    let one = |s: &Segment<'_>| Segment {
        inputs: s.inputs.iter().map(|u| mean(u)).collect(),
        output: mean(&s.output),
        missing: Vec::new(),
        impulse: None,
        experiment: s.experiment,
        first: 0,
    };
    segments.iter().map(one).collect()
}

/// The dynamics at the slower rate: a full numerator, since an input moves within a block, and no noise model.
pub(super) fn slow_orders(orders: &Orders, factor: usize) -> Orders {
    Orders {
        na: orders.na,
        nb: orders.nf.iter().map(|nf| orders.na.max(*nf) + 1).collect(),
        nc: 0,
        nd: 0,
        nf: orders.nf.clone(),
        nk: orders.nk.iter().map(|nk| nk / factor).collect(),
    }
}

/// θ at the fast rate with the denominators of `slow`, and zeros elsewhere.
pub(super) fn quickened(orders: &Orders, slow_orders: &Orders, slow: &[f64], factor: usize) -> Vec<f64> {
    let mut theta = vec![0.0; orders.count()];
    let pairs = (0..orders.inputs()).map(|k| (orders.f(k), slow_orders.f(k)));
    for (to, from) in pairs.chain([(orders.a(), slow_orders.a())]) {
        theta[to].copy_from_slice(&rooted(&slow[from], factor));
    }
    theta
}

/// The polynomial whose roots are the `factor`-th roots of those of `1 + p₁ q⁻¹ + …`; negative roots, which no slow
/// sampling of a smooth system has, lose their sign.
fn rooted(p: &[f64], factor: usize) -> Vec<f64> {
    let full: Vec<f64> = std::iter::once(1.0).chain(p.iter().copied()).collect();
    let Ok(roots) = polynomial::roots(&full) else {
        return vec![0.0; p.len()];
    };
    let share = 1.0 / factor as f64;
    let one = |r: &Complex64| {
        let angle = if r.im == 0.0 { 0.0 } else { r.arg() * share };
        Complex64::from_polar(r.norm().powf(share), angle)
    };
    polynomial::from_roots(&roots.iter().map(one).collect::<Vec<_>>())[1..].to_vec()
}
