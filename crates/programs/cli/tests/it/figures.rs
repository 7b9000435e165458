//! Readings of the report's figures by a reader, in a browser.

use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::support::Campaign;

/// Uses every figure that has measured, modelled and residual, and writes what it says: at positions of the cursor the
/// rows of the read-out, as drawn and zoomed; what is stated of the zoom; which other figures follow; and the files
/// that are saved.
const READER: &str = r##"<script>
const later = (ms) => new Promise((resolve) => setTimeout(resolve, ms));
const files = [];
URL.createObjectURL = (blob) => { files.push(blob); return "#"; };
HTMLAnchorElement.prototype.click = function () { files[files.length - 1].saved = this.download; };
async function until(holds) {
  for (let tries = 0; tries < 4000 && !holds(); tries++) await later(5);
  return holds();
}
function press(root, key) { root.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true })); }
function point(root, share) {
  const box = root.getBoundingClientRect();
  root.dispatchEvent(new PointerEvent("pointermove", { clientX: box.left + share * box.width, clientY: box.top + 40, bubbles: true }));
}
function rows(figure) {
  const root = figure.querySelector(".stage svg");
  const all = [];
  for (let share = 0.08; share < 0.98; share += 0.0137) {
    point(root, share);
    all.push([...figure.querySelectorAll(".readout .value")].map((row) => row.textContent.trim()));
  }
  return all;
}
async function use(figure, figures) {
  const root = figure.querySelector(".stage svg");
  root.dispatchEvent(new PointerEvent("pointerenter"));
  const state = figure.querySelector(".state");
  const found = { title: figure.querySelector(".plot-title").textContent, whole: rows(figure) };
  point(root, 0.4);
  for (let n = 0; n < 4; n++) press(root, "+");
  await until(() => /sample/.test(state.textContent) && !/point/.test(state.textContent));
  await later(100);
  found.state = state.textContent;
  found.zoomed = rows(figure);
  found.drawn = (root.querySelector("[data-type=line] path").getAttribute("d").match(/L/g) || []).length;
  found.followers = figures.filter((other) => other !== figure && other.classList.contains("zoomed")).length;
  press(root, "l");
  press(root, "+");
  press(root, "0");
  found.apart = figures.filter((other) => other !== figure && other.classList.contains("zoomed")).length;
  press(root, "l");
  press(root, "0");
  found.linked = figures.filter((other) => other.classList.contains("zoomed")).length;
  return found;
}
async function save(figure) {
  const root = figure.querySelector(".stage svg");
  for (const key of ["c", "s", "p"]) {
    const count = files.length;
    press(root, key);
    await until(() => files.length > count && files[count].saved);
  }
  const [csv, drawing, pixels] = files;
  const text = await drawing.text();
  const read = new DOMParser().parseFromString(text, "image/svg+xml");
  return {
    names: files.map((file) => file.saved), csv: await csv.text(), pixels: pixels.size, kind: pixels.type,
    isDrawing: read.documentElement.tagName === "svg" && !text.includes("var("),
  };
}
addEventListener("load", async () => {
  document.querySelectorAll("details").forEach((fold) => { fold.open = true; });
  await later(300);
  const figures = [...document.querySelectorAll("figure.plot")];
  const compared = figures.filter((figure) => /residual/.test(figure.querySelector("[data-name=residual]") ? "residual" : ""));
  const result = { figures: [], saved: null };
  for (const figure of compared) result.figures.push(await use(figure, figures));
  result.saved = await save(compared[0]);
  const out = document.createElement("pre");
  out.id = "read";
  out.textContent = JSON.stringify(result);
  document.body.replaceChildren(out);
});
</script>"##;

/// Runs axe over a page with all folds open, and writes what it finds.
const AXE: &str = r##"<script>
addEventListener("load", async () => {
  document.querySelectorAll("details").forEach((fold) => { fold.open = true; });
  document.querySelectorAll(".stage svg").forEach((root) => root.dispatchEvent(new KeyboardEvent("keydown", { key: "?", bubbles: true })));
  const { violations } = await axe.run(document);
  const found = violations.map(({ id, help, nodes }) => ({ id, help, count: nodes.length, first: nodes[0].html.slice(0, 300), why: nodes[0].failureSummary }));
  const out = document.createElement("pre");
  out.id = "read";
  out.textContent = JSON.stringify(found);
  document.body.replaceChildren(out);
});
</script>"##;

fn browser() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let folders: Vec<PathBuf> = std::env::split_paths(&std::env::var_os("PATH")?).collect();
    names.iter().flat_map(|name| folders.iter().map(move |folder| folder.join(name))).find(|path| path.is_file())
}

/// Value that a script of a page writes into the element `read`.
fn read(browser: &Path, page: &Path, more: &[&str]) -> Value {
    let output = Command::new(browser)
        .args([
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--virtual-time-budget=600000",
            "--window-size=1400,900",
        ])
        .args(more)
        .arg("--dump-dom")
        .arg(format!("file://{}", page.display()))
        .stderr(Stdio::null())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let read = text.split("<pre id=\"read\">").nth(1).unwrap_or_else(|| panic!("nothing was read: {}", text.len()));
    let json = read.split("</pre>").next().unwrap_or_default();
    serde_json::from_str(&json.replace("&lt;", "<").replace("&gt;", ">").replace("&amp;", "&")).unwrap()
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

/// The number of residuals among positions of the cursor that are measured less modelled; fails where one is not.
fn residuals(positions: &Value) -> usize {
    let mut compared = 0;
    for position in positions.as_array().unwrap() {
        let rows: Vec<&str> = position.as_array().unwrap().iter().filter_map(Value::as_str).collect();
        let of = |series: &str| rows.iter().filter_map(|text| row(text, series)).collect::<Vec<_>>();
        for (panel, (residual, c)) in of("residual") {
            let signal = panel.trim_end_matches(" − model");
            let same = |series: &str| of(series).into_iter().find(|(name, _)| *name == signal).map(|(_, value)| value);
            let (Some((measured, a)), Some((modelled, b))) = (same("measured"), same("modelled")) else { continue };
            compared += 1;
            let left = (measured - modelled - residual).abs();
            assert!(left <= 1.2 * (a + b + c), "{left}: {rows:?}");
        }
    }
    compared
}

/// The page of a study with a script in it.
fn study_page(script: &str) -> (Campaign, PathBuf) {
    let campaign = Campaign::whole();
    assert!(matches!(campaign.run(&["study", "bench.toml", "--quiet"]).code, Some(0 | 1)));
    let page = campaign.read("study/report.html");
    assert!(page.contains("Drawn with"), "a figure with fewer points than samples is what this test is about");
    campaign.write("read.html", page.replace("</body>", &format!("{script}</body>")).as_bytes());
    let path = campaign.path("read.html");
    (campaign, path)
}

#[test]
fn exact_at_every_position_of_the_cursor_measured_less_modelled_is_the_residual() {
    // `exact_what_is_drawn_of_a_residual_…` of `page` proves the same of the drawing.
    let Some(browser) = browser() else { return testdata::skip("no browser (Chromium) to read figures with") };
    let (_campaign, page) = study_page(READER);
    let found = read(&browser, &page, &[]);
    let figures = found["figures"].as_array().unwrap();
    let count = |of: &str| figures.iter().map(|figure| residuals(&figure[of])).sum::<usize>();
    let (whole, zoomed) = (count("whole"), count("zoomed"));
    assert!(whole > 200 && zoomed > 200, "{whole} and {zoomed} positions were compared");
    for figure in figures {
        let state = figure["state"].as_str().unwrap();
        assert!(state.contains("every sample"), "{}: {state}", figure["title"]);
        assert!(figure["drawn"].as_u64() > Some(40), "{}: {} points in view", figure["title"], figure["drawn"]);
        assert_eq!(figure["linked"], 0, "all are shown again: {}", figure["title"]);
    }
    let most = |of: &str| figures.iter().filter_map(|figure| figure[of].as_u64()).max();
    assert!(most("followers") > Some(0), "figures of one recording are zoomed together");
    assert!(most("apart") > Some(0), "without the link one is zoomed alone");
    saved(&found["saved"]);
}

/// The files of a figure: numbers with every sample, a drawing and a picture.
fn saved(files: &Value) {
    let names: Vec<&str> = files["names"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    assert!(names[0].ends_with(".csv") && names[1].ends_with(".svg") && names[2].ends_with(".png"), "{names:?}");
    assert_eq!(files["isDrawing"], true);
    assert!(files["kind"] == "image/png" && files["pixels"].as_u64() > Some(10_000), "{}", files["pixels"]);
    let csv = files["csv"].as_str().unwrap();
    let mut lines = csv.lines();
    let heads: Vec<&str> = lines.next().unwrap().split("\",\"").map(|head| head.trim_matches('"')).collect();
    let at = |words: &[&str]| heads.iter().position(|head| words.iter().all(|word| head.contains(word))).unwrap();
    let [time, measured, modelled, residual] =
        [at(&["time [s]"]), at(&["measured ["]), at(&["modelled ["]), at(&["residual ["])];
    let rows: Vec<Vec<f64>> =
        lines.map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()).collect();
    assert!(rows.len() > 1500, "{} rows", rows.len());
    let step = rows[1][time] - rows[0][time];
    let span = |at: usize| {
        let column = || rows.iter().map(|row| row[at]).filter(|y| y.is_finite());
        column().fold(f64::NEG_INFINITY, f64::max) - column().fold(f64::INFINITY, f64::min)
    };
    // Each of the three is known to a step of its range, of which there are 2^14.
    let known = (span(measured) + span(modelled) + span(residual)) / 16_000.0;
    for pair in rows.windows(2) {
        assert!((pair[1][time] - pair[0][time] - step).abs() < 1e-6 * step.max(1.0), "every sample: {pair:?}");
        let left = pair[0][measured] - pair[0][modelled] - pair[0][residual];
        assert!(left.is_nan() || left.abs() <= known, "{left}: {:?}", pair[0]);
    }
}

#[test]
fn ref_a_checker_of_accessibility_finds_nothing_in_light_or_dark() {
    let Some(browser) = browser() else { return testdata::skip("no browser (Chromium) to read figures with") };
    let Some(axe) = testdata::axe() else { return };
    let axe = format!("<script>{}</script>{AXE}", std::fs::read_to_string(axe).unwrap());
    let (campaign, study) = study_page(&axe);
    let recording = "recordings/WhiteNoise_T_TN_1200.mf4";
    let fit = ["fit", "arx", recording, "-u", "DynoTorqueDemand", "-y", "DynoTorqueCalc", "--na", "2", "--nb", "2"];
    assert_eq!(campaign.run(&[&fit[..], &["--plot", "fit.html"]].concat()).code, Some(0));
    campaign.write("fit-read.html", campaign.read("fit.html").replace("</body>", &format!("{axe}</body>")).as_bytes());
    for page in [study, campaign.path("fit-read.html")] {
        for scheme in ["--blink-settings=preferredColorScheme=1", "--blink-settings=preferredColorScheme=0"] {
            let found = read(&browser, &page, &[scheme]);
            assert_eq!(found.as_array().map(Vec::len), Some(0), "{} {scheme}: {found:#}", page.display());
        }
    }
}
