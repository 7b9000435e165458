//! Polynomials that are orthonormal over weighted points of the complex plane.

use signal::Complex64;

/// Real polynomials `p_0 … p_n`, orthonormal in `Re Σ_k w_k² p_i(x_k)* p_j(x_k)`: a basis in which fits of any degree
/// over any band are well conditioned.
///
/// # Source
/// Brubeck, Nakatsukasa & Trefethen, *Vandermonde with Arnoldi*, SIAM Review 63, 2021; Pintelon & Schoukens 2012, §13.
#[derive(Debug, Clone)]
pub(crate) struct Basis {
    /// `values[j][k]` is p_j at point k.
    pub(crate) values: Vec<Vec<Complex64>>,
    /// `coefficients[j]` are those of p_j, ascending.
    pub(crate) coefficients: Vec<Vec<f64>>,
}

impl Basis {
    /// Up to the given degree; `None` where the points are too few for it.
    pub(crate) fn new(points: &[Complex64], weights: &[f64], degree: usize) -> Option<Self> {
        let mut basis = Basis { values: Vec::new(), coefficients: Vec::new() };
        let (mut next, mut coefficients) = (vec![Complex64::new(1.0, 0.0); points.len()], vec![1.0]);
        loop {
            basis.push(next, coefficients, weights)?;
            let last = basis.values.len() - 1;
            if last == degree {
                return Some(basis);
            }
            next = basis.values[last].iter().zip(points).map(|(p, x)| p * x).collect();
            coefficients = std::iter::once(0.0).chain(basis.coefficients[last].iter().copied()).collect();
        }
    }

    fn push(&mut self, mut next: Vec<Complex64>, mut coefficients: Vec<f64>, weights: &[f64]) -> Option<()> {
        let before = product(&next, &next, weights).sqrt();
        for _ in 0..2 {
            for (p, of) in self.values.iter().zip(&self.coefficients) {
                let along = product(p, &next, weights);
                next.iter_mut().zip(p).for_each(|(v, p)| *v -= p * along);
                coefficients.iter_mut().zip(of).for_each(|(c, p)| *c -= p * along);
            }
        }
        let length = product(&next, &next, weights).sqrt();
        if !(length > 1e-10 * before && length.is_finite()) {
            return None;
        }
        self.values.push(next.into_iter().map(|v| v / length).collect());
        self.coefficients.push(coefficients.into_iter().map(|c| c / length).collect());
        Some(())
    }

    /// The sum `Σ_j θ_j p_j` at point k.
    pub(crate) fn at(&self, theta: &[f64], k: usize) -> Complex64 {
        self.values.iter().zip(theta).map(|(p, t)| p[k] * t).sum()
    }
}

fn product(a: &[Complex64], b: &[Complex64], weights: &[f64]) -> f64 {
    a.iter().zip(b).zip(weights).map(|((a, b), w)| w * w * (a.re * b.re + a.im * b.im)).sum()
}
