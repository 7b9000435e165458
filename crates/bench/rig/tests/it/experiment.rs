//! Plans from the catalogue, and from demands of one's own.

use recording::{Channel, Format, Raster, Recording};
use rig::ExperimentLabel;
use rig::experiment::catalogue::{self, CatalogueError, Settings};
use rig::experiment::free_form::{self, FreeFormError};
use rig::experiment::{DEMAND_HOLD_S, DemandKind, Demands, ExperimentPlan, Waveform};
use units::RPM_RAD_S;

fn settings(name: &str, given: &[(&str, &str)]) -> Result<Settings, CatalogueError> {
    Settings::parse(&catalogue::find(name)?.parameters(), given)
}

fn plan(name: &str, given: &[(&str, &str)]) -> Result<ExperimentPlan, CatalogueError> {
    catalogue::find(name)?.plan(&settings(name, given)?)
}

/// Name, unit, stamps and samples of a channel.
type Given<'a> = (&'a str, &'a str, &'a [f64], &'a [f64]);

/// A recording of channels, each on a raster of its own.
fn recording(channels: &[Given<'_>]) -> Recording {
    let raster = |(_, _, time_s, _): &Given<'_>| Raster { time_s: time_s.to_vec(), name: None };
    let channel = |(raster, (name, unit, _, samples)): (usize, &Given<'_>)| Channel {
        name: (*name).to_owned(),
        unit: (*unit).to_owned(),
        comment: String::new(),
        raster,
        samples: samples.to_vec(),
    };
    Recording {
        format: Format::Csv { delimiter: ',', decimal_comma: false },
        comment: None,
        start_time: None,
        rasters: channels.iter().map(raster).collect(),
        channels: channels.iter().enumerate().map(channel).collect(),
        findings: Vec::new(),
    }
}

fn free(file: &str, recording: &Recording, given: &[(&str, &str)]) -> Result<ExperimentPlan, FreeFormError> {
    let settings = Settings::parse(free_form::PARAMETERS, given)?;
    Ok(free_form::plan(file, recording, &settings)?.plan)
}

#[test]
fn exact_defaults_are_those_of_the_method() {
    type Constructor = fn(f64, f64) -> ExperimentPlan;
    let made: [(&str, Constructor); 8] = [
        ("BS_T_NT", ExperimentPlan::bs_t_nt),
        ("WhiteNoise_T_TN", ExperimentPlan::white_noise_t_tn),
        ("Step_T_TN", ExperimentPlan::step_t_tn),
        ("Ramp_N_NT", ExperimentPlan::ramp_n_nt),
        ("Levels_N_NT", ExperimentPlan::levels_n_nt),
        ("Unfired_N_NT", ExperimentPlan::unfired_n_nt),
        ("Sine_T_TN", ExperimentPlan::sine_t_tn),
        ("NoShaft_N_NT", ExperimentPlan::no_shaft_n_nt),
    ];
    for (name, constructor) in made {
        assert_eq!(plan(name, &[("speed", "1500"), ("duration", "40")]).unwrap(), constructor(1500.0, 40.0), "{name}");
    }
}

#[test]
fn prop_every_template_gives_a_plan_of_its_label_at_the_ends_of_its_ranges() {
    for template in catalogue::all() {
        let name = template.label().to_string();
        assert_eq!(name.parse::<ExperimentLabel>().unwrap(), template.label());
        assert_eq!(plan(&name, &[]).unwrap().label, template.label());
        for parameter in template.parameters() {
            assert!((parameter.lowest..=parameter.highest).contains(&parameter.default), "{name} {}", parameter.name);
            for edge in [parameter.lowest, parameter.highest] {
                // Either a plan that can be, or a refusal in words; never a panic, never NaN.
                if let Ok(plan) = plan(&name, &[(parameter.name, &edge.to_string())]) {
                    assert!(plan.check().is_ok(), "{name} {} = {edge}", parameter.name);
                }
            }
        }
    }
}

#[test]
fn exact_settings_reach_the_waveform() {
    let plan = plan("bs_t_nt", &[("low", "30"), ("HIGH", "70 Nm"), ("clock", "0.2 s"), ("settling", "5")]).unwrap();
    assert_eq!(plan.engine_torque_nm, Waveform::RandomBinary { low: 30.0, high: 70.0, clock_s: 0.2 });
    assert_eq!(plan.settling_s, 5.0);
}

#[test]
fn regress_wrong_settings_are_refused_in_words() {
    let words = |name: &str, given: &[(&str, &str)]| plan(name, given).unwrap_err().to_string();
    assert!(words("BS_N_NT", &[]).contains("did you mean `BS_T_NT`"));
    assert!(words("BS_T_NT", &[("hgih", "1")]).contains("did you mean `high`"));
    assert!(words("BS_T_NT", &[("low", "35 rpm")]).contains("no number in Nm"));
    assert!(words("BS_T_NT", &[("low", "nan")]).contains("no number"));
    assert!(words("BS_T_NT", &[("low", "1"), ("low", "2")]).contains("given twice"));
    assert!(words("Sine_T_TN", &[("highest", "90")]).contains("outside 0.01 … 45"));
    assert!(words("Sine_T_TN", &[("lowest", "30")]).contains("lowest = 30 lies above highest = 20"));
    assert!(words("Multisine", &[]).contains("no experiment `Multisine`"), "two have this name");
    assert!(words("Multisine_T_TN", &[("period", "0.1"), ("highest", "5")]).contains("0 lines"));
}

#[test]
fn exact_multisine_has_its_root_mean_square_and_repeats() {
    for rounds in ["0", "50"] {
        let plan = plan("Multisine_T_TN", &[("rms", "9"), ("rounds", rounds), ("duration", "20")]).unwrap();
        let torque = Demands::of(&plan, 1, DEMAND_HOLD_S).dyno_torque_nm;
        let deviation = |x: &f64| x - 60.0;
        let power = torque[10_000..].iter().map(|x| deviation(x).powi(2)).sum::<f64>() / 10_000.0;
        assert!((power.sqrt() - 9.0).abs() < 1e-9, "{}", power.sqrt());
        // The bench settles at the mean, which takes the place of the first value.
        assert!((torque[0] - 60.0).abs() < 1e-9 && torque[10_000] != 60.0);
        assert!(torque[10..10_000] == torque[10_010..], "the period repeats");
        let peak = torque.iter().map(|x| deviation(x).abs()).fold(0.0, f64::max);
        assert!(peak / 9.0 < if rounds == "0" { 2.1 } else { 1.75 }, "{rounds}: crest {}", peak / 9.0);
    }
}

#[test]
fn exact_speeds_run_straight_and_torques_are_held() {
    let stamps = [10.0, 10.5, 11.0];
    let given = recording(&[
        ("dyno_speed_demand", "rpm", &stamps, &[1000.0, 1100.0, 1100.0]),
        ("engine_torque_demand", "", &stamps, &[40.0, 50.0, 60.0]),
    ]);
    let plan = free("cycle.csv", &given, &[]).unwrap();
    assert_eq!((plan.label.to_string().as_str(), plan.duration_s), ("FreeForm_T_NT", 1.5));
    let demands = Demands::of(&plan, 1, DEMAND_HOLD_S);
    let rpm = |k: usize| demands.speed_rad_s[k] / RPM_RAD_S;
    assert!((rpm(0) - 1000.0).abs() < 1e-9 && (rpm(250) - 1050.0).abs() < 1e-9 && (rpm(1400) - 1100.0).abs() < 1e-9);
    assert_eq!(
        [0, 499, 500, 999, 1000, 1499].map(|k| demands.engine_torque_nm[k]),
        [40.0, 40.0, 50.0, 50.0, 60.0, 60.0]
    );
}

#[test]
fn exact_a_plan_written_down_is_the_plan() {
    for name in ["BS_T_NT", "WhiteNoise_T_TN", "Levels_N_NT", "Unfired_N_NT", "NoShaft_N_NT", "Multisine_T_TN"] {
        let planned = plan(name, &[("duration", "3.017")]).unwrap();
        let demands = Demands::of(&planned, 7, DEMAND_HOLD_S);
        let written = demands.recording(&planned);
        let again = free(&format!("{name}_1200.csv"), &written, &[]).unwrap();
        assert_eq!(
            (&again.label, again.is_motored, again.has_shaft),
            (&planned.label, planned.is_motored, planned.has_shaft)
        );
        let back = Demands::of(&again, 1, DEMAND_HOLD_S);
        for (one, other) in demands.named(&planned).iter().zip(back.named(&again)) {
            assert_eq!((one.kind, one.values.len()), (other.kind, other.values.len()), "{name}");
            let worst = one.values.iter().zip(other.values).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(worst < 1e-12, "{name} {}: {worst}", one.kind.name());
        }
    }
}

#[test]
fn regress_demands_that_are_none_are_refused_in_words() {
    let t = [0.0, 1.0, 2.0];
    let ones = [1.0; 3];
    let words = |channels: &[Given<'_>]| free("x.csv", &recording(channels), &[]).unwrap_err().to_string();
    assert!(words(&[("DynoSpeedDemand", "rpm", &t, &ones)]).contains("may be meant as `dyno_speed_demand`"));
    assert!(words(&[("dyno_torque_demand", "Nm", &t, &ones)]).contains("engine_speed_demand"));
    assert!(words(&[("dyno_speed_demand", "rpm", &t, &ones)]).contains("engine_torque_demand"));
    let both: &[Given<'_>] = &[("dyno_speed_demand", "rpm", &t, &ones), ("dyno_torque_demand", "Nm", &t, &ones)];
    assert!(words(both).contains("exclude each other"));
    let torque = ("dyno_torque_demand", "Nm", &t[..], &ones[..]);
    assert!(words(&[("engine_speed_demand", "Nm", &t, &ones), torque]).contains("unit of torque"));
    assert!(words(&[("engine_speed_demand", "rpm", &t, &[1.0, f64::NAN, 1.0]), torque]).contains("no value at 1 s"));
    assert!(words(&[("engine_speed_demand", "rpm", &[0.0, 2.0, 1.0], &ones), torque]).contains("1 s after 2 s"));
    assert!(words(&[("engine_speed_demand", "rpm", &t, &[1e9; 3]), torque]).contains("outside"));
    let error = free("BS_T_NT.csv", &recording(&[("engine_speed_demand", "rpm", &t, &ones), torque]), &[]);
    assert!(error.unwrap_err().to_string().contains("BS_T_NT, but its demands are those of TN"));
    let instant = recording(&[("engine_speed_demand", "rpm", &t[..1], &ones[..1])]);
    let error = free("x.csv", &instant, &[]).unwrap_err();
    assert!(matches!(error, FreeFormError::NoLength), "{error}");
}

#[test]
fn exact_constant_speed_beside_torques_of_ones_own() {
    let given =
        recording(&[("dyno_torque_demand", "kNm", &[0.0, 0.01], &[0.05, 0.06]), ("oil", "°C", &[0.0], &[90.0])]);
    let settings = Settings::parse(free_form::PARAMETERS, &[("speed", "2000"), ("duration", "1")]).unwrap();
    let free_form = free_form::plan("mine.mf4", &given, &settings).unwrap();
    assert_eq!(free_form.ignored, ["oil"]);
    let demands = Demands::of(&free_form.plan, 1, DEMAND_HOLD_S);
    assert_eq!(demands.speed_rad_s, vec![2000.0 * RPM_RAD_S; 1000]);
    assert_eq!(
        (demands.dyno_torque_nm[9], demands.dyno_torque_nm[10], demands.dyno_torque_nm[999]),
        (50.0, 60.0, 60.0)
    );
    assert_eq!(DemandKind::ALL.len(), 7);
}

#[test]
fn regress_letter_case_of_a_test_does_not_matter() {
    for (text, label) in [("whitenoise_T_TN_1500", "WhiteNoise_T_TN"), ("bs_T_NT", "BS_T_NT"), ("Own_N_NT", "Own_N_NT")]
    {
        assert_eq!(text.parse::<ExperimentLabel>().unwrap().to_string(), label);
    }
}
