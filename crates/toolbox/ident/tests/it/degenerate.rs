//! Data that cannot carry an estimate: it is refused, or it comes with the right doubt.

use faer::{Mat, mat};
use ident::{
    AnyModel, Armax, Arx, ArxOrders, BoxJenkins, ContinuousTransferFunction, Dataset, Doubt, Fit, GreyBox,
    GreyParameter, IdentError, Iv4, OutputError, ProcessFit, StateSpacePem, Structure, Subspace, Termination,
};
use lti::{LtiError, StateSpace};

use crate::noise::Noise;

type Estimator = fn(&Dataset) -> Result<Vec<Doubt>, IdentError>;

/// `y_i = 0.5 (q⁻¹)/(1 − 0.8 q⁻¹) (u_1 + … )+ e_i` for each output.
fn data(inputs: usize, outputs: usize) -> (Mat<f64>, Mat<f64>) {
    let mut noise = Noise::new(11);
    let u = Mat::from_fn(600, inputs, |_, _| noise.normal());
    let mut x = vec![0.0; 601];
    (0..600).for_each(|t| x[t + 1] = 0.8 * x[t] + 0.5 * (0..inputs).map(|k| u[(t, k)]).sum::<f64>());
    let y = Mat::from_fn(600, outputs, |t, _| x[t] + 0.1 * noise.normal());
    (u, y)
}

/// A first-order lag of one unknown time constant for any number of channels.
#[derive(Debug, Clone, PartialEq)]
struct Lag(usize, usize);

impl Structure for Lag {
    fn parameters(&self) -> Vec<GreyParameter> {
        vec![GreyParameter::new("pole", 0.5).within(0.0, 0.99), GreyParameter::new("gain", 0.4).within(-9.0, 9.0)]
    }

    fn system(&self, p: &[f64]) -> Result<StateSpace, LtiError> {
        let (inputs, outputs) = (self.0, self.1);
        let (b, c) = (Mat::from_fn(1, inputs, |_, _| p[1]), Mat::from_fn(outputs, 1, |_, _| 1.0));
        StateSpace::discrete(mat![[p[0]]], b, c, Mat::zeros(outputs, inputs), 0.1)
    }
}

fn arx_orders(data: &Dataset) -> ArxOrders {
    let (m, p) = (data.inputs(), data.outputs());
    let na = (0..p).map(|i| (0..p).map(|j| usize::from(i == j)).collect()).collect();
    ArxOrders { na, nb: vec![vec![1; m]; p], nk: vec![vec![1; m]; p] }
}

const ESTIMATORS: [(&str, Estimator); 10] = [
    ("arx", |d| Arx::with_orders(arx_orders(d)).fit(d).map(|f| f.doubts)),
    ("iv4", |d| Iv4::with_orders(arx_orders(d)).fit(d).map(|f| f.doubts)),
    ("oe", |d| OutputError::new(1, 1, 1).fit(d).map(|f| f.doubts)),
    ("armax", |d| Armax::new(1, 1, 1, 1).fit(d).map(|f| f.doubts)),
    ("bj", |d| BoxJenkins::new(1, 1, 1, 1, 1).fit(d).map(|f| f.doubts)),
    ("subspace", |d| Subspace::new(1).fit(d).map(|f| f.doubts)),
    ("ss", |d| StateSpacePem::new(1).fit(d).map(|f| f.doubts)),
    ("tf", |d| ContinuousTransferFunction::new(0, 1).fit(d).map(|f| f.doubts)),
    ("process", |d| ProcessFit::named("P1").unwrap().fit(d).map(|f| f.doubts)),
    ("grey box", |d| GreyBox::new(Lag(d.inputs(), d.outputs())).fit(d).map(|f| f.doubts)),
];

fn refused_or_doubted(data: &Dataset, leave_out: &[&str], is_meant: fn(&Doubt) -> bool) {
    for (name, estimate) in ESTIMATORS.iter().filter(|(name, _)| !leave_out.contains(name)) {
        if let Ok(doubts) = estimate(data) {
            assert!(doubts.iter().any(is_meant), "{name}: {doubts:?}");
        }
    }
}

#[test]
fn regress_identical_inputs_are_doubted() {
    let (u, y) = data(1, 1);
    for (gain, offset) in [(1.0, 0.0), (-3.0, 5.0)] {
        let twice = Mat::from_fn(600, 2, |t, k| if k == 0 { u[(t, 0)] } else { gain * u[(t, 0)] + offset });
        let data = Dataset::new(0.1, twice, y.clone()).unwrap();
        // The grey box knows how the inputs share their effect.
        refused_or_doubted(&data, &["grey box"], |d| matches!(d, Doubt::DependentInputs { input: 1 }));
    }
    let (u, y) = self::data(2, 1);
    let doubts = OutputError::new(1, 1, 1).fit(&Dataset::new(0.1, u, y).unwrap()).unwrap().doubts;
    assert!(doubts.is_empty(), "{doubts:?}");
}

#[test]
fn regress_values_too_small_to_square_are_doubted() {
    let (u, y) = data(1, 1);
    let tiny = |m: &Mat<f64>| Mat::from_fn(m.nrows(), m.ncols(), |i, j| 1e-200 * m[(i, j)]);
    for (u, y) in [(tiny(&u), tiny(&y)), (u.clone(), tiny(&y))] {
        let data = Dataset::new(0.1, u, y).unwrap();
        refused_or_doubted(&data, &[], |d| matches!(d, Doubt::NothingLeft { output: 0 }));
    }
}

#[test]
fn regress_outputs_that_are_multiples_of_each_other_are_doubted() {
    let (u, y) = data(1, 1);
    let twice = Mat::from_fn(600, 2, |t, i| (1.0 + i as f64) * y[(t, 0)]);
    let data = Dataset::new(0.1, u, twice).unwrap();
    // Output by output nothing is amiss: one gain cannot be both.
    refused_or_doubted(&data, &["grey box"], |d| matches!(d, Doubt::DependentOutputs { output: 1 }));
    let fit = Arx::with_orders(arx_orders(&data)).fit(&data).unwrap();
    assert_eq!(fit.loss, 0.0);
}

fn over_parametrised(nc: usize, nd: usize, seed: u64) -> Fit<AnyModel> {
    let mut noise = Noise::new(seed);
    let (u, e) = (noise.normals(500), noise.normals(500));
    let mut x = 0.0;
    let y: Vec<f64> = (0..500)
        .map(|t: usize| {
            x = 0.8 * x + if t > 0 { u[t - 1] } else { 0.0 };
            x + e[t]
        })
        .collect();
    BoxJenkins::new(1, nc, nd, 1, 1).fit(&Dataset::siso(1.0, &u, &y).unwrap()).unwrap().map(Into::into)
}

/// White noise described by polynomials that are too long: their roots cancel, and some wander to the unit circle.
#[test]
fn regress_a_root_at_the_unit_circle_is_named() {
    let (mut stopped, mut named) = (0, 0);
    for seed in 0..12 {
        let fit = over_parametrised(3, 3, seed);
        if fit.termination != Termination::Edge {
            continue;
        }
        stopped += 1;
        assert!(!fit.termination.converged());
        let at_edge = |d: &Doubt| matches!(d, Doubt::RootAtEdge { output: 0, polynomial: 'C', input: None, .. });
        named += usize::from(fit.doubts.iter().any(at_edge));
        let is_near = |d: &Doubt| !matches!(d, Doubt::RootAtEdge { magnitude, .. } if (magnitude - 1.0).abs() > 0.031);
        assert!(fit.doubts.iter().all(is_near), "{:?}", fit.doubts);
    }
    assert!(stopped > 0 && named == stopped, "{stopped} {named}");
}

/// As text holds it, with six digits and a mean.
#[test]
fn regress_an_input_that_is_another_but_for_its_rounding_is_named() {
    let mut noise = Noise::new(8);
    let rounded = |v: f64| format!("{v:.5e}").parse::<f64>().unwrap();
    let u: Vec<f64> = noise.normals(400).iter().map(|v| rounded(v + 30.0)).collect();
    let y: Vec<f64> = (0..400).map(|t: usize| u[t.saturating_sub(1)] + 0.1 * noise.normal()).collect();
    let both = Mat::from_fn(400, 2, |t, k| if k == 0 { u[t] } else { rounded(2.0 * u[t] + 5.0) });
    let data = Dataset::new(0.1, both, Mat::from_fn(400, 1, |t, _| y[t])).unwrap();
    let said: Vec<String> = ident::advise(&data).iter().map(ToString::to_string).collect();
    let wanted = "input 2 is 2 times input 1 but for a constant, so that no data can separate their effects; leave one of them out";
    assert!(said.iter().any(|s| s == wanted), "{said:?}");
    // Inputs that differ by a hundredth are not the same.
    let apart = Mat::from_fn(400, 2, |t, k| if k == 0 { u[t] } else { u[t] + 0.01 * (t as f64).sin() });
    let data = Dataset::new(0.1, apart, Mat::from_fn(400, 1, |t, _| y[t])).unwrap();
    assert!(!ident::advise(&data).iter().any(|a| matches!(a, ident::Advice::Dependent { .. })));
}
