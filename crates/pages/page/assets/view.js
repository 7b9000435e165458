// What part of a figure is shown: its drawing is moved and stretched, and axes are marked anew. Nothing is drawn twice.

const SVG = "http://www.w3.org/2000/svg";
const MARGIN = 18; // from the right end of the axes to that of the drawing
const AIR = 0.07; // above and below what is in view, as a part of its height

/** An SVG element with attributes, appended to `parent`. */
function svg(parent, name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (parent) parent.appendChild(element);
  return element;
}

const numbers = (text) => (text.match(/-?\d*\.?\d+(?:e-?\d+)?/g) || []).map(Number);

/** A panel as it was drawn: frame and scales in pixels of the drawing, layers with what they hold. */
function readPanel(group) {
  const [left, right, top, bottom] = group.dataset.frame.split(" ").map(Number);
  const scale = (text, from, to) => {
    const [kind, low, high] = text.split(" ");
    return makeScale(kind, Number(low), Number(high), from, to);
  };
  const sx = scale(group.dataset.x, left, right);
  const sy = scale(group.dataset.y, bottom, top);
  const { label, unit } = group.dataset;
  const layers = [...group.querySelectorAll(".layer")].map(readLayer);
  const of = (name) => group.querySelector(name);
  const drawn = { axes: of(".axes").cloneNode(true), x: of(".axis-name.x") };
  const [fixed, last] = ["fixed", "last"].map((name) => name in group.dataset);
  return { group, left, right, top, bottom, sx, sy, label, unit, layers, drawn, fixed, last, clip: of("clipPath rect") };
}

function readLayer(group) {
  const { type, moves = "xy", name, style } = group.dataset;
  const children = [...group.children].map((element) => {
    const at = element.dataset.at && element.dataset.at.split(" ").map(Number);
    const own = ["x", "y"].map((key) => Number(element.getAttribute(key)));
    return { element, at, own, scale: Number(element.dataset.scale || 1), isText: element.tagName === "text" };
  });
  const layer = { group, type, moves, name, style, children, points: null, samples: null };
  layer.isCoarse = children.some((child) => child.scale < 1);
  // From a point, in pixels, to the next one that can be written.
  layer.finest = layer.isCoarse ? 0.1 : type === "line" ? 0.001 : 0.01;
  return layer;
}

/** The points of a series in pixels of the drawing, read from its path when they are first needed, and which of them begin a stretch. */
function pointsOf(layer) {
  if (layer.points) return layer.points;
  const [x, y, begins] = [[], [], new Set()];
  const [{ element, scale }] = layer.children.length > 0 ? layer.children : [{ element: layer.group, scale: 1 }];
  let pen = [0, 0];
  const add = ([px, py]) => {
    pen = [px, py];
    x.push(scale * px);
    y.push(scale * py);
  };
  for (const [, letter, text] of (element.getAttribute("d") || "").matchAll(/([MmlhV])([^MmlhV]*)/g)) {
    const all = numbers(text);
    if (letter === "h") pen[0] += all[0];
    if (letter === "V" || letter === "h") continue;
    if (letter !== "l") begins.add(x.length);
    for (let n = 0; n + 1 < all.length; n += 2) add(letter === "M" ? [all[n], all[n + 1]] : [pen[0] + all[n], pen[1] + all[n + 1]]);
  }
  layer.points = { x, y, begins };
  return layer.points;
}

const isSeries = (layer) => ["line", "points", "stems"].includes(layer.type);

/** First position in ascending x whose value is not below `value`. */
function lowerBound(x, value) {
  let [low, high] = [0, x.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (x[middle] < value) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** From where to where the series in view reach, in pixels of the drawing; the whole frame where none is in view. */
function heightInView(panel, [from, to], hidden) {
  let [low, high] = [Infinity, -Infinity];
  for (const layer of panel.layers) {
    if (!isSeries(layer) || hidden.has(layer.name)) continue;
    const { x, y } = pointsOf(layer);
    const end = Math.min(x.length, lowerBound(x, to) + 1);
    for (let n = Math.max(0, lowerBound(x, from) - 1); n < end; n++) {
      low = Math.min(low, y[n]);
      high = Math.max(high, y[n]);
    }
  }
  if (!(low < high)) return [panel.top, panel.bottom];
  const air = AIR * (high - low);
  return [low - air, high + air];
}

/** Shows the part of the figure that `plot.domain` names (pixels of the drawing; null for all) at a width. */
function show(plot) {
  const { panels, width, hidden, root } = plot;
  const right = width - MARGIN;
  const whole = plot.domain === null && hidden.size === 0;
  const domain = plot.domain || [panels[0].left, panels[0].right];
  for (const panel of panels) {
    const { left, top, bottom } = panel;
    const ax = (right - left) / (domain[1] - domain[0]);
    const view = { ax, bx: left - ax * domain[0], ay: 1, by: 0 };
    if (plot.equalAxes) {
      // A pixel stays worth the same along both axes; the height that was pointed at moves to the middle.
      const zoom = (panel.right - left) / (domain[1] - domain[0]);
      const middle = (top + bottom) / 2;
      view.ay = zoom;
      view.by = middle - zoom * (whole || plot.focus === null ? middle : plot.focus);
    } else if (!whole && !panel.fixed) {
      const [low, high] = heightInView(panel, domain, hidden);
      view.ay = (bottom - top) / (high - low);
      view.by = top - view.ay * low;
    }
    panel.view = view;
    panel.clip.setAttribute("width", right - left);
    panel.layers.forEach((layer) => move(layer, panel, right, { hidden, isWhole: whole }));
    markAxes(panel, right, whole && width === plot.drawnWidth);
  }
  root.setAttribute("viewBox", `0 0 ${width} ${plot.height}`);
  root.setAttribute("width", width);
  stateView(plot);
}

/** Strokes of lines whose points are further apart than pixels. */
const WIDTHS = { measured: 2, residual: 1, guide: 0.8 };

/** Draws the samples in view in place of the line as it was drawn; a dense one with the stroke that it was drawn with. */
function drawSamples(layer, panel, right) {
  if (layer.children.length === 0) return;
  const [{ element }] = layer.children;
  const names = ["stroke-width", "stroke-opacity"];
  layer.dense = layer.dense || names.map((name) => [name, element.getAttribute(name)]);
  const { d, count } = pathInView(layer, panel.view, panel.left, right);
  element.setAttribute("d", d);
  element.removeAttribute("transform");
  const sparse = [["stroke-width", WIDTHS[layer.style] || 1.2], ["stroke-opacity", null]];
  for (const [name, value] of count > right - panel.left ? layer.dense : sparse) {
    if (value === null) element.removeAttribute(name);
    else element.setAttribute(name, value);
  }
}

/** Moves and stretches what a layer holds; texts and markers move and keep their size. */
function move(layer, panel, right, { hidden, isWhole }) {
  layer.group.style.display = layer.name && hidden.has(layer.name) ? "none" : "";
  if (layer.type === "outside") layer.group.style.display = isWhole ? "" : "none";
  if (layer.samples) return drawSamples(layer, panel, right);
  const { ax, bx, ay, by } = panel.view;
  const toX = (x) => (layer.moves.includes("x") ? ax * x + bx : x);
  const toY = (y) => (layer.moves.includes("y") ? ay * y + by : y);
  const [mx, cx] = layer.moves.includes("x") ? [ax, bx] : [(right - panel.left) / (panel.right - panel.left), 0];
  const [my, cy] = layer.moves.includes("y") ? [ay, by] : [1, 0];
  const shiftX = layer.moves.includes("x") ? cx : panel.left * (1 - mx);
  const taken = [];
  for (const child of layer.children) {
    const { element, at, own, scale, isText } = child;
    if (layer.type === "words") placeWord(child, [toX(at[0]), toY(at[1])], panel, right, taken);
    else if (at) element.setAttribute("transform", `translate(${toX(at[0])} ${toY(at[1])})`);
    else if (!isText) element.setAttribute("transform", `matrix(${scale * mx} 0 0 ${scale * my} ${shiftX} ${cy})`);
    else {
      element.setAttribute("x", toX(own[0]));
      element.setAttribute("y", toY(own[1]));
    }
  }
}

/** A word beside its point, unless it would cover one before it. */
function placeWord({ element }, [x, y], panel, right, taken) {
  element.removeAttribute("display");
  const half = element.getComputedTextLength() / 2;
  const middle = Math.min(right - half, Math.max(panel.left + half, x));
  const base = Math.max(panel.top + 10, y - 5);
  const covers = taken.some(([from, to, above, below]) => middle - half < to && middle + half > from && base - 11 < below && base > above);
  if (covers || x < panel.left || x > right || base > panel.bottom) {
    element.setAttribute("display", "none");
    return;
  }
  taken.push([middle - half, middle + half, base - 11, base]);
  element.setAttribute("x", middle);
  element.setAttribute("y", base);
}

/** Marks the axes of what is shown; where that is all, as they were drawn. */
function markAxes(panel, right, asDrawn) {
  const old = panel.group.querySelector(".axes");
  if (panel.drawn.x) panel.drawn.x.setAttribute("x", right);
  if (asDrawn) {
    old.replaceWith(panel.drawn.axes.cloneNode(true));
    return;
  }
  const { left, top, bottom, view } = panel;
  const axes = svg(null, "g", { class: "axes" });
  const part = (scale, [from, to], [a, b]) => makeScale(scale.kind, scale.toValue((from - b) / a), scale.toValue((to - b) / a), from, to);
  const sy = part(panel.sy, [bottom, top], [view.ay, view.by]);
  const sx = part(panel.sx, [left, right], [view.ax, view.bx]);
  const vertical = makeTicks(sy, (bottom - top) / 30);
  const horizontal = makeTicks(sx, (right - left) / 75);
  const lines = [
    ...vertical.ticks.map((value) => `M${left} ${sy.toPixel(value)}H${right}`),
    ...horizontal.ticks.map((value) => `M${sx.toPixel(value)} ${top}V${bottom}`),
  ];
  svg(axes, "path", { class: "grid", d: lines.join("") });
  const mark = (group, x, y, text) => { svg(group, "text", { x, y }).textContent = text; };
  const beside = svg(axes, "g", { class: "tick", "text-anchor": "end" });
  for (const value of vertical.ticks) mark(beside, left - 7, sy.toPixel(value) + 4, vertical.format(value));
  const below = svg(axes, "g", { class: "tick", "text-anchor": "middle" });
  if (panel.last) horizontal.ticks.forEach((value) => mark(below, sx.toPixel(value), bottom + 17, horizontal.format(value)));
  svg(axes, "line", { class: "axis", x1: left, x2: right, y1: bottom, y2: bottom });
  old.replaceWith(axes);
}
