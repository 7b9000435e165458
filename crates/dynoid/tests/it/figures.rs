//! What a reader of the report reads off its figures, in a browser.

use std::path::PathBuf;
use std::process::{Command, Stdio};

use crate::support::Campaign;

/// Moves the cursor over every figure that has measured, modelled and residual, and writes what the read-out says: one line a
/// position with panel, series and value.
const READER: &str = r##"<script>
addEventListener("load", () => setTimeout(() => {
  const lines = [];
  document.querySelectorAll("details").forEach((fold) => { fold.open = true; });
  document.querySelectorAll("figure.plot").forEach((figure, number) => {
    const root = figure.querySelector(".stage svg");
    const box = root.getBoundingClientRect();
    for (let share = 0.08; share < 0.98; share += 0.0137) {
      const at = { clientX: box.left + share * box.width, clientY: box.top + 40, bubbles: true };
      root.dispatchEvent(new PointerEvent("pointermove", at));
      const values = [...figure.querySelectorAll(".readout .value")].map((row) => row.textContent.trim());
      lines.push([number, ...values].join(" | "));
    }
  });
  const out = document.createElement("pre");
  out.id = "read";
  out.textContent = lines.join("\n");
  document.body.replaceChildren(out);
}, 300));
</script>"##;

fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name))).find(|path| path.is_file())
}

/// A value as it is written, and half of what its last digit is worth.
fn value(text: &str) -> Option<(f64, f64)> {
    let number: String = text
        .chars()
        .map(|c| if c == '−' { '-' } else { c })
        .take_while(|c| c.is_ascii_digit() || "-.".contains(*c))
        .collect();
    let decimals = number.split_once('.').map_or(0, |(_, behind)| behind.len());
    Some((number.parse().ok()?, 0.5 * 0.1_f64.powi(decimals as i32)))
}

/// Of a row such as `T_shaft, measured 51.18 Nm`, the name of the series and its value.
fn row<'a>(text: &'a str, series: &str) -> Option<(&'a str, (f64, f64))> {
    let (panel, rest) = text.split_once(&format!(", {series} "))?;
    Some((panel, value(rest)?))
}

#[test]
fn at_every_position_of_the_cursor_measured_less_modelled_is_the_residual() {
    // `exact_what_is_drawn_of_a_residual_…` of `page` proves the same of the drawing.
    let Some(browser) = browser() else { return testdata::skip("no browser (Chromium) to read figures with") };
    let campaign = Campaign::whole();
    assert!(matches!(campaign.run(&["study", "bench.toml", "--quiet"]).code, Some(0 | 1)));
    let page = campaign.read("study/report.html");
    assert!(page.contains("Drawn with"), "a figure with fewer points than samples is what this test is about");
    campaign.write("read.html", page.replace("</body>", &format!("{READER}</body>")).as_bytes());
    let output = Command::new(browser)
        .args([
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--virtual-time-budget=20000",
            "--window-size=1400,900",
        ])
        .arg("--dump-dom")
        .arg(format!("file://{}", campaign.path("read.html").display()))
        .stderr(Stdio::null())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let read = text.split("<pre id=\"read\">").nth(1).unwrap_or_else(|| panic!("nothing was read: {}", text.len()));
    let mut compared = 0;
    for line in read.split("</pre>").next().unwrap_or_default().lines() {
        let rows: Vec<&str> = line.split(" | ").collect();
        let of = |series: &str| rows.iter().filter_map(|text| row(text, series)).collect::<Vec<_>>();
        for (panel, (residual, c)) in of("residual") {
            let signal = panel.trim_end_matches(" − model");
            let same = |series: &str| of(series).into_iter().find(|(name, _)| *name == signal).map(|(_, value)| value);
            let (Some((measured, a)), Some((modelled, b))) = (same("measured"), same("modelled")) else { continue };
            compared += 1;
            let left = (measured - modelled - residual).abs();
            assert!(left <= 1.1 * (a + b + c), "{left}: {line}");
        }
    }
    assert!(compared > 200, "{compared} positions were compared");
}
