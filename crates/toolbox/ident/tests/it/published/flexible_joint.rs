//! A rotary joint with a spring: the deflection of the arm from the angle of the base, under feedback.

use ident::{ChannelPair, FrequencyData, FrequencyGreyBox, ResponseFunction};
use signal::frf::LocalModel;
use signal::resample::decimate;
use signal::{Complex64, Signal};

use super::channels;

/// `α/θ = −g s²/(s² + 2 ζ ω s + ω²)`, published as ω = 13.45 rad/s and ζ = 0.05, by eye from a plot whose lines are
/// 0.16 rad/s apart.
#[test]
fn ref_flexible_joint_mode() {
    let Some(record) = channels("flexible-joint/Joint_SI_CL_40s_Data.mat", ["Theta", "Alpha"]) else { return };
    let [angle, deflection] = record.map(|x| decimate(&Signal::new(0.0, 0.002, x).unwrap(), 25).unwrap().samples);
    let local = LocalModel::polynomial(2, 1).estimate(&[&angle], &[&deflection], 0.05).unwrap();
    let whole = FrequencyData::of_local(&local, ChannelPair { output: 0, input: 0 }).unwrap();
    let data = whole.within(6.0, 30.0);
    let mode = |p: &[f64], w: f64| p[2] * w * w / Complex64::new(p[0] * p[0] - w * w, 2.0 * p[1] * p[0] * w);
    let start = ResponseFunction::new(&["frequency", "damping", "gain"], &[12.0, 0.1, -1.0], mode);
    let found = FrequencyGreyBox::default().fit(&start, &data).unwrap().fit.parameters();
    assert!((found[0] / 13.45 - 1.0).abs() < 0.015, "{found:?}");
    assert!((found[1] - 0.05).abs() < 0.005, "{found:?}");
}
