//! Invariants.

use proptest::prelude::*;
use signal::derivative::{central_difference, integral_trapezoid};
use signal::resample::{Interpolation, interpolate_at};
use signal::{Signal, Sos};

proptest! {
    #[test]
    fn prop_lowpass_gain_is_one_at_rest_and_3_db_down_at_the_cut_off(order in 1_usize..12, relative in 0.01_f64..0.95) {
        let filter = Sos::butterworth_lowpass(order, relative * 50.0, 0.01).unwrap();
        prop_assert!((filter.response(0.0).re - 1.0).abs() < 1e-9);
        prop_assert!((filter.response(relative * 50.0).norm_sqr() - 0.5).abs() < 1e-6);
    }

    #[test]
    fn prop_stop_and_pass_of_a_band_add_up_in_power(order in 1_usize..5, low in 5.0_f64..20.0, width in 3.0_f64..20.0, freq in 0.5_f64..49.0) {
        let pass = Sos::butterworth_bandpass(order, low, low + width, 0.01).unwrap();
        let stop = Sos::butterworth_bandstop(order, low, low + width, 0.01).unwrap();
        prop_assert!((pass.response(freq).norm_sqr() + stop.response(freq).norm_sqr() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn prop_zero_phase_filter_commutes_with_reversal_inside(level in -5.0_f64..5.0, seed in 0_u64..1000) {
        let mut random = signal::excitation::Random::new(seed);
        let mut x = vec![level; 400];
        x[150..250].iter_mut().for_each(|v| *v += random.normal());
        let filter = Sos::butterworth_lowpass(3, 10.0, 0.01).unwrap();
        let forward = filter.filtfilt(&x).unwrap();
        x.reverse();
        let mut backward = filter.filtfilt(&x).unwrap();
        backward.reverse();
        prop_assert!(forward.iter().zip(&backward).all(|(a, b)| (a - b).abs() < 1e-9));
    }

    #[test]
    fn prop_interpolation_keeps_straight_lines(start in -10.0_f64..10.0, slope in -3.0_f64..3.0, position in 0.0_f64..99.0) {
        let x = Signal::new(0.0, 1.0, (0..100).map(|i| start + slope * f64::from(i)).collect()).unwrap();
        for method in [Interpolation::Linear, Interpolation::BandLimited] {
            let y = interpolate_at(&x, &[position], method).unwrap();
            prop_assert!((y[0] - start - slope * position).abs() < 1e-4 * (1.0 + slope.abs()));
        }
    }

    #[test]
    fn prop_difference_undoes_the_integral_of_a_line(a in -3.0_f64..3.0, b in -3.0_f64..3.0) {
        let x: Vec<f64> = (0..30).map(|i| a + b * 0.1 * f64::from(i)).collect();
        let back = central_difference(&integral_trapezoid(&x, 0.1, 7.0).unwrap(), 0.1).unwrap();
        prop_assert!(x.iter().zip(&back).all(|(p, q)| (p - q).abs() < 1e-9));
    }
}
