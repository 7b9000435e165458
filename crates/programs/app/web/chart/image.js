// Plots of numbers over a plane, as colours with their scale. The colours are Viridis: they rise in lightness, so that
// those who see colours differently, and prints in grey, show the same order.

import { HEIGHT, TOP } from './axes.js';
import { part, value as valueAt } from './scale.js';

/** @typedef {import('./axes.js').Axis} Axis */
/** @typedef {import('./axes.js').Drawing} Drawing */

const VIRIDIS = ['#440154', '#472d7b', '#3b528b', '#2c728e', '#21918c', '#28ae80', '#5ec962', '#addc30', '#fde725']
  .map((text) => [1, 3, 5].map((at) => parseInt(text.slice(at, at + 2), 16)));
/** Pixels for the scale beside the plot. */
const SCALE = 76;

/** @param {number} part from 0 to 1 @returns {number[]} */
function viridis(part) {
  const place = Math.min(1, Math.max(0, part)) * (VIRIDIS.length - 1);
  const k = Math.min(VIRIDIS.length - 2, Math.floor(place));
  return VIRIDIS[k].map((from, channel) => from + (place - k) * (VIRIDIS[k + 1][channel] - from));
}

/**
 * @typedef {object} Plane
 * @property {string} label
 * @property {Axis} x
 * @property {Axis} y
 * @property {[number, number]} along_x lower edge and width of the columns
 * @property {[number, number]} along_y lower edge and height of the rows
 * @property {(number | null)[][]} values of each column its rows; null where there is none
 * @property {[number, number]} range of the colours
 * @property {boolean} [isLog] whether the colours are by powers
 * @property {string} scale what the colours are
 * @property {(x: number, y: number, value: number | null) => string} words
 */

/** @param {Plane} given @returns {Drawing} */
export function imageOf({ label, x, y, along_x, along_y, values, range: [low, high], isLog, scale, words }) {
  const [columns, rows] = [values.length, values[0]?.length ?? 0];
  const range = { low, high, isLog };
  const pixels = new ImageData(Math.max(1, columns), Math.max(1, rows));
  values.forEach((column, i) => column.forEach((value, j) => {
    if (value === null || (isLog && value <= 0)) return;
    pixels.data.set([...viridis(high > low ? part(range, value) : 1), 255], 4 * ((rows - 1 - j) * columns + i));
  }));
  const picture = new OffscreenCanvas(pixels.width, pixels.height);
  picture.getContext('2d')?.putImageData(pixels, 0, 0);
  const cell = (/** @type {number} */ at, /** @type {[number, number]} */ [first, width], /** @type {number} */ count) => Math.min(count - 1, Math.max(0, Math.floor((at - first) / width)));
  return {
    label, x, y, right: SCALE,
    paint: (plot, context) => {
      const [left, right] = [plot.xOf(along_x[0]), plot.xOf(along_x[0] + columns * along_x[1])];
      const [bottom, top] = [plot.yOf(along_y[0]), plot.yOf(along_y[0] + rows * along_y[1])];
      context.imageSmoothingEnabled = false;
      context.drawImage(picture, left, top, right - left, bottom - top);
    },
    beside: paintScale,
    near: (plot, pixelX, pixelY) => {
      const [i, j] = [cell(plot.xAt(pixelX), along_x, columns), cell(plot.yAt(pixelY), along_y, rows)];
      return { x: along_x[0] + (i + 0.5) * along_x[1], y: along_y[0] + (j + 0.5) * along_y[1] };
    },
    words: (atX, atY) => words(atX, atY, values[cell(atX, along_x, columns)]?.[cell(atY, along_y, rows)] ?? null),
  };

  /** @param {import('./axes.js').Plot} plot @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour */
  function paintScale(plot, context, colour) {
    const [left, height] = [plot.right + 12, plot.bottom - TOP - 20];
    for (let k = 0; k < height; k += 1) {
      context.fillStyle = `rgb(${viridis(1 - k / height).map(Math.round).join(' ')})`;
      context.fillRect(left, TOP + 20 + k, 14, 1);
    }
    context.fillStyle = colour('text-soft');
    context.textAlign = 'left';
    context.textBaseline = 'middle';
    context.fillText(scale, left, TOP + 6);
    for (const share of [0, 0.25, 0.5, 0.75, 1]) {
      context.fillText(String(Number(valueAt(range, share).toPrecision(3))).replace('-', '−'), left + 18, Math.min(HEIGHT - 50, TOP + 20 + (1 - share) * height));
    }
  }
}
