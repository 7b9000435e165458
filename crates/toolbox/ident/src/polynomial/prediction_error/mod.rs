//! Prediction-error estimation of polynomial models: ARMAX, output error, Box–Jenkins and everything between.

mod assemble;
mod equation;
mod evaluate;
mod excerpt;
#[cfg(test)]
mod gradient;
mod high_order_arx;
mod joint;
mod line;
mod noise_roots;
mod options;
mod orders;
mod quadratic_region;
mod reduced;
mod segment;
mod signals;
mod slower;
mod split;
mod stability_boundary;
mod start;
mod unseen_modes;

use lti::PolynomialModel;
use numerics::parallel;
use signal::filter::Sos;

pub use self::options::Polynomial;
use self::orders::Orders;
pub use self::orders::PerInput;
use crate::{Dataset, Fit, Focus, IdentError, NonlinearOptions};
use fitting::StructureError;

impl Polynomial {
    /// Orders of `A`, `B`, `C`, `D`, `F` and the delays; `nb`, `nf` and `nk` are one number, or one an input.
    pub fn new(
        na: usize,
        nb: impl Into<PerInput>,
        nc: usize,
        nd: usize,
        nf: impl Into<PerInput>,
        nk: impl Into<PerInput>,
    ) -> Self {
        Polynomial {
            na,
            nb: nb.into(),
            nc,
            nd,
            nf: nf.into(),
            nk: nk.into(),
            from_rest: false,
            focus: Focus::default(),
            prefilter: None,
            batches: None,
            held: Vec::new(),
            starts: Vec::new(),
            search: NonlinearOptions::default(),
        }
    }

    /// Takes inputs, outputs and noise as zero before each stretch of data. Otherwise the state that suits a stretch
    /// best is found by least squares, for every trial model.
    #[must_use]
    pub fn from_rest(self) -> Self {
        Polynomial { from_rest: true, ..self }
    }

    /// Which errors are made small; by default those of the prediction.
    #[must_use]
    pub fn with_focus(self, focus: Focus) -> Self {
        Polynomial { focus, ..self }
    }

    /// Finds the dynamics where this filter lets pass, such as a band around what matters: `B` and `F` from filtered
    /// prediction errors, whose noise model is thrown away, or from the simulated output under [`Focus::Simulation`]
    /// and wherever there is an `A`, since errors that the filter colours would take part in it. `C` and `D` are those
    /// that predict all of the data best with these dynamics; residuals and criteria are those of unfiltered data.
    ///
    /// # Source
    /// Ljung 1999, §14.4: a filter on the errors is a noise model `1/L` times as large, which a free noise model
    /// undoes.
    #[must_use]
    pub fn with_prefilter(self, prefilter: Sos) -> Self {
        Polynomial { prefilter: Some(prefilter), ..self }
    }

    /// Takes the covariance from the scatter between `batches` stretches of the data, two at least and each long
    /// against the memory of the residuals, right also where the residuals are coloured or change in size. It is what
    /// happens, with 30 stretches, to dynamics from filtered prediction errors. Otherwise the residuals of a noise
    /// model are taken as white, and those of an output-error model, or of dynamics that were found by simulation, as
    /// having the autocorrelation they show, independent of the inputs.
    #[must_use]
    pub fn robust(self, batches: usize) -> Self {
        Polynomial { batches: Some(batches), ..self }
    }

    /// Holds one coefficient at a value; its name is that of [`PolynomialModel::coefficient_names`], such as `f1`.
    #[must_use]
    pub fn hold(mut self, coefficient: impl Into<String>, value: f64) -> Self {
        self.held.push((coefficient.into(), value));
        self
    }

    /// Starts the search at these coefficients, in the order of [`Fit::parameters`], or at the best of several such; by
    /// default starting values are sought on the data. An output-error model starts with the numerators that suit the
    /// denominators given. For a scan of many structures that start at their neighbours, or a model that is known
    /// roughly: the minimum found is that nearest to the start, and need not be the lowest.
    ///
    /// # Example
    /// ```
    /// let u: Vec<f64> = (0..200).map(|t| if (t * t / 7) % 2 == 0 { 1.0 } else { -1.0 }).collect();
    /// let mut y = vec![0.0; 200];
    /// (1..200).for_each(|t| y[t] = 0.8 * y[t - 1] + 0.5 * u[t - 1]);
    /// let data = ident::Dataset::siso(0.1, &u, &y)?;
    /// let fit = ident::OutputError::new(1, 1, 1).starting_at(vec![vec![0.0, -0.7]]).fit(&data)?;
    /// assert!((fit.parameters()[1] + 0.8).abs() < 1e-9);
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    #[must_use]
    pub fn starting_at(self, starts: Vec<Vec<f64>>) -> Self {
        Polynomial { starts, ..self }
    }

    /// How far and how exactly to search.
    #[must_use]
    pub fn with_search(self, search: NonlinearOptions) -> Self {
        Polynomial { search, ..self }
    }

    /// Estimates the model.
    ///
    /// Every equation is estimated by itself: consistent whatever the noise of the outputs has in common, and efficient
    /// where it has nothing. The covariance is that of all equations together, with what they share of the noise.
    /// `initial_states` belong to [`PolynomialModel::innovations`]; zero stands for an experiment whose first sample is
    /// missing.
    ///
    /// # Errors
    /// [`IdentError::Structure`] for orders that make no model, a held coefficient that there is not, or a simulation
    /// or prefilter without inputs; [`IdentError::Length`] for orders of another number of inputs, or a start of
    /// another number of coefficients; [`IdentError::NotFinite`] for a start or a held value that is no number;
    /// [`IdentError::TooFewSamples`]; [`IdentError::RankDeficient`] where the data do not determine every coefficient.
    ///
    /// # Example
    /// ```
    /// // y(t) = 0.5/(1 − 0.8 q⁻¹) u(t−1)
    /// let u: Vec<f64> = (0..200).map(|t| if (t * t / 7) % 2 == 0 { 1.0 } else { -1.0 }).collect();
    /// let mut y = vec![0.0; 200];
    /// (1..200).for_each(|t| y[t] = 0.8 * y[t - 1] + 0.5 * u[t - 1]);
    /// let fit = ident::OutputError::new(1, 1, 1).fit(&ident::Dataset::siso(0.1, &u, &y)?)?;
    /// let [b, f] = fit.parameters()[..] else { unreachable!() };
    /// assert!((b - 0.5).abs() < 1e-9 && (f + 0.8).abs() < 1e-9);
    /// # Ok::<(), ident::IdentError>(())
    /// ```
    pub fn fit(&self, data: &Dataset) -> Result<Fit<PolynomialModel>, IdentError> {
        let orders = self.orders(data.inputs())?;
        let held = self.held_coefficients(&orders, data)?;
        self.check_starts(orders.count() * data.outputs())?;
        let one = |output: &usize| equation::estimate(self, &orders, data, *output, &held[*output]);
        let equations = parallel::map(&Vec::from_iter(0..data.outputs()), one);
        let fit = assemble::fit(&orders, data, equations.into_iter().collect::<Result<_, _>>()?)?;
        // A noise model takes care of feedback; without one, and beside dynamics found by simulation, nothing does.
        let has_noise_model = orders.na + orders.nc + orders.nd > 0 && self.focus == Focus::Prediction;
        let fit = if has_noise_model { fit } else { fit.doubting_feedback(data) };
        Ok(fit.made_by(self.focus.method(), data))
    }

    fn orders(&self, inputs: usize) -> Result<Orders, IdentError> {
        let orders = Orders {
            na: self.na,
            nb: self.nb.spread("orders nb", inputs)?,
            nc: self.nc,
            nd: self.nd,
            nf: self.nf.spread("orders nf", inputs)?,
            nk: self.nk.spread("delays nk", inputs)?,
        };
        if orders.nb.contains(&0) {
            return Err(StructureError::NoNumerator.into());
        }
        if inputs == 0 && (self.prefilter.is_some() || self.focus == Focus::Simulation) {
            return Err(StructureError::NoDynamics.into());
        }
        if orders.count() == 0 {
            return Err(StructureError::NoParameters.into());
        }
        Ok(orders)
    }

    fn check_starts(&self, count: usize) -> Result<(), IdentError> {
        for start in &self.starts {
            if start.len() != count {
                let what = "coefficients to start at";
                return Err(IdentError::Length { what, expected: count, found: start.len() });
            }
            if let Some(index) = start.iter().position(|value| !value.is_finite()) {
                return Err(IdentError::NotFinite { what: "the value of a coefficient to start at", index });
            }
        }
        Ok(())
    }

    /// For each equation, the coefficients held and their values.
    fn held_coefficients(&self, orders: &Orders, data: &Dataset) -> Result<Vec<Vec<(usize, f64)>>, IdentError> {
        let zeros = vec![vec![0.0; orders.count()]; data.outputs()];
        let names = assemble::model(orders, data, &zeros)?.coefficient_names();
        let mut held = vec![Vec::new(); data.outputs()];
        for (name, value) in &self.held {
            let Some(index) = names.iter().position(|n| n == name) else {
                return Err(StructureError::UnknownParameter { name: name.clone(), parameters: names }.into());
            };
            if !value.is_finite() {
                return Err(IdentError::NotFinite { what: "the value of a coefficient to be held", index });
            }
            held[index / orders.count()].push((index % orders.count(), *value));
        }
        Ok(held)
    }
}

/// `A y = Σ B_k u_k + C e`.
#[derive(Debug)]
pub struct Armax;

impl Armax {
    /// The orders of `A`, `B_k`, `C` and the delays.
    ///
    /// # Example
    /// ```
    /// let options = ident::Armax::new(2, 2, 2, 1);
    /// assert_eq!(options, ident::Polynomial::new(2, 2, 2, 0, 0, 1));
    /// ```
    #[allow(clippy::new_ret_no_self, reason = "a member of the family has the family's options")]
    pub fn new(na: usize, nb: impl Into<PerInput>, nc: usize, nk: impl Into<PerInput>) -> Polynomial {
        Polynomial::new(na, nb, nc, 0, 0, nk)
    }
}

/// `A y = Σ B_k u_k + 1/D e`.
#[derive(Debug)]
pub struct Ararx;

impl Ararx {
    /// The orders of `A`, `B_k`, `D` and the delays.
    #[allow(clippy::new_ret_no_self, reason = "a member of the family has the family's options")]
    pub fn new(na: usize, nb: impl Into<PerInput>, nd: usize, nk: impl Into<PerInput>) -> Polynomial {
        Polynomial::new(na, nb, 0, nd, 0, nk)
    }
}

/// `y = Σ B_k/F_k u_k + e`.
#[derive(Debug)]
pub struct OutputError;

impl OutputError {
    /// The orders of `B_k`, `F_k` and the delays.
    #[allow(clippy::new_ret_no_self, reason = "a member of the family has the family's options")]
    pub fn new(nb: impl Into<PerInput>, nf: impl Into<PerInput>, nk: impl Into<PerInput>) -> Polynomial {
        Polynomial::new(0, nb, 0, 0, nf, nk)
    }
}

/// `y = Σ B_k/F_k u_k + C/D e`.
#[derive(Debug)]
pub struct BoxJenkins;

impl BoxJenkins {
    /// The orders of `B_k`, `C`, `D`, `F_k` and the delays.
    #[allow(clippy::new_ret_no_self, reason = "a member of the family has the family's options")]
    pub fn new(
        nb: impl Into<PerInput>,
        nc: usize,
        nd: usize,
        nf: impl Into<PerInput>,
        nk: impl Into<PerInput>,
    ) -> Polynomial {
        Polynomial::new(0, nb, nc, nd, nf, nk)
    }
}

/// `A y = C e`, for a time series without input.
#[derive(Debug)]
pub struct Arma;

impl Arma {
    /// The orders of `A` and `C`.
    #[allow(clippy::new_ret_no_self, reason = "a member of the family has the family's options")]
    pub fn new(na: usize, nc: usize) -> Polynomial {
        Polynomial::new(na, [], nc, 0, [], [])
    }
}
