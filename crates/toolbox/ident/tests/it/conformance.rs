//! Every estimator passes the conformance suite.

use faer::mat;
use ident::{
    Ararx, Arma, Armax, Arx, ArxOrders, BoxJenkins, ContinuousTransferFunction, Dataset, Focus, GreyBox, GreyNoise,
    GreyParameter, ImpulseResponse, Iv4, OutputError, Polynomial, ProcessFit, ProcessSystem, RationalChannel,
    StateSpacePem, Structure, Subspace, TransferFunctionModel, Weighting,
};
use lti::{Innovations, LtiError, PolynomialEquation, PolynomialModel, ProcessModel, StateSpace};
use testkit::estimator::{Case, conform};
use testkit::system::{self, SAMPLE_TIME_S};

#[test]
fn exact_arx_conforms() {
    conform(&Case::new(|data: &Dataset| Arx::new(2, 2, 1).fit(data), &system::arx().unwrap(), SAMPLE_TIME_S));
}

#[test]
fn exact_arx_of_two_outputs_conforms() {
    let fit = |data: &Dataset| Arx::with_orders(ArxOrders::uniform(2, 2, 2, 2, 1)).fit(data);
    conform(&Case::new(fit, &system::arx_two_by_two().unwrap(), SAMPLE_TIME_S));
}

#[test]
fn exact_instrumental_variables_conform() {
    let fit = |data: &Dataset| Iv4::new(2, 2, 1).fit(data);
    conform(&Case::new(fit, &system::arx().unwrap(), SAMPLE_TIME_S));
}

#[test]
fn exact_armax_conforms() {
    let fit = |data: &Dataset| Armax::new(2, 2, 2, 2).fit(data);
    conform(&Case::new(fit, &system::armax().unwrap(), SAMPLE_TIME_S).iterative());
}

#[test]
fn exact_output_error_conforms() {
    let fit = |data: &Dataset| OutputError::new(2, 2, 1).fit(data);
    conform(&Case::new(fit, &system::output_error().unwrap(), SAMPLE_TIME_S).iterative());
}

/// The orders of [`system::output_error`] from two inputs.
fn two_inputs() -> PolynomialModel {
    let equation = PolynomialEquation {
        a: vec![vec![]],
        b: vec![vec![1.0, 0.5], vec![-0.4, 0.8]],
        nk: vec![1, 2],
        f: vec![vec![-1.5, 0.7], vec![-0.8, 0.3]],
        ..Default::default()
    };
    PolynomialModel::new(SAMPLE_TIME_S, vec![equation], mat![[0.25]]).unwrap()
}

#[test]
fn exact_output_error_of_two_inputs_conforms() {
    let fit = |data: &Dataset| OutputError::new(2, 2, [1, 2]).fit(data);
    conform(&Case::new(fit, &two_inputs(), SAMPLE_TIME_S).iterative());
}

#[test]
fn exact_box_jenkins_conforms() {
    let fit = |data: &Dataset| BoxJenkins::new(2, 1, 1, 2, 1).fit(data);
    conform(&Case::new(fit, &system::box_jenkins().unwrap(), SAMPLE_TIME_S).iterative());
}

#[test]
fn exact_ararx_conforms() {
    let fit = |data: &Dataset| Ararx::new(2, 2, 1, 1).fit(data);
    conform(&Case::new(fit, &system::ararx().unwrap(), SAMPLE_TIME_S).iterative());
}

/// Of a time series there is nothing to be had without noise.
#[test]
fn stat_arma_conforms() {
    let equation = PolynomialEquation { a: vec![vec![-1.2, 0.5]], c: vec![0.6], ..Default::default() };
    let truth = PolynomialModel::new(SAMPLE_TIME_S, vec![equation], mat![[0.04]]).unwrap();
    let case = Case::new(|data: &Dataset| Arma::new(2, 1).fit(data), &truth, SAMPLE_TIME_S).iterative();
    conform(&Case { exact_noise: 1.0, exact_tolerance: case.noisy_tolerance, ..case });
}

#[test]
fn exact_the_whole_polynomial_conforms() {
    let (a, b, f) = (vec![vec![-0.9]], vec![vec![1.0, 0.5]], vec![vec![0.6]]);
    let equation = PolynomialEquation { a, b, c: vec![0.7], d: vec![-0.3], f, nk: vec![1] };
    let truth = PolynomialModel::new(SAMPLE_TIME_S, vec![equation], mat![[0.04]]).unwrap();
    let fit = |data: &Dataset| Polynomial::new(1, 2, 1, 1, 1, 1).fit(data);
    conform(&Case::new(fit, &truth, SAMPLE_TIME_S).iterative());
}

#[test]
fn exact_dynamics_by_simulation_conform() {
    let fit = |data: &Dataset| BoxJenkins::new(2, 1, 1, 2, 1).with_focus(Focus::Simulation).fit(data);
    conform(&Case::new(fit, &system::box_jenkins().unwrap(), SAMPLE_TIME_S).iterative());
}

/// A truth that ends with the last tap.
#[test]
fn exact_impulse_responses_conform() {
    let equation = PolynomialEquation {
        a: vec![vec![]],
        b: vec![vec![1.0, 0.7, 0.4, 0.2, 0.05]],
        nk: vec![1],
        f: vec![vec![]],
        ..Default::default()
    };
    let truth = PolynomialModel::new(SAMPLE_TIME_S, vec![equation], mat![[0.04]]).unwrap();
    for options in [ImpulseResponse::new(5).delay(1), ImpulseResponse::new(5).delay(1).unregularised()] {
        let case = Case::new(|data: &Dataset| options.fit(data).map(|found| found.fit), &truth, SAMPLE_TIME_S);
        conform(&Case { exact_tolerance: 1e-6, same_tolerance: 1e-4, ..case });
    }
}

#[test]
fn exact_subspace_conforms_with_every_weighting() {
    for weighting in [Weighting::N4sid, Weighting::Moesp, Weighting::Cva] {
        let fit = |data: &Dataset| Subspace::new(2).with_weighting(weighting).fit(data);
        conform(&Case::new(fit, &system::arx().unwrap(), SAMPLE_TIME_S));
    }
}

#[test]
fn exact_subspace_of_two_inputs_and_outputs_conforms() {
    let fit = |data: &Dataset| Subspace::new(4).fit(data);
    conform(&Case::new(fit, &system::arx_two_by_two().unwrap(), SAMPLE_TIME_S));
}

#[test]
fn exact_state_space_by_prediction_errors_conforms() {
    let fit = |data: &Dataset| StateSpacePem::new(2).fit(data);
    conform(&Case::new(fit, &system::arx().unwrap(), SAMPLE_TIME_S).iterative());
}

#[test]
fn exact_state_space_by_simulation_conforms() {
    let fit = |data: &Dataset| StateSpacePem::new(2).with_focus(Focus::Simulation).fit(data);
    conform(&Case::new(fit, &system::output_error().unwrap(), SAMPLE_TIME_S).iterative());
}

#[test]
fn exact_state_space_of_two_inputs_and_outputs_by_prediction_errors_conforms() {
    let fit = |data: &Dataset| StateSpacePem::new(4).fit(data);
    conform(&Case::new(fit, &system::arx_two_by_two().unwrap(), SAMPLE_TIME_S).iterative());
}

#[test]
fn exact_continuous_transfer_function_of_two_inputs_conforms() {
    let first = RationalChannel::new(vec![1.0, 6.0], vec![1.2, 4.0], 0.0).unwrap();
    let second = RationalChannel::new(vec![3.0], vec![2.0], 0.0).unwrap();
    let truth = TransferFunctionModel::new(vec![first, second], 2, mat![[0.01]]).unwrap();
    let fit = |data: &Dataset| ContinuousTransferFunction::per_input(vec![1, 0], vec![2, 1]).fit(data);
    conform(&Case::new(fit, &truth, SAMPLE_TIME_S).iterative());
}

#[test]
fn exact_continuous_transfer_function_conforms() {
    let channel = RationalChannel::new(vec![1.0, 6.0], vec![1.2, 4.0], 0.0).unwrap();
    let truth = TransferFunctionModel::new(vec![channel], 1, mat![[0.01]]).unwrap();
    let fit = |data: &Dataset| ContinuousTransferFunction::new(1, 2).fit(data);
    conform(&Case::new(fit, &truth, SAMPLE_TIME_S).iterative());
}

#[test]
fn exact_process_model_conforms() {
    let process = ProcessModel::new(2.0).unwrap().with_lags(vec![0.5]).unwrap().with_delay(0.23).unwrap();
    let truth = ProcessSystem::new(vec![process], 1, mat![[0.01]]).unwrap();
    let options = ProcessFit::named("P1D").unwrap().with_delay_between(&[(0.0, 1.0)]);
    conform(&Case::new(|data: &Dataset| options.fit(data), &truth, SAMPLE_TIME_S).iterative());
}

/// The two masses of [`system::two_mass`]: both inertias, the stiffness and the damping of the shaft are wanted.
#[derive(Debug, Clone, PartialEq)]
struct TwoMass;

impl Structure for TwoMass {
    fn parameters(&self) -> Vec<GreyParameter> {
        let start = [("motor", 0.03), ("load", 0.04), ("stiffness", 300.0), ("damping", 0.1)];
        start.into_iter().map(|(name, value)| GreyParameter::new(name, value).within(1e-9, 1e15)).collect()
    }

    fn system(&self, p: &[f64]) -> Result<StateSpace, LtiError> {
        let (motor, load, stiffness, damping) = (p[0], p[1], p[2], p[3]);
        let a = mat![
            [0.0, 1.0, -1.0],
            [-stiffness / motor, -(damping + 0.1) / motor, damping / motor],
            [stiffness / load, damping / load, -(damping + 0.2) / load]
        ];
        let b = mat![[0.0, 0.0], [1.0 / motor, 0.0], [0.0, -1.0 / load]];
        StateSpace::continuous(a, b, mat![[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], faer::Mat::zeros(2, 2))
    }
}

#[test]
fn exact_grey_box_conforms() {
    let fit = |data: &Dataset| GreyBox::new(TwoMass).fit(data);
    conform(&Case::new(fit, &system::two_mass_sampled().unwrap(), 1e-3).iterative().in_fixed_units());
}

/// One state with process noise: `x(t+1) = a x + b u + k e`, `y = x + e`.
#[derive(Debug, Clone, PartialEq)]
struct Leaking;

impl Structure for Leaking {
    fn parameters(&self) -> Vec<GreyParameter> {
        [("a", 0.5), ("b", 0.5), ("k", 0.1)].into_iter().map(|(name, value)| GreyParameter::new(name, value)).collect()
    }

    fn system(&self, p: &[f64]) -> Result<StateSpace, LtiError> {
        StateSpace::discrete(mat![[p[0]]], mat![[p[1]]], mat![[1.0]], mat![[0.0]], SAMPLE_TIME_S)
    }

    fn noise(&self, p: &[f64]) -> GreyNoise {
        GreyNoise::Gain(mat![[p[2]]])
    }
}

#[test]
fn exact_grey_box_with_noise_conforms() {
    let system = Leaking.system(&[0.8, 1.5, 0.0]).unwrap();
    let truth = Innovations::new(system, mat![[0.4]], mat![[0.04]]).unwrap();
    let fit = |data: &Dataset| GreyBox::new(Leaking).fit(data);
    conform(&Case::new(fit, &truth, SAMPLE_TIME_S).iterative().in_fixed_units());
}
