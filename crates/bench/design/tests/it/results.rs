//! Checks and designs as documents.

use bench_model::model::ModelParameter;
use bench_testkit::documents::read_back;
use design::excitation_design::{
    DesignedExcitation, ExcitationDesign, LimitedQuantity, Peaks, PredictedParameter, SpectralLine,
};
use design::safety::{Checked, Proposal, Quantity, SafeSine, Safety, SafetyCheck, ThermalHint};
use rig::experiment::Waveform;
use signal::proportion::Proportion;

fn checked() -> SafetyCheck {
    let reached = Proportion::new(3, 200);
    SafetyCheck {
        checked: vec![Checked {
            of: Quantity::ShaftTorque,
            limit: Some(180.0),
            // One of the benches is not stable.
            values: vec![101.25, 120.0 / 7.0, f64::INFINITY],
            reached: Some(reached),
            worst: f64::INFINITY,
            worst_resonance_hz: Some(17.9),
        }],
        unstable: Proportion::new(1, 200),
        any: reached,
        unchecked: vec![Quantity::Power, Quantity::TimeAtResonance],
        safety: Safety::Risky,
        thermal: Some(ThermalHint { below_80_percent_s: 4.5, mean_loss: 0.1 }),
        sines: Some(Proposal {
            sines: vec![SafeSine { frequency_hz: 18.0, planned_nm: 20.0, reached, safe_nm: 12.0 }],
            holds: true,
        }),
    }
}

#[test]
fn exact_a_safety_check_is_read_as_it_was_written() {
    for check in [checked(), SafetyCheck { thermal: None, sines: None, ..checked() }] {
        assert_eq!(read_back(&SafetyCheck::DOCUMENT, &check), check);
    }
}

#[test]
fn exact_a_designed_experiment_is_read_as_it_was_written() {
    let parameter = PredictedParameter {
        parameter: ModelParameter::Stiffness,
        value: 2437.7,
        standard_error: 1.0 / 3.0,
        white_noise_standard_error: 0.7,
    };
    let designed = |waveform| DesignedExcitation {
        waveform,
        parameters: vec![parameter],
        covariance: vec![vec![1.0 / 9.0]],
        peaks: Peaks { shaft_torque_nm: 60.0, air_gap_torque_nm: 45.5, speed_rad_s: 3.2, demand: 40.0 },
        binding: LimitedQuantity::ShaftTorque,
        criterion: 1e-7,
    };
    let design = ExcitationDesign {
        multisine: designed(Waveform::Constant { value: 60.0 }),
        binary: designed(Waveform::Constant { value: 61.5 }),
        spectrum: vec![SpectralLine { frequency_hz: 17.5, amplitude: 8.25 }],
        duality_gap: 0.003,
        rounds: 41,
    };
    assert_eq!(read_back(&ExcitationDesign::DOCUMENT, &design), design);
}
