// Start: every figure of the page gets its plot, on the screen and on paper.

const PAPER_WIDTH = 680; // CSS pixels of A4 between the margins
const PAPER_STRETCH = 0.78; // panels are lower on paper, so that fewer pages stay half empty
const plots = [];

function mount(box, number) {
  const source = box.querySelector("script[type='application/json']");
  const figure = decodeFigure(JSON.parse(source.textContent));
  const stage = document.createElement("div");
  stage.className = "stage";
  const legend = document.createElement("div");
  legend.className = "legend";
  const readout = document.createElement("output");
  readout.className = "readout";
  readout.hidden = true;
  const root = svg(null, "svg", { tabindex: 0, role: "img", "aria-label": `${figure.title}. Arrow keys read values, plus zooms, Escape resets.` });
  stage.append(root, readout);
  source.replaceWith(legend, stage);
  const plot = { id: `plot-${number}`, box, stage, svg: root, readout, figure, hidden: new Set(), cursor: null, width: 0, stretch: 1 };
  plot.domain = xExtent(figure);
  fillLegend(plot, legend);
  fit(plot, stage.clientWidth);
  listenToPointer(plot);
  listenToKeys(plot);
  plots.push(plot);
}

/** Draws at a new width. */
function fit(plot, width) {
  if (width < 50 || width === plot.width) return;
  plot.width = width;
  redraw(plot);
}

/** Paper has its own width, known before it is laid out. */
function fitToPaper() {
  for (const plot of plots) {
    hideCursor(plot);
    plot.stretch = PAPER_STRETCH;
    fit(plot, plot.box.parentElement.classList.contains("pair") ? (PAPER_WIDTH - 24) / 2 : PAPER_WIDTH);
  }
}

function fitToScreen() {
  for (const plot of plots) {
    plot.stretch = 1;
    fit(plot, plot.stage.clientWidth);
  }
}

document.querySelectorAll("figure.plot").forEach(mount);
window.addEventListener("beforeprint", fitToPaper);
window.addEventListener("afterprint", fitToScreen);
let pending = 0;
window.addEventListener("resize", () => {
  cancelAnimationFrame(pending);
  pending = requestAnimationFrame(fitToScreen);
});
