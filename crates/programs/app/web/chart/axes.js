// A plot with two axes, each linear or logarithmic, and a mark that pointer and arrow keys move.

import { h } from '../dom.js';
import { shown, ticks } from './scale.js';

/** @typedef {{ low: number, high: number, name: string, isLog?: boolean }} Axis */

/**
 * What is drawn: between its axes, and what a place means.
 * @typedef {object} Drawing
 * @property {string} label what it is, for those who do not see it
 * @property {Axis} x
 * @property {Axis} y
 * @property {number} [right] pixels to the right that it needs for itself
 * @property {(plot: Plot, context: CanvasRenderingContext2D, colour: (name: string) => string) => void} paint
 * @property {(plot: Plot, context: CanvasRenderingContext2D, colour: (name: string) => string) => void} [beside] draws to the right
 * @property {(plot: Plot, x: number, y: number) => { x: number, y: number } | null} near the place to mark, next to pixels
 * @property {(x: number, y: number) => string} words what is at a marked place
 */

export const LEFT = 84;
export const TOP = 8;
const BOTTOM = 44;
const RIGHT = 14;
export const HEIGHT = 320;

export class Plot {
  /** @param {Element} parent @param {Drawing} drawing */
  constructor(parent, drawing) {
    this.drawing = drawing;
    /** @type {{ x: number, y: number } | null} */
    this.mark = null;
    this.canvas = h('canvas', { tabindex: 0, role: 'application', 'aria-label': `${drawing.label}. Arrow keys move the mark, and its place is read below.` });
    this.readout = h('p', { class: 'readout', role: 'status' }, 'Point at the plot to read a place, or move with the arrow keys.');
    this.canvas.addEventListener('pointermove', ({ offsetX, offsetY }) => this.point(offsetX, offsetY));
    this.canvas.addEventListener('keydown', (event) => this.step(event));
    parent.replaceChildren(this.canvas, this.readout);
    this.sizes = new ResizeObserver(() => this.paint());
    this.sizes.observe(this.canvas);
    this.scheme = matchMedia('(prefers-color-scheme: dark)');
    this.repaint = () => this.paint();
    this.scheme.addEventListener('change', this.repaint);
  }

  end() {
    this.sizes.disconnect();
    this.scheme.removeEventListener('change', this.repaint);
  }

  get right() {
    return this.canvas.clientWidth - RIGHT - (this.drawing.right ?? 0);
  }

  get bottom() {
    return HEIGHT - BOTTOM;
  }

  /** @param {number} value */
  xOf(value) {
    return LEFT + part(this.drawing.x, value) * (this.right - LEFT);
  }

  /** @param {number} value */
  yOf(value) {
    return this.bottom - part(this.drawing.y, value) * (this.bottom - TOP);
  }

  /** @param {number} pixel */
  xAt(pixel) {
    return value(this.drawing.x, (pixel - LEFT) / (this.right - LEFT));
  }

  /** @param {number} pixel */
  yAt(pixel) {
    return value(this.drawing.y, (this.bottom - pixel) / (this.bottom - TOP));
  }

  /** @param {number} x @param {number} y */
  point(x, y) {
    const found = this.drawing.near(this, x, y);
    if (!found) return;
    this.mark = found;
    this.readout.textContent = this.drawing.words(found.x, found.y);
    this.paint();
  }

  /** @param {KeyboardEvent} event */
  step(event) {
    const step = event.shiftKey ? 10 : 1;
    const moves = /** @type {Record<string, [number, number]>} */ ({ ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] });
    const move = moves[event.key];
    if (!move) return;
    event.preventDefault();
    const [x, y] = this.mark ? [this.xOf(this.mark.x), this.yOf(this.mark.y)] : [(LEFT + this.right) / 2, (TOP + this.bottom) / 2];
    // A step that does not reach the next place goes on until one is reached.
    for (let k = 1; k <= 400; k += 1) {
      const found = this.drawing.near(this, x + k * move[0], y + k * move[1]);
      if (!found || (this.mark && found.x === this.mark.x && found.y === this.mark.y)) continue;
      this.point(x + k * move[0], y + k * move[1]);
      return;
    }
  }

  paint() {
    const context = this.canvas.getContext('2d');
    if (!context) return;
    const ratio = devicePixelRatio || 1;
    const width = this.canvas.clientWidth;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(HEIGHT * ratio);
    const style = getComputedStyle(document.documentElement);
    const colour = (/** @type {string} */ name) => style.getPropertyValue(`--${name}`).trim();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    this.paintAxes(context, colour);
    context.save();
    context.beginPath();
    context.rect(LEFT, TOP, this.right - LEFT, this.bottom - TOP);
    context.clip();
    this.drawing.paint(this, context, colour);
    this.paintMark(context, colour);
    context.restore();
    this.drawing.beside?.(this, context, colour);
    context.strokeStyle = colour('line');
    context.strokeRect(LEFT + 0.5, TOP + 0.5, this.right - LEFT, this.bottom - TOP);
  }

  /** @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour */
  paintAxes(context, colour) {
    const { x, y } = this.drawing;
    context.strokeStyle = colour('grid');
    context.fillStyle = colour('text-soft');
    context.textAlign = 'center';
    context.textBaseline = 'top';
    for (const [place, text] of places(x, (this.right - LEFT) / 60)) {
      const at = Math.round(this.xOf(place)) + 0.5;
      line(context, at, TOP, at, this.bottom);
      context.fillText(text, at, this.bottom + 6);
    }
    context.fillText(x.name, (LEFT + this.right) / 2, this.bottom + 24);
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    for (const [place, text] of places(y, (this.bottom - TOP) / 36)) {
      const at = Math.round(this.yOf(place)) + 0.5;
      line(context, LEFT, at, this.right, at);
      context.fillText(text, LEFT - 6, at);
    }
    context.save();
    context.translate(10, (TOP + this.bottom) / 2);
    context.rotate(-Math.PI / 2);
    context.textAlign = 'center';
    context.fillText(y.name, 0, 0);
    context.restore();
  }

  /** @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour */
  paintMark(context, colour) {
    if (!this.mark) return;
    const [x, y] = [this.xOf(this.mark.x), this.yOf(this.mark.y)];
    // Dark and light beside one another, which any colour behind them leaves visible.
    for (const [name, shift] of /** @type {[string, number][]} */ ([['back', 1], ['cursor-a', 0]])) {
      context.strokeStyle = colour(name);
      context.setLineDash([3, 3]);
      line(context, x + shift, TOP, x + shift, this.bottom);
      line(context, LEFT, y + shift, this.right, y + shift);
      context.setLineDash([]);
      context.strokeRect(x - 4 - shift, y - 4 - shift, 8 + 2 * shift, 8 + 2 * shift);
    }
  }
}

/** @typedef {Pick<Axis, 'low' | 'high' | 'isLog'>} Range */

/** Where a value is in a range, from 0 to 1. @param {Range} range @param {number} value */
export function part({ low, high, isLog }, value) {
  return isLog ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low);
}

/** The value at a part of a range. @param {Range} range @param {number} part */
export function value({ low, high, isLog }, part) {
  return isLog ? low * (high / low) ** part : low + part * (high - low);
}

/**
 * Ticks with their texts. A logarithmic axis has powers of ten, and where these are few also 2 and 5 times each.
 * @param {Axis} axis @param {number} most
 * @returns {[number, string][]}
 */
function places({ low, high, isLog }, most) {
  const decades = isLog ? Math.log10(high / low) : 0;
  if (!isLog || decades < 1) {
    const { step, places: all } = ticks(low, high, most);
    return all.map((place) => [place, shown(place, step)]);
  }
  const several = Math.ceil(decades / Math.max(1, most));
  const factors = decades * 3 <= most ? [1, 2, 5] : [1];
  /** @type {[number, string][]} */
  const found = [];
  for (let power = Math.floor(Math.log10(low)); power <= Math.log10(high); power += 1) {
    for (const factor of factors) {
      const place = factor * 10 ** power;
      if (power % several || place < low * (1 - 1e-9) || place > high * (1 + 1e-9)) continue;
      found.push([place, Math.abs(power) > 4 ? place.toExponential(0).replace(/-/g, '−') : String(Number(place.toPrecision(3)))]);
    }
  }
  return found;
}

/** @param {CanvasRenderingContext2D} context @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 */
function line(context, x0, y0, x1, y1) {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.stroke();
}

/**
 * An axis about values, with some room; of a logarithmic one values above zero alone.
 * @param {Iterable<number>} values @param {string} name @param {boolean} isLog @param {number} [room]
 * @returns {Axis}
 */
export function about(values, name, isLog, room = 0.04) {
  let [low, high] = [Infinity, -Infinity];
  for (const each of values) {
    if (!Number.isFinite(each) || (isLog && each <= 0)) continue;
    if (each < low) low = each;
    if (each > high) high = each;
  }
  if (!(low <= high)) [low, high] = isLog ? [0.1, 1] : [0, 1];
  if (isLog) return { low: low === high ? low / 2 : low, high: low === high ? high * 2 : high * (high / low) ** room, name, isLog };
  const margin = high > low ? room * (high - low) : Math.abs(high) / 2 || 0.5;
  return { low: low - margin, high: high + margin, name };
}
