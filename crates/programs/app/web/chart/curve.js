// Plots of numbers over numbers: a line, bars or dots.

/** @typedef {import('./axes.js').Axis} Axis */
/** @typedef {import('./axes.js').Drawing} Drawing */

/**
 * @param {{ label: string, x: Axis, y: Axis, xs: ArrayLike<number>, ys: ArrayLike<number>, words: (x: number, y: number) => string }} given
 * @returns {Drawing}
 */
export function lineOf({ label, x, y, xs, ys, words }) {
  return {
    label, x, y, words,
    paint: (plot, context, colour) => {
      context.strokeStyle = colour('series-0');
      context.lineWidth = 1.25;
      context.beginPath();
      for (let k = 0; k < xs.length; k += 1) {
        if ((x.isLog && xs[k] <= 0) || (y.isLog && ys[k] <= 0)) continue;
        context.lineTo(plot.xOf(xs[k]), plot.yOf(ys[k]));
      }
      context.stroke();
      context.lineWidth = 1;
    },
    near: (plot, pixel) => nearest(plot.xAt(pixel), xs, ys),
  };
}

/**
 * Bars from a least value on, all of one width.
 * @param {{ label: string, x: Axis, y: Axis, low: number, width: number, heights: number[], words: (x: number, y: number) => string }} given
 * @returns {Drawing}
 */
export function barsOf({ label, x, y, low, width, heights, words }) {
  const middles = heights.map((_, k) => low + (k + 0.5) * width);
  return {
    label, x, y, words,
    paint: (plot, context, colour) => {
      context.fillStyle = colour('series-0');
      heights.forEach((height, k) => {
        if (!height) return;
        const [x0, x1, top] = [plot.xOf(low + k * width), plot.xOf(low + (k + 1) * width), plot.yOf(height)];
        context.fillRect(x0, top, Math.max(1, x1 - x0 - 1), plot.bottom - top);
      });
    },
    near: (plot, pixel) => nearest(plot.xAt(pixel), middles, heights),
  };
}

/**
 * @param {{ label: string, x: Axis, y: Axis, points: [number, number][], words: (x: number, y: number) => string }} given
 * @returns {Drawing}
 */
export function dotsOf({ label, x, y, points, words }) {
  return {
    label, x, y, words,
    paint: (plot, context, colour) => {
      context.fillStyle = colour('series-0');
      context.globalAlpha = points.length > 2000 ? 0.5 : 0.9;
      for (const [px, py] of points) context.fillRect(plot.xOf(px) - 1, plot.yOf(py) - 1, 2.5, 2.5);
      context.globalAlpha = 1;
    },
    near: (plot, pixelX, pixelY) => {
      /** @type {{ x: number, y: number } | null} */
      let found = null;
      let least = Infinity;
      for (const [px, py] of points) {
        const apart = (plot.xOf(px) - pixelX) ** 2 + (plot.yOf(py) - pixelY) ** 2;
        if (apart < least) [least, found] = [apart, { x: px, y: py }];
      }
      return found;
    },
  };
}

/** The place of rising numbers next to one. @param {number} wanted @param {ArrayLike<number>} xs @param {ArrayLike<number>} ys */
export function nearest(wanted, xs, ys) {
  if (!xs.length) return null;
  let [low, high] = [0, xs.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (xs[middle] <= wanted) low = middle;
    else high = middle;
  }
  const k = wanted - xs[low] < xs[high] - wanted ? low : high;
  return { x: xs[k], y: ys[k] };
}
