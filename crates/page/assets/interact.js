// Interaction: zoom, read-out, legend, keyboard. All panels of a figure move together.

const SMALLEST_DRAG = 6;

/** Shows a part of the x-axis, in pixels of the drawing; null shows all of it. `focus` is the height pointed at. */
function zoomTo(plot, domain, focus = null) {
  plot.domain = domain;
  plot.focus = focus;
  plot.box.classList.toggle("zoomed", Boolean(domain));
  show(plot);
}

/** Horizontal position of a pointer in the figure's own coordinates. */
function pointerX(plot, event) {
  const box = plot.root.getBoundingClientRect();
  return ((event.clientX - box.left) * plot.width) / box.width;
}

/** Vertical position of a pointer in the figure's own coordinates. */
function pointerY(plot, event) {
  const box = plot.root.getBoundingClientRect();
  return ((event.clientY - box.top) * plot.height) / box.height;
}

const ends = (plot) => [plot.panels[0].left, plot.width - MARGIN];
const inside = (plot, x) => Math.min(ends(plot)[1], Math.max(ends(plot)[0], x));

/** From a pixel on the screen to one of the drawing, and back. */
const drawn = ({ panels: [{ view }] }, x) => (x - view.bx) / view.ax;
const shown = ({ panels: [{ view }] }, x) => view.ax * x + view.bx;

function listenToPointer(plot) {
  let start = null;
  let selection = null;
  const over = () => [plot.panels[0].top, plot.panels[plot.panels.length - 1].bottom];
  plot.root.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || event.pointerType === "touch") return;
    start = inside(plot, pointerX(plot, event));
    plot.root.setPointerCapture(event.pointerId);
  });
  plot.root.addEventListener("pointermove", (event) => {
    const x = inside(plot, pointerX(plot, event));
    showCursor(plot, drawn(plot, x), event);
    if (start === null) return;
    selection = selection || svg(plot.root, "rect", { class: "selection" });
    const [top, bottom] = over();
    const size = { x: Math.min(start, x), width: Math.abs(x - start), y: top, height: bottom - top };
    for (const key in size) selection.setAttribute(key, size[key]);
  });
  const end = () => {
    if (selection) selection.remove();
    [start, selection] = [null, null];
  };
  plot.root.addEventListener("pointerup", (event) => {
    const x = inside(plot, pointerX(plot, event));
    if (start !== null && Math.abs(x - start) >= SMALLEST_DRAG) {
      const { ay, by } = plot.panels[0].view;
      const focus = (pointerY(plot, event) - by) / ay;
      zoomTo(plot, [start, x].map((at) => drawn(plot, at)).sort((a, b) => a - b), focus);
    }
    end();
  });
  plot.root.addEventListener("pointercancel", end);
  plot.root.addEventListener("pointerleave", () => hideCursor(plot));
  plot.root.addEventListener("dblclick", () => zoomTo(plot, null));
}

/** Draws the cursor at an x of the drawing and fills the read-out. `event` places the read-out; without it, it stays. */
function showCursor(plot, at, event) {
  plot.cursor = at;
  const x = shown(plot, at);
  plot.root.append(plot.cursorLayer);
  plot.cursorLayer.replaceChildren();
  const last = plot.panels[plot.panels.length - 1];
  svg(plot.cursorLayer, "line", { x1: x, x2: x, y1: plot.panels[0].top, y2: last.bottom });
  const rows = plot.panels.flatMap((panel) => readValues(plot, panel, at));
  fillReadout(plot, at, rows);
  placeReadout(plot, x, event);
}

/** Points of a line that are further apart, in pixels, are corners of a course that is straight in between. */
const SPARSE = 3;

/** Where a series is read: at the nearest point, or on the straight line between the corners of a sparse course. */
function pointAt(layer, at, scale) {
  const { x, y, begins } = pointsOf(layer);
  const after = lowerBound(x, at);
  const isBetween = layer.type === "line" && after > 0 && after < x.length && !begins.has(after);
  if (isBetween && scale * (x[after] - x[after - 1]) > SPARSE) {
    const share = (at - x[after - 1]) / (x[after] - x[after - 1]);
    return [at, y[after - 1] + share * (y[after] - y[after - 1])];
  }
  const nearest = after > 0 && (after === x.length || at - x[after - 1] <= x[after] - at) ? after - 1 : after;
  return [x[nearest], y[nearest]];
}

/** The value of every visible series of a panel at the cursor, each marked by a ring. */
function readValues(plot, panel, at) {
  const { ax, bx, ay, by } = panel.view;
  return panel.layers.filter((layer) => isSeries(layer) && !plot.hidden.has(layer.name)).map((layer) => {
    const [x, y] = pointAt(layer, at, ax);
    const [cx, cy] = [ax * x + bx, ay * y + by];
    const seen = cx >= panel.left - 0.5 && cx <= ends(plot)[1] + 0.5;
    if (seen) svg(plot.cursorLayer, "circle", { class: `ring s-${layer.style}`, cx, cy, r: 3.5 });
    return { layer, panel, value: seen ? panel.sy.toValue(y) : NaN };
  });
}

function fillReadout(plot, at, rows) {
  plot.readout.replaceChildren();
  const line = (text, name) => {
    const element = document.createElement("div");
    element.className = name;
    element.append(text);
    plot.readout.append(element);
    return element;
  };
  line(`${plot.label} ${positionText(plot, at)} ${plot.unit}`, "at");
  const severalPanels = rows.some((row) => row.panel !== rows[0].panel);
  for (const { layer, panel, value } of rows) {
    const row = line("", "value");
    const entry = plot.entries.get(layer.name);
    if (entry) row.append(entry.querySelector("svg").cloneNode(true), " ");
    row.append(severalPanels ? `${panel.label}, ${layer.name}` : layer.name);
    const number = document.createElement("b");
    number.textContent = ` ${valueText(panel, value)} ${panel.unit}`;
    row.append(number);
  }
  plot.readout.hidden = false;
}

/** From a line's point in the drawing, in pixels, to the next one that can be written. */
const DRAWN_STEP = 0.001;

/** A value with the digits that the drawing carries: its last digit is worth five steps of the drawing or more. */
function valueText({ sy, top, bottom }, value) {
  if (sy.kind === "log" || !Number.isFinite(value)) return plainNumber(value, 4);
  const step = (5 * DRAWN_STEP * (sy.high - sy.low)) / (bottom - top);
  const place = Math.ceil(Math.log10(step));
  if (place <= 0) return fixedNumber(value, -place);
  const unit = Math.pow(10, place);
  return fixedNumber(unit * Math.round(value / unit), 0);
}

/** The cursor's x to a thousandth of what is in view. */
function positionText(plot, at) {
  const { sx } = plot.panels[0];
  const value = sx.toValue(at);
  if (sx.kind === "log") return plainNumber(value, 4);
  const [from, to] = ends(plot).map((x) => sx.toValue(drawn(plot, x)));
  return fixedNumber(value, Math.max(0, 3 - decades(to - from)));
}

/** Puts the read-out beside the cursor, on the side with more room. */
function placeReadout(plot, x, event) {
  const scale = plot.root.getBoundingClientRect().width / plot.width;
  const [left, width] = [x * scale, plot.readout.offsetWidth];
  const isRight = left + 14 + width > plot.width * scale;
  plot.readout.style.left = `${Math.max(0, isRight ? left - 14 - width : left + 14)}px`;
  const top = event ? event.clientY - plot.stage.getBoundingClientRect().top - 20 : plot.panels[0].top;
  plot.readout.style.top = `${Math.max(0, Math.min(top, plot.stage.offsetHeight - plot.readout.offsetHeight))}px`;
}

function hideCursor(plot) {
  plot.cursorLayer.replaceChildren();
  plot.readout.hidden = true;
  plot.cursor = null;
}

/** Arrow keys move the cursor, + and − zoom around it, Escape shows all again. */
function listenToKeys(plot) {
  plot.root.addEventListener("keydown", (event) => {
    const [left, right] = ends(plot);
    const at = plot.cursor === null ? (left + right) / 2 : shown(plot, plot.cursor);
    const step = event.shiftKey ? 40 : 4;
    const zoom = (factor) => {
      const middle = drawn(plot, at);
      zoomTo(plot, [left, right].map((edge) => drawn(plot, inside(plot, at + (edge - at) * factor))));
      showCursor(plot, middle);
    };
    const actions = {
      ArrowLeft: () => showCursor(plot, drawn(plot, inside(plot, at - step))),
      ArrowRight: () => showCursor(plot, drawn(plot, inside(plot, at + step))),
      "+": () => zoom(0.5),
      "-": () => zoomTo(plot, null),
      Escape: () => { zoomTo(plot, null); hideCursor(plot); },
    };
    if (!actions[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    actions[event.key]();
  });
  plot.root.addEventListener("blur", () => hideCursor(plot));
}

/** Names of the legend become buttons that hide or show their series in every panel. */
function listenToLegend(plot) {
  for (const [name, entry] of plot.entries) {
    if (!plot.panels.some((panel) => panel.layers.some((layer) => layer.name === name))) continue;
    const button = document.createElement("button");
    button.type = "button";
    button.className = "entry";
    button.setAttribute("aria-pressed", "true");
    button.append(...[...entry.childNodes].map((node) => node.cloneNode(true)));
    button.addEventListener("click", () => {
      const isShown = plot.hidden.delete(name) || !plot.hidden.add(name);
      button.setAttribute("aria-pressed", String(isShown));
      show(plot);
    });
    entry.replaceWith(button);
    plot.entries.set(name, button);
  }
}
