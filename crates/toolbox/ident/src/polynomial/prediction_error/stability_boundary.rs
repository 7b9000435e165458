//! Why a search stopped at an edge.

use std::ops::Range;

use lti::{Complex64, polynomial};

use super::equation::Equation;
use super::orders::Orders;
use crate::{Doubt, IdentError, Termination};

/// How far from one, in its logarithm, the magnitude of a root at the unit circle is at most.
const AT_EDGE: f64 = 0.03;
/// Distance within which two roots nearly cancel.
const NEAR: f64 = 0.05;

/// A polynomial that has to keep its roots inside the unit circle, and those whose roots may cancel them.
#[derive(Clone)]
struct Guarded {
    name: char,
    input: Option<usize>,
    place: Range<usize>,
    others: Vec<(char, Range<usize>)>,
}

/// The root that would cross the unit circle, where that is what stopped the search for an equation; none for roots
/// well outside, which are what [`Doubt::Unstable`] says.
///
/// # Errors
/// Those of [`polynomial::roots`].
pub(super) fn reason(orders: &Orders, equation: &Equation<'_>, output: usize) -> Result<Option<Doubt>, IdentError> {
    if equation.lowest.termination != Termination::Edge {
        return Ok(None);
    }
    let of_input =
        |k: usize| Guarded { name: 'F', input: Some(k), place: orders.f(k), others: vec![('B', orders.b(k))] };
    let noise = vec![('D', orders.d()), ('A', orders.a())];
    let guarded = std::iter::once(Guarded { name: 'C', input: None, place: orders.c(), others: noise });
    let distance = |root: &Complex64| root.norm().ln().abs();
    let mut nearest: Option<(Complex64, Guarded)> = None;
    for polynomial in guarded.chain((0..orders.inputs()).map(of_input)) {
        for root in roots(&equation.theta[polynomial.place.clone()])? {
            let is_nearer = nearest.as_ref().is_none_or(|(other, _)| distance(&root) < distance(other));
            if distance(&root) <= AT_EDGE && is_nearer {
                nearest = Some((root, polynomial.clone()));
            }
        }
    }
    let Some((root, polynomial)) = nearest else { return Ok(None) };
    let mut cancelled_by = None;
    for (name, place) in &polynomial.others {
        let coefficients = &equation.theta[place.clone()];
        let others = if *name == 'B' { numerator_roots(coefficients)? } else { roots(coefficients)? };
        if others.iter().any(|other| (other - root).norm() < NEAR) {
            cancelled_by = Some(*name);
            break;
        }
    }
    Ok(Some(Doubt::RootAtEdge {
        output,
        polynomial: polynomial.name,
        input: polynomial.input,
        magnitude: root.norm(),
        angle: root.arg().abs(),
        cancelled_by,
    }))
}

/// In z, of `1 + c₁ q⁻¹ + …`.
fn roots(coefficients: &[f64]) -> Result<Vec<Complex64>, IdentError> {
    let whole: Vec<f64> = std::iter::once(1.0).chain(coefficients.iter().copied()).collect();
    Ok(polynomial::roots(&whole)?)
}

/// In z, of `b₀ + b₁ q⁻¹ + …`; none of zero.
fn numerator_roots(coefficients: &[f64]) -> Result<Vec<Complex64>, IdentError> {
    if coefficients.iter().all(|v| *v == 0.0) {
        return Ok(Vec::new());
    }
    Ok(polynomial::roots(coefficients)?)
}
