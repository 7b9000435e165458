// A plot with two axes, each linear or logarithmic, and a mark that pointer and arrow keys move.

import { h } from '../dom.js';
import { kept, prepared, stroke } from './canvas.js';
import { part, places, value } from './scale.js';

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
 * @property {(x: number, y: number) => void} [chosen] hears of a place that is clicked, or marked as Enter is pressed
 */

export const LEFT = 84;
export const TOP = 8;
const BOTTOM = 44;
const RIGHT = 14;
export const HEIGHT = 320;

/** @param {Drawing} drawing */
const labelOf = (drawing) => `${drawing.label}. Arrow keys move the mark, and its place is read below.`;

export class Plot {
  /** @param {Element} parent @param {Drawing} drawing */
  constructor(parent, drawing) {
    this.drawing = drawing;
    /** @type {{ x: number, y: number } | null} */
    this.mark = null;
    this.canvas = h('canvas', { tabindex: 0, role: 'application', 'aria-label': labelOf(drawing) });
    this.readout = h('p', { class: 'readout', role: 'status' }, 'Point at the plot to read a place, or move with the arrow keys.');
    this.canvas.addEventListener('pointermove', ({ offsetX, offsetY }) => this.point(offsetX, offsetY));
    this.canvas.addEventListener('click', ({ offsetX, offsetY }) => this.choose(offsetX, offsetY));
    this.canvas.addEventListener('keydown', (event) => this.step(event));
    parent.replaceChildren(this.canvas, this.readout);
    this.end = kept(this.canvas, () => this.draw());
  }

  /** Shows another drawing in the same place. @param {Drawing} drawing */
  show(drawing) {
    this.drawing = drawing;
    this.mark = null;
    this.canvas.setAttribute('aria-label', labelOf(drawing));
    this.readout.textContent = '';
    this.draw();
  }

  /** Draws with the next frame, once. */
  draw() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => {
      this.isDue = false;
      this.paint();
    });
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

  /** @param {number} x @param {number} y */
  choose(x, y) {
    const found = this.drawing.near(this, x, y);
    if (found) this.drawing.chosen?.(found.x, found.y);
  }

  /** @param {KeyboardEvent} event */
  step(event) {
    if (event.key === 'Enter' && this.mark) this.drawing.chosen?.(this.mark.x, this.mark.y);
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
    const drawn = prepared(this.canvas, this.canvas.clientWidth, HEIGHT);
    if (!drawn) return;
    const { context, colour } = drawn;
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
      stroke(context, [[at, TOP], [at, this.bottom]]);
      context.fillText(text, at, this.bottom + 6);
    }
    context.fillText(x.name, (LEFT + this.right) / 2, this.bottom + 24);
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    for (const [place, text] of places(y, (this.bottom - TOP) / 36)) {
      const at = Math.round(this.yOf(place)) + 0.5;
      stroke(context, [[LEFT, at], [this.right, at]]);
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
      stroke(context, [[x + shift, TOP], [x + shift, this.bottom]]);
      stroke(context, [[LEFT, y + shift], [this.right, y + shift]]);
      context.setLineDash([]);
      context.strokeRect(x - 4 - shift, y - 4 - shift, 8 + 2 * shift, 8 + 2 * shift);
    }
  }
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
