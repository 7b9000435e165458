// One plot that stands still: bands, lines, points and limits, with the axes and number formats of the reports.

import { h } from '../dom.js';
import { shown, ticks } from './scale.js';

/** @typedef {{ label: string, unit: string, from?: number, to?: number }} Axis */
/** @typedef {{ name: string, x: number[], y: number[], colour: string, isDashed?: boolean }} Line */
/** @typedef {{ name: string, x: number[], low: number[], high: number[], colour: string }} Band */
/** @typedef {{ name: string, at: number, colour: string }} Limit */
/** @typedef {{ name: string, from: number, to: number }} Span */
/** @typedef {{ name: string, x: number, y: number, colour: string, isChosen?: boolean }} Point */
/**
 * @typedef {object} Picture
 * @property {string} words the picture in words, for those who do not see it
 * @property {Axis} x
 * @property {Axis} y
 * @property {Band[]} [bands]
 * @property {Line[]} [lines]
 * @property {Limit[]} [limits] horizontal lines
 * @property {Span[]} [spans] shaded spans of the horizontal axis
 * @property {Point[]} [points]
 */

const LEFT = 76;
const RIGHT = 12;
const TOP = 8;
const AXIS = 44;

export class Plot {
  /** @param {HTMLElement} parent @param {(name: string) => void} [chosen] hears of a point that is clicked */
  constructor(parent, chosen) {
    /** @type {Picture | null} */
    this.picture = null;
    this.canvas = h('canvas', { role: 'img' });
    this.names = h('p', { class: 'names' });
    parent.append(this.canvas, this.names);
    new ResizeObserver(() => this.draw()).observe(parent);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
    this.canvas.addEventListener('click', (event) => {
      const near = this.nearest(event.offsetX, event.offsetY);
      if (near) chosen?.(near.name);
    });
  }

  /** @param {Picture} picture */
  show(picture) {
    this.picture = picture;
    this.canvas.setAttribute('aria-label', picture.words);
    const { bands = [], lines = [], limits = [], spans = [] } = picture;
    const named = [...lines, ...bands, ...limits].filter((each) => each.name);
    const keys = named.map(({ name, colour, ...rest }) => h('span', {},
      h('i', { class: `key ${colour}${'low' in rest ? ' band' : ''}`, 'aria-hidden': 'true' }), name));
    const [span] = spans;
    this.names.replaceChildren(...keys, ...(span ? [h('span', {}, h('i', { class: 'key beyond band', 'aria-hidden': 'true' }), span.name)] : []));
    this.draw();
  }

  /** Draws with the next frame, once. */
  draw() {
    if (this.isDue) return;
    this.isDue = true;
    requestAnimationFrame(() => {
      this.isDue = false;
      if (this.picture) this.paint(this.picture);
    });
  }

  /** The least and largest number of some lists, with a margin. @param {Axis} axis @param {number[][]} lists */
  range(axis, lists) {
    let [low, high] = [axis.from ?? Infinity, axis.to ?? -Infinity];
    for (const list of lists) {
      for (const value of list) {
        if (value === null || !Number.isFinite(value)) continue;
        low = Math.min(low, value);
        high = Math.max(high, value);
      }
    }
    if (!(low <= high)) return { low: 0, high: 1 };
    const margin = high > low ? 0.05 * (high - low) : 0.05 * Math.abs(high) || 1;
    return { low: axis.from ?? low - margin, high: axis.to ?? high + margin };
  }

  /** @param {Picture} picture */
  paint(picture) {
    const { x, y, bands = [], lines = [], limits = [], spans = [], points = [] } = picture;
    const context = this.canvas.getContext('2d');
    if (!context) return;
    const ratio = devicePixelRatio || 1;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.canvas.width = Math.round(width * ratio);
    this.canvas.height = Math.round(height * ratio);
    const across = this.range(x, [...lines.map((line) => line.x), points.map((point) => point.x)]);
    const along = this.range(y, [...lines.map((line) => line.y), ...bands.map((band) => band.high), limits.map((limit) => limit.at), points.map((point) => point.y)]);
    const [inner, tall] = [Math.max(1, width - LEFT - RIGHT), Math.max(1, height - TOP - AXIS)];
    this.xOf = (/** @type {number} */ value) => LEFT + ((value - across.low) / (across.high - across.low || 1)) * inner;
    this.yOf = (/** @type {number} */ value) => TOP + (1 - (value - along.low) / (along.high - along.low || 1)) * tall;
    const style = getComputedStyle(document.documentElement);
    const colour = (/** @type {string} */ name) => style.getPropertyValue(`--${name}`).trim();
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
    this.paintAxes(context, colour, x, y, across, along, width, height);
    context.save();
    context.beginPath();
    context.rect(LEFT, 0, inner, height - AXIS);
    context.clip();
    for (const { from, to } of spans) {
      context.globalAlpha = 0.22;
      context.fillStyle = colour('mark-leave');
      context.fillRect(this.xOf(from), 0, Math.max(1, this.xOf(to) - this.xOf(from)), height - AXIS);
    }
    for (const band of bands) this.paintBand(context, band, colour(band.colour));
    context.globalAlpha = 1;
    for (const line of lines) this.paintLine(context, line, colour(line.colour));
    for (const { at, colour: name } of limits) {
      this.paintLine(context, { name: '', x: [across.low, across.high], y: [at, at], colour: name, isDashed: true }, colour(name));
    }
    for (const point of points) this.paintPoint(context, point, colour);
    context.restore();
  }

  /**
   * @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour @param {Axis} x @param {Axis} y
   * @param {{ low: number, high: number }} across @param {{ low: number, high: number }} along @param {number} width @param {number} height
   */
  paintAxes(context, colour, x, y, across, along, width, height) {
    const bottom = height - AXIS;
    context.strokeStyle = colour('grid');
    context.fillStyle = colour('text-soft');
    /** @param {number} x0 @param {number} y0 @param {number} x1 @param {number} y1 */
    const rule = (x0, y0, x1, y1) => { context.beginPath(); context.moveTo(x0, y0); context.lineTo(x1, y1); context.stroke(); };
    context.textAlign = 'center';
    context.textBaseline = 'top';
    const columns = ticks(across.low, across.high, (width - LEFT) / 80);
    for (const place of columns.places) {
      const at = Math.round(this.xOf(place)) + 0.5;
      rule(at, 0, at, bottom);
      context.fillText(shown(place, columns.step), at, bottom + 6);
    }
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    const rows = ticks(along.low, along.high, bottom / 45);
    for (const place of rows.places) {
      const at = Math.round(this.yOf(place)) + 0.5;
      rule(LEFT, at, width - RIGHT, at);
      context.fillText(shown(place, rows.step), LEFT - 6, at);
    }
    const named = (/** @type {Axis} */ axis) => (axis.unit ? `${axis.label} [${axis.unit}]` : axis.label);
    context.fillStyle = colour('text');
    context.textAlign = 'center';
    context.textBaseline = 'bottom';
    context.fillText(named(x), LEFT + 0.5 * (width - LEFT - RIGHT), height - 4);
    context.save();
    context.translate(14, TOP + 0.5 * (bottom - TOP));
    context.rotate(-0.5 * Math.PI);
    context.textBaseline = 'middle';
    context.fillText(named(y), 0, 0);
    context.restore();
  }

  /** @param {number} value */
  xOf(value) { return value; }

  /** @param {number} value */
  yOf(value) { return value; }

  /** @param {CanvasRenderingContext2D} context @param {Band} band @param {string} colour */
  paintBand(context, { x, low, high }, colour) {
    context.globalAlpha = 0.28;
    context.fillStyle = colour;
    context.beginPath();
    x.forEach((value, k) => context.lineTo(this.xOf(value), this.yOf(high[k])));
    for (let k = x.length - 1; k >= 0; k -= 1) context.lineTo(this.xOf(x[k]), this.yOf(low[k]));
    context.fill();
  }

  /** @param {CanvasRenderingContext2D} context @param {Line} line @param {string} colour */
  paintLine(context, { x, y, isDashed }, colour) {
    context.strokeStyle = colour;
    context.lineWidth = isDashed ? 2 : 1.5;
    context.setLineDash(isDashed ? [7, 4] : []);
    context.beginPath();
    x.forEach((value, k) => context.lineTo(this.xOf(value), this.yOf(y[k])));
    context.stroke();
    context.setLineDash([]);
    context.lineWidth = 1;
  }

  /** @param {CanvasRenderingContext2D} context @param {Point} point @param {(name: string) => string} colour */
  paintPoint(context, { name, x, y, colour: of, isChosen }, colour) {
    const [at, up] = [this.xOf(x), this.yOf(y)];
    context.fillStyle = colour(of);
    context.strokeStyle = colour('text');
    context.beginPath();
    context.arc(at, up, isChosen ? 7 : 5, 0, 2 * Math.PI);
    context.fill();
    if (isChosen) context.stroke();
    context.fillStyle = colour('text');
    const isRight = at > this.canvas.clientWidth - 130;
    context.textAlign = isRight ? 'right' : 'left';
    context.textBaseline = 'middle';
    context.fillText(name, at + (isRight ? -10 : 10), up);
  }

  /** @param {number} x @param {number} y */
  nearest(x, y) {
    const far = (/** @type {Point} */ point) => Math.hypot(this.xOf(point.x) - x, this.yOf(point.y) - y);
    const near = (this.picture?.points ?? []).filter((point) => far(point) < 16);
    return near.sort((a, b) => far(a) - far(b))[0];
  }
}
