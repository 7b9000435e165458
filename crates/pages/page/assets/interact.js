// The pointer, the cursor and its read-out, the legend. All panels of a figure move together.

const SMALLEST_DRAG = 6;

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

/** Dragging selects what is shown; with Shift it moves what is shown. */
function listenToPointer(plot) {
  let drag = null;
  plot.root.addEventListener("pointerenter", () => unpack(plot));
  plot.root.addEventListener("pointerdown", (event) => {
    if (event.button !== 0 || event.pointerType === "touch") return;
    const isPan = event.shiftKey && plot.domain !== null;
    drag = { start: inside(plot, pointerX(plot, event)), isPan, domain: plot.domain, view: plot.panels[0].view, selection: null };
    plot.root.classList.toggle("panning", isPan);
    plot.root.setPointerCapture(event.pointerId);
  });
  plot.root.addEventListener("pointermove", (event) => {
    const x = inside(plot, pointerX(plot, event));
    if (drag && drag.isPan) {
      const way = (drag.start - x) / drag.view.ax;
      zoomTo(plot, drag.domain.map((edge) => edge + way), plot.focus);
    } else if (drag) {
      select(plot, drag, x);
    }
    showCursor(plot, drawn(plot, x));
  });
  const end = () => {
    if (drag && drag.selection) drag.selection.remove();
    plot.root.classList.remove("panning");
    drag = null;
  };
  plot.root.addEventListener("pointerup", (event) => {
    const x = inside(plot, pointerX(plot, event));
    if (drag && !drag.isPan && Math.abs(x - drag.start) >= SMALLEST_DRAG) {
      const { ay, by } = plot.panels[0].view;
      const focus = (pointerY(plot, event) - by) / ay;
      zoomTo(plot, [drag.start, x].map((at) => drawn(plot, at)).sort((a, b) => a - b), focus);
    }
    end();
  });
  plot.root.addEventListener("pointercancel", end);
  plot.root.addEventListener("pointerleave", () => hideCursor(plot));
  plot.root.addEventListener("dblclick", () => zoomTo(plot, null));
}

/** Shows what a drag would zoom to. */
function select(plot, drag, x) {
  drag.selection = drag.selection || svg(plot.root, "rect", { class: "selection" });
  const [top, bottom] = [plot.panels[0].top, plot.panels[plot.panels.length - 1].bottom];
  const size = { x: Math.min(drag.start, x), width: Math.abs(x - drag.start), y: top, height: bottom - top };
  for (const key in size) drag.selection.setAttribute(key, size[key]);
}

/** Draws the cursor at an x of the drawing and fills the read-out. */
function showCursor(plot, at) {
  plot.cursor = at;
  const x = shown(plot, at);
  plot.root.append(plot.cursorLayer);
  plot.cursorLayer.replaceChildren();
  const last = plot.panels[plot.panels.length - 1];
  svg(plot.cursorLayer, "line", { x1: x, x2: x, y1: plot.panels[0].top, y2: last.bottom });
  fillReadout(plot, at, plot.panels.flatMap((panel) => readValues(plot, panel, at)));
}

/** Points of a line that are further apart, in pixels, are corners of a course that is straight in between. */
const SPARSE = 3;

/** Where a series is read: at the nearest point, or on the straight line between the corners of a sparse or coarse course. */
function pointAt(layer, at, scale) {
  const { x, y, begins } = pointsOf(layer);
  const after = lowerBound(x, at);
  const isBetween = layer.type === "line" && !layer.samples && after > 0 && after < x.length && !begins.has(after);
  if (isBetween && (layer.isCoarse || scale * (x[after] - x[after - 1]) > SPARSE)) {
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
    const isIn = seen && cy >= panel.top - 2 && cy <= panel.bottom + 2;
    if (isIn) svg(plot.cursorLayer, "circle", { class: `ring s-${layer.style}`, cx, cy, r: 3.5 });
    return { layer, panel, value: seen ? panel.sy.toValue(y) : NaN };
  });
}

/** The read-out lies below the drawing, over what stands there, so that nothing moves and no curve is covered. */
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
    number.textContent = ` ${valueText(panel, layer, value)} ${panel.unit}`;
    row.append(number);
  }
  plot.readout.hidden = false;
}

/** A value with the digits that are known: its last digit is worth five steps of the drawing or of the samples, or more. */
function valueText({ sy, top, bottom }, layer, value) {
  if (sy.kind === "log" || !Number.isFinite(value)) return plainNumber(value, 4);
  const step = layer.samples ? layer.step : (layer.finest * (sy.high - sy.low)) / (bottom - top);
  const place = Math.ceil(Math.log10(5 * step));
  if (place <= 0) return fixedNumber(value, -place);
  const unit = Math.pow(10, place);
  return fixedNumber(unit * Math.round(value / unit), 0);
}

/** An x of the drawing to a thousandth of what is in view. */
function positionText(plot, at) {
  const { sx } = plot.panels[0];
  const value = sx.toValue(at);
  if (sx.kind === "log") return plainNumber(value, 4);
  const [from, to] = ends(plot).map((x) => sx.toValue(drawn(plot, x)));
  return fixedNumber(value, Math.max(0, 3 - decades(to - from)));
}

function hideCursor(plot) {
  plot.cursorLayer.replaceChildren();
  plot.readout.hidden = true;
  plot.cursor = null;
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
