// Saving a figure: as it is shown, as a drawing or as pixels, and its numbers as text.

const PIXELS = 2; // of a saved picture to one of the screen
const SAVED_STYLES = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-dasharray", "stroke-linejoin", "stroke-linecap", "opacity", "font-size", "font-weight", "font-family", "text-anchor", "paint-order", "vector-effect", "display", "shape-rendering"];

function download(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

const fileName = (plot, ending) => `${plot.title.replace(/[^\p{L}\p{N}_.-]+/gu, "_").replace(/^_+|_+$/g, "").slice(0, 80) || "figure"}.${ending}`;

/** The figure as it is shown, with title and legend, in the colours of paper; its styles are its own. */
function asDrawing(plot) {
  const legend = [...plot.entries.values()].filter((entry) => entry.getAttribute("aria-pressed") !== "false");
  const above = legend.length > 0 ? 52 : 30;
  const [width, height] = [plot.width, plot.height + above];
  const whole = svg(null, "svg", { xmlns: SVG, width, height, viewBox: `0 0 ${width} ${height}`, "font-family": "DejaVu Sans, sans-serif", "font-size": 12 });
  whole.classList.add("saved");
  svg(whole, "rect", { class: "ground", width, height });
  svg(whole, "text", { class: "axis-name head", x: plot.panels[0].left, y: 20 }).textContent = plot.title;
  const inner = plot.root.cloneNode(true);
  inner.querySelectorAll(".cursor, .selection").forEach((element) => element.remove());
  svg(whole, "g", { transform: `translate(0 ${above})` }).append(...inner.childNodes);
  const holder = document.createElement("div");
  holder.className = "stage paper";
  holder.append(whole);
  document.body.append(holder);
  let x = plot.panels[0].left;
  for (const entry of legend) {
    const key = svg(whole, "g", { transform: `translate(${x} 30)` });
    key.append(...entry.querySelector("svg").cloneNode(true).childNodes);
    const name = svg(whole, "text", { class: "axis-name", x: x + 24, y: 41 });
    name.textContent = entry.textContent.trim();
    x += 40 + name.getComputedTextLength();
  }
  whole.querySelectorAll("*").forEach((element) => {
    const style = getComputedStyle(element);
    SAVED_STYLES.forEach((name) => element.style.setProperty(name, style.getPropertyValue(name)));
  });
  holder.remove();
  return { text: new XMLSerializer().serializeToString(whole), width, height };
}

function saveDrawing(plot) {
  download(fileName(plot, "svg"), new Blob([asDrawing(plot).text], { type: "image/svg+xml" }));
}

function savePixels(plot) {
  const { text, width, height } = asDrawing(plot);
  const image = new Image();
  image.onload = () => {
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [PIXELS * width, PIXELS * height];
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    canvas.toBlob((blob) => download(fileName(plot, "png"), blob), "image/png");
  };
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(text)}`;
}

/** A number with the digits that are known, in the characters of a keyboard. */
const written = (value, digits) => (Number.isFinite(value) ? String(Number(value.toPrecision(digits))) : "");

/** Columns of the series of a figure: those of one clock share their x. */
function columns(plot) {
  const heading = (name, unit) => (unit ? `${name} [${unit}]` : name);
  const clocks = new Map();
  for (const panel of plot.panels) {
    for (const layer of panel.layers.filter((one) => isSeries(one) || one.type === "path")) {
      const { x, y } = pointsOf(layer);
      if (x.length === 0) continue;
      const key = layer.samples || `${x.length} ${x[0]} ${x[x.length - 1]} ${x[x.length >> 1]}`;
      const own = layer.samples && layer.samples.y[layer.samples.lines.findIndex(([row, at]) => plot.panels[row].layers[at] === layer)];
      if (!clocks.has(key)) {
        const places = layer.samples ? layer.samples.x : Array.from(x, (px) => panel.sx.toValue(px));
        clocks.set(key, [{ head: heading(plot.label, plot.unit), values: places, digits: layer.samples ? 12 : 6 }]);
      }
      const name = [panel.label, layer.name].filter(Boolean).join(" ");
      const values = own || Array.from(y, (py) => panel.sy.toValue(py));
      clocks.get(key).push({ head: heading(name, panel.unit), values, digits: layer.samples ? 7 : 5 });
    }
  }
  return [...clocks.values()].flat();
}

/** All series over the whole axis, with every sample that the page has. */
function asNumbers(plot) {
  const all = columns(plot);
  const quoted = (text) => `"${text.replace(/"/g, '""')}"`;
  const rows = [all.map(({ head }) => quoted(head)).join(",")];
  const count = Math.max(0, ...all.map(({ values }) => values.length));
  for (let n = 0; n < count; n++) rows.push(all.map(({ values, digits }) => (n < values.length ? written(values[n], digits) : "")).join(","));
  return `${rows.join("\r\n")}\r\n`;
}

async function saveNumbers(plot) {
  await unpack(plot);
  download(fileName(plot, "csv"), new Blob([asNumbers(plot)], { type: "text/csv" }));
}
