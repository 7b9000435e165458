// What part of the x-axis a figure shows. Figures of one recording are linked: they show the same part.

/** Zoomed no further than to this share of the axis. */
const NEAREST = 1e-5;

/** Recordings whose figures are not linked. */
const unlinked = new Set();

const ends = (plot) => [plot.panels[0].left, plot.width - MARGIN];
const axisOf = (plot) => [plot.panels[0].left, plot.panels[0].right];
const inside = (plot, x) => Math.min(ends(plot)[1], Math.max(ends(plot)[0], x));

/** From a pixel on the screen to one of the drawing, and back. */
const drawn = ({ panels: [{ view }] }, x) => (x - view.bx) / view.ax;
const shown = ({ panels: [{ view }] }, x) => view.ax * x + view.bx;

/** The part of a figure that is next to a wanted one and not outside the axis; null for all of it. */
function clamped(plot, [from, to]) {
  const [left, right] = axisOf(plot);
  const width = Math.max(to - from, NEAREST * (right - left));
  if (width >= right - left) return null;
  const start = Math.min(Math.max(from, left), right - width);
  return [start, start + width];
}

/** Shows a part of the x-axis, in pixels of the drawing; null shows all of it. `focus` is the height pointed at. */
function zoomTo(plot, domain, focus = null) {
  const part = domain && clamped(plot, domain);
  showPart(plot, part, focus);
  const { sx } = plot.panels[0];
  for (const other of linkedTo(plot)) {
    const scale = other.panels[0].sx;
    const [left, right] = axisOf(other);
    const own = part && part.map((x) => scale.toPixel(sx.toValue(x))).map((x) => Math.min(right, Math.max(left, x)));
    if (!own || own[1] - own[0] >= NEAREST * (right - left)) showPart(other, own && clamped(other, own), null);
  }
}

function showPart(plot, domain, focus) {
  plot.domain = domain;
  plot.focus = focus;
  plot.box.classList.toggle("zoomed", Boolean(domain));
  if (domain) unpack(plot);
  show(plot);
}

/** Other figures of the same recording over the same axis. */
function siblings(plot) {
  const { recording, label, unit } = plot;
  return plots.filter((other) => other !== plot && recording && other.recording === recording && other.label === label && other.unit === unit);
}

const linkedTo = (plot) => (unlinked.has(plot.recording) ? [] : siblings(plot));

/** Shows this share of what is shown, around a place on the screen or the cursor. */
function zoomBy(plot, factor) {
  const [left, right] = ends(plot);
  const at = plot.cursor === null ? (left + right) / 2 : inside(plot, shown(plot, plot.cursor));
  zoomTo(plot, [left, right].map((edge) => drawn(plot, at + (edge - at) * factor)), plot.focus);
}

/** Moves what is shown by a share of itself. */
function panBy(plot, share) {
  if (!plot.domain) return;
  const [from, to] = plot.domain;
  const way = share * (to - from);
  zoomTo(plot, [from + way, to + way], plot.focus);
}

/** States what is shown where that is not all. */
function stateView(plot) {
  const { state, domain } = plot;
  state.hidden = !domain;
  if (!domain) return;
  const { sx } = plot.panels[0];
  const [from, to] = domain.map((x) => positionText(plot, x));
  const unit = plot.unit ? ` ${plot.unit}` : "";
  state.textContent = sx.kind === "log" || plot.equalAxes ? `zoomed: ${from} to ${to}${unit}` : `zoomed: ${from} to ${to}${unit}, ${samplesShown(plot)}`;
}
