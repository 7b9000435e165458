//! Modelica files.

use bench_model::model::BenchModel;
use bench_model::simulate::{DynoInput, InitialState, Inputs, simulate};
use export::modelica;
use export::names::Names;

use crate::model::{arx, document, oscillator};
use crate::others::{folder_with, largest, python};

const SAMPLES: usize = 600;
/// Where every demand is seen by the controller, between two of its ticks, s.
const DEMANDS: &str = "if time < 0.0995 then 100.0 elseif time < 0.2995 then 103.0 else 140.0";
/// Rumoca does not stop at a delayed jump but smears it over a step; so large a part of the largest value that leaves.
const SMEARED: f64 = 1e-3;
const ENGINE: &str = "40.0 + 60.0 * max(0.0, time - 0.2)";

fn series(of: impl Fn(usize) -> f64) -> Vec<f64> {
    (0..SAMPLES).map(of).collect()
}

fn stepped(steps: [f64; 3]) -> Vec<f64> {
    series(|k| steps[usize::from(k >= 100) + usize::from(k >= 300)])
}

/// Models that drive the exported ones.
fn driven(class: &str) -> String {
    format!(
        "model DrivenSpeed\n  {class}.SpeedControl bench(w_start = 100.0, T_start = 40.0);\nequation\n  bench.w_d_demand = {DEMANDS};\n  \
         bench.T_e = {ENGINE};\nend DrivenSpeed;\n\
         model DrivenTorque\n  {class}.Plant plant(w_start = 100.0, T_start = 40.0);\n  \
         discrete Real held(start = 40.0, fixed = true);\nequation\n  when sample(0.0, 0.001) then\n    \
         held = 40.0 + 15.0 * sin(20.0 * time);\n  end when;\n  plant.T_d_demand = held;\n  \
         plant.T_e = {ENGINE};\nend DrivenTorque;\n"
    )
}

#[test]
fn ref_rumoca_simulates_the_bench_within_its_tolerance() {
    let mut model = document().model;
    model.torque_limit_nm = Some(150.0);
    let mut document = document();
    document.model = model.clone();
    let file = modelica::bench(&document, &Names::of("Test cell 4"));
    let text = format!("{}{}", String::from_utf8(file.content.clone()).unwrap(), driven("TestCell4"));
    let folder = folder_with("modelica", &[file]);
    write_driven(&folder, &text);
    let expected = serde_json::json!({
        "DrivenSpeed": expected(&model, true), "DrivenTorque": expected(&model, false),
    });
    std::fs::write(folder.join("expected.json"), expected.to_string()).unwrap();
    if let Some(lines) = python("modelica.py", &folder) {
        assert!(largest(&lines) < SMEARED, "{lines}");
    }
}

/// Connectors as the Modelica Standard Library defines them, which rumoca does not have.
const LIBRARY: &str = "package Modelica\n  package Blocks\n    package Interfaces\n      connector RealInput = input Real;\n      \
    connector RealOutput = output Real;\n      connector BooleanOutput = output Boolean;\n    end Interfaces;\n  end Blocks;\n  \
    package Mechanics\n    package Rotational\n      package Interfaces\n        connector Flange_a\n          Real phi(unit = \"rad\");\n          \
    flow Real tau(unit = \"N.m\");\n        end Flange_a;\n      end Interfaces;\n    end Rotational;\n  end Mechanics;\nend Modelica;\n";
/// Inertia of the engine at the flange, kg m².
const FLANGED_INERTIA_KG_M2: f64 = 0.15;
/// Torque of the engine at the flange, Nm.
const FLANGED_TORQUE_NM: f64 = 55.0;
/// Friction, Nm and Nm s/rad.
const COULOMB_NM: f64 = 3.0;
const VISCOUS_NM_S_PER_RAD: f64 = 0.04;
/// Ripple, Nm, its part of T_d, and its order.
const RIPPLE_NM: f64 = 2.0;
const RIPPLE_PART: f64 = 0.05;
const RIPPLE_ORDER: f64 = 4.0;

/// The plant with friction and ripple, held in torque control by a constant demand, turned by the engine at its flange:
/// readings of ω_d, T_d and T_shaft at each sample, by Runge and Kutta.
fn flanged(model: &BenchModel, demand_nm: f64) -> [Vec<f64>; 3] {
    const STEPS: usize = 20;
    let m = model.mechanics;
    let bandwidth = model.torque_control.unwrap().bandwidth_rad_s.unwrap();
    let shaft = |x: &[f64; 5]| m.stiffness_nm_per_rad * x[2] + m.damping_nm_s_per_rad * (x[1] - x[0]);
    let slope = |x: [f64; 5]| {
        let friction = COULOMB_NM * (x[0] / 0.5).clamp(-1.0, 1.0) + VISCOUS_NM_S_PER_RAD * x[0];
        let ripple = (RIPPLE_NM + RIPPLE_PART * x[3]) * (RIPPLE_ORDER * x[4]).sin();
        [
            (shaft(&x) - x[3] - friction - ripple) / m.dyno_inertia_kg_m2,
            (FLANGED_TORQUE_NM - shaft(&x)) / (m.engine_inertia_kg_m2 + FLANGED_INERTIA_KG_M2),
            x[1] - x[0],
            bandwidth * (demand_nm - x[3]),
            x[0],
        ]
    };
    let moved = |x: [f64; 5], by: [f64; 5], h: f64| -> [f64; 5] { std::array::from_fn(|i| x[i] + h * by[i]) };
    let h = 1e-3 / STEPS as f64;
    let mut x = [100.0, 100.0, 40.0 / m.stiffness_nm_per_rad, 40.0, 0.0];
    let mut rows = [const { Vec::new() }; 3];
    for _ in 0..SAMPLES {
        for (row, value) in rows.iter_mut().zip([x[0], x[3], shaft(&x)]) {
            row.push(value);
        }
        for _ in 0..STEPS {
            let a = slope(x);
            let b = slope(moved(x, a, 0.5 * h));
            let c = slope(moved(x, b, 0.5 * h));
            let d = slope(moved(x, c, h));
            x = std::array::from_fn(|i| x[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
        }
    }
    rows
}

/// An engine with an inertia of its own is rigidly coupled at the flange; in speed control the model is that without a
/// flange.
#[test]
fn ref_rumoca_couples_an_engine_at_the_flange_with_friction_and_ripple() {
    let mut document = document();
    document.model.torque_limit_nm = Some(150.0);
    let file = modelica::bench(&document, &Names::of("Test cell 4"));
    let text = String::from_utf8(file.content.clone()).unwrap().replace("within ;\n", "");
    let (inertia, torque) = (FLANGED_INERTIA_KG_M2, FLANGED_TORQUE_NM);
    let options = format!(
        "friction_coulomb = {:?}, friction_viscous = {:?}, ripple_torque = {:?}, ripple_part = {:?}, ripple_order = {:?}",
        COULOMB_NM, VISCOUS_NM_S_PER_RAD, RIPPLE_NM, RIPPLE_PART, RIPPLE_ORDER
    );
    let flange = "Modelica.Mechanics.Rotational.Interfaces.Flange_a flange;";
    let models = format!(
        "model Engine\n  {flange}\n  Real w;\nequation\n  w = der(flange.phi);\n  {inertia:?} * der(w) = {torque:?} + flange.tau;\nend Engine;\n\
         model Torque\n  {flange}\nequation\n  flange.tau = -({ENGINE});\nend Torque;\n\
         model DrivenFlange\n  TestCell4.PlantFlange bench(w_start = 100.0, T_start = 40.0, plant({options}));\n  Engine engine;\n\
         equation\n  connect(engine.flange, bench.flange);\n  bench.T_d_demand = 45.0;\nend DrivenFlange;\n\
         model DrivenSpeed\n  TestCell4.SpeedControlFlange bench(w_start = 100.0, T_start = 40.0);\n  Torque engine;\n\
         equation\n  connect(engine.flange, bench.flange);\n  bench.w_d_demand = {DEMANDS};\nend DrivenSpeed;\n"
    );
    let folder = folder_with("modelica_flange", &[file]);
    write_driven(&folder, &format!("{LIBRARY}{text}{models}"));
    let [speed, torque, shaft] = flanged(&document.model, 45.0);
    let expected = serde_json::json!({
        "DrivenFlange": { "bench.w_d": speed, "bench.T_d": torque, "bench.T_shaft": shaft },
        "DrivenSpeed": expected(&document.model, true),
    });
    std::fs::write(folder.join("expected.json"), expected.to_string()).unwrap();
    if let Some(lines) = python("modelica.py", &folder) {
        println!("{lines}");
        assert!(largest(&lines) < SMEARED, "{lines}");
    }
}

/// Recordings have ω_d* a sample later than the controller has it. The error waits for its demand, so that one sample
/// is enough, and the table has the delays that all targets have.
#[test]
fn regress_the_table_of_parameters_has_the_delays_of_the_code() {
    let mut early = document();
    let pi = early.model.speed_controller.as_mut().unwrap();
    (pi.delay_s, pi.demand_delay_s) = (2e-3, 0.0);
    early.model.feed_forward.as_mut().unwrap().delay_s = -1e-3;
    let text = String::from_utf8(modelica::bench(&early, &Names::of("early")).content).unwrap();
    assert!(text.contains("error = read_1 - past_0;") && text.contains("k * past_0 +"), "{text}");
    assert!(text.contains("delay(pi_part, tau_c - 1 * T_s)"), "{text}");
    let row = |name: &str| text.lines().find(|line| line.starts_with(&format!("<tr><td>{name}</td>"))).unwrap();
    assert!(row("tau_n").contains("<td>0.001000</td>"), "{}", row("tau_n"));
    assert!(row("tau_f").contains("<td>0.000000</td>"), "{}", row("tau_f"));
    assert!(text.contains("recordings have it 1 T_s (1 ms) later: advance a recorded demand by as much"), "{text}");
}

/// τ_c is 2.6 samples and the demand has no delay in the error: the error waits 3 samples for it, and PI acts at its
/// time all the same.
#[test]
fn ref_rumoca_lets_pi_act_after_its_delay_where_the_error_waits_longer() {
    let mut document = document();
    let pi = document.model.speed_controller.as_mut().unwrap();
    (pi.delay_s, pi.demand_delay_s) = (2.6e-3, 0.0);
    document.model.torque_control.as_mut().unwrap().delay_s = 1.5e-3;
    document.model.torque_limit_nm = Some(150.0);
    assert_eq!((document.model.demand_lead(), document.model.demand_lags().0), (0, -3));
    let file = modelica::bench(&document, &Names::of("Test cell 4"));
    let text = String::from_utf8(file.content.clone()).unwrap().replace("within ;\n", "");
    let models = "model Torque\n  Modelica.Mechanics.Rotational.Interfaces.Flange_a flange;\nequation\n  flange.tau = -(ENGINE);\nend Torque;\n\
         model DrivenFlange\n  TestCell4.SpeedControlFlange bench(w_start = 100.0, T_start = 40.0);\n  Torque engine;\n\
         equation\n  connect(engine.flange, bench.flange);\n  bench.w_d_demand = DEMANDS;\nend DrivenFlange;\n"
        .replace("ENGINE", ENGINE)
        .replace("DEMANDS", DEMANDS);
    let folder = folder_with("modelica_waits", &[file]);
    write_driven(&folder, &format!("{LIBRARY}{text}{}{models}", driven("TestCell4")));
    let speed = expected(&document.model, true);
    let all = serde_json::json!({
        "DrivenSpeed": speed, "DrivenTorque": expected(&document.model, false), "DrivenFlange": speed,
    });
    std::fs::write(folder.join("expected.json"), all.to_string()).unwrap();
    if let Some(lines) = python("modelica.py", &folder) {
        println!("{lines}");
        // Rumoca smears the jumps of PI and of the delayed feed-forward. With PI 0.4 ms late, T_d is off by 18 %.
        assert!(largest(&lines) < 0.02, "{lines}");
    }
}

#[test]
fn exact_channels_of_linear_models_have_their_units() {
    let (mut model, _) = arx();
    let text = |model: &ident::ModelDocument| {
        String::from_utf8(modelica::linear(model, &Names::of("arx"), "0.1.0").unwrap().content).unwrap()
    };
    let known = text(&model);
    assert!(known.contains("input Real u1(unit = \"N.m\") \"T_demand, Nm\";"), "{known}");
    assert!(known.contains("output Real y1(unit = \"rev/min\") \"N_dyno \\\"1\\\", rpm\";"), "{known}");
    model.inputs[0].unit = "furlong".into();
    assert!(text(&model).contains("input Real u1 \"T_demand, furlong\";"));
}

/// In a folder of its own: the exported classes are in it a second time.
fn write_driven(folder: &std::path::Path, text: &str) {
    std::fs::create_dir_all(folder.join("driven")).unwrap();
    std::fs::write(folder.join("driven/driven.mo"), text).unwrap();
}

/// Values that the program simulates.
fn expected(model: &BenchModel, is_speed: bool) -> serde_json::Value {
    let engine = series(|k| 40.0 + 60.0 * (k as f64 * 1e-3 - 0.2).max(0.0));
    let demand =
        if is_speed { stepped([100.0, 103.0, 140.0]) } else { series(|k| 40.0 + 15.0 * (0.02 * k as f64).sin()) };
    let dyno = if is_speed { DynoInput::SpeedDemand(&demand) } else { DynoInput::TorqueDemand(&demand) };
    let inputs = Inputs { sample_time_s: 1e-3, engine_torque_nm: &engine, dyno };
    let response = simulate(model, &inputs, &InitialState::steady(model, 100.0, 40.0)).unwrap();
    assert!(!is_speed || response.limited_share > 0.01, "the limit is met");
    let (plant, bench) = if is_speed { ("bench.plant.", "bench.") } else { ("plant.", "plant.") };
    serde_json::json!({
        format!("{plant}w_d_read"): response.dyno_speed_rad_s,
        format!("{bench}T_d"): response.air_gap_torque_nm,
        format!("{bench}T_shaft"): response.shaft_torque_nm,
    })
}

#[test]
fn ref_rumoca_takes_linear_models() {
    let (discrete, expected) = arx();
    let (continuous, step) = oscillator();
    let version = "0.1.0";
    let files = [
        modelica::linear(&discrete, &Names::of("Arx"), version).unwrap(),
        modelica::linear(&continuous, &Names::of("Oscillator"), version).unwrap(),
    ];
    let folder = folder_with("modelica_linear", &files);
    let text: String =
        files.iter().map(|file| String::from_utf8(file.content.clone()).unwrap().replace("within ;\n", "")).collect();
    let driven = format!(
        "{text}model Driven\n  Arx arx;\n  Oscillator oscillator;\nequation\n  arx.u1 = if time < 0.0995 then 0.0 else 2.0;\n  \
         oscillator.u1 = if time < 0.1 then 0.0 else 1.0;\nend Driven;\n"
    );
    write_driven(&folder, &driven);
    let wanted = serde_json::json!({ "Driven": { "arx.y1": expected["step"], "oscillator.y1": step } });
    std::fs::write(folder.join("expected.json"), wanted.to_string()).unwrap();
    if let Some(lines) = python("modelica.py", &folder) {
        assert!(largest(&lines) < SMEARED, "{lines}");
    }
}

#[test]
fn exact_a_bench_without_controllers_has_the_plant_alone() {
    let mut document = document();
    document.model.torque_control = None;
    document.bench.name = "cell \"4\" <b> \\ é".into();
    let text = String::from_utf8(modelica::bench(&document, &Names::of("Test cell 4")).content).unwrap();
    assert!(text.contains("input Real T_d(unit = \"N.m\"") && !text.contains("SpeedController"), "{text}");
    assert!(
        text.contains("Bench model of cell \\\"4\\\" <b> \\\\ é") && text.contains("cell \\\"4\\\" &lt;b&gt;"),
        "{text}"
    );
    assert!(!text.contains('@'), "every place is filled");
}
