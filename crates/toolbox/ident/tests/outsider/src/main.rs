use ident::prelude::*;
use ndarray::Array2;

fn main() -> Result<(), IdentError> {
    // Two inputs and one output in arrays, as they come from elsewhere.
    let inputs = Array2::from_shape_fn((400, 2), |(t, k)| if (t * t / (7 + 4 * k)) % 2 == 0 { 1.0 } else { -1.0 });
    let mut outputs = Array2::zeros((400, 1));
    for t in 1..400 {
        let noise = 0.01 * (1.7 * (t * t) as f64).sin();
        outputs[[t, 0]] = 0.8 * outputs[[t - 1, 0]] + 0.5 * inputs[[t - 1, 0]] - 0.3 * inputs[[t - 1, 1]] + noise;
    }
    let data = Dataset::from_ndarray(0.1, inputs.view(), outputs.view())?.split(0.7)?;

    let arx = Arx::with_orders(ArxOrders::uniform(1, 2, 1, 1, 1)).fit(&data.estimation)?;
    let state_space = Subspace::new(1).fit(&data.estimation)?;
    println!("{arx}\n\n{state_space}\n");
    println!("{}", compare(&[&arx, &state_space], &data.validation).named(&["ARX", "subspace"]));

    for chart in arx.bode()? {
        println!("{}: {:.2} dB at {:.3} Hz", chart.channel, chart.magnitude_db[0], chart.freq_hz[0]);
    }
    let step = &arx.step()?[1];
    println!("{}: {:.2} after {:.1} s", step.channel, step.response[20], step.time_s[20]);

    let report = ResidualTest::default().run(&arx, &data.validation, TestData::Unseen)?;
    println!("white residuals: {}", report.whiteness[0].joint.passes(0.99));
    let [pole, first, second] = arx.parameters()[..] else { return Ok(()) };
    assert!((pole + 0.8).abs() < 0.01 && (first - 0.5).abs() < 0.01 && (second + 0.3).abs() < 0.01);
    Ok(())
}
