//! What is between ω_d and ω_e: one spring, or two with a mass between them.
//!
//! s T_shaft = H_e(s) ω_e − H_d(s) ω_d. One spring: H_d = H_e = K + B s. Two, with the mass J_2 between shaft and engine and
//! the spring K_2 + B_2 s behind it (a dual-mass flywheel): with Z = K + B s and Z_2 = K_2 + B_2 s,
//! H_e = Z Z_2/(J_2 s² + Z + Z_2), H_d = Z (J_2 s² + Z_2)/(J_2 s² + Z + Z_2).
//!
//! Under a window an operator H(p) is not H(s); with p = s + (p − s), H(p) x = H(s) x + H'(s) (p − s) x + ½ H''(s) (p − s)² x + …
//! in which (p − s) takes a derivative of the window. A polynomial of second order is exact so, and two springs are as
//! exact as H bends little over the width of a line.
//!
//! # Source
//! Thesis §3.3 and (2.7); Shinbrot 1957.

use ident::frequency::ORDERS;
use signal::Complex64;

use crate::shaft::places::{B, DUAL_MASS, K, TERM};
use crate::shaft::term::Term;

/// Coefficients by order of derivative.
type Orders = [Complex64; ORDERS];
/// The most parameters that springs have.
const SLOPES: usize = 5;
/// Steps of the differences by s and by a parameter, relatively.
const STEP: f64 = 1e-3;
const PARAMETER_STEP: f64 = 1e-5;
/// Where a parameter is zero, it is moved as if it were this: K, B, J_2, K_2, B_2.
const LEAST: [f64; SLOPES] = [1.0, 1e-2, 1e-4, 1.0, 1e-2];

/// H_d and H_e.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Sides {
    pub(super) dyno: Orders,
    pub(super) engine: Orders,
}

/// Both with their slopes by parameters.
pub(super) struct Springs {
    pub(super) sides: Sides,
    pub(super) slopes: [Option<(usize, Sides)>; SLOPES],
}

impl Springs {
    /// At one frequency.
    pub(super) fn of(term: Option<Term>, s: Complex64, theta: &[f64]) -> Self {
        match term {
            Some(Term::DualMass) => Self::dual_mass(s, theta),
            Some(Term::LossFactor) => {
                let turned = Complex64::new(1.0, theta[TERM]);
                let mut springs = Self::one(theta, turned, Complex64::from(1.0));
                let slope = [Complex64::new(0.0, theta[K]), 0.0.into(), 0.0.into()];
                springs.slopes[2] = Some((TERM, Sides { dyno: slope, engine: slope }));
                springs
            }
            Some(Term::SecondMass) => {
                let mut springs = Self::one(theta, Complex64::from(1.0), 1.0 - theta[TERM] * s * s);
                let engine = [theta[K], theta[B], 0.0].map(|c| -s * s * c);
                springs.slopes[2] = Some((TERM, Sides { dyno: Orders::default(), engine }));
                springs
            }
            Some(Term::OfStiffness(_) | Term::OfDamping(_)) | None => {
                Self::one(theta, Complex64::from(1.0), Complex64::from(1.0))
            }
        }
    }

    /// K·`turned` + B s, times `far` on the engine's side.
    fn one(theta: &[f64], turned: Complex64, far: Complex64) -> Self {
        let zero = Complex64::default();
        let both = |dyno: Orders| Sides { dyno, engine: dyno.map(|c| far * c) };
        let slopes =
            [Some((K, both([turned, zero, zero]))), Some((B, both([zero, 1.0.into(), zero]))), None, None, None];
        Springs { sides: both([turned * theta[K], theta[B].into(), zero]), slopes }
    }

    fn dual_mass(s: Complex64, theta: &[f64]) -> Self {
        let places = [K, B, DUAL_MASS[0], DUAL_MASS[1], DUAL_MASS[2]];
        let values = places.map(|place| theta[place]);
        let slope = |i: usize| {
            let step = PARAMETER_STEP * values[i].abs().max(LEAST[i]);
            let moved = |by: f64| {
                let mut values = values;
                values[i] += by;
                expanded(s, values)
            };
            let (up, down) = (moved(step), moved(-step));
            let of = |up: Orders, down: Orders| std::array::from_fn(|n| (up[n] - down[n]) / (2.0 * step));
            Some((places[i], Sides { dyno: of(up.dyno, down.dyno), engine: of(up.engine, down.engine) }))
        };
        Springs { sides: expanded(s, values), slopes: std::array::from_fn(slope) }
    }
}

/// H_d and H_e of two springs as polynomials of second order about s.
fn expanded(s: Complex64, values: [f64; SLOPES]) -> Sides {
    let h = STEP * s.norm();
    let [below, here, above] = [s - h, s, s + h].map(|s| two_springs(s, values));
    let about = |below: Complex64, here: Complex64, above: Complex64| {
        let first = (above - below) / (2.0 * h);
        let second = (above - 2.0 * here + below) / (h * h);
        [here - s * first + 0.5 * s * s * second, first - s * second, 0.5 * second]
    };
    Sides { dyno: about(below.0, here.0, above.0), engine: about(below.1, here.1, above.1) }
}

fn two_springs(s: Complex64, [k, b, mass, k_2, b_2]: [f64; SLOPES]) -> (Complex64, Complex64) {
    let (shaft, behind) = (k + b * s, k_2 + b_2 * s);
    let whole = mass * s * s + shaft + behind;
    (shaft * (mass * s * s + behind) / whole, shaft * behind / whole)
}
