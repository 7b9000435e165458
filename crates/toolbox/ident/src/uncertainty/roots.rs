//! Poles and zeros with their regions.

use faer::Mat;
use lti::{Complex64, LtiError, StateSpace, polynomial};
use numerics::linalg;

use super::{Derived, Dynamics};
use crate::distributions::f_quantile;
use crate::{Fit, IdentError, Parametric};

/// A root is near another where its deviation exceeds this part of the distance: a region of 95 % then reaches half the
/// way, and a root no longer moves in proportion to the parameters.
const NEAR: f64 = 0.2;

/// A pole at rest that moves by less than this part of the fastest pole does not depend on the parameters.
const STRUCTURAL: f64 = 1e-6;

/// A pole or a zero with its uncertainty to first order.
#[derive(Debug, Clone, PartialEq)]
pub struct UncertainRoot {
    /// Where it is, in rad/s for a continuous model.
    pub value: Complex64,
    /// Covariance of its real and imaginary parts. Infinite for a multiple root.
    pub covariance: [[f64; 2]; 2],
    /// It lies so near another root, or a complex one so near the real axis, that its region means nothing.
    pub near_multiple: bool,
    /// Degrees of freedom behind the covariance.
    pub degrees_of_freedom: f64,
}

/// An ellipse in the complex plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ellipse {
    /// Its centre.
    pub center: Complex64,
    /// The longer half axis.
    pub semi_major: f64,
    /// The shorter one; zero for a real root.
    pub semi_minor: f64,
    /// The direction of the longer one, counted from the real axis.
    pub angle_rad: f64,
}

impl Ellipse {
    /// The region that holds a complex number with probability `level`, from the covariance of its parts: by F with two
    /// degrees of freedom, with one where it can only be real.
    pub(super) fn new(center: Complex64, covariance: [[f64; 2]; 2], degrees_of_freedom: f64, level: f64) -> Self {
        let [[rr, ri], [_, ii]] = covariance;
        if !(rr.is_finite() && ri.is_finite() && ii.is_finite()) {
            return Ellipse { center, semi_major: f64::INFINITY, semi_minor: f64::INFINITY, angle_rad: 0.0 };
        }
        let (mean, half, radius) = (0.5 * (rr + ii), 0.5 * (rr - ii), (0.5 * (rr - ii)).hypot(ri));
        let dimension = if center.im == 0.0 && ii == 0.0 { 1.0 } else { 2.0 };
        let reach = dimension * f_quantile(level, dimension, degrees_of_freedom);
        Ellipse {
            center,
            semi_major: (reach * (mean + radius)).sqrt(),
            semi_minor: (reach * (mean - radius).max(0.0)).sqrt(),
            angle_rad: 0.5 * ri.atan2(half),
        }
    }

    /// Returns true if a point lies inside.
    #[must_use]
    pub fn contains(&self, point: Complex64) -> bool {
        let turned = (point - self.center) * Complex64::cis(-self.angle_rad);
        let part = |distance: f64, axis: f64| if distance == 0.0 { 0.0 } else { distance / axis };
        part(turned.re, self.semi_major).hypot(part(turned.im, self.semi_minor)) <= 1.0
    }

    /// `count` points on its edge, to draw it by.
    #[must_use]
    pub fn points(&self, count: usize) -> Vec<Complex64> {
        let at = |k: usize| {
            let (sine, cosine) = (std::f64::consts::TAU * k as f64 / count as f64).sin_cos();
            let edge = Complex64::new(self.semi_major * cosine, self.semi_minor * sine);
            self.center + edge * Complex64::cis(self.angle_rad)
        };
        (0..count).map(at).collect()
    }
}

impl UncertainRoot {
    /// The region that holds the root with probability `level`.
    #[must_use]
    pub fn ellipse(&self, level: f64) -> Ellipse {
        Ellipse::new(self.value, self.covariance, self.degrees_of_freedom, level)
    }

    fn largest_deviation(&self) -> f64 {
        let [[rr, ri], [_, ii]] = self.covariance;
        (0.5 * (rr + ii) + (0.5 * (rr - ii)).hypot(ri)).sqrt()
    }
}

impl<M: Parametric + Dynamics> Fit<M> {
    /// The poles from an input to an output, those of the whole system where the model is not written in polynomials.
    /// Delays of a discrete model, poles at zero by structure, are left out.
    ///
    /// Derivatives are those of roots, `∂p = −Σ ∂c_i p^{n−i} / c′(p)`, or of eigenvalues, `∂p = wᴴ ∂A v / wᴴ v`;
    /// differences are taken of coefficients or matrices only.
    ///
    /// # Errors
    /// Those of the model; [`IdentError::NotFinite`].
    ///
    /// # Source
    /// Stewart & Sun, *Matrix Perturbation Theory*, 1990, ch. IV, for the derivative of an eigenvalue; Ljung 1999,
    /// §9.6.
    pub fn poles(&self, output: usize, input: usize) -> Result<Vec<UncertainRoot>, IdentError> {
        if self.model.polynomials(output, input)?.is_some() {
            return self
                .polynomial_roots(|m| Ok(m.polynomials(output, input)?.map_or_else(Vec::new, |r| r.denominator)));
        }
        let system = self.model.system()?;
        let values = system.poles()?;
        let mut roots = self.pencil_roots(&values, system.states(), |m| Ok(pencil(&m.system()?, false)))?;
        let fastest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
        for (root, (value, is_at_rest)) in roots.iter_mut().zip(lti::settled(&values, system.sample_time_s())) {
            // By its structure the system integrates: its pole is at rest whatever the parameters, and rounding beside
            // it.
            let deviation = root.largest_deviation();
            if is_at_rest && (deviation <= STRUCTURAL * fastest || !deviation.is_finite()) {
                *root = UncertainRoot { value, covariance: [[0.0; 2]; 2], near_multiple: false, ..root.clone() };
            }
        }
        Ok(roots)
    }

    /// The zeros from an input to an output.
    ///
    /// # Errors
    /// Those of [`Fit::poles`]; [`LtiError::ZeroPolynomial`], [`LtiError::ZeroSystem`] where the input has no effect.
    pub fn zeros(&self, output: usize, input: usize) -> Result<Vec<UncertainRoot>, IdentError> {
        if self.model.polynomials(output, input)?.is_some() {
            return self.polynomial_roots(|m| Ok(m.polynomials(output, input)?.map_or_else(Vec::new, |r| r.numerator)));
        }
        let channel = self.model.system()?.channel(output, input)?;
        let values = channel.zeros()?;
        self.pencil_roots(&values, channel.states(), |m| Ok(pencil(&m.system()?.channel(output, input)?, true)))
    }

    fn polynomial_roots(
        &self,
        coefficients: impl Fn(&M) -> Result<Vec<f64>, LtiError>,
    ) -> Result<Vec<UncertainRoot>, IdentError> {
        let derived = self.derive(coefficients)?;
        let c = &derived.values;
        let values = polynomial::roots(c)?;
        let derivative: Vec<f64> =
            c[..c.len().saturating_sub(1)].iter().enumerate().map(|(i, v)| v * (c.len() - 1 - i) as f64).collect();
        let directions = derived.factor.ncols();
        let slopes = |root: &Complex64| {
            let slope = polynomial::evaluate(&derivative, *root);
            let column = |k: usize| (0..c.len()).map(|i| derived.factor[(i, k)]).collect::<Vec<_>>();
            (0..directions).map(|k| -polynomial::evaluate(&column(k), *root) / slope).collect()
        };
        Ok(with_regions(&values, slopes, &derived))
    }

    /// Roots of `det(P − λ E)`, with `P` of this many rows after the function and `E` the identity over the states.
    fn pencil_roots(
        &self,
        values: &[Complex64],
        states: usize,
        entries: impl Fn(&M) -> Result<Vec<f64>, LtiError>,
    ) -> Result<Vec<UncertainRoot>, IdentError> {
        let derived = self.derive(entries)?;
        let pencils =
            values.iter().map(|z| Shifted::new(&derived.values, states, *z)).collect::<Result<Vec<_>, _>>()?;
        let slopes = |root: &Complex64| {
            let shifted = &pencils[values.iter().position(|v| v == root).unwrap_or(0)];
            let change = |k: usize| shifted.along(|i| derived.factor[(i, k)]);
            (0..derived.factor.ncols()).map(change).collect()
        };
        Ok(with_regions(values, slopes, &derived))
    }
}

/// `A`, or `[A B; C D]`, by rows.
fn pencil(s: &StateSpace, bordered: bool) -> Vec<f64> {
    let n = s.states();
    let size = if bordered { n + 1 } else { n };
    let at = |i: usize, j: usize| match (i < n, j < n) {
        (true, true) => s.a()[(i, j)],
        (true, false) => s.b()[(i, 0)],
        (false, true) => s.c()[(0, j)],
        (false, false) => s.d()[(0, 0)],
    };
    (0..size).flat_map(|i| (0..size).map(move |j| (i, j))).map(|(i, j)| at(i, j)).collect()
}

/// `P − λ E` at a root, with its null vectors. Inputs and outputs are brought to the size of the states first: they
/// have units of their own, and beside much larger numbers the null vectors would be rounding.
struct Shifted {
    rows: Vec<f64>,
    columns: Vec<f64>,
    left: Vec<Complex64>,
    right: Vec<Complex64>,
    /// `wᴴ E v`.
    weight: Complex64,
}

impl Shifted {
    fn new(entries: &[f64], states: usize, root: Complex64) -> Result<Self, IdentError> {
        let n = entries.len().isqrt();
        let whole = Mat::from_fn(n, n, |i, j| {
            let value = Complex64::new(entries[i * n + j], 0.0);
            if i == j && i < states { value - root } else { value }
        });
        let (rows, columns) = scales(entries, states, root.norm());
        let scaled = Mat::from_fn(n, n, |i, j| whole[(i, j)] * rows[i] * columns[j]);
        let svd = linalg::complex_svd(scaled.as_ref())?;
        let last = |m: &Mat<Complex64>| (0..n).map(|i| m[(i, n - 1)]).collect::<Vec<_>>();
        let (left, right) = (last(&svd.u), last(&svd.v));
        let weight = (0..states).map(|i| left[i].conj() * right[i] * (rows[i] * columns[i])).sum();
        Ok(Shifted { rows, columns, left, right, weight })
    }

    /// How far the root moves with these changes of the entries of `P`: `wᴴ ∂P v / wᴴ E v`.
    fn along(&self, change: impl Fn(usize) -> f64) -> Complex64 {
        let n = self.rows.len();
        let at = |i: usize, j: usize| {
            self.left[i].conj() * (change(i * n + j) * self.rows[i] * self.columns[j]) * self.right[j]
        };
        let all = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        all.map(|(i, j)| at(i, j)).sum::<Complex64>() / self.weight
    }
}

/// Powers of two for the rows and the columns of `[A B; C D]` that bring `B`, `C` and `D` to no more than the size of
/// `A − λ E`.
fn scales(entries: &[f64], states: usize, root: f64) -> (Vec<f64>, Vec<f64>) {
    let n = entries.len().isqrt();
    let (mut rows, mut columns) = (vec![1.0; n], vec![1.0; n]);
    let largest = |places: &dyn Fn(usize, usize) -> bool| {
        let all = (0..n * n).filter(|place| places(place / n, place % n)).map(|place| entries[place].abs());
        all.fold(0.0, f64::max)
    };
    let states_alone = |i: usize, j: usize| i < states && j < states;
    let size = largest(&states_alone).max(root);
    if n == states || size == 0.0 {
        return (rows, columns);
    }
    let power = |value: f64| if value > 0.0 { value.log2() } else { 0.0 };
    let to_input = power(largest(&|i, j| i < states && j >= states) / size);
    let to_output = power(largest(&|i, j| i >= states && j < states) / size);
    let through = power(largest(&|i, j| i >= states && j >= states) / size) - to_input - to_output;
    let less = 0.5 * through.max(0.0);
    rows[states..].fill((-to_output - less).round().exp2());
    columns[states..].fill((-to_input - less).round().exp2());
    (rows, columns)
}

fn with_regions(
    values: &[Complex64],
    slopes: impl Fn(&Complex64) -> Vec<Complex64>,
    derived: &Derived,
) -> Vec<UncertainRoot> {
    let region = |(index, value): (usize, &Complex64)| {
        let slopes = slopes(value);
        let sum = |part: fn(&Complex64) -> f64| slopes.iter().map(part).sum::<f64>();
        let cross = sum(|s| s.re * s.im);
        let imaginary = if value.im == 0.0 { 0.0 } else { sum(|s| s.im * s.im) };
        let covariance = [[sum(|s| s.re * s.re), cross], [cross, imaginary]];
        let finite = covariance.iter().flatten().all(|v| v.is_finite());
        let covariance = if finite { covariance } else { [[f64::INFINITY; 2]; 2] };
        let mut root = UncertainRoot {
            value: *value,
            covariance,
            near_multiple: false,
            degrees_of_freedom: derived.degrees_of_freedom,
        };
        let others = values.iter().enumerate().filter(|(other, _)| *other != index);
        let nearest = others.map(|(_, other)| (other - value).norm()).fold(f64::INFINITY, f64::min);
        root.near_multiple = !finite || root.largest_deviation() > NEAR * nearest;
        root
    };
    values.iter().enumerate().map(region).collect()
}
