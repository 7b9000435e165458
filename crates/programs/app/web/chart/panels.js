// Panels over one time axis: drawn from columns that the program sends, so that no spike is ever lost.

import { h } from '../dom.js';
import { COLUMN, view } from '../api.js';
import { kept, prepared, stroke } from './canvas.js';
import { ticks, shown } from './scale.js';

/**
 * One line of a plot.
 * @typedef {object} Trace
 * @property {string} file
 * @property {string} channel
 * @property {string} unit
 * @property {number} offset_s time that is added to its stamps
 * @property {Float64Array} columns of each: first and last stamp, least and largest, first and last sample
 * @property {{ from: number, to: number, width: number } | null} held span and width that the columns are of
 */

/** @typedef {{ traces: Trace[] }} Panel */

const LEFT = 76;
const RIGHT = 12;
const AXIS = 26;
/** Columns that are drawn as one path. */
const AT_ONCE = 32;
const GAP = 8;
const LEAST_HEIGHT = 90;
/** Columns that are asked for, over those that are seen: a little on both sides, for the next move. */
const MARGIN = 0.5;

export class Panels {
  /**
   * @param {HTMLElement} parent
   * @param {{ moved: (from: number, to: number, isSettled: boolean) => void, marked: () => void, failed: (error: unknown) => void }} told
   */
  constructor(parent, told) {
    this.told = told;
    /** @type {Panel[]} */
    this.panels = [];
    this.whole = { from: 0, to: 1 };
    this.from = 0;
    this.to = 1;
    /** @type {(number | null)[]} */
    this.cursors = [null, null];
    /** Marked stretches, with the text at their head. @type {{ from_s: number, to_s: number, kind: string, text: string }[]} */
    this.stretches = [];
    this.asked = 0;
    this.canvas = h('canvas', {
      tabindex: 0, role: 'application',
      'aria-label': 'Plots over time. Arrow keys move, plus and minus zoom, Home shows all, a and b set cursors.',
    });
    parent.append(this.canvas);
    this.listen();
    kept(parent, () => this.resized());
  }

  /** @param {Panel[]} panels */
  show(panels) {
    this.panels = panels;
    this.resized();
  }

  /** Goes to a span of time. @param {number} from @param {number} to @param {boolean} [isSettled] */
  goTo(from, to, isSettled = true) {
    const least = (this.whole.to - this.whole.from) * 1e-9;
    if (!(to - from > least)) return;
    [this.from, this.to] = [from, to];
    this.draw();
    this.fetch();
    this.told.moved(from, to, isSettled);
  }

  /** @param {number} factor @param {number} [about] */
  zoom(factor, about = 0.5 * (this.from + this.to), isSettled = true) {
    this.goTo(about - (about - this.from) * factor, about + (this.to - about) * factor, isSettled);
  }

  all() {
    this.goTo(this.whole.from, this.whole.to);
  }

  get width() {
    return Math.max(1, this.canvas.clientWidth - LEFT - RIGHT);
  }

  /** @param {number} x */
  timeAt(x) {
    return this.from + ((x - LEFT) / this.width) * (this.to - this.from);
  }

  /** @param {number} time */
  xOf(time) {
    return LEFT + ((time - this.from) / (this.to - this.from)) * this.width;
  }

  /** Asks for the columns of what is seen, where those that are there are too coarse or end too early. */
  async fetch() {
    const [span, turn] = [this.to - this.from, (this.asked += 1)];
    const [from, to] = [this.from - MARGIN * span, this.to + MARGIN * span];
    /** @type {Map<string, Trace[]>} */
    const wanted = new Map();
    for (const trace of this.panels.flatMap((panel) => panel.traces)) {
      const { held } = trace;
      const isFine = held && held.width <= span / this.width * 2.01 || held?.width === 0;
      if (held && isFine && held.from <= this.from && held.to >= this.to) continue;
      const key = `${trace.offset_s}\n${trace.file}`;
      wanted.set(key, [...(wanted.get(key) ?? []), trace]);
    }
    if (!wanted.size) return;
    // The pointer may still be moving.
    await new Promise((done) => setTimeout(done, 30));
    if (turn !== this.asked) return;
    try {
      await Promise.all([...wanted.values()].map((traces) => this.load(traces, from, to, turn)));
    } catch (error) {
      this.told.failed(error);
    }
  }

  /** @param {Trace[]} traces @param {number} from @param {number} to @param {number} turn */
  async load(traces, from, to, turn) {
    const { file, offset_s } = traces[0];
    const columns = Math.ceil(this.width * (1 + 2 * MARGIN) * Math.min(2, devicePixelRatio || 1));
    const found = await view(file, traces.map((trace) => trace.channel), from - offset_s, to - offset_s, columns);
    if (turn < this.asked - 1) return;
    traces.forEach((trace, index) => {
      trace.columns = found[index] ?? new Float64Array();
      const isEvery = trace.columns.length / COLUMN < columns / 2;
      trace.held = { from, to, width: isEvery ? 0 : (to - from) / columns };
    });
    this.draw();
  }

  resized() {
    const height = Math.max(this.canvas.parentElement?.clientHeight ?? 0, this.panels.length * LEAST_HEIGHT + AXIS);
    this.canvas.style.height = `${height}px`;
    this.draw();
    this.fetch();
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

  paint() {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const drawn = prepared(this.canvas, width, height);
    if (!drawn) return;
    const { context, colour } = drawn;
    const each = (height - AXIS) / Math.max(1, this.panels.length);
    this.paintAxis(context, colour, height);
    this.panels.forEach((panel, index) => this.paintPanel(context, colour, panel, index * each + GAP / 2, each - GAP, width));
    this.paintMarks(context, colour, height);
  }

  /**
   * @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour
   * @param {number} height
   */
  paintAxis(context, colour, height) {
    const { step, places } = ticks(this.from, this.to, this.width / 90);
    context.textAlign = 'center';
    context.textBaseline = 'top';
    for (const place of places) {
      const x = Math.round(this.xOf(place)) + 0.5;
      context.strokeStyle = colour('grid');
      stroke(context, [[x, 0], [x, height - AXIS]]);
      context.fillStyle = colour('text-soft');
      context.fillText(`${shown(place, step)}${place === places.at(-1) ? ' s' : ''}`, x, height - AXIS + 6);
    }
  }

  /** Least and largest sample of what is seen. @param {Panel} panel */
  extent(panel) {
    let [low, high] = [Infinity, -Infinity];
    for (const { columns, offset_s } of panel.traces) {
      for (let k = 0; k < columns.length; k += COLUMN) {
        if (columns[k + 1] + offset_s < this.from || columns[k] + offset_s > this.to) continue;
        if (columns[k + 2] < low) low = columns[k + 2];
        if (columns[k + 3] > high) high = columns[k + 3];
      }
    }
    if (!(low <= high)) return { low: 0, high: 1 };
    const margin = high > low ? 0.06 * (high - low) : Math.max(1e-12, 0.05 * Math.abs(high)) || 1;
    return { low: low - margin, high: high + margin };
  }

  /**
   * @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour
   * @param {Panel} panel @param {number} top @param {number} height @param {number} width
   */
  paintPanel(context, colour, panel, top, height, width) {
    const { low, high } = this.extent(panel);
    const yOf = (/** @type {number} */ value) => top + height - ((value - low) / (high - low)) * height;
    const { step, places } = ticks(low, high, height / 34);
    context.textAlign = 'right';
    context.textBaseline = 'middle';
    for (const place of places) {
      const y = Math.round(yOf(place)) + 0.5;
      context.strokeStyle = colour('grid');
      stroke(context, [[LEFT, y], [width - RIGHT, y]]);
      context.fillStyle = colour('text-soft');
      context.fillText(shown(place, step), LEFT - 6, y);
    }
    context.strokeStyle = colour('line');
    context.strokeRect(LEFT + 0.5, Math.round(top) + 0.5, width - LEFT - RIGHT - 1, Math.round(height) - 1);
    context.save();
    context.beginPath();
    context.rect(LEFT, top, width - LEFT - RIGHT, height);
    context.clip();
    panel.traces.forEach((trace, index) => this.paintTrace(context, trace, colour(`series-${index % 8}`), yOf));
    context.restore();
    this.paintNames(context, colour, panel, top);
  }

  /**
   * Within a column a line from the first over the least and the largest to the last sample, between columns a line
   * from the last to the first one, as the signal runs.
   * @param {CanvasRenderingContext2D} context @param {Trace} trace @param {string} colour
   * @param {(value: number) => number} yOf
   */
  paintTrace(context, trace, colour, yOf) {
    const { columns, offset_s } = trace;
    context.strokeStyle = colour;
    context.lineWidth = 1.25;
    context.lineJoin = 'bevel';
    context.beginPath();
    let isApart = true;
    for (let k = 0; k < columns.length; k += COLUMN) {
      if (columns[k + COLUMN + 1] + offset_s < this.from) continue;
      const [low, high, first, last] = [columns[k + 2], columns[k + 3], columns[k + 4], columns[k + 5]];
      if (Number.isNaN(low)) {
        isApart = true;
        continue;
      }
      const [x0, x1] = [this.xOf(columns[k] + offset_s), this.xOf(columns[k + 1] + offset_s)];
      if (isApart) context.moveTo(x0, yOf(first));
      else context.lineTo(x0, yOf(first));
      if (high > low) {
        const [one, other] = first - low < high - first ? [low, high] : [high, low];
        context.lineTo((x0 + x1) / 2, yOf(one));
        context.lineTo((x0 + x1) / 2, yOf(other));
      }
      context.lineTo(x1, yOf(last));
      isApart = false;
      if (columns[k] + offset_s > this.to) break;
      // One path of many steep lines takes a browser the square of their number.
      if ((k / COLUMN) % AT_ONCE === AT_ONCE - 1) {
        context.stroke();
        context.beginPath();
        context.moveTo(x1, yOf(last));
      }
    }
    context.stroke();
    context.lineWidth = 1;
  }

  /**
   * @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour
   * @param {Panel} panel @param {number} top
   */
  paintNames(context, colour, panel, top) {
    context.textAlign = 'left';
    context.textBaseline = 'top';
    let x = LEFT + 8;
    panel.traces.forEach((trace, index) => {
      const text = `${trace.channel}${trace.unit ? ` [${trace.unit}]` : ''}`;
      const { width } = context.measureText(text);
      context.fillStyle = colour('back');
      context.globalAlpha = 0.8;
      context.fillRect(x - 4, top + 3, width + 20, 18);
      context.globalAlpha = 1;
      context.fillStyle = colour(`series-${index % 8}`);
      context.fillRect(x, top + 10, 10, 3);
      context.fillStyle = colour('text');
      context.fillText(text, x + 14, top + 6);
      x += width + 30;
    });
  }

  /** @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour @param {number} height */
  paintMarks(context, colour, height) {
    for (const { from_s, to_s, kind, text } of this.stretches) {
      const [x0, x1] = [Math.max(LEFT, this.xOf(from_s)), Math.min(LEFT + this.width, this.xOf(to_s))];
      if (x1 <= x0) continue;
      context.fillStyle = colour(`mark-${kind}`);
      context.globalAlpha = 0.16;
      context.fillRect(x0, 0, x1 - x0, height - AXIS);
      context.globalAlpha = 1;
      paintEnds(context, colour, text, x0, x1, height - AXIS);
    }
    this.cursors.forEach((time, index) => {
      if (time === null || time < this.from || time > this.to) return;
      const x = Math.round(this.xOf(time)) + 0.5;
      context.strokeStyle = colour(index ? 'cursor-b' : 'cursor-a');
      context.setLineDash(index ? [6, 3] : []);
      context.beginPath();
      context.moveTo(x, 0);
      context.lineTo(x, height - AXIS);
      context.stroke();
      context.setLineDash([]);
      context.fillStyle = context.strokeStyle;
      context.textAlign = 'center';
      context.textBaseline = 'bottom';
      context.fillText(index ? 'B' : 'A', x, height - AXIS);
    });
  }

  listen() {
    const { canvas } = this;
    /** @type {{ x: number, from: number, to: number, hasMoved: boolean, cursor: number } | null} */
    let held = null;
    canvas.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      canvas.setPointerCapture(event.pointerId);
      const near = this.cursors.findIndex((time) => time !== null && Math.abs(this.xOf(time) - event.offsetX) < 6);
      held = { x: event.offsetX, from: this.from, to: this.to, hasMoved: false, cursor: near };
    });
    canvas.addEventListener('pointermove', (event) => {
      if (!held) return;
      held.hasMoved ||= Math.abs(event.offsetX - held.x) > 3;
      if (!held.hasMoved) return;
      if (held.cursor >= 0) {
        this.setCursor(held.cursor, this.timeAt(event.offsetX));
        return;
      }
      const moved = ((held.x - event.offsetX) / this.width) * (held.to - held.from);
      this.goTo(held.from + moved, held.to + moved, false);
    });
    canvas.addEventListener('pointerup', (event) => {
      if (held && !held.hasMoved && event.offsetX >= LEFT) {
        this.click(this.timeAt(event.offsetX));
      } else if (held && held.cursor < 0 && held.hasMoved) {
        this.told.moved(this.from, this.to, true);
      }
      held = null;
    });
    canvas.addEventListener('dblclick', () => this.all());
    canvas.addEventListener('wheel', (event) => {
      event.preventDefault();
      const factor = Math.exp(event.deltaY * (event.deltaMode ? 0.05 : 0.0015));
      if (event.shiftKey || Math.abs(event.deltaX) > Math.abs(event.deltaY)) {
        const moved = ((event.deltaX || event.deltaY) / this.width) * (this.to - this.from);
        this.goTo(this.from + moved, this.to + moved);
      } else this.zoom(factor, this.timeAt(event.offsetX));
    }, { passive: false });
    canvas.addEventListener('keydown', (event) => {
      const act = this.keys(event);
      if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      act();
    });
  }

  /** @param {KeyboardEvent} event */
  keys({ key, shiftKey }) {
    const step = (this.to - this.from) * (shiftKey ? 0.02 : 0.2);
    const centre = 0.5 * (this.from + this.to);
    /** @type {Record<string, () => void>} */
    const acts = {
      ArrowLeft: () => this.goTo(this.from - step, this.to - step),
      ArrowRight: () => this.goTo(this.from + step, this.to + step),
      ArrowUp: () => this.zoom(0.5),
      ArrowDown: () => this.zoom(2),
      '+': () => this.zoom(0.5),
      '-': () => this.zoom(2),
      Home: () => this.all(),
      a: () => this.setCursor(0, this.cursors[0] ?? centre),
      b: () => this.setCursor(1, this.cursors[1] ?? centre),
      ',': () => this.nudge(0, -1), '.': () => this.nudge(0, 1),
      ';': () => this.nudge(1, -1), ':': () => this.nudge(1, 1),
      Escape: () => { this.cursors = [null, null]; this.draw(); this.told.marked(); },
    };
    return acts[key];
  }

  /** The first click sets A, the next B, then A again. @param {number} time */
  click(time) {
    this.setCursor(this.cursors[0] === null || this.cursors[1] !== null ? 0 : 1, time);
  }

  /** Moves a cursor by a pixel. @param {number} index @param {number} sign */
  nudge(index, sign) {
    const time = this.cursors[index] ?? 0.5 * (this.from + this.to);
    this.setCursor(index, time + (sign * (this.to - this.from)) / this.width);
  }

  /** @param {number} index @param {number} time */
  setCursor(index, time) {
    this.cursors[index] = time;
    this.draw();
    this.told.marked();
  }
}

/**
 * The ends of a stretch and its text, which tell its kind without colours.
 * @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour @param {string} text
 * @param {number} x0 @param {number} x1 @param {number} height
 */
function paintEnds(context, colour, text, x0, x1, height) {
  context.strokeStyle = colour('text-soft');
  context.strokeRect(x0 + 0.5, 0.5, Math.max(1, x1 - x0 - 1), height - 1);
  context.fillStyle = colour('text');
  context.textAlign = 'center';
  context.textBaseline = 'bottom';
  context.fillText(text, 0.5 * (x0 + x1), height - 4, Math.max(8, x1 - x0));
}
