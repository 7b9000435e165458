//! Two carts joined by a spring (University of Waterloo), under stepped sines of the voltage, with dry friction.

use faer::Mat;
use ident::validate::judge;
use ident::{Dataset, FormulaStructure, GreyBox, InitialState};

use super::channels;

/// Every so many samples of 1 ms are taken.
const EVERY: usize = 5;

/// Friction enters as an input: the direction of each cart. The spring's length is the third state.
const DRIVE: &str = r#"{
    "parameters": {
        "m1": { "value": 1e-3, "min": 0 }, "m2": { "value": 1e-3, "min": 0 }, "k": { "value": 0.1, "min": 0 },
        "b1": { "value": 0.01, "min": 0 }, "b2": { "value": 0.01, "min": 0 }, "c": { "value": 0.01, "min": 0 },
        "d1": { "value": 0.1, "min": 0 }, "d2": { "value": 0.1, "min": 0 }
    },
    "matrices": {
        "A": [["-(b1 + c)/m1", "c/m1", "-k/m1"], ["c/m2", "-(b2 + c)/m2", "k/m2"], [1, -1, 0]],
        "B": [["1/m1", "-d1/m1", 0], [0, 0, "-d2/m2"], [0, 0, 0]],
        "C": [[1, 0, 0], [0, 1, 0]]
    },
    "derived": { "dip": "sqrt(k/m2)/(2*pi)", "peak": "sqrt(k*(1/m1 + 1/m2))/(2*pi)" }
}"#;

/// The run at a frequency, as its file spells it: voltage and directions in, speeds in mm/s out.
fn run(frequency: &str) -> Option<Dataset> {
    let path = format!("flexible-drive/Project3_Lab3_360_Data_velocity_response_sine_{frequency}.mat");
    let [u, v1, v2] = channels(&path, ["u", "v1", "v2"])?;
    let rows = u.len() / EVERY;
    let inputs = [u, v1.iter().map(|v| v.signum()).collect(), v2.iter().map(|v| v.signum()).collect()];
    let outputs = [v1, v2];
    let table = |x: &[Vec<f64>]| Mat::from_fn(rows, x.len(), |i, j| x[j][EVERY * i]);
    Some(Dataset::new(1e-3 * EVERY as f64, table(&inputs), table(&outputs)).unwrap())
}

/// Published: anti-resonance at 2.49 Hz, resonance at 3.09 Hz, from masses and a spring that were found from steps, one
/// after the other, and simulate a gain at 0.5 Hz that is half as large again as measured. All runs in which both carts
/// move, together, are simulated to nine tenths.
#[test]
fn ref_flexible_drive_modes() {
    let runs: Option<Vec<Dataset>> = ["0_5", "1", "1_5", "2", "2_5", "3"].into_iter().map(run).collect();
    let Some(runs) = runs else { return };
    let data = runs.into_iter().reduce(|all, run| all.merge(&run).unwrap()).unwrap();
    let structure: FormulaStructure = serde_json::from_str(DRIVE).unwrap();
    let fit = GreyBox::new(structure).fit(&data).unwrap();
    let modes = fit.model.derived();
    assert!((modes[0].1 / 2.49 - 1.0).abs() < 0.05 && (modes[1].1 / 3.09 - 1.0).abs() < 0.025, "{modes:?}");
    let judged = judge(&fit.model, &data, None, &InitialState::Estimated).unwrap().fit_percent;
    assert!(judged.iter().flatten().all(|fit| *fit > 87.0), "{judged:?}");
    // The published masses are a third of these, in the same proportion. At 8 Hz cart 2 stands still and cart 1 answers
    // with 22.5 mm/s a volt, 1/(m1 ω): 8.8e-4, less what friction takes.
    let [m1, m2, ..] = fit.parameters()[..] else { unreachable!() };
    assert!((7.5e-4..8.8e-4).contains(&m1) && (m2 / m1 / (1.4383 / 2.6634) - 1.0).abs() < 0.15, "{m1} {m2}");
}
