// Interaction: zoom, read-out, legend, keyboard. All panels of a figure move together.

const SMALLEST_DRAG = 6;

/** Shows a part of the x-axis; null shows all of it. */
function zoomTo(plot, domain) {
  plot.domain = domain || xExtent(plot.figure);
  plot.box.classList.toggle("zoomed", Boolean(domain));
  redraw(plot);
}

function redraw(plot) {
  plot.layout = drawFigure(plot, plot.width);
}

/** Horizontal position of a pointer in the figure's own coordinates. */
function pointerX(plot, event) {
  const box = plot.svg.getBoundingClientRect();
  return ((event.clientX - box.left) * plot.width) / box.width;
}

const inside = (plot, x) => Math.min(plot.layout.right, Math.max(plot.layout.left, x));

function listenToPointer(plot) {
  let start = null;
  let selection = null;
  plot.svg.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || event.pointerType === "touch") return;
    start = inside(plot, pointerX(plot, event));
    plot.svg.setPointerCapture(event.pointerId);
  });
  plot.svg.addEventListener("pointermove", (event) => {
    const x = inside(plot, pointerX(plot, event));
    showCursor(plot, plot.layout.sx.toValue(x), event);
    if (start === null) return;
    selection = selection || svg(plot.svg, "rect", { class: "selection" });
    const { top, bottom } = plot.layout;
    const size = { x: Math.min(start, x), width: Math.abs(x - start), y: top, height: bottom - top };
    for (const key in size) selection.setAttribute(key, size[key]);
  });
  plot.svg.addEventListener("pointerup", (event) => {
    const x = inside(plot, pointerX(plot, event));
    if (selection) selection.remove();
    selection = null;
    if (start !== null && Math.abs(x - start) >= SMALLEST_DRAG) {
      const ends = [plot.layout.sx.toValue(start), plot.layout.sx.toValue(x)].sort((a, b) => a - b);
      zoomTo(plot, ends);
    }
    start = null;
  });
  plot.svg.addEventListener("pointercancel", () => {
    start = null;
    if (selection) selection.remove();
    selection = null;
  });
  plot.svg.addEventListener("pointerleave", () => hideCursor(plot));
  plot.svg.addEventListener("dblclick", () => zoomTo(plot, null));
}

/** Draws the cursor at an x value and fills the read-out. `event` places the read-out; without it, it stays put. */
function showCursor(plot, value, event) {
  plot.cursor = value;
  const { sx, panels, top, bottom } = plot.layout;
  const x = sx.toPixel(value);
  plot.cursorLayer.replaceChildren();
  svg(plot.cursorLayer, "line", { x1: x, x2: x, y1: top, y2: bottom });
  const rows = panels.flatMap((frame) => readPanel(plot, frame, value));
  fillReadout(plot, value, rows);
  placeReadout(plot, x, event);
}

/** The value of every visible series of a panel at the sample nearest to the cursor, each marked by a ring. */
function readPanel(plot, { panel, sx, sy }, value) {
  const shown = panel.layers.filter((layer) => isSeries(layer) && !plot.hidden.has(layer.name) && layer.x.length > 0);
  return shown.map((layer) => {
    const at = nearest(layer.x, value, sx);
    const [cx, cy] = [sx.toPixel(layer.x[at]), sy.toPixel(layer.y[at])];
    const seen = layer.x[at] >= sx.low && layer.x[at] <= sx.high && Number.isFinite(cy);
    if (seen) svg(plot.cursorLayer, "circle", { class: `ring s-${layer.style}`, cx, cy, r: 3.5 });
    return { layer, label: panel.y.label, unit: panel.y.unit, value: seen ? layer.y[at] : NaN };
  });
}

function fillReadout(plot, value, rows) {
  const { label, unit } = plot.figure.x;
  plot.readout.replaceChildren();
  const head = document.createElement("div");
  head.textContent = `${label} ${positionText(plot, value)} ${unit}`;
  head.className = "at";
  plot.readout.append(head);
  for (const row of rows) {
    const line = document.createElement("div");
    line.append(swatch(row.layer), " ");
    htmlText(line, rows.some((other) => other.label !== row.label) ? `${row.label}, ${row.layer.name}` : row.layer.name, plot.figure.symbols);
    const number = document.createElement("b");
    number.textContent = ` ${plainNumber(row.value, 5)} ${row.unit}`;
    line.append(number);
    plot.readout.append(line);
  }
  plot.readout.hidden = false;
}

/** The cursor's x to a thousandth of what is in view. */
function positionText({ figure, domain }, value) {
  if (figure.x.scale === "log") return plainNumber(value, 4);
  return fixedNumber(value, Math.max(0, 3 - decades(domain[1] - domain[0])));
}

/** Puts the read-out beside the cursor, on the side with more room. */
function placeReadout(plot, x, event) {
  const scale = plot.svg.getBoundingClientRect().width / plot.width;
  const [left, width] = [x * scale, plot.readout.offsetWidth];
  const right = left + 14 + width > plot.width * scale;
  plot.readout.style.left = `${Math.max(0, right ? left - 14 - width : left + 14)}px`;
  const top = event ? event.clientY - plot.stage.getBoundingClientRect().top - 20 : MARGIN.top;
  plot.readout.style.top = `${Math.max(0, Math.min(top, plot.stage.offsetHeight - plot.readout.offsetHeight))}px`;
}

function hideCursor(plot) {
  plot.cursorLayer.replaceChildren();
  plot.readout.hidden = true;
  plot.cursor = null;
}

/** Arrow keys move the cursor, + and − zoom around it, Escape shows all again. */
function listenToKeys(plot) {
  plot.svg.addEventListener("keydown", (event) => {
    const { sx, left, right } = plot.layout;
    const at = sx.toPixel(plot.cursor === null ? sx.toValue((left + right) / 2) : plot.cursor);
    const step = event.shiftKey ? 40 : 4;
    const zoom = (factor) => {
      const edges = [left, right].map((edge) => inside(plot, at + (edge - at) * factor));
      zoomTo(plot, edges.map(sx.toValue));
      showCursor(plot, sx.toValue(at));
    };
    const actions = {
      ArrowLeft: () => showCursor(plot, sx.toValue(inside(plot, at - step))),
      ArrowRight: () => showCursor(plot, sx.toValue(inside(plot, at + step))),
      "+": () => zoom(0.5),
      "-": () => zoomTo(plot, null),
      Escape: () => { zoomTo(plot, null); hideCursor(plot); },
    };
    if (!actions[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    actions[event.key]();
  });
  plot.svg.addEventListener("blur", () => hideCursor(plot));
}

/** One button a series; pressing it hides or shows the series in every panel. */
function fillLegend(plot, legend) {
  const named = new Map();
  for (const layer of plot.figure.panels.flatMap((panel) => panel.layers)) {
    const drawn = isSeries(layer) || isLoose(layer);
    if (drawn && layer.name && !named.has(layer.name)) named.set(layer.name, layer);
  }
  for (const [name, layer] of named.size > 1 ? named : []) {
    const button = document.createElement("button");
    button.type = "button";
    button.setAttribute("aria-pressed", "true");
    button.append(swatch(layer), " ");
    htmlText(button, name, plot.figure.symbols);
    button.addEventListener("click", () => {
      const shown = plot.hidden.delete(name) || !plot.hidden.add(name);
      button.setAttribute("aria-pressed", String(shown));
      redraw(plot);
    });
    legend.append(button);
  }
  for (const label of regionLabels(plot.figure)) {
    const entry = document.createElement("span");
    const key = document.createElement("i");
    key.className = "swatch shaded";
    entry.append(key, ` ${label}`);
    legend.append(entry);
  }
}

function regionLabels(figure) {
  const regions = figure.panels.flatMap((panel) => panel.layers).filter((layer) => /region/.test(layer.type) && layer.label);
  return new Set(regions.map((layer) => layer.label));
}

function swatch(layer) {
  if (layer.type === "markers") {
    const key = svg(null, "svg", { class: "mark-key", width: 12, height: 12 });
    svg(key, "path", { class: `${classOf(layer)} markers`, d: SHAPES[layer.marker](6, 6) });
    return key;
  }
  const key = document.createElement("i");
  const shape = !isLine(layer) ? " dot" : DASHED.has(layer.style) ? " dashed" : "";
  key.className = `swatch k-${layer.style}${shape}`;
  return key;
}

/** HTML text with indices. */
function htmlText(parent, text, symbols) {
  for (const [piece, isBelow] of symbolPieces(text, symbols)) {
    const part = document.createElement(isBelow ? "sub" : "span");
    part.textContent = piece;
    parent.append(part);
  }
}
