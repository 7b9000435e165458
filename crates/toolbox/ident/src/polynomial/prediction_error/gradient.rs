//! The analytic gradient against finite differences.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::borrow::Cow;

use proptest::prelude::*;

use super::evaluate::Evaluator;
use super::orders::Orders;
use super::segment::Segment;
use super::signals::Aim;
use fitting::nonlinear::SumOfSquares;

fn segment(rows: usize, seed: u64) -> Segment<'static> {
    let mut state = seed;
    let mut next = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1_u32 << 30) - 1.0
    };
    let mut signal = || Cow::Owned((0..rows).map(|_| next()).collect::<Vec<f64>>());
    Segment {
        inputs: vec![signal(), signal()],
        output: signal(),
        missing: vec![],
        impulse: None,
        experiment: 0,
        first: 0,
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn prop_gradient_is_the_slope_of_the_cost(
        na in 0_usize..3, nc in 0_usize..3, nd in 0_usize..3, nf in prop::array::uniform2(0_usize..3),
        nb in prop::array::uniform2(1_usize..3), nk in prop::array::uniform2(0_usize..3),
        estimate in any::<bool>(), simulate in any::<bool>(), seed in any::<u64>(),
        values in prop::collection::vec(-0.45_f64..0.45, 14),
    ) {
        let (nc, nd) = if simulate { (0, 0) } else { (nc, nd) };
        let orders = Orders { na, nb: nb.to_vec(), nc, nd, nf: nf.to_vec(), nk: nk.to_vec() };
        let segments = [segment(150, seed), segment(1100, seed ^ 77)];
        let aim = if simulate { Aim::Simulation } else { Aim::Prediction };
        let mut evaluator = Evaluator::new(&orders, &segments, aim, estimate);
        let theta = &values[..orders.count()];
        let factor = evaluator.factor(theta).unwrap();
        let cost = evaluator.cost(theta).unwrap();
        let n = theta.len();
        // A direction of the initial state that moves the residuals by 1e-10 of the strongest is known to rounding over
        // 1e-10.
        let rounding = if estimate { 1e-6 } else { 1e-10 };
        prop_assert!((factor.col(n).squared_norm_l2() / cost - 1.0).abs() < rounding);
        for j in 0..n {
            let half_slope: f64 = (0..=j).map(|i| factor[(i, j)] * factor[(i, n)]).sum();
            let mut at = |step: f64| {
                let mut moved = theta.to_vec();
                moved[j] += step;
                evaluator.cost(&moved).unwrap()
            };
            let [wide, narrow] = [4e-6, 2e-6].map(|step| (at(step) - at(-step)) / (4.0 * step));
            // Along such a direction the cost may bend within a step: differences are no slope there, and depend on the
            // step.
            prop_assume!(!estimate || (wide - narrow).abs() < 1e-7 * cost);
            prop_assert!((half_slope - narrow).abs() < 1e-6 * cost, "{j}: {half_slope} {narrow}");
        }
    }
}

/// On 16 384 of 20 000 rows a root may lie farther out than on all; such a start once ended the estimate.
#[test]
fn regress_a_start_found_on_a_part_of_the_data_is_pulled_within_the_edge_of_all() {
    let orders = Orders { na: 0, nb: vec![1, 1], nc: 0, nd: 0, nf: vec![1, 2], nk: vec![1, 1] };
    let root = 1.0 + 1.0 / 18_000.0;
    let start = [1.0, 1.0, -root, -0.9, 0.2];
    let (part, all) = ([segment(16_384, 1)], [segment(20_000, 1)]);
    assert!(Evaluator::new(&orders, &part, Aim::Simulation, true).is_stable(&start));
    let mut whole = Evaluator::new(&orders, &all, Aim::Simulation, true);
    assert!(whole.cost(&start).is_err());
    let inside = whole.within_the_edge(&start);
    assert!(whole.cost(&inside).is_ok());
    assert!((inside[2] + 1.0).abs() < 2e-3, "{inside:?}");
    assert_eq!((&inside[..2], &inside[3..]), (&start[..2], &start[3..]));
}
