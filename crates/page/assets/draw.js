// Drawing: one SVG for a figure, its panels below each other.

const SVG = "http://www.w3.org/2000/svg";
const MARGIN = { left: 58, right: 14, top: 24, between: 34, bottom: 40 };
// A word of its own, no part of a file's name.
const SYMBOL = /(?<![\w\-./\\α-ωΑ-Ω])([A-Za-zα-ωΑ-Ω])_([A-Za-z0-9]+(?:,[a-z]+)*)(?!\w|[\-./\\]\w)/g;

/** An SVG element with attributes, appended to `parent`. */
function svg(parent, name, attributes) {
  const element = document.createElementNS(SVG, name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (parent) parent.appendChild(element);
  return element;
}

/** Splits text into pieces, [text, isSubscript], so that T_d is set with an index where words are symbols. */
function symbolPieces(text, symbols = true) {
  if (!symbols) return [[text, false]];
  const pieces = [];
  let end = 0;
  for (const match of text.matchAll(SYMBOL)) {
    pieces.push([text.slice(end, match.index) + match[1], false], [match[2], true]);
    end = match.index + match[0].length;
  }
  pieces.push([text.slice(end), false]);
  return pieces.filter((piece) => piece[0] !== "");
}

/** SVG text with indices. */
function svgText(parent, text, attributes, symbols = true) {
  const element = svg(parent, "text", attributes);
  let below = false;
  for (const [piece, isBelow] of symbolPieces(text, symbols)) {
    const span = svg(element, "tspan", isBelow ? { class: "sub" } : {});
    if (isBelow !== below) span.setAttribute("dy", isBelow ? 3 : -3);
    span.textContent = piece;
    below = isBelow;
  }
  return element;
}

/** Draws the figure anew at a width; returns what interaction needs to know. */
function drawFigure(plot, width) {
  const { figure, domain, hidden } = plot;
  const [left, right] = [MARGIN.left, width - MARGIN.right];
  let sx = makeScale(figure.x.scale, domain[0], domain[1], left, right);
  const root = plot.svg;
  root.replaceChildren();
  let top = MARGIN.top;
  const panels = figure.panels.map((panel, number) => {
    let [low, high] = yExtent(panel, domain, hidden);
    const bottom = top + panel.height * plot.stretch;
    if (figure.equal_axes) {
      const [x, y] = equalRanges(domain, [low, high], right - left, bottom - top);
      sx = makeScale("linear", x[0], x[1], left, right);
      [low, high] = y;
    }
    const sy = makeScale(panel.y.scale, low, high, bottom, top);
    const last = number === figure.panels.length - 1;
    const frame = { panel, sx, sy, left, right, top, bottom, last, names: [], clip: `${plot.id}-${number}` };
    drawPanel(root, frame, figure, hidden);
    top = bottom + MARGIN.between;
    return frame;
  });
  const height = top - MARGIN.between + MARGIN.bottom;
  root.setAttribute("viewBox", `0 0 ${width} ${height}`);
  root.setAttribute("width", width);
  root.setAttribute("height", height);
  plot.cursorLayer = svg(root, "g", { class: "cursor" });
  return { sx, panels, left, right, top: MARGIN.top, bottom: top - MARGIN.between };
}

function drawPanel(root, frame, figure, hidden) {
  const { panel, left, right, top, bottom } = frame;
  const group = svg(root, "g", { class: "panel" });
  const clip = svg(svg(group, "clipPath", { id: frame.clip }), "rect", {});
  for (const [key, value] of Object.entries({ x: left, y: top - 2, width: right - left, height: bottom - top + 4 })) {
    clip.setAttribute(key, value);
  }
  drawYAxis(group, frame);
  drawXAxis(group, frame, figure);
  const inside = svg(group, "g", { "clip-path": `url(#${frame.clip})` });
  for (const layer of panel.layers) {
    if (!hidden.has(layer.name)) LAYERS[layer.type](inside, layer, frame);
  }
  const unit = panel.y.unit ? ` [${panel.y.unit}]` : "";
  const name = svgText(group, panel.y.label + unit, { class: "axis-name", x: left, y: top - 9 }, figure.symbols);
  if (panel.note) svg(name, "tspan", { class: "tick", dx: 8 }).textContent = panel.note;
}

function drawYAxis(group, { sy, left, right, top, bottom }) {
  const { ticks, format } = makeTicks(sy, (bottom - top) / 30);
  for (const value of ticks) {
    const y = sy.toPixel(value);
    svg(group, "line", { class: "grid", x1: left, x2: right, y1: y, y2: y });
    svg(group, "text", { class: "tick", x: left - 7, y: y + 4, "text-anchor": "end" }).textContent = format(value);
  }
}

function drawXAxis(group, { sx, left, right, top, bottom, last }, figure) {
  const { ticks, format } = makeTicks(sx, (right - left) / 75);
  for (const value of ticks) {
    const x = sx.toPixel(value);
    svg(group, "line", { class: "grid", x1: x, x2: x, y1: top, y2: bottom });
    if (last) svg(group, "text", { class: "tick", x, y: bottom + 16, "text-anchor": "middle" }).textContent = format(value);
  }
  svg(group, "line", { class: "axis", x1: left, x2: right, y1: bottom, y2: bottom });
  if (!last) return;
  const name = `${figure.x.label}${figure.x.unit ? ` [${figure.x.unit}]` : ""}`;
  svgText(group, name, { class: "axis-name", x: right, y: bottom + 33, "text-anchor": "end" }, figure.symbols);
}

/** From the name of a mark to one below it. */
const NAME_HEIGHT = 15;

/** The first row along the top of a panel in which a name covers no earlier one; it is taken. */
function freeRow(names, from, to) {
  const free = names.findIndex((row) => row.every(([start, end]) => to < start || from > end));
  const row = free < 0 ? names.push([]) - 1 : free;
  names[row].push([from, to]);
  return row;
}

/** Paths of markers about a point. */
const SHAPES = {
  cross: (x, y) => `M${x - 4} ${y - 4}l8 8M${x - 4} ${y + 4}l8 -8`,
  ring: (x, y) => `M${x - 4.5} ${y}a4.5 4.5 0 1 0 9 0a4.5 4.5 0 1 0 -9 0`,
};

const classOf = (layer) => `series s-${layer.style}${isLine(layer) ? " line" : ""}`;
// A line that travels so many heights of its panel fills an area.
const ROUGH = 20;
const isLine = (layer) => layer.type === "line" || layer.type === "path";
const DASHED = new Set(["sixth", "seventh", "eighth", "ninth", "tenth"]);

/** How each kind of layer is drawn. */
const LAYERS = {
  line(group, layer, { sx, sy }) {
    const [first, end] = visibleRange(layer.x, sx.low, sx.high);
    const dense = end - first > sx.toPixel(sx.high) - sx.toPixel(sx.low) && isRough(layer.y, first, end, sy) ? " dense" : "";
    svg(group, "path", { class: classOf(layer) + dense, d: linePath(layer, sx, sy) });
  },
  points(group, layer, { sx, sy }) {
    const at = layer.x.map((x) => sx.toPixel(x));
    if (layer.low && layer.high) {
      const bars = path(layer, (n) => bar(at[n], sy.toPixel(layer.low[n]), sy.toPixel(layer.high[n])));
      svg(group, "path", { class: `${classOf(layer)} bars`, d: bars });
    }
    const dots = path(layer, (n) => `M${at[n].toFixed(1)} ${sy.toPixel(layer.y[n]).toFixed(1)}h0`);
    const dense = layer.x.length > sx.toPixel(sx.high) - sx.toPixel(sx.low);
    const size = layer.low ? "dots large" : dense ? "dots small" : "dots";
    svg(group, "path", { class: `${classOf(layer)} ${size}`, d: dots });
  },
  stems(group, layer, { sx, sy }) {
    const zero = sy.toPixel(0).toFixed(1);
    const at = (n) => `M${sx.toPixel(layer.x[n]).toFixed(1)} ${zero}V${sy.toPixel(layer.y[n]).toFixed(1)}`;
    svg(group, "path", { class: `${classOf(layer)} stems`, d: path(layer, at) });
    const dot = (n) => `M${sx.toPixel(layer.x[n]).toFixed(1)} ${sy.toPixel(layer.y[n]).toFixed(1)}h0`;
    svg(group, "path", { class: `${classOf(layer)} dots`, d: path(layer, dot) });
  },
  markers(group, layer, { sx, sy }) {
    const at = (n) => [sx.toPixel(layer.x[n]), sy.toPixel(layer.y[n])].map((v) => Number(v.toFixed(1)));
    svg(group, "path", { class: `${classOf(layer)} markers`, d: path(layer, (n) => SHAPES[layer.marker](...at(n))) });
  },
  path(group, layer, { sx, sy }) {
    svg(group, "path", { class: classOf(layer), d: samplePath(layer.x, layer.y, 0, layer.x.length, sx, sy) });
  },
  band(group, layer, { sx, sy }) {
    const [first, end] = visibleRange(layer.x, sx.low, sx.high);
    // What reaches down to nothing ends where a logarithmic axis does.
    const above = (values) => (sy.kind === "log" ? values.map((v) => Math.max(v, sy.low)) : values);
    const upper = samplePath(layer.x, above(layer.high), first, end, sx, sy);
    const back = [layer.x, above(layer.low)].map((values) => values.slice(first, end).reverse());
    const lower = samplePath(back[0], back[1], 0, end - first, sx, sy).replace("M", "L");
    if (upper && lower) svg(group, "path", { class: `band b-${layer.style}`, d: `${upper}${lower}Z` });
  },
  shades(group, layer, { sx, sy }) {
    const paths = Array.from({ length: 10 }, () => "");
    const edge = ([low, high], index, count) => low + ((high - low) * index) / count;
    layer.columns.forEach((column, at) => {
      const [left, right] = [at, at + 1].map((n) => sx.toPixel(edge(layer.x, n, layer.columns.length)).toFixed(1));
      for (const run of column.matchAll(/(.)\1*/g)) {
        const ends = [run.index, run.index + run[0].length];
        const [low, high] = ends.map((n) => sy.toPixel(edge(layer.y, n, column.length)).toFixed(1));
        paths[Number(run[1])] += `M${left} ${low}H${right}V${high}H${left}Z`;
      }
    });
    paths.forEach((d, shade) => {
      if (shade > 0 && d) svg(group, "path", { class: "shade", d, "fill-opacity": 0.085 * shade });
    });
  },
  words(group, layer, { sx, sy, left, right, top, bottom }) {
    const taken = [];
    layer.words.forEach((word, n) => {
      const [x, y] = [sx.toPixel(layer.x[n]), Math.max(top + 10, sy.toPixel(layer.y[n]) - 5)];
      if (!(x >= left && x <= right && y <= bottom)) return;
      const text = svgText(group, word, { class: `word w-${layer.style}`, "text-anchor": "middle", y });
      const half = text.getComputedTextLength() / 2;
      const middle = Math.min(right - half, Math.max(left + half, x));
      if (taken.some(([from, to, above, below]) => middle - half < to && middle + half > from && y - 11 < below && y > above)) {
        text.remove();
        return;
      }
      text.setAttribute("x", middle);
      taken.push([middle - half, middle + half, y - 11, y]);
    });
  },
  horizontal_mark(group, layer, { sy, left, right, top, bottom }) {
    const y = layer.y === null ? NaN : sy.toPixel(layer.y);
    if (!(y >= top && y <= bottom)) return;
    svg(group, "line", { class: "mark", x1: left, x2: right, y1: y, y2: y });
    svgText(group, layer.label, { class: "mark-name", x: left + 6, y: y - NAME_HEIGHT < top ? y + NAME_HEIGHT : y - 6 });
  },
  vertical_marks(group, layer, { sx, left, right, top, bottom, names }) {
    const inView = layer.x.filter((x) => x >= sx.low && x <= sx.high).map((x) => sx.toPixel(x));
    inView.forEach((x) => svg(group, "line", { class: "mark", x1: x, x2: x, y1: top, y2: bottom }));
    if (!layer.label || inView.length === 0) return;
    const before = inView[0] > (left + right) / 2;
    const x = inView[0] + (before ? -5 : 5);
    const name = svgText(group, layer.label, { class: "mark-name", x, "text-anchor": before ? "end" : "start" });
    const width = name.getComputedTextLength();
    const row = freeRow(names, before ? x - width : x, before ? x : x + width);
    name.setAttribute("y", top + 12 + NAME_HEIGHT * row);
  },
  y_region(group, layer, { sy, left, right }) {
    if (layer.low === null || layer.high === null) return;
    const [y, below] = [sy.toPixel(layer.high), sy.toPixel(layer.low)];
    svg(group, "rect", { class: "region", x: left, width: right - left, y, height: Math.max(0, below - y) });
  },
  x_region(group, layer, { sx, left, right, top, bottom }) {
    if (layer.low === null || layer.high === null) return;
    const at = (value) => Math.min(right, Math.max(left, sx.toPixel(Math.max(value, Number.MIN_VALUE))));
    const [x, end] = [at(layer.low), at(layer.high)];
    svg(group, "rect", { class: "region", x, width: Math.max(1, end - x), y: top, height: bottom - top });
  },
};

/** Whether a line goes up and down so often that it fills an area. */
function isRough(y, first, end, sy) {
  let travel = 0;
  for (let n = first + 1; n < end; n++) {
    const way = Math.abs(sy.toPixel(y[n]) - sy.toPixel(y[n - 1]));
    if (Number.isFinite(way)) travel += way;
  }
  return travel > ROUGH * Math.abs(sy.toPixel(sy.high) - sy.toPixel(sy.low));
}

/** Joins the path of every sample whose values are finite. */
function path(layer, piece) {
  let all = "";
  for (let n = 0; n < layer.x.length; n++) {
    const part = piece(n);
    if (!/NaN|Infinity/.test(part)) all += part;
  }
  return all;
}

/** An error bar with caps; a bound that is not finite ends the bar at the other. */
function bar(x, low, high) {
  const [cap, at] = [3, (value) => value.toFixed(1)];
  return `M${at(x)} ${at(low)}V${at(high)}M${at(x - cap)} ${at(low)}h${2 * cap}M${at(x - cap)} ${at(high)}h${2 * cap}`;
}
