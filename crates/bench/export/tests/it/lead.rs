//! By how much a recorded speed demand is to be advanced: every target states it, and an independent simulation shows
//! that it is right.

use bench_model::document::BenchModelDocument;
use bench_model::model::{BenchModel, FeedForwardGains, Mechanics, PiController, TorqueControlModel};
use export::fmu::{FmiVersion, c_files, fmu};
use export::names::Names;
use export::{ExportedFile, modelica, python, ssv};

use crate::fmu::{compiled, printed, text, unpacked};
use crate::model::document;
use crate::others::{folder_with, largest, python as run};

/// Time between samples, s, and steps of the independent simulation within it.
const SAMPLE_S: f64 = 1e-3;
const STEPS: usize = 50;
const SAMPLES: usize = 700;
/// The sample from which on recordings have the higher demand, both demands, rad/s, and the engine's torque throughout,
/// Nm.
const RISES_AT: usize = 200;
const LOWER_DEMAND_RAD_S: f64 = 320.0;
const HIGHER_DEMAND_RAD_S: f64 = 322.0;
const ENGINE_NM: f64 = 30.0;
const WORDS: &str = "recordings have it 1 T_s (1 ms) later: advance a recorded demand by as much";

/// A bench whose recordings have ω_d* a sample after the controller has it: a feed-forward one sample before it, a
/// speed error with no delay of the demand.
fn late_recordings() -> BenchModelDocument {
    let mut document = document();
    document.model = BenchModel {
        mechanics: Mechanics {
            dyno_inertia_kg_m2: 0.85,
            engine_inertia_kg_m2: 0.31,
            stiffness_nm_per_rad: 3300.0,
            damping_nm_s_per_rad: 6.0,
        },
        speed_controller: Some(PiController {
            proportional_nm_s_per_rad: 15.0,
            integral_nm_per_rad: 14.0,
            delay_s: 2.06e-3,
            demand_delay_s: 0.0,
            sample_time_s: SAMPLE_S,
        }),
        feed_forward: Some(FeedForwardGains {
            speed_nm_s_per_rad: 0.126,
            acceleration_nm_s2_per_rad: -1.37,
            delay_s: -1e-3,
        }),
        torque_control: Some(TorqueControlModel { delay_s: 1.42e-3, bandwidth_rad_s: Some(800.0) }),
        torque_limit_nm: None,
        encoder_gate_s: 1e-3,
    };
    document
}

fn recorded(sample: usize) -> f64 {
    if sample < RISES_AT { LOWER_DEMAND_RAD_S } else { HIGHER_DEMAND_RAD_S }
}

/// The equations of the bench by Runge and Kutta, with the demand as recorded: readings of ω_d and T_shaft at each
/// sample.
///
/// The error at a sample takes the demand of τ_c − τ_n later, which has the same delay when the output acts; the
/// feed-forward that of −τ_f later.
fn independent(model: &BenchModel) -> Vec<(f64, f64)> {
    let (pi, feed, torque) =
        (model.speed_controller.unwrap(), model.feed_forward.unwrap(), model.torque_control.unwrap());
    let m = model.mechanics;
    let step_s = SAMPLE_S / STEPS as f64;
    let samples = |time_s: f64| (time_s / SAMPLE_S).round() as isize;
    let at = |k: usize, later_s: f64| recorded(k.saturating_add_signed(samples(later_s)));
    let mut integral = ENGINE_NM - feed.speed_nm_s_per_rad * LOWER_DEMAND_RAD_S;
    // Outputs of PI and feed-forward with the instants from which on they act on the lag.
    let (mut delayed, mut direct) =
        (vec![(f64::NEG_INFINITY, integral)], vec![(f64::NEG_INFINITY, ENGINE_NM - integral)]);
    let mut x = [LOWER_DEMAND_RAD_S, LOWER_DEMAND_RAD_S, ENGINE_NM / m.stiffness_nm_per_rad, ENGINE_NM, 0.0];
    let mut angles = vec![0.0];
    let mut out = Vec::new();
    let shaft = |x: &[f64; 5]| m.stiffness_nm_per_rad * x[2] + m.damping_nm_s_per_rad * (x[1] - x[0]);
    for k in 0..SAMPLES {
        let turned = match k {
            0 => LOWER_DEMAND_RAD_S * SAMPLE_S,
            _ => angles[k * STEPS] - angles[(k - 1) * STEPS],
        };
        let reading = turned / SAMPLE_S;
        out.push((reading, shaft(&x)));
        let error = reading - at(k, pi.delay_s - pi.demand_delay_s);
        let (now, before) = (at(k, -feed.delay_s), at(k.saturating_sub(1), -feed.delay_s));
        let time_s = k as f64 * SAMPLE_S;
        delayed.push((time_s + pi.delay_s + torque.delay_s, pi.proportional_nm_s_per_rad * error + integral));
        let fed = feed.speed_nm_s_per_rad * now + feed.acceleration_nm_s2_per_rad * (now - before) / SAMPLE_S;
        direct.push((time_s + torque.delay_s, fed));
        integral += pi.integral_nm_per_rad * SAMPLE_S * error;
        for step in 0..STEPS {
            let middle_s = time_s + (step as f64 + 0.5) * step_s;
            let last = |of: &[(f64, f64)]| of.iter().rev().find(|(from_s, _)| *from_s <= middle_s).unwrap().1;
            let demand = last(&delayed) + last(&direct);
            let slope = |x: [f64; 5]| {
                let t = shaft(&x);
                [
                    (t - x[3]) / m.dyno_inertia_kg_m2,
                    (ENGINE_NM - t) / m.engine_inertia_kg_m2,
                    x[1] - x[0],
                    torque.bandwidth_rad_s.unwrap() * (demand - x[3]),
                    x[0],
                ]
            };
            let moved = |x: [f64; 5], by: [f64; 5], h: f64| std::array::from_fn(|i| x[i] + h * by[i]);
            let a = slope(x);
            let b = slope(moved(x, a, 0.5 * step_s));
            let c = slope(moved(x, b, 0.5 * step_s));
            let d = slope(moved(x, c, step_s));
            x = std::array::from_fn(|i| x[i] + step_s / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]));
            angles.push(x[4]);
        }
    }
    out
}

#[test]
fn exact_every_target_states_the_lead_of_the_demand() {
    let document = late_recordings();
    let names = Names::of("late");
    assert_eq!(document.model.demand_lead(), 1);
    for version in [FmiVersion::V2, FmiVersion::V3] {
        let files = unpacked(&fmu(&document, &names, version, None).unwrap().content);
        let description = text(&files, "modelDescription.xml");
        let input = description.split("name=\"speed_demand\"").nth(1).unwrap().split('>').next().unwrap();
        assert!(input.contains(WORDS), "{input}");
        let head = description.split("<UnitDefinitions>").next().unwrap();
        assert!(head.contains(WORDS), "{head}");
        assert!(text(&files, "documentation/index.html").contains(WORDS));
    }
    let of = |file: &ExportedFile| String::from_utf8(file.content.clone()).unwrap();
    let c = c_files(&document, &names).unwrap();
    let texts = [
        of(&modelica::bench(&document, &names)),
        of(&python::bench(&document, &names)),
        of(&ssv::bench(&document, &names, 0).unwrap()[0]),
        of(c.iter().find(|file| file.name == "late.h").unwrap()),
    ];
    for text in &texts {
        assert!(text.contains(WORDS), "{text}");
    }
    assert!(texts[1].contains("DEMAND_LEAD = 1\n"), "{}", texts[1]);
    // The delays are the same everywhere: a sample of the demand in the error, none in the feed-forward.
    assert!(texts[0].contains("<tr><td>tau_n</td><td>delay of w_d* in the speed error</td><td>0.001000</td>"));
    assert!(texts[1].contains("\"tau_n\": 0.001,") && texts[1].contains("\"tau_f\": 0.0,"), "{}", texts[1]);
    // Recordings that have the demand as the controller does need no lead, and no words about one.
    let own = self::document();
    assert_eq!(own.model.demand_lead(), 0);
    assert!(!of(&modelica::bench(&own, &names)).contains("advance a recorded demand"));
}

/// The differences to the independent simulation of a program in C whose demand is advanced by so many samples: rad/s
/// and Nm.
fn difference_in_c(document: &BenchModelDocument, lead: usize) -> Option<(f64, f64)> {
    let folder = folder_with("lead_c", &c_files(document, &Names::of("late")).unwrap());
    let program = format!(
        "#include <stdio.h>\n#include <stdlib.h>\n#include \"late.h\"\nint main(int n, char **a) {{\n    static bench b;\n    \
         int lead = atoi(a[n - 1]);\n    bench_initial start = {{.speed_rad_s = {0:?}, .torque_nm = {2:?}}};\n    \
         bench_inputs in = {{.engine_torque_nm = {2:?}}};\n    \
         if (!bench_start(&b, LATE_MODEL, BENCH_SPEED_CONTROL, &start)) return 1;\n    \
         for (int k = 0; k < {SAMPLES} - 1; k++) {{\n        in.speed_demand_rad_s = k + lead < {RISES_AT} ? {0:?} : {1:?};\n        \
         if (!bench_step(&b, &in, {SAMPLE_S})) return 1;\n        \
         printf(\"%.17g %.17g\\n\", b.state.reading[0], bench_shaft_torque_nm(&b.state));\n    }}\n    return 0;\n}}\n",
        LOWER_DEMAND_RAD_S, HIGHER_DEMAND_RAD_S, ENGINE_NM
    );
    std::fs::write(folder.join("lead.c"), program).unwrap();
    compiled(&folder, &["-std=c99", "-O1", "lead.c", "bench.c", "matrix.c", "-lm", "-o", "lead"])?;
    let said = printed(&folder.join("lead"), &[&lead.to_string()]);
    let expected = independent(&document.model);
    let rows = said.lines().zip(&expected[1..]).map(|(line, expected)| {
        let found: Vec<f64> = line.split(' ').map(|number| number.parse().unwrap()).collect();
        ((found[0] - expected.0).abs(), (found[1] - expected.1).abs())
    });
    Some(rows.fold((0.0, 0.0), |most, row| (most.0.max(row.0), most.1.max(row.1))))
}

#[test]
fn ref_a_recorded_demand_that_is_advanced_by_the_lead_gives_the_recorded_motion() {
    let document = late_recordings();
    let Some(stated) = difference_in_c(&document, document.model.demand_lead()) else { return };
    assert!(stated.0 < 1e-4 && stated.1 < 1e-2, "{stated:?}");
    for other in [0, 2] {
        let found = difference_in_c(&document, other).unwrap();
        assert!(found.0 > 0.1 && found.1 > 1.0, "advanced by {other}: {found:?}");
    }
}

/// The same demand for the Modelica model, the Python module and the independent simulation.
#[test]
fn ref_modelica_takes_the_demand_by_the_lead_that_it_states() {
    let document = late_recordings();
    let names = Names::of("late");
    let file = modelica::bench(&document, &names);
    let rises_s = (RISES_AT - document.model.demand_lead()) as f64 * SAMPLE_S - 0.5 * SAMPLE_S;
    let driven = format!(
        "{}model DrivenSpeed\n  {}.SpeedControl bench(w_start = {:?}, T_start = {ENGINE_NM:?});\nequation\n  \
         bench.w_d_demand = if time < {rises_s:?} then {:?} else {:?};\n  bench.T_e = {ENGINE_NM:?};\nend DrivenSpeed;\n",
        String::from_utf8(file.content.clone()).unwrap(),
        names.class,
        LOWER_DEMAND_RAD_S,
        LOWER_DEMAND_RAD_S,
        HIGHER_DEMAND_RAD_S
    );
    let folder = folder_with("lead_modelica", &[file]);
    std::fs::create_dir_all(folder.join("driven")).unwrap();
    std::fs::write(folder.join("driven/driven.mo"), driven).unwrap();
    let (speed, shaft): (Vec<f64>, Vec<f64>) = independent(&document.model).into_iter().unzip();
    let expected = serde_json::json!({ "DrivenSpeed": { "bench.plant.w_d_read": speed, "bench.T_shaft": shaft } });
    std::fs::write(folder.join("expected.json"), expected.to_string()).unwrap();
    if let Some(lines) = run("modelica.py", &folder) {
        // Advanced by 0 or by 2 samples, T_shaft is off by 10 % of its largest value and more.
        assert!(largest(&lines) < 5e-3, "{lines}");
    }
}
