// Curves over any axis: lines with bands, stems and points, with a readout by pointer and by keys.

import { fill, h } from '../dom.js';
import { kept, prepared, stroke } from './canvas.js';
import { figure, part, places } from './scale.js';

/**
 * A part of a drawing: a `line`, a `path` or a `guide` through points, a `band` from `low` to `y`, `stems` from zero, or
 * points as a `cross` or a `ring`. Lines, stems and points have a name, and are read out; paths and guides are not.
 * @typedef {object} Layer
 * @property {'line' | 'band' | 'stems' | 'cross' | 'ring' | 'path' | 'guide'} kind
 * @property {string} [name]
 * @property {number} series number of its colour and dash
 * @property {(number | null)[]} x
 * @property {(number | null)[]} y
 * @property {(number | null)[]} [low] lower edge of a band, and of the interval of a line
 * @property {(number | null)[]} [high] upper edge of the interval of a line
 */
/** @typedef {{ name: string, unit: string, height: number, layers: Layer[] }} Panel */
/** @typedef {{ name: string, unit: string, isLog?: boolean }} Axis */
/** @typedef {import('./scale.js').Range} Range */
/** @typedef {{ xOf: (x: number) => number, yOf: (y: number) => number, top: number, height: number, x: Range, y: Range }} Frame */

const LEFT = 64;
const RIGHT = 24;
const AXIS = 40;
const GAP = 24;
/** Series differ by their dashes too, not by their colours alone. */
const DASHES = [[], [7, 3], [2, 3], [9, 3, 2, 3]];
/** Pixels within which a point is read out. */
const NEAR = 40;

export class Curves {
  /**
   * @param {HTMLElement} parent @param {string} title @param {Axis} axis
   * @param {boolean} [isEqual] whether both axes have one scale, as in a complex plane
   */
  constructor(parent, title, axis, isEqual = false) {
    this.axis = axis;
    this.isEqual = isEqual;
    /** @type {Panel[]} */
    this.panels = [];
    /** Place that is read out. @type {number | null} */
    this.at = null;
    /** Point of a plane that is read out. @type {{ x: number, y: number, name?: string } | undefined} */
    this.mark = undefined;
    /** @type {{ panel: Panel, frame: Frame }[]} */
    this.frames = [];
    this.canvas = h('canvas', { tabindex: 0, role: 'application', 'aria-label': `${title}. Arrow keys read the values out.` });
    this.read = h('p', { class: 'readout', role: 'status' });
    parent.append(h('figure', { class: 'curves' }, h('figcaption', {}, title), this.canvas, this.read));
    this.listen();
    kept(parent, () => this.paint());
  }

  /** @param {Panel[]} panels */
  show(panels) {
    this.panels = panels;
    this.at = null;
    fill(this.read);
    this.paint();
  }

  /** Layers that are read out. @param {Panel} panel */
  static named(panel) {
    return panel.layers.filter((layer) => layer.name !== undefined && layer.kind !== 'path' && layer.kind !== 'band');
  }

  get range() {
    const layers = this.panels.flatMap((panel) => panel.layers);
    const [all, named] = [layers, layers.filter(isCentral)].map((some) => extent(some.flatMap((layer) => layer.x), this.axis.isLog));
    return this.isEqual ? within(all, named) : all;
  }

  paint() {
    const width = this.canvas.parentElement?.clientWidth ?? 0;
    if (width === 0) return;
    const height = this.panels.reduce((sum, panel) => sum + panel.height + GAP, 0) + AXIS;
    this.canvas.style.height = `${height}px`;
    const drawn = prepared(this.canvas, width, height);
    if (!drawn) return;
    const { context, colour } = drawn;
    let top = GAP;
    this.frames = [];
    for (const panel of this.panels) {
      const frame = this.frame(panel, top, width);
      this.frames.push({ panel, frame });
      this.paintPanel(context, colour, panel, frame, width);
      top += panel.height + GAP;
    }
    this.paintReadout(context, colour);
  }

  /** @param {Panel} panel @param {number} top @param {number} width @returns {Frame} */
  frame(panel, top, width) {
    const inner = width - LEFT - RIGHT;
    let [left, right] = this.range;
    let [low, high] = padded(upright(panel));
    if (this.isEqual) {
      // The scale of the axis that needs the coarser one.
      const perPixel = Math.max((1.12 * (right - left)) / inner, (high - low) / panel.height);
      [left, right] = [0.5 * (left + right - perPixel * inner), 0.5 * (left + right + perPixel * inner)];
      [low, high] = [0.5 * (low + high - perPixel * panel.height), 0.5 * (low + high + perPixel * panel.height)];
    }
    const [across, along] = [{ low: left, high: right, isLog: this.axis.isLog }, { low, high }];
    return {
      top, height: panel.height, x: across, y: along,
      xOf: (x) => LEFT + (right > left ? part(across, x) : 0) * inner,
      yOf: (y) => top + panel.height - (high > low ? part(along, y) : 0) * panel.height,
    };
  }

  /**
   * @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour
   * @param {Panel} panel @param {Frame} frame @param {number} width
   */
  paintPanel(context, colour, panel, frame, width) {
    const bottom = frame.top + frame.height;
    const isLast = panel === this.panels.at(-1);
    this.paintGrid(context, colour, frame, width, isLast);
    context.fillStyle = colour('text');
    context.textAlign = 'left';
    context.textBaseline = 'bottom';
    context.fillText(panel.unit ? `${panel.name} [${panel.unit}]` : panel.name, LEFT, frame.top - 5);
    context.save();
    context.beginPath();
    context.rect(LEFT, frame.top, width - LEFT - RIGHT, frame.height);
    context.clip();
    for (const layer of panel.layers) this.paintLayer(context, colour, layer, frame);
    context.restore();
    context.strokeStyle = colour('line');
    context.strokeRect(LEFT + 0.5, frame.top + 0.5, width - LEFT - RIGHT - 1, frame.height - 1);
    if (!isLast) return;
    context.fillStyle = colour('text');
    context.textAlign = 'right';
    context.textBaseline = 'bottom';
    context.fillText(this.axis.unit ? `${this.axis.name} [${this.axis.unit}]` : this.axis.name, width - RIGHT, bottom + AXIS - 4);
  }

  /**
   * @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour
   * @param {Frame} frame @param {number} width @param {boolean} isLast
   */
  paintGrid(context, colour, frame, width, isLast) {
    const { yOf, xOf, top, height } = frame;
    context.strokeStyle = colour('grid');
    context.fillStyle = colour('text-soft');
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    for (const [place, text] of places(frame.y, height / 34)) {
      const y = Math.round(yOf(place)) + 0.5;
      stroke(context, [[LEFT, y], [width - RIGHT, y]]);
      context.fillText(text, LEFT - 6, y);
    }
    context.textAlign = 'center';
    context.textBaseline = 'top';
    for (const [place, text] of places(frame.x, width / 90)) {
      const x = Math.round(xOf(place)) + 0.5;
      stroke(context, [[x, top], [x, top + height]]);
      if (isLast) context.fillText(text, x, top + height + 5);
    }
  }

  /**
   * @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour
   * @param {Layer} layer @param {Frame} frame
   */
  paintLayer(context, colour, layer, { xOf, yOf }) {
    const { kind, series, x, y } = layer;
    const own = kind === 'guide' ? colour('line') : colour(`series-${series % 8}`);
    [context.strokeStyle, context.fillStyle] = [own, own];
    context.lineWidth = kind === 'line' ? 1.75 : 1.25;
    context.setLineDash(kind === 'line' ? DASHES[series % DASHES.length] : []);
    if (kind === 'band') band(context, layer, xOf, yOf);
    else if (kind === 'stems') points(x, y).forEach(([at, value]) => stroke(context, [[xOf(at), yOf(0)], [xOf(at), yOf(value)]]));
    else if (kind === 'cross' || kind === 'ring') points(x, y).forEach(([at, value]) => mark(context, kind, xOf(at), yOf(value)));
    else pieces(x, y).forEach((piece) => stroke(context, piece.map(([at, value]) => [xOf(at), yOf(value)])));
    context.setLineDash([]);
    context.lineWidth = 1;
  }

  /** Names and values at the place that is read out. @param {number} at */
  values(at) {
    const found = [];
    for (const { panel } of this.frames) {
      for (const layer of Curves.named(panel)) {
        const k = nearest(layer.x, at);
        const [value, low, high] = [layer.y[k], layer.low?.[k], layer.high?.[k]];
        if (value === null || value === undefined) continue;
        const interval = low !== null && low !== undefined ? ` (${figure(low)} … ${figure(high)})` : '';
        found.push(`${layer.name}: ${panel.name} ${figure(value)}${interval}${panel.unit ? ` ${panel.unit}` : ''}`);
      }
    }
    return found;
  }

  /** @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour */
  paintReadout(context, colour) {
    if (this.at === null) return;
    context.strokeStyle = colour('cursor-a');
    for (const { frame } of this.frames) {
      const x = Math.round(frame.xOf(this.at)) + 0.5;
      stroke(context, [[x, frame.top], [x, frame.top + frame.height]]);
    }
  }

  /** Reads out a place; of a plane the point there. @param {number | null} at @param {string} [text] */
  readOut(at, text) {
    this.at = at;
    const unit = this.axis.unit ? ` ${this.axis.unit}` : '';
    fill(this.read, text ?? (at === null ? '' : `${this.axis.name} ${figure(at)}${unit}. ${this.values(at).join('; ')}`));
    this.paint();
  }

  /** Places that keys step through. */
  get places() {
    const all = this.panels.flatMap((panel) => Curves.named(panel)).flatMap((layer) => layer.x);
    return [...new Set(all.filter((x) => x !== null))].sort((a, b) => a - b);
  }

  /** Points of a plane, from left to right. */
  get marks() {
    const layers = this.panels.flatMap((panel) => Curves.named(panel));
    return layers.flatMap((layer) => points(layer.x, layer.y).map(([x, y]) => ({ x, y, name: layer.name })))
      .sort((a, b) => a.x - b.x || a.y - b.y);
  }

  /** @param {{ x: number, y: number, name?: string } | undefined} point */
  readMark(point) {
    this.mark = point;
    if (point) this.readOut(null, `${point.name}: real part ${figure(point.x)}, imaginary part ${figure(point.y)} ${this.axis.unit}`);
  }

  listen() {
    this.canvas.addEventListener('pointermove', ({ offsetX, offsetY }) => {
      const frame = this.frames.at(-1)?.frame;
      if (!frame) return;
      if (this.isEqual) {
        const far = (/** @type {{ x: number, y: number }} */ { x, y }) => Math.hypot(frame.xOf(x) - offsetX, frame.yOf(y) - offsetY);
        const [next] = this.marks.sort((a, b) => far(a) - far(b));
        if (next && far(next) < NEAR) this.readMark(next);
        return;
      }
      const { places } = this;
      if (places.length) this.readOut(places[nearest(places.map(frame.xOf), offsetX)]);
    });
    this.canvas.addEventListener('keydown', (event) => {
      const step = event.key === 'ArrowLeft' ? -1 : event.key === 'ArrowRight' ? 1 : 0;
      if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      if (this.isEqual) {
        const { marks, mark: now } = this;
        const index = marks.findIndex((each) => each.x === now?.x && each.y === now?.y && each.name === now?.name);
        this.readMark(marks[(index + step + marks.length) % marks.length]);
        return;
      }
      const { places } = this;
      const far = event.shiftKey ? 10 : 1;
      const index = this.at === null ? 0 : nearest(places, this.at) + step * far;
      if (places.length) this.readOut(places[Math.max(0, Math.min(places.length - 1, index))]);
    });
  }
}

/** Least and largest number. @param {(number | null | undefined)[]} values @param {boolean} [isPositive] */
function extent(values, isPositive = false) {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (typeof value !== 'number' || !Number.isFinite(value) || (isPositive && value <= 0)) continue;
    [low, high] = [Math.min(low, value), Math.max(high, value)];
  }
  return low <= high ? [low, high] : isPositive ? [1, 10] : [0, 1];
}

/** Whether a layer is always seen whole; bands and regions may be too wide for that. @param {Layer} layer */
const isCentral = ({ kind }) => kind !== 'band' && kind !== 'path';

/** Least and largest of a panel. @param {Panel} panel */
function upright({ layers }) {
  const all = extent(layers.flatMap(({ y, low = [], high = [] }) => [...y, ...low, ...high]));
  const central = extent(layers.filter(isCentral).flatMap(({ y }) => y));
  if (layers.some(({ kind }) => kind === 'stems')) return [Math.min(0, all[0]), Math.max(0, all[1])];
  return within(all, central);
}

/** A range that is wider than what is always seen, but no more than twice on either side. @param {number[]} all @param {number[]} central */
function within(all, [low, high]) {
  const room = high - low || Math.abs(high) || 1;
  return [Math.max(all[0], low - room), Math.min(all[1], high + room)];
}

/** @param {number[]} range */
function padded([low, high]) {
  const margin = high > low ? 0.06 * (high - low) : Math.max(1e-12, 0.05 * Math.abs(high)) || 1;
  return [low - margin, high + margin];
}

/** @param {(number | null)[]} x @param {(number | null)[]} y @returns {[number, number][]} */
const points = (x, y) => /** @type {[number, number][]} */ (x.map((at, k) => [at, y[k]]).filter(([at, value]) => Number.isFinite(at) && Number.isFinite(value)));

/** Points in pieces, apart where a value is missing. @param {(number | null)[]} x @param {(number | null)[]} y */
function pieces(x, y) {
  /** @type {[number, number][][]} */
  const all = [[]];
  x.forEach((at, k) => {
    const value = y[k];
    if (typeof at === 'number' && typeof value === 'number') all[all.length - 1].push([at, value]);
    else all.push([]);
  });
  return all.filter((piece) => piece.length);
}

/** @param {CanvasRenderingContext2D} context @param {Layer} layer @param {(x: number) => number} xOf @param {(y: number) => number} yOf */
function band(context, { x, y, low = [] }, xOf, yOf) {
  const above = points(x, y);
  const below = points(x, low);
  context.globalAlpha = 0.2;
  context.beginPath();
  above.forEach(([at, value]) => context.lineTo(xOf(at), yOf(value)));
  below.reverse().forEach(([at, value]) => context.lineTo(xOf(at), yOf(value)));
  context.fill();
  context.globalAlpha = 1;
}

/** @param {CanvasRenderingContext2D} context @param {'cross' | 'ring'} kind @param {number} x @param {number} y */
function mark(context, kind, x, y) {
  context.lineWidth = 1.75;
  if (kind === 'cross') {
    stroke(context, [[x - 5, y - 5], [x + 5, y + 5]]);
    stroke(context, [[x - 5, y + 5], [x + 5, y - 5]]);
    return;
  }
  context.beginPath();
  context.arc(x, y, 5, 0, 2 * Math.PI);
  context.stroke();
}

/** Index of the value nearest to another. @param {(number | null)[]} values @param {number} at */
function nearest(values, at) {
  let best = 0;
  values.forEach((value, k) => {
    if (Math.abs((value ?? Infinity) - at) < Math.abs((values[best] ?? Infinity) - at)) best = k;
  });
  return best;
}
