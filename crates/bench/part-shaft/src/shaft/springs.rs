//! Springs between ω_d and ω_e: one, or two with a mass between them.
//!
//! s T_shaft = H_e(s) ω_e − H_d(s) ω_d. One spring: H_d = H_e = K + B s. Two, with the mass J_2 between shaft and
//! engine and the spring K_2 + B_2 s behind it (a dual-mass flywheel): with Z = K + B s and Z_2 = K_2 + B_2 s, H_e = Z
//! Z_2/(J_2 s² + Z + Z_2), H_d = Z (J_2 s² + Z_2)/(J_2 s² + Z + Z_2).
//!
//! Under a window an operator H(p) is not H(s); with p = s + (p − s), H(p) x = H(s) x + H'(s) (p − s) x + ½ H''(s) (p −
//! s)² x + … in which (p − s) takes a derivative of the window. A polynomial of second order is exact so, and two
//! springs are as exact as H bends little over the width of a line.
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
    /// At one frequency; those of a dual-mass flywheel have slopes only where these are wanted.
    pub(super) fn of(term: Option<Term>, s: Complex64, theta: &[f64], sloped: bool) -> Self {
        match term {
            Some(Term::DualMass) => Self::dual_mass(s, theta, sloped),
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

    /// With W = Z + Q, Q = J_2 s² + Z_2: H_d = Z Q/W, H_e = Z Z_2/W.
    fn dual_mass(s: Complex64, theta: &[f64], sloped: bool) -> Self {
        let [mass, k_2, b_2] = DUAL_MASS.map(|place| theta[place]);
        let (one, p) = (Taylor::constant(1.0), Taylor([s, 1.0.into(), Complex64::ZERO]));
        let square = p * p;
        let (shaft, behind) = (one * theta[K] + p * theta[B], one * k_2 + p * b_2);
        let far = square * mass + behind;
        let part = (shaft + far).inverse();
        let (of_shaft, of_behind, of_far) = (shaft * part, behind * part, far * part);
        let sides = |dyno: Taylor, engine: Taylor| Sides { dyno: dyno.about(s), engine: engine.about(s) };
        let mut springs = Springs { sides: sides(of_shaft * far, of_shaft * behind), slopes: [None; SLOPES] };
        if sloped {
            // By Z, Q and Z_2, the other two held.
            let by_shaft = (of_far * of_far, of_behind * of_far);
            let (by_far, by_behind) = ((of_shaft * of_shaft, -(of_shaft * of_behind)), of_shaft);
            let by_spring = (by_far.0, by_far.1 + by_behind);
            let of = |place: usize, (dyno, engine): (Taylor, Taylor), factor: Taylor| {
                Some((place, sides(dyno * factor, engine * factor)))
            };
            springs.slopes = [
                of(K, by_shaft, one),
                of(B, by_shaft, p),
                of(DUAL_MASS[0], by_far, square),
                of(DUAL_MASS[1], by_spring, one),
                of(DUAL_MASS[2], by_spring, p),
            ];
        }
        springs
    }
}

/// A function of p about s: value, slope, and half the curvature, the coefficients of its Taylor series.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Taylor([Complex64; ORDERS]);

impl Taylor {
    fn constant(value: f64) -> Self {
        Taylor([value.into(), Complex64::ZERO, Complex64::ZERO])
    }

    fn inverse(self) -> Self {
        let Taylor([a, b, c]) = self;
        let first = 1.0 / a;
        let second = -b * first * first;
        Taylor([first, second, -(b * second + c * first) * first])
    }

    /// The series as a polynomial in p.
    fn about(self, s: Complex64) -> Orders {
        let Taylor([a, b, c]) = self;
        [a - s * (b - s * c), b - 2.0 * s * c, c]
    }
}

impl std::ops::Add for Taylor {
    type Output = Taylor;

    fn add(self, other: Taylor) -> Taylor {
        Taylor(std::array::from_fn(|n| self.0[n] + other.0[n]))
    }
}

impl std::ops::Neg for Taylor {
    type Output = Taylor;

    fn neg(self) -> Taylor {
        Taylor(self.0.map(|c| -c))
    }
}

impl std::ops::Mul for Taylor {
    type Output = Taylor;

    fn mul(self, other: Taylor) -> Taylor {
        let (Taylor([a, b, c]), Taylor([d, e, f])) = (self, other);
        Taylor([a * d, a * e + b * d, a * f + b * e + c * d])
    }
}

impl std::ops::Mul<f64> for Taylor {
    type Output = Taylor;

    fn mul(self, factor: f64) -> Taylor {
        Taylor(self.0.map(|c| factor * c))
    }
}
