//! Experiments to record next, in words.

use design::safety::Safety;
use report::next::{best, choices, recommendation};
use rig::ExperimentLabel;
use rig::results::Quantity;
use study::{Candidate, Gain, NextExperiments};

fn gain(quantity: Quantity, now: Option<f64>, then: f64) -> Gain {
    Gain { quantity, value: 100.0, now, then, is_enough_now: false }
}

fn candidate(label: ExperimentLabel, is_designed: bool, gains: Vec<Gain>) -> Candidate {
    let (speed_rpm, duration_s) = (1200.0, 60.0);
    Candidate { label, is_designed, speed_rpm, duration_s, peak_shaft_torque_nm: 100.0, safety: None, gains }
}

/// An experiment that was tried with two demands is one entry, which says what each of them buys.
#[test]
fn regress_an_experiment_with_two_demands_is_one_entry() {
    let candidates = vec![
        candidate(
            ExperimentLabel::MULTISINE_T_TN,
            true,
            vec![gain(Quantity::EngineInertia, None, 1.0), gain(Quantity::Stiffness, Some(10.0), 1.0)],
        ),
        candidate(ExperimentLabel::MULTISINE_T_TN, false, vec![gain(Quantity::Stiffness, Some(10.0), 5.0)]),
        candidate(ExperimentLabel::BS_T_NT, false, vec![gain(Quantity::Stiffness, Some(10.0), 6.0)]),
        candidate(ExperimentLabel::STEP_T_TN, false, Vec::new()),
    ];
    let mut found = NextExperiments { now: Vec::new(), candidates, enough: 0.01, assumptions: Vec::new() };
    let labels: Vec<String> = choices(&found).iter().map(|choice| choice.candidate.label.to_string()).collect();
    assert_eq!(labels, ["Multisine_T_TN", "BS_T_NT", "Step_T_TN"]);
    assert_eq!(best(&found).len(), 2);
    assert_eq!(
        recommendation(&found),
        "Record Multisine_T_TN (designed for this shaft), 60 s at 1200 rpm next: it shows J_e, which no recording shows; K \
         becomes known within ± 1 % instead of ± 10 %. With the demand of the method, the same experiment gains: K becomes \
         known within ± 5 % instead of ± 10 %."
    );
    found.candidates[1].gains.clear();
    let words = recommendation(&found);
    assert!(words.ends_with("With the demand of the method, the same experiment gains nothing."), "{words}");
}

#[test]
fn regress_an_experiment_that_reaches_a_limit_is_not_recommended() {
    let gains = || vec![gain(Quantity::Stiffness, Some(10.0), 1.0)];
    let mut candidates = vec![
        candidate(ExperimentLabel::MULTISINE_T_TN, true, gains()),
        candidate(ExperimentLabel::MULTISINE_T_TN, false, gains()),
        candidate(ExperimentLabel::BS_T_NT, false, gains()),
    ];
    candidates[0].safety = Some(Safety::Unsafe);
    candidates[2].safety = Some(Safety::Unsafe);
    let mut found = NextExperiments { now: Vec::new(), candidates, enough: 0.01, assumptions: Vec::new() };
    assert_eq!(best(&found).len(), 1);
    let words = recommendation(&found);
    assert!(words.starts_with("Record Multisine_T_TN, 60 s"), "{words}");
    assert!(words.contains("Not recommended: Multisine_T_TN (designed for this shaft)"), "{words}");
    assert!(words.contains("the same experiment reaches a limit of the bench"), "{words}");
    found.candidates[1].safety = Some(Safety::Unsafe);
    let words = recommendation(&found);
    assert!(best(&found).is_empty() && words.starts_with("Not recommended:"), "{words}");
}

/// Half an interval of 0.87 % became one of 29 % without a word.
#[test]
fn regress_a_number_that_gets_worse_is_said_and_ranks_lower() {
    let spoiled = Gain { is_enough_now: true, ..gain(Quantity::ResonanceFrequency, Some(0.87), 29.0) };
    let spoiling =
        candidate(ExperimentLabel::RAMP_N_NT, false, vec![gain(Quantity::Stiffness, Some(10.0), 1.0), spoiled]);
    let other = candidate(ExperimentLabel::BS_T_NT, false, vec![gain(Quantity::Stiffness, Some(10.0), 2.0)]);
    assert!(spoiling.worth(0.01) < other.worth(0.01));
    let found = NextExperiments { now: Vec::new(), candidates: vec![spoiling], enough: 0.01, assumptions: Vec::new() };
    let words = recommendation(&found);
    let said = "In a study with it f_r becomes known within ± 29 % instead of ± 0.87 %: keep a study without it.";
    assert!(words.ends_with(said), "{words}");
}
