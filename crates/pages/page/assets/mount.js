// Start: every figure of the page becomes interactive, and follows the width of its column.

const plots = [];

/** What a reader comes near is drawn from its samples. */
const comesIntoView = new IntersectionObserver((entries) => {
  const near = entries.filter((entry) => entry.isIntersecting).map((entry) => entry.target);
  plots.filter((plot) => near.includes(plot.box)).forEach(unpack);
}, { rootMargin: "300px" });

function mount(box) {
  const stage = box.querySelector(".stage");
  const root = stage.querySelector("svg");
  const panels = [...root.querySelectorAll(".panel")].map(readPanel);
  if (panels.length === 0) return;
  const overlay = (tag, name) => {
    const element = document.createElement(tag);
    element.className = name;
    element.hidden = true;
    stage.append(element);
    return element;
  };
  const [readout, state] = [overlay("output", "readout"), overlay("p", "state")];
  state.setAttribute("role", "status");
  root.setAttribute("tabindex", 0);
  const title = root.querySelector("title");
  const [, , width, height] = root.getAttribute("viewBox").split(" ").map(Number);
  const entries = new Map([...box.querySelectorAll(".legend .entry")].map((entry) => [entry.dataset.name, entry]));
  const { xLabel: label, xUnit: unit, recording } = root.dataset;
  const plot = {
    box, stage, root, readout, state, panels, height, entries, label, unit, recording, title: title.textContent,
    equalAxes: "equalAxes" in root.dataset, drawnWidth: width, width, groups: readHeader(box), unpacking: null,
    hidden: new Set(), cursor: null, domain: null, focus: null, cursorLayer: svg(root, "g", { class: "cursor" }),
  };
  title.remove(); // it would cover the read-out
  listenToLegend(plot);
  addTools(plot);
  fit(plot, stage.clientWidth);
  listenToPointer(plot);
  listenToKeys(plot);
  plots.push(plot);
  comesIntoView.observe(box);
}

/** Shows a figure at a width. */
function fit(plot, width) {
  if (width < 50) return;
  plot.width = plot.equalAxes ? plot.drawnWidth : width;
  show(plot);
  if (plot.cursor !== null) hideCursor(plot);
}

/** On paper a figure is as wide as it was drawn. */
function fitToPaper() {
  plots.forEach((plot) => fit(plot, plot.drawnWidth));
}

function fitToScreen() {
  plots.forEach((plot) => fit(plot, plot.stage.clientWidth));
}

document.querySelectorAll("figure.plot").forEach(mount);
plots.forEach(showLink);
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
