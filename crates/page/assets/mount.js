// Start: every figure of the page becomes interactive, and follows the width of its column.

const plots = [];

function mount(box) {
  const stage = box.querySelector(".stage");
  const root = stage.querySelector("svg");
  const readout = document.createElement("output");
  readout.className = "readout";
  readout.hidden = true;
  stage.append(readout);
  root.setAttribute("tabindex", 0);
  root.setAttribute("aria-label", `${root.getAttribute("aria-label")}. Arrow keys read values, plus zooms, Escape resets.`);
  root.querySelector("title").remove(); // it would cover the read-out
  const panels = [...root.querySelectorAll(".panel")].map(readPanel);
  if (panels.length === 0) return;
  const [, , width, height] = root.getAttribute("viewBox").split(" ").map(Number);
  const entries = new Map([...box.querySelectorAll(".legend .entry")].map((entry) => [entry.dataset.name, entry]));
  const { xLabel: label, xUnit: unit } = root.dataset;
  const plot = {
    box, stage, root, readout, panels, height, entries, label, unit,
    equalAxes: "equalAxes" in root.dataset, drawnWidth: width, width,
    hidden: new Set(), cursor: null, domain: null, focus: null, cursorLayer: svg(root, "g", { class: "cursor" }),
  };
  listenToLegend(plot);
  fit(plot, stage.clientWidth);
  listenToPointer(plot);
  listenToKeys(plot);
  plots.push(plot);
}

/** Shows a figure at a width. */
function fit(plot, width) {
  if (width < 50) return;
  plot.width = plot.equalAxes ? plot.drawnWidth : width;
  show(plot);
}

/** On paper a figure is as it was drawn. */
function fitToPaper() {
  for (const plot of plots) {
    hideCursor(plot);
    fit(plot, plot.drawnWidth);
  }
}

function fitToScreen() {
  plots.forEach((plot) => fit(plot, plot.stage.clientWidth));
}

document.querySelectorAll("figure.plot").forEach(mount);
// What is folded has no width until it is opened.
document.querySelectorAll("details").forEach((fold) => fold.addEventListener("toggle", fitToScreen));
const foldedAway = [];
window.addEventListener("beforeprint", () => {
  for (const fold of document.querySelectorAll("details:not([open])")) {
    fold.open = true;
    foldedAway.push(fold);
  }
  fitToPaper();
});
window.addEventListener("afterprint", () => foldedAway.splice(0).forEach((fold) => { fold.open = false; }));
window.addEventListener("afterprint", fitToScreen);
let pending = 0;
window.addEventListener("resize", () => {
  cancelAnimationFrame(pending);
  pending = requestAnimationFrame(fitToScreen);
});
