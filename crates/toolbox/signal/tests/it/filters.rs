//! Filters against SciPy 1.17: `butter(order, edges, kind, fs=1000, output='sos')`, then `sosfiltfilt` and `sosfilt` of
//! the common record, at the samples 0, 1, 10, 30, 58, 59.

use signal::{SignalError, Sos};

use crate::{assert_close, record};

const AT: [usize; 6] = [0, 1, 10, 30, 58, 59];
const T: f64 = 1e-3;

fn check(filter: &Sos, zero_phase: [f64; 6], causal: [f64; 6]) {
    let both = filter.filtfilt(&record()).unwrap();
    let forward = filter.filter(&record(), &mut filter.state_at_rest());
    assert_close(&AT.map(|i| both[i]), &zero_phase, 1e-10);
    assert_close(&AT.map(|i| forward[i]), &causal, 1e-12);
}

#[test]
fn ref_lowpass_of_order_5_at_80_hz() {
    check(
        &Sos::butterworth_lowpass(5, 80.0, T).unwrap(),
        [
            0.49663676275072394,
            0.6495363615897788,
            0.3419351415937766,
            1.0120449757878545,
            0.597186506882691,
            0.7582186857560524,
        ],
        [
            0.00024471804306733485,
            0.002173146955822306,
            0.7747826584427611,
            1.1298845373075008,
            1.3450813252926888,
            1.071478146538228,
        ],
    );
}

#[test]
fn ref_highpass_of_order_2_at_30_hz() {
    check(
        &Sos::butterworth_highpass(2, 30.0, T).unwrap(),
        [
            0.03953592303603207,
            -0.21158940057872894,
            -0.051683001216725866,
            0.7365150277890055,
            -0.914982885635848,
            -0.11585783122217735,
        ],
        [
            0.43759154621906743,
            0.10367492771317438,
            -0.6974257264815091,
            -0.14902458548627062,
            -0.5512254206378011,
            0.3288002222625782,
        ],
    );
}

#[test]
fn ref_bandpass_of_order_3_at_50_to_200_hz() {
    check(
        &Sos::butterworth_bandpass(3, 50.0, 200.0, T).unwrap(),
        [
            -0.03834143084623917,
            -0.3051865206564147,
            0.15349978962974462,
            0.17623426487465985,
            -0.6288569982047172,
            -0.00724529156715098,
        ],
        [
            0.024766498178626594,
            0.09423930771320385,
            -0.3454111140594838,
            -0.6127535023100796,
            0.6099390830461152,
            0.5511586981746733,
        ],
    );
}

#[test]
fn ref_bandstop_of_order_2_at_100_to_220_hz() {
    check(
        &Sos::butterworth_bandstop(2, 100.0, 220.0, T).unwrap(),
        [
            0.5082152936828283,
            0.6299465151974333,
            0.23952803907134232,
            1.3479942737624704,
            0.4248789075734465,
            0.761647041894796,
        ],
        [
            0.2912588984950148,
            -0.02453562281830196,
            1.0348264908900595,
            1.3305917118147614,
            0.4164863166116547,
            0.5470779450301355,
        ],
    );
}

#[test]
fn exact_wide_band_with_real_poles_is_3_db_down_at_its_edges() {
    let filter = Sos::butterworth_bandpass(3, 1.0, 400.0, T).unwrap();
    for edge_hz in [1.0, 400.0] {
        assert!((filter.response(edge_hz).norm() - 0.5_f64.sqrt()).abs() < 1e-9);
    }
}

#[test]
fn exact_filtering_in_blocks_equals_filtering_at_once() {
    let filter = Sos::butterworth_lowpass(4, 60.0, T).unwrap();
    let x = record();
    let whole = filter.filter(&x, &mut filter.state_at_rest());
    let mut state = filter.state_at_rest();
    let parts = [&x[..17], &x[17..]].map(|part| filter.filter(part, &mut state)).concat();
    assert_eq!(whole, parts);
}

#[test]
fn exact_impossible_filters_are_refused() {
    assert!(matches!(Sos::butterworth_lowpass(2, 500.0, T), Err(SignalError::Cutoff { .. })));
    assert!(matches!(Sos::butterworth_lowpass(2, f64::NAN, T), Err(SignalError::Cutoff { .. })));
    assert!(matches!(Sos::butterworth_bandpass(2, 50.0, 40.0, T), Err(SignalError::Cutoff { .. })));
    assert!(matches!(Sos::butterworth_lowpass(0, 50.0, T), Err(SignalError::Parameter { .. })));
    assert!(matches!(Sos::butterworth_lowpass(2, 50.0, 0.0), Err(SignalError::SampleTime { .. })));
    let low = Sos::butterworth_lowpass(2, 50.0, T).unwrap();
    assert_eq!(low.filtfilt(&[0.0; 9]), Err(SignalError::TooShort { needed: 10, got: 9 }));
}
