//! Poles and bands of fitted models that are not polynomials in `q⁻¹`.

use faer::{Mat, mat};
use ident::uncertainty::Dynamics;
use ident::{
    ContinuousTransferFunction, Dataset, Fit, GreyBox, GreyParameter, LinearModel, Parametric, RationalChannel,
    StateSpacePem, Structure, TransferFunctionModel,
};
use lti::{Complex64, LtiError, StateSpace, TimeGrid, TransferFunction};
use testkit::system::{self, SAMPLE_TIME_S};

/// How often the regions of an estimate held the truth.
#[derive(Debug, Default)]
struct Held {
    runs: usize,
    pole: usize,
    gain: usize,
    magnitude: usize,
    phase: usize,
    step: usize,
}

/// True values: a pole, the gains at some frequencies in rad/s, a step response on a grid.
struct Truth {
    pole: Complex64,
    omega: [f64; 3],
    gains: [Complex64; 3],
    grid: TimeGrid,
    step: Vec<f64>,
}

impl Held {
    fn count<M: Parametric + Dynamics + LinearModel>(&mut self, fit: &Fit<M>, truth: &Truth) {
        let inside = |(low, high): (f64, f64), value: f64| usize::from(low < value && value < high);
        let nearest = |a: &Complex64, b: &Complex64| (a - truth.pole).norm().total_cmp(&(b - truth.pole).norm());
        let poles = fit.poles(0, 0).unwrap();
        let pole = poles.iter().min_by(|a, b| nearest(&a.value, &b.value)).unwrap();
        let band = fit.frequency_band(0, 0, &truth.omega).unwrap();
        let step = fit.step_band(0, 0, &truth.grid).unwrap();
        self.runs += 1;
        self.pole += usize::from(pole.ellipse(0.95).contains(truth.pole));
        self.gain += usize::from(band.ellipses(0.95)[1].contains(truth.gains[1]));
        self.magnitude += inside(band.magnitude(0.95)[0], truth.gains[0].norm());
        // The phase unwrapped from the estimate's own start may differ by whole turns.
        let (low, high) = band.phase_deg(0.95)[2];
        let turns = ((0.5 * (low + high) - truth.gains[2].arg().to_degrees()) / 360.0).round();
        self.phase += inside((low, high), truth.gains[2].arg().to_degrees() + 360.0 * turns);
        self.step += inside(step.intervals(0.95)[9], truth.step[9]);
    }

    /// 95 % within three and a half deviations.
    fn assert_fair(&self) {
        let n = self.runs as f64;
        for count in [self.pole, self.gain, self.magnitude, self.phase, self.step] {
            assert!((count as f64 - 0.95 * n).abs() < 3.5 * (n * 0.95 * 0.05).sqrt(), "{self:?}");
        }
    }
}

const DELAY_S: f64 = 0.137;

fn delayed() -> TransferFunctionModel {
    let channel = RationalChannel::new(vec![1.0, 8.0], vec![1.2, 4.0], DELAY_S).unwrap();
    TransferFunctionModel::new(vec![channel], 1, mat![[0.01]]).unwrap()
}

#[test]
fn exact_dynamics_of_a_delayed_transfer_function_hold_its_delay_as_phase_alone() {
    let fit = ContinuousTransferFunction::new(1, 2)
        .with_delay_between(&[(0.0, 0.3)])
        .fit(&system::data(&delayed(), SAMPLE_TIME_S, 400, 1.0, 1).unwrap())
        .unwrap();
    let channel = fit.model.transfer_function(0, 0).unwrap();
    let omega = [0.5, 2.0, 9.0];
    let expected = channel.frequency_response(&omega).unwrap().response;
    assert_eq!(fit.frequency_band(0, 0, &omega).unwrap().response.response, expected);
    let plain = fit.model.system().unwrap().frequency_response(0, 0, &omega).unwrap().response;
    for ((h, g), w) in expected.iter().zip(&plain).zip(omega) {
        assert!((h - g * Complex64::cis(-w * channel.delay_s())).norm() < 1e-12 * h.norm());
    }
    let poles = fit.poles(0, 0).unwrap();
    assert_eq!((poles.len(), fit.zeros(0, 0).unwrap().len()), (2, 1));
    assert!(poles.iter().all(|p| p.value.re < 0.0 && p.covariance[0][0] > 0.0));
}

#[test]
#[ignore = "slow"]
fn stat_bands_of_a_delayed_transfer_function_cover() {
    let model = delayed();
    let omega = [0.5, 2.0, 4.0];
    let channel = model.transfer_function(0, 0).unwrap();
    let grid = TimeGrid { step_s: SAMPLE_TIME_S, points: 12 };
    let gains = channel.frequency_response(&omega).unwrap().response;
    let pole = *channel.poles().unwrap().iter().find(|p| p.im > 0.0).unwrap();
    let step = channel.step_response(&grid).unwrap();
    let truth = Truth { pole, omega, gains: gains.try_into().unwrap(), grid, step };
    let options = ContinuousTransferFunction::new(1, 2).with_delay_between(&[(0.05, 0.25)]);
    let mut held = Held::default();
    for seed in 0..200 {
        held.count(&options.fit(&system::data(&model, SAMPLE_TIME_S, 600, 1.0, seed).unwrap()).unwrap(), &truth);
    }
    held.assert_fair();
}

#[test]
#[ignore = "slow"]
fn stat_bands_of_a_state_space_estimate_cover() {
    let model = system::arx().unwrap();
    let omega = [1.0, 5.0, 9.0];
    let channel = model.transfer_function(0, 0).unwrap();
    let grid = TimeGrid { step_s: SAMPLE_TIME_S, points: 12 };
    let gains = channel.frequency_response(&omega).unwrap().response;
    let pole = *channel.poles().unwrap().iter().find(|p| p.im > 0.0).unwrap();
    let step = channel.step_response(&grid).unwrap();
    let truth = Truth { pole, omega, gains: gains.try_into().unwrap(), grid, step };
    let mut held = Held::default();
    for seed in 0..200 {
        let data = system::data(&model, SAMPLE_TIME_S, 600, 1.0, seed).unwrap();
        held.count(&StateSpacePem::new(2).fit(&data).unwrap(), &truth);
    }
    held.assert_fair();
}

/// `T ẋ = −x + g u(t − delay)`, all three wanted.
#[derive(Debug, Clone)]
struct Lag;

impl Structure for Lag {
    fn parameters(&self) -> Vec<GreyParameter> {
        let start = [("gain", 1.5, 0.1, 10.0), ("lag", 0.3, 0.01, 10.0), ("delay", 0.13, 0.11, 0.19)];
        start.into_iter().map(|(name, value, low, high)| GreyParameter::new(name, value).within(low, high)).collect()
    }

    fn system(&self, p: &[f64]) -> Result<StateSpace, LtiError> {
        StateSpace::continuous(mat![[-1.0 / p[1]]], mat![[p[0] / p[1]]], mat![[1.0]], Mat::zeros(1, 1))
    }

    fn input_delays_s(&self, p: &[f64]) -> Vec<f64> {
        vec![p[2]]
    }
}

#[test]
fn stat_bands_of_a_grey_box_with_a_delay_cover() {
    let channel = RationalChannel::new(vec![4.0], vec![2.0], 0.15).unwrap();
    let model = TransferFunctionModel::new(vec![channel], 1, mat![[0.01]]).unwrap();
    let omega = [0.5, 2.0, 4.0];
    let channel: TransferFunction = model.transfer_function(0, 0).unwrap();
    let grid = TimeGrid { step_s: SAMPLE_TIME_S, points: 12 };
    let gains = channel.frequency_response(&omega).unwrap().response.try_into().unwrap();
    let step = channel.step_response(&grid).unwrap();
    let truth = Truth { pole: Complex64::new(-2.0, 0.0), omega, gains, grid, step };
    let mut held = Held::default();
    for seed in 0..100 {
        let data: Dataset = system::data(&model, SAMPLE_TIME_S, 300, 1.0, seed).unwrap();
        held.count(&GreyBox::new(Lag).fit(&data).unwrap(), &truth);
    }
    held.assert_fair();
}
