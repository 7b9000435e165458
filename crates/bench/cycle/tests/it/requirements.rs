use cycle::{CycleError, requirement, requirements};

#[test]
fn exact_every_set_states_paragraph_year_and_whether_it_was_seen() {
    for set in requirements().unwrap() {
        assert!(!set.paragraph.is_empty() && set.year > 2000, "{}", set.name);
        assert!(set.seen || set.note.contains("not seen"), "{} rests on a text that was not seen", set.name);
    }
}

#[test]
fn exact_limits_of_1065_514() {
    let set = requirement("1065.514").unwrap();
    let (speed, torque, power) = (set.speed.unwrap(), set.torque.unwrap(), set.power.unwrap());
    assert_eq!((speed.slope, torque.slope, power.slope), ([0.95, 1.03], [0.83, 1.03], [0.83, 1.03]));
    assert_eq!((speed.intercept.percent, torque.intercept.percent, power.intercept.percent), (10.0, 2.0, 2.0));
    let errors = (speed.standard_error.percent, torque.standard_error.percent, power.standard_error.percent);
    assert_eq!(errors, (5.0, 10.0, 10.0));
    assert_eq!((speed.determination, torque.determination, power.determination), (0.97, 0.85, 0.91));
    assert!(set.omission && set.work.is_none());
}

#[test]
fn regress_an_unknown_set_lists_those_there_are() {
    let error = requirement("86.1341").unwrap_err();
    assert!(matches!(&error, CycleError::UnknownRequirement { known, .. } if known.len() == 7), "{error}");
}
