// Data of a figure: decoding, searching, thinning to the pixels at hand.

/** Turns a figure's JSON into one with typed arrays; null becomes NaN. */
function decodeFigure(json) {
  for (const panel of json.panels) {
    for (const layer of panel.layers) {
      for (const key of ["y", "low", "high"]) {
        if (Array.isArray(layer[key])) layer[key] = Float64Array.from(layer[key], numberOrNaN);
      }
      const values = layer.y || layer.low;
      if (isLoose(layer)) layer.x = Float64Array.from(layer.x, numberOrNaN);
      else if (layer.x && values && values.length !== undefined) layer.x = decodeX(layer.x, values.length);
      else if (layer.type === "vertical_marks") layer.x = Float64Array.from(layer.x, numberOrNaN);
    }
  }
  return json;
}

const numberOrNaN = (value) => (value === null ? NaN : value);

/** The x values: given one by one, or as start, step and the samples skipped. */
function decodeX(x, length) {
  if (Array.isArray(x)) return Float64Array.from(x, numberOrNaN);
  let index = 0;
  return Float64Array.from({ length }, (_, n) => {
    index = x.skip ? index + x.skip[n] : n;
    return x.start + x.step * index;
  });
}

/** Points in no order of x: they are shown whole, and not read out. */
const isLoose = (layer) => ["markers", "path"].includes(layer.type);

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

/** Position of the sample nearest to `value`, on the screen's scale. */
function nearest(x, value, scale) {
  const after = lowerBound(x, value);
  if (after === 0 || after >= x.length) return Math.min(after, x.length - 1);
  const distance = (n) => Math.abs(scale.toPixel(x[n]) - scale.toPixel(value));
  return distance(after - 1) <= distance(after) ? after - 1 : after;
}

/** The samples in view, with one more on each side so that lines reach the edge. */
function visibleRange(x, low, high) {
  return [Math.max(0, lowerBound(x, low) - 1), Math.min(x.length, lowerBound(x, high) + 1)];
}

/** SVG path of a line; where samples are denser than pixels, the smallest and largest of each column are joined. */
function linePath(layer, sx, sy) {
  const [first, end] = visibleRange(layer.x, sx.low, sx.high);
  const pixels = Math.abs(sx.toPixel(sx.high) - sx.toPixel(sx.low));
  return end - first > 3 * pixels
    ? columnPath(layer, first, end, sx, sy)
    : samplePath(layer.x, layer.y, first, end, sx, sy);
}

function samplePath(x, y, first, end, sx, sy) {
  let path = "";
  let pen = "M";
  for (let n = first; n < end; n++) {
    const [px, py] = [sx.toPixel(x[n]), sy.toPixel(y[n])];
    if (!Number.isFinite(px) || !Number.isFinite(py)) {
      pen = "M";
      continue;
    }
    path += pen + px.toFixed(1) + " " + py.toFixed(1);
    pen = "L";
  }
  return path;
}

function columnPath(layer, first, end, sx, sy) {
  const kept = [];
  let n = first;
  while (n < end) {
    const column = Math.floor(sx.toPixel(layer.x[n]));
    let [low, high] = [n, n];
    for (; n < end && Math.floor(sx.toPixel(layer.x[n])) === column; n++) {
      if (layer.y[n] < layer.y[low]) low = n;
      if (layer.y[n] > layer.y[high]) high = n;
    }
    kept.push(Math.min(low, high));
    if (low !== high) kept.push(Math.max(low, high));
  }
  const pick = (values) => kept.map((at) => values[at]);
  return samplePath(pick(layer.x), pick(layer.y), 0, kept.length, sx, sy);
}

/** Smallest and largest x of all series. */
function xExtent(figure) {
  if (figure.x.range) return figure.x.range;
  const log = figure.x.scale === "log";
  let [low, high] = [Infinity, -Infinity];
  for (const layer of figure.panels.flatMap((panel) => panel.layers)) {
    if (!isSeries(layer) && !isLoose(layer) && layer.type !== "shades") continue;
    for (const value of layer.x) {
      if (!Number.isFinite(value) || (log && value <= 0)) continue;
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
  }
  if (figure.panels.some((panel) => panel.layers.some((layer) => layer.type === "stems"))) {
    [low, high] = [low - 0.015 * (high - low), high + 0.015 * (high - low)];
  }
  if (figure.equal_axes) [low, high] = [low - 0.07 * (high - low), high + 0.07 * (high - low)];
  return low < high ? [low, high] : Number.isFinite(low) ? [low * 0.9 - 1e-9, low * 1.1 + 1] : [log ? 1 : 0, log ? 10 : 1];
}

const BAND_BEYOND = 4; // how far a band widens a logarithmic axis, as a factor

/** Range of y for what is in view and not hidden, with a little air. */
function yExtent(panel, domain, hidden) {
  if (panel.y.range) return panel.y.range;
  const log = panel.y.scale === "log";
  const [range, bands] = [[Infinity, -Infinity], [Infinity, -Infinity]];
  const take = (into, value) => {
    if (!Number.isFinite(value) || (log && value <= 0)) return;
    into[0] = Math.min(into[0], value);
    into[1] = Math.max(into[1], value);
  };
  for (const layer of panel.layers) {
    if (layer.type === "y_region") [layer.low, layer.high].forEach((v) => take(range, v === null ? NaN : v));
    if (!layer.x || ["vertical_marks", "x_region", "words"].includes(layer.type) || hidden.has(layer.name)) continue;
    const [first, end] = isLoose(layer) || layer.type === "shades" ? [0, layer.x.length] : visibleRange(layer.x, domain[0], domain[1]);
    for (const key of ["y", "low", "high"]) {
      if (layer[key]) for (let n = first; n < end; n++) take(layer.type === "band" ? bands : range, layer[key][n]);
    }
    if (layer.type === "stems") take(range, 0);
  }
  const [low, high] = widened(range, bands, log);
  if (!(low <= high)) return log ? [1, 10] : [0, 1];
  if (log) return [low / 1.2, high * 1.2];
  const air = 0.07 * (high - low) || Math.abs(high) * 0.1 || 1;
  return [low - air, high + air];
}

/** A range with what bands take beside it; on a logarithmic axis, where a band may reach down without end, not far. */
function widened(range, bands, log) {
  const [low, high] = [Math.min(range[0], bands[0]), Math.max(range[1], bands[1])];
  if (!log || range[0] > range[1]) return [low, high];
  return [Math.max(low, range[0] / BAND_BEYOND), Math.min(high, range[1] * BAND_BEYOND)];
}

/** Widens the shorter of two ranges so that a pixel is worth the same along both. */
function equalRanges([x0, x1], [y0, y1], width, height) {
  const perPixel = Math.max((x1 - x0) / width, (y1 - y0) / height);
  const around = (a, b, pixels) => [(a + b - perPixel * pixels) / 2, (a + b + perPixel * pixels) / 2];
  return [around(x0, x1, width), around(y0, y1, height)];
}
