// Small plots of a recording: what it is at a glance.

import { COLUMN, view } from '../api.js';
import { h } from '../dom.js';

/**
 * A canvas for some lines, one below the other.
 * @param {string} name @param {number} width @param {number} height
 */
export function thumbnail(name, width, height) {
  const canvas = h('canvas', { class: 'thumbnail', width: width * 2, height: height * 2, role: 'img', 'aria-label': name });
  [canvas.style.width, canvas.style.height] = [`${width}px`, `${height}px`];
  return canvas;
}

/**
 * Draws channels of a recording, each over its own range.
 * @param {HTMLCanvasElement} canvas @param {string} file @param {string[]} channels @param {boolean} [isInverted]
 */
export async function drawSmall(canvas, file, channels, isInverted = false) {
  const context = canvas.getContext('2d');
  if (!context || !channels.length) return;
  const lines = await view(file, channels, -Infinity, Infinity, canvas.width / 2);
  const each = canvas.height / lines.length;
  context.lineWidth = 2;
  lines.forEach((columns, index) => {
    const colour = getComputedStyle(document.documentElement).getPropertyValue(`--series-${index}`);
    drawLine(context, columns, colour, index * each + 3, each - 6, isInverted);
  });
}

/**
 * @param {CanvasRenderingContext2D} context @param {Float64Array} columns @param {string} colour
 * @param {number} top @param {number} height @param {boolean} isInverted
 */
function drawLine(context, columns, colour, top, height, isInverted) {
  if (!columns.length) return;
  let [low, high] = [Infinity, -Infinity];
  for (let k = 0; k < columns.length; k += COLUMN) {
    if (columns[k + 2] < low) low = columns[k + 2];
    if (columns[k + 3] > high) high = columns[k + 3];
  }
  const [first, last] = [columns[0], columns[columns.length - COLUMN + 1]];
  const yOf = (/** @type {number} */ value) => {
    const share = high > low ? (value - low) / (high - low) : 0.5;
    return top + height * (isInverted ? share : 1 - share);
  };
  context.strokeStyle = colour;
  context.beginPath();
  for (let k = 0; k < columns.length; k += COLUMN) {
    if (Number.isNaN(columns[k + 2])) continue;
    const x = (context.canvas.width * (columns[k] - first)) / Math.max(1e-9, last - first);
    context.lineTo(x, yOf(columns[k + 2]));
    context.lineTo(x, yOf(columns[k + 3]));
  }
  context.stroke();
}
