//! The state equations of a model, stepped through an experiment.

use super::form::Form;
use crate::Experiment;

/// `[x; u]`, stepped through the records of one experiment.
pub(super) struct Stepper<'a> {
    form: &'a Form,
    inputs: Vec<&'a [f64]>,
    point: Vec<f64>,
    next: Vec<f64>,
}

impl<'a> Stepper<'a> {
    pub(super) fn new(form: &'a Form, experiment: &'a Experiment, x0: &[f64]) -> Self {
        let mut point = x0.to_vec();
        point.resize(form.states + form.inputs, 0.0);
        let inputs = (0..form.inputs).map(|k| experiment.input(k)).collect();
        Stepper { form, inputs, point, next: vec![0.0; form.states] }
    }

    /// Writes `C x + D u` at sample `t`.
    pub(super) fn output(&mut self, t: usize, y: &mut [f64]) {
        for (slot, input) in self.point[self.form.states..].iter_mut().zip(&self.inputs) {
            *slot = input[t];
        }
        self.form.output.product(&self.point, y);
    }

    /// `x ← A x + B u`.
    pub(super) fn advance(&mut self) {
        self.form.transition.product(&self.point, &mut self.next);
        self.point[..self.form.states].copy_from_slice(&self.next);
    }

    /// `x ← A x + B u + v`.
    pub(super) fn advance_corrected(&mut self, correction: &[f64]) {
        self.advance();
        for (x, v) in self.point.iter_mut().zip(correction) {
            *x += v;
        }
    }
}
