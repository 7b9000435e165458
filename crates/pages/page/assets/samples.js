// The samples of lines that are drawn with fewer points: unpacked when they are first needed.

/** Starts to unpack the samples of a figure once; where the browser cannot, its figure stays as it was drawn. */
function unpack(plot) {
  plot.unpacking = plot.unpacking || readSamples(plot).then((isRead) => {
    if (!isRead) return;
    show(plot);
    stateSamples(plot);
    if (plot.cursor !== null) showCursor(plot, plot.cursor);
  });
  return plot.unpacking;
}

async function readSamples(plot) {
  const holder = plot.box.querySelector("script.samples");
  if (!holder || typeof DecompressionStream === "undefined") return false;
  const packed = Uint8Array.from(atob(holder.textContent), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  const reader = { bytes, at: 0 };
  plot.groups.forEach((group) => readGroup(plot, group, reader));
  return true;
}

/** The groups of lines that a figure's samples are of, without these. */
function readHeader(box) {
  const holder = box.querySelector("script.samples");
  return holder ? JSON.parse(holder.dataset.groups) : [];
}

/** Whole numbers of so many bytes each, the lowest bytes of all of them first. */
function readNumbers({ bytes, at }, count, planes) {
  const all = new Float64Array(count);
  for (let plane = 0; plane < planes; plane++) {
    for (let n = 0; n < count; n++) all[n] += bytes[at + plane * count + n] * 256 ** plane;
  }
  return all;
}

/** Numbers that were written as differences of steps; NaN where there is none. */
function readColumn(reader, count, planes, { low, step, order, log }) {
  const all = readNumbers(reader, count, planes);
  reader.at += planes * count;
  for (let n = 0; n < count; n++) all[n] = all[n] % 2 ? -(all[n] + 1) / 2 : all[n] / 2;
  for (let pass = 0; pass < order; pass++) {
    for (let n = 1; n < count; n++) all[n] += all[n - 1];
  }
  const value = (code) => (log ? 10 ** (low + step * (code - 1)) : low + step * (code - 1));
  return all.map((code) => (code === 0 ? NaN : value(code)));
}

/** The x of every sample of a group. */
function readPlaces(group, reader) {
  const { count, clock, numbered, places } = group;
  if (!clock) return readColumn(reader, count, 4, places);
  const steps = numbered ? readNumbers(reader, count, 4) : null;
  if (numbered) reader.at += 4 * count;
  let number = 0;
  return Float64Array.from({ length: count }, (_, n) => {
    number = steps ? number + steps[n] : n;
    return clock[0] + clock[1] * number;
  });
}

function readGroup(plot, group, reader) {
  group.x = readPlaces(group, reader);
  const px = group.x.map((x) => plot.panels[0].sx.toPixel(x));
  group.y = group.values.map((code, number) => {
    const values = readColumn(reader, group.count, 2, code);
    const [row, column] = group.lines[number];
    const panel = plot.panels[row];
    panel.layers[column].points = pointsOfSamples(px, values.map((y) => panel.sy.toPixel(y)));
    panel.layers[column].samples = group;
    panel.layers[column].step = code.step;
    return values;
  });
}

/** Points in pixels of the drawing, without those that are missing, and which of them begin a stretch. */
function pointsOfSamples(px, py) {
  const begins = new Set();
  if (!py.some((y) => !Number.isFinite(y))) return { x: px, y: py, begins: begins.add(0) };
  const kept = [];
  py.forEach((y, n) => {
    if (!Number.isFinite(y)) return;
    if (n === 0 || !Number.isFinite(py[n - 1])) begins.add(kept.length);
    kept.push(n);
  });
  return { x: kept.map((n) => px[n]), y: kept.map((n) => py[n]), begins };
}

/** A path through the samples in view, in pixels of the screen: of a column of pixels no more than first, lowest, highest and last. */
function pathInView(layer, { ax, bx, ay, by }, left, right) {
  const { x, y, begins } = layer.points;
  const from = Math.max(0, lowerBound(x, (left - bx) / ax) - 1);
  const end = Math.min(x.length, lowerBound(x, (right - bx) / ax) + 1);
  const isDense = end - from > 4 * (right - left);
  const pieces = [];
  const point = (n) => {
    const way = n === from || begins.has(n) ? "M" : "L";
    pieces.push(`${way}${(ax * x[n] + bx).toFixed(2)} ${(ay * y[n] + by).toFixed(2)}`);
  };
  const column = (n) => Math.floor(ax * x[n] + bx);
  for (let n = from; n < end;) {
    let last = n;
    let [low, high] = [n, n];
    while (isDense && last + 1 < end && !begins.has(last + 1) && column(last + 1) === column(n)) {
      last += 1;
      if (y[last] < y[low]) low = last;
      if (y[last] > y[high]) high = last;
    }
    [...new Set([n, Math.min(low, high), Math.max(low, high), last])].forEach(point);
    n = last + 1;
  }
  return { d: pieces.join(""), count: end - from };
}

/** How many of the samples are shown where few of them are, in words; what is not packed is drawn with all of its points. */
function samplesShown(plot) {
  if (plot.groups.length === 0) return "every point";
  const shown = (group) => {
    const [row, column] = group.lines[0];
    return group.x ? group.count : pointsOf(plot.panels[row].layers[column]).x.length;
  };
  const share = Math.max(...plot.groups.map((group) => group.of / shown(group)));
  if (share <= 1) return "every sample";
  return `1 of ${share < 10 ? share.toFixed(1) : Math.round(share)} samples, with every peak`;
}

/** States below the figure how many samples it has, in place of how many its drawing had. */
function stateSamples(plot) {
  const note = plot.box.querySelector(".samples-drawn");
  const group = plot.groups.find(({ of }) => of === Math.max(...plot.groups.map((one) => one.of)));
  if (!note || !group) return;
  note.textContent = group.count >= group.of ? `Has all ${group.of} samples.` : `Has ${group.count} of ${group.of} samples; every peak is kept.`;
}
