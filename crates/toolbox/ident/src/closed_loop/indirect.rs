//! From the closed loop to the plant, given the regulator.

use faer::Mat;
use lti::polynomial::multiply;
use lti::{LtiError, PolynomialEquation, PolynomialModel, TransferFunction};

use super::{REFERENCE, check_loop};
use crate::{Dataset, Fit, IdentError};
use fitting::{Count, StructureError};

/// Fits a model from `r` to `y`, `T = G S`, and solves it for the plant: `G = T/(1 − T R)`.
///
/// With `T = N/M` and `R = P/Q` in `q⁻¹` that is `G = N Q/(M Q − N P)`, linear in the coefficients of `N` and `M`, so
/// the covariance passes to those of `G` without approximation but for the products `M = A F`. The plant comes in the
/// form of output error with as many coefficients as these polynomials have; nothing is cancelled, so the covariance is
/// singular where the plant has more coefficients than the closed loop.
///
/// # Source
/// Ljung 1999, (13.58)–(13.60); the delta method: (9.56) and appendix II.
#[derive(Debug, Clone, PartialEq)]
pub struct Indirect {
    /// `R` of `u = r − R y`, discrete, on the data's sample time, without delay beyond its polynomials.
    pub regulator: TransferFunction,
}

impl Indirect {
    /// Fits the closed loop of data with the inputs `u`, `r` and one output, and solves it for the plant. Noise
    /// variance, loss and counts are those of the closed loop.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for other channels; those of `estimate` and of [`Indirect::solve`].
    pub fn fit(
        &self,
        data: &Dataset,
        estimate: impl Fn(&Dataset) -> Result<Fit<PolynomialModel>, IdentError>,
    ) -> Result<Fit<PolynomialModel>, IdentError> {
        check_loop(data)?;
        self.solve(&estimate(&data.channels(&[REFERENCE], &[0])?)?)
    }

    /// The plant that belongs to a closed loop from `r` to `y`.
    ///
    /// # Errors
    /// [`IdentError::Structure`] unless the closed loop has one input and one output; [`LtiError::SampleTimesDiffer`];
    /// [`LtiError::DelayPresent`] or [`LtiError::Improper`] for the regulator; [`LtiError::AlgebraicLoop`] where
    /// `1 − T R` vanishes at once.
    pub fn solve(&self, closed: &Fit<PolynomialModel>) -> Result<Fit<PolynomialModel>, IdentError> {
        let model = &closed.model;
        let method = "the plant of a closed loop";
        if model.inputs() != 1 {
            return Err(StructureError::inputs(method, Count::Exactly(1), model.inputs()).into());
        }
        if model.outputs() != 1 {
            return Err(StructureError::outputs(method, Count::Exactly(1), model.outputs()).into());
        }
        let (p, q) = self.regulator_polynomials(model.sample_time_s())?;
        let loops = ClosedLoop::new(&model.equations()[0]);
        let raw = loops.plant(&p, &q);
        let lead = raw.den[0];
        if lead.abs() <= 1e-12 * raw.den.iter().fold(0.0_f64, |m, v| m.max(v.abs())) {
            return Err(LtiError::AlgebraicLoop.into());
        }
        // The denominator is made monic, numerator coefficients before the delay of the closed loop are zero for good.
        let nk = loops.nk;
        let values: Vec<f64> = raw.num[nk..].iter().chain(&raw.den[1..]).map(|v| v / lead).collect();
        let slopes: Vec<&Vec<f64>> = raw.num_slopes[nk..].iter().chain(&raw.den_slopes[1..]).collect();
        let count = model.coefficients().len();
        let jacobian =
            Mat::from_fn(values.len(), count, |i, j| (slopes[i][j] - values[i] * raw.den_slopes[0][j]) / lead);
        let covariance = &jacobian * &closed.covariance * jacobian.transpose();
        let (b, f) = values.split_at(raw.num.len() - nk);
        let equation = PolynomialEquation { b: vec![b.to_vec()], f: vec![f.to_vec()], ..Default::default() };
        let plant = PolynomialModel::siso(model.sample_time_s(), nk, equation)?
            .with_noise_covariance(model.noise_covariance().to_owned())?;
        Ok(with_model(closed, plant, covariance))
    }

    /// `P` and `Q` in ascending powers of q⁻¹, equally long.
    fn regulator_polynomials(&self, sample_time_s: f64) -> Result<(Vec<f64>, Vec<f64>), IdentError> {
        let r = &self.regulator;
        crate::data::check_clock(r.sample_time_s().ok_or(LtiError::NotDiscrete)?, sample_time_s)?;
        if r.delay_s() > 0.0 {
            return Err(LtiError::DelayPresent { delay_s: r.delay_s() }.into());
        }
        let (num, den) = (r.num(), r.den());
        if num.len() > den.len() {
            return Err(LtiError::Improper { numerator: num.len() - 1, denominator: den.len() - 1 }.into());
        }
        let padding = std::iter::repeat_n(0.0, den.len() - num.len());
        Ok((padding.chain(num.iter().copied()).collect(), den.to_vec()))
    }
}

/// The same statistics with another model.
fn with_model(fit: &Fit<PolynomialModel>, model: PolynomialModel, covariance: Mat<f64>) -> Fit<PolynomialModel> {
    Fit { model, covariance, initial_states: Vec::new(), ..fit.clone() }
}

/// `T = N/(A F)` and how its polynomials depend on the coefficients, in the model's order.
struct ClosedLoop {
    nk: usize,
    n: Vec<f64>,
    m: Vec<f64>,
    /// Slope of `N` and of `M` with each coefficient.
    slopes: Vec<(Vec<f64>, Vec<f64>)>,
}

/// Numerator and denominator of the plant, and the slope of each coefficient with each of the closed loop.
struct RawPlant {
    num: Vec<f64>,
    den: Vec<f64>,
    num_slopes: Vec<Vec<f64>>,
    den_slopes: Vec<Vec<f64>>,
}

impl ClosedLoop {
    fn new(equation: &PolynomialEquation) -> Self {
        let monic = |p: &[f64]| -> Vec<f64> { std::iter::once(1.0).chain(p.iter().copied()).collect() };
        let (a, f) = (monic(&equation.a[0]), monic(&equation.f[0]));
        let n = equation.delayed_b(0);
        let m = multiply(&a, &f);
        let power = |i: usize| -> Vec<f64> { std::iter::repeat_n(0.0, i).chain([1.0]).collect() };
        let nothing = Vec::new;
        let of_a = (1..a.len()).map(|i| (nothing(), multiply(&power(i), &f)));
        let of_b = (0..equation.b[0].len()).map(|i| (power(equation.nk[0] + i), nothing()));
        let of_noise = (0..equation.c.len() + equation.d.len()).map(|_| (nothing(), nothing()));
        let of_f = (1..f.len()).map(|i| (nothing(), multiply(&power(i), &a)));
        let slopes = of_a.chain(of_b).chain(of_noise).chain(of_f).collect();
        ClosedLoop { nk: equation.nk[0], n, m, slopes }
    }

    fn plant(&self, p: &[f64], q: &[f64]) -> RawPlant {
        let num_length = (self.n.len() + q.len()).saturating_sub(1);
        let den_length = (self.m.len() + q.len() - 1).max((self.n.len() + p.len()).saturating_sub(1));
        let ratio = |n: &[f64], m: &[f64]| {
            (combine(num_length, &multiply(n, q), &[]), combine(den_length, &multiply(m, q), &multiply(n, p)))
        };
        let (num, den) = ratio(&self.n, &self.m);
        let slopes: Vec<_> = self.slopes.iter().map(|(n, m)| ratio(n, m)).collect();
        let num_slopes = (0..num_length).map(|i| slopes.iter().map(|s| s.0[i]).collect()).collect();
        let den_slopes = (0..den_length).map(|i| slopes.iter().map(|s| s.1[i]).collect()).collect();
        RawPlant { num, den, num_slopes, den_slopes }
    }
}

/// The difference of two polynomials in `q⁻¹`, so many coefficients long.
fn combine(length: usize, plus: &[f64], minus: &[f64]) -> Vec<f64> {
    let at = |p: &[f64], i: usize| p.get(i).copied().unwrap_or(0.0);
    (0..length).map(|i| at(plus, i) - at(minus, i)).collect()
}
