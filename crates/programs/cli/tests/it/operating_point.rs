//! Where models rest, and recordings that rest elsewhere.

use tempfile::TempDir;

use crate::identify::{fitted, folder, recorded, run};

/// The same kind of recording about other levels.
fn shifted(folder: &TempDir) {
    recorded(folder.path(), "shifted.csv", 3, 0.2);
    let path = folder.path().join("shifted.csv");
    let text = std::fs::read_to_string(&path).unwrap();
    let moved = |line: &str| {
        let cells: Vec<f64> = line.split(',').map(|cell| cell.parse().unwrap()).collect();
        format!("{},{},{}\n", cells[0], cells[1] + 2.0, cells[2] + 300.0)
    };
    let (head, rows) = text.split_once('\n').unwrap();
    std::fs::write(path, format!("{head}\n{}", rows.lines().map(moved).collect::<String>())).unwrap();
}

fn fit_percent(folder: &TempDir, line: &str) -> (f64, String) {
    let ran = run(folder, &format!("{line} --json"));
    assert_eq!(ran.code, Some(0), "{line}: {}", ran.stderr);
    (ran.json()[0]["fit_percent"][0][0].as_f64().unwrap(), ran.stderr)
}

#[test]
fn exact_another_operating_point_is_separated_from_a_bad_model() {
    let folder = folder();
    shifted(&folder);
    let result = fitted(&folder, "fit oe --out model.json");
    let own = result["judged"][0]["fit_percent_simulated"][0][0].as_f64().unwrap();
    let (again, silent) = fit_percent(&folder, "model compare model.json --on run.csv");
    assert!((own - again).abs() < 1e-9, "on its own recording the model is as good as the fit said: {own}, {again}");
    assert!(!silent.contains("offset or a drift"), "{silent}");
    let (elsewhere, said) = fit_percent(&folder, "model compare model.json --on shifted.csv");
    assert!(elsewhere < -1000.0 && said.contains("offset or a drift") && said.contains("--detrend mean"), "{said}");
    let (dynamics, silent) = fit_percent(&folder, "model compare model.json --on shifted.csv --detrend mean");
    assert!(dynamics > 80.0 && !silent.contains("offset or a drift"), "{dynamics} {silent}");
    let (_, said) = fit_percent(&folder, "model compare model.json --on unseen.csv --detrend none");
    assert!(said.contains("--detrend model"), "{said}");
    let said = run(&folder, "model residuals model.json --on shifted.csv").stderr;
    assert!(said.contains("offset or a drift"), "{said}");
}

#[test]
fn exact_a_simulation_does_not_look_at_the_output() {
    let folder = folder();
    fitted(&folder, "fit oe --out model.json");
    let text = std::fs::read_to_string(folder.path().join("unseen.csv")).unwrap();
    let inputs = text.lines().map(|line| format!("{}\n", line.rsplit_once(',').unwrap().0));
    std::fs::write(folder.path().join("inputs.csv"), inputs.collect::<String>()).unwrap();
    let values = |on: &str| {
        let ran =
            run(&folder, &format!("model simulate model.json --on {on} --from-rest --out s.csv --overwrite --json"));
        assert_eq!(ran.code, Some(0), "{}", ran.stderr);
        std::fs::read_to_string(folder.path().join("s.csv")).unwrap()
    };
    assert_eq!(values("unseen.csv"), values("inputs.csv"));
    run(&folder, "model simulate model.json --on inputs.csv --detrend mean")
        .assert_refused(2, &["speed", "leave the option out"]);
}
