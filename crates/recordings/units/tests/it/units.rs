use std::f64::consts::TAU;

use proptest::prelude::*;
use units::{Quantity, RPM_RAD_S, UnitError, parse_unit, parse_unit_of, parse_value, si_spelling, spellings};

#[test]
fn exact_factors_of_every_spelling() {
    let cases: &[(&[&str], Quantity, f64)] = &[
        (
            &[
                "rpm", "RPM", "[rpm]", "1/min", "1 / min", "U/min", "r/min", "min-1", "min^-1", "min⁻¹", "rev/min",
                "Upm",
            ],
            Quantity::AngularSpeed,
            TAU / 60.0,
        ),
        (&["rad/s", "Rad/s", "rad/sec", "rad s^-1", "rad·s⁻¹"], Quantity::AngularSpeed, 1.0),
        (&["deg/s", "°/s"], Quantity::AngularSpeed, TAU / 360.0),
        (&["rev/s", "U/s"], Quantity::AngularSpeed, TAU),
        (&["Nm", "N.m", "N*m", "N·m", "N m", "N⋅m", "nm", "N-m", " NM "], Quantity::Torque, 1.0),
        (&["kNm", "kN·m"], Quantity::Torque, 1000.0),
        (&["lbf·ft", "ft-lb", "lb.ft", "ft·lbf", "lb-ft", "ft lb"], Quantity::Torque, 1.355_817_948_331_400_4),
        (&["%", "percent", "Prozent"], Quantity::Ratio, 0.01),
        (&["1", "-"], Quantity::Ratio, 1.0),
        (&["kg m²", "kg*m^2", "kgm2", "kg·m²", "kg.m2", "kg m**2", "Nms²"], Quantity::Inertia, 1.0),
        (&["g m²", "gm^2"], Quantity::Inertia, 1e-3),
        (&["kg cm²", "kgcm2", "kg*cm^2"], Quantity::Inertia, 1e-4),
        (&["Nm/rad", "N·m/rad"], Quantity::Stiffness, 1.0),
        (&["Nm s/rad", "Nm/(rad/s)", "N·m·s/rad"], Quantity::Damping, 1.0),
    ];
    for (texts, quantity, factor) in cases {
        for text in *texts {
            let unit = parse_unit(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!((unit.quantity, unit.factor), (*quantity, *factor), "{text}");
        }
    }
    assert_eq!(RPM_RAD_S * 60.0, TAU);
    assert_eq!(parse_unit("rpm").unwrap().to_si(3000.0), 3000.0 * RPM_RAD_S);
}

#[test]
fn exact_units_of_what_plays_no_role() {
    let si = |text: &str, value: f64| parse_unit(text).unwrap_or_else(|error| panic!("{text}: {error}")).to_si(value);
    for (text, value, quantity, expected) in [
        ("°C", 20.0, Quantity::Temperature, 293.15),
        ("degC", -273.15, Quantity::Temperature, 0.0),
        ("°F", 212.0, Quantity::Temperature, 373.15),
        ("kW", 1.5, Quantity::Power, 1500.0),
        ("PS", 1.0, Quantity::Power, 735.498_75),
        ("hp", 1.0, Quantity::Power, 745.699_871_582_270_2),
        ("mbar", 1013.25, Quantity::Pressure, 101_325.0),
        ("psi", 1.0, Quantity::Pressure, 6_894.757_293_168_361),
        ("°KW", 180.0, Quantity::Angle, std::f64::consts::PI),
        ("1/min/s", 60.0, Quantity::AngularAcceleration, TAU),
        ("kg/h", 3600.0, Quantity::MassFlow, 1.0),
        ("km/h", 36.0, Quantity::Speed, 10.0),
        ("ms", 250.0, Quantity::Time, 0.25),
        ("m s⁻¹", 1.0, Quantity::Speed, 1.0),
    ] {
        assert_eq!(parse_unit(text).unwrap().quantity, quantity, "{text}");
        assert!((si(text, value) - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{text}: {}", si(text, value));
    }
    assert!(!units::may_be_same("K", "°C") && units::may_be_same("degC", "℃"));
}

#[test]
fn regress_unknown_unit_suggests_the_closest() {
    let Err(UnitError::Unknown { text, closest }) = parse_unit("rmp") else { panic!() };
    assert_eq!(text, "rmp");
    assert!(closest.contains(&"rpm".to_owned()), "{closest:?}");
    let Err(UnitError::Unknown { closest, .. }) = parse_unit("kg m3") else { panic!() };
    assert_eq!(closest[0], "kg m²");
    assert!(parse_unit("Nmm²").unwrap_err().to_string().contains("closest known"));
    // Where the quantity is known, only its units can be meant.
    let Err(UnitError::Unknown { closest, .. }) = units::parse_unit_of("kg", Quantity::Inertia) else { panic!() };
    assert_eq!(closest[0], "kg m²", "{closest:?}");
    let Err(UnitError::Unknown { closest, .. }) = units::parse_value("12 kg", Quantity::Torque) else { panic!() };
    assert!(closest.iter().all(|unit| parse_unit(unit).unwrap().quantity == Quantity::Torque), "{closest:?}");
}

#[test]
fn regress_ambiguous_and_empty_units_are_refused() {
    assert!(matches!(parse_unit("Hz"), Err(UnitError::Ambiguous { .. })));
    assert!(parse_unit("1/s").unwrap_err().to_string().contains("rev/s or rad/s"));
    assert_eq!(parse_unit("  "), Err(UnitError::Empty));
}

#[test]
fn exact_values_with_units() {
    assert_eq!(parse_value("0.6 kg m²", Quantity::Inertia), Ok(0.6));
    assert_eq!(parse_value("6000 kg cm²", Quantity::Inertia), Ok(6000.0 * 1e-4));
    assert_eq!(parse_value("6000rpm", Quantity::AngularSpeed), Ok(6000.0 * RPM_RAD_S));
    assert_eq!(parse_value("-1.5e2 Nm", Quantity::Torque), Ok(-150.0));
    assert_eq!(parse_value("2 1/min", Quantity::AngularSpeed), Ok(2.0 * RPM_RAD_S));
    assert!(matches!(parse_value("400 Nm", Quantity::AngularSpeed), Err(UnitError::OtherQuantity { .. })));
    assert!(matches!(parse_value("Nm", Quantity::Torque), Err(UnitError::NotANumber { .. })));
    assert!(matches!(parse_value("inf Nm", Quantity::Torque), Err(UnitError::NotANumber { .. })));
    assert_eq!(parse_value("400", Quantity::Torque), Err(UnitError::Empty));
}

#[test]
fn regress_a_decimal_comma_is_named() {
    for (text, instead) in [("0,851 kgm2", "0.851 kgm2"), ("-1,5 kg m²", "-1.5 kg m²")] {
        let error = parse_value(text, Quantity::Inertia).unwrap_err();
        assert_eq!(error, UnitError::DecimalComma { text: text.to_owned(), instead: instead.to_owned() });
        assert!(error.to_string().contains("decimal comma"), "{error}");
    }
    assert!(matches!(units::parse_frequency_hz("18,5 Hz"), Err(UnitError::DecimalComma { .. })));
    assert!(matches!(parse_value("18, Hz", Quantity::Torque), Err(UnitError::Unknown { .. })));
}

#[test]
fn regress_unit_of_another_quantity_names_both() {
    let error = parse_unit_of("Nm", Quantity::AngularSpeed).unwrap_err().to_string();
    assert!(error.contains("torque") && error.contains("speed"), "{error}");
}

#[test]
fn prop_every_spelling_reads_as_itself() {
    for quantity in Quantity::ALL {
        assert_eq!(parse_unit(si_spelling(quantity)).unwrap().factor, 1.0);
        for spelling in spellings(quantity) {
            let unit = parse_unit(spelling).unwrap();
            assert_eq!((unit.spelling, unit.quantity), (spelling, quantity));
        }
    }
}

proptest! {
    #[test]
    fn prop_conversion_round_trips(value in -1e6..1e6_f64, which in 0_usize..5) {
        let unit = parse_unit(["rpm", "lbf ft", "kg cm²", "%", "deg/s"][which]).unwrap();
        let back = unit.from_si(unit.to_si(value));
        prop_assert!((back - value).abs() <= 1e-15 * value.abs().max(1e-300) * 4.0);
    }

    #[test]
    fn prop_case_and_space_do_not_matter(upper in any::<bool>(), spaces in "[ \t]{0,3}", which in 0_usize..6) {
        let text = ["rpm", "1/min", "Nm", "kg m²", "rad/s", "Nm/rad"][which];
        let changed = text.chars().map(|c| format!("{c}{spaces}")).collect::<String>();
        let changed = if upper { changed.to_uppercase() } else { changed.to_lowercase() };
        prop_assert_eq!(parse_unit(&changed).unwrap(), parse_unit(text).unwrap());
    }

    #[test]
    fn prop_any_text_is_answered(text in "\\PC{0,12}") {
        let _ = parse_unit(&text);
        let _ = parse_value(&text, Quantity::Torque);
    }

    #[test]
    fn prop_number_with_unit_is_read(value in -1e9..1e9_f64) {
        prop_assert_eq!(parse_value(&format!("{value} Nm"), Quantity::Torque), Ok(value));
        prop_assert_eq!(parse_value(&format!("{value:e}Nm"), Quantity::Torque), Ok(value));
    }
}
