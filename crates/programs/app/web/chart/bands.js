// Bands, lines, limits and points over one another, and the names of what is in them.

import { h } from '../dom.js';
import { about } from './axes.js';
import { stroke } from './canvas.js';
import { nearest } from './curve.js';

/** @typedef {import('./axes.js').Axis} Axis */
/** @typedef {import('./axes.js').Drawing} Drawing */
/** @typedef {import('./axes.js').Plot} Plot */
/** @typedef {{ name: string, from?: number, to?: number }} Side an axis, with its ends where they are known */
/** @typedef {{ name: string, x: number[], y: number[], colour: string }} Line */
/** @typedef {{ name: string, x: number[], low: number[], high: number[], colour: string }} Band */
/** @typedef {{ name: string, at: number, colour: string }} Limit a horizontal line */
/** @typedef {{ name: string, from: number, to: number }} Span a shaded part of the horizontal axis */
/** @typedef {{ name: string, x: number, y: number, colour: string, isChosen?: boolean }} Point */
/** @typedef {{ bands?: Band[], lines?: Line[], limits?: Limit[], spans?: Span[], points?: Point[] }} Parts */

/** @param {Side} side @param {number[]} values @returns {Axis} */
function axis({ name, from, to }, values) {
  const { low, high } = about([...values, ...(from === undefined ? [] : [from]), ...(to === undefined ? [] : [to])], name, false);
  return { low: from ?? low, high: to ?? high, name };
}

/**
 * A picture of bands and lines, whose mark moves along the first line.
 * @param {{ label: string, x: Side, y: Side, words: (x: number, y: number) => string } & Parts} given
 * @returns {Drawing}
 */
export function bandsOf({ label, x, y, words, bands = [], lines = [], limits = [], spans = [] }) {
  return {
    label, words,
    x: axis(x, lines.flatMap((line) => line.x)),
    y: axis(y, [...lines.flatMap((line) => line.y), ...bands.flatMap((band) => band.high), ...limits.map((limit) => limit.at)]),
    near: (plot, pixel) => nearest(plot.xAt(pixel), lines[0].x, lines[0].y),
    paint: (plot, context, colour) => {
      for (const { from, to } of spans) {
        context.globalAlpha = 0.22;
        context.fillStyle = colour('mark-leave');
        context.fillRect(plot.xOf(from), 0, Math.max(1, plot.xOf(to) - plot.xOf(from)), plot.bottom);
      }
      for (const band of bands) paintBand(plot, context, band, colour(band.colour));
      context.globalAlpha = 1;
      context.lineWidth = 1.5;
      for (const line of lines) {
        context.strokeStyle = colour(line.colour);
        stroke(context, line.x.map((at, k) => [plot.xOf(at), plot.yOf(line.y[k])]));
      }
      context.lineWidth = 2;
      context.setLineDash([7, 4]);
      for (const limit of limits) {
        context.strokeStyle = colour(limit.colour);
        stroke(context, [[0, plot.yOf(limit.at)], [plot.right, plot.yOf(limit.at)]]);
      }
      context.setLineDash([]);
      context.lineWidth = 1;
    },
  };
}

/** @param {Plot} plot @param {CanvasRenderingContext2D} context @param {Band} band @param {string} colour */
function paintBand(plot, context, { x, low, high }, colour) {
  context.globalAlpha = 0.28;
  context.fillStyle = colour;
  context.beginPath();
  x.forEach((at, k) => context.lineTo(plot.xOf(at), plot.yOf(high[k])));
  for (let k = x.length - 1; k >= 0; k -= 1) context.lineTo(plot.xOf(x[k]), plot.yOf(low[k]));
  context.fill();
}

/**
 * Points with their names, one of which can be chosen.
 * @param {{ label: string, x: Side, y: Side, points: Point[], chosen: (name: string) => void }} given
 * @returns {Drawing}
 */
export function pointsOf({ label, x, y, points, chosen }) {
  const at = (/** @type {number} */ px, /** @type {number} */ py) => points.find((point) => point.x === px && point.y === py);
  return {
    label,
    x: axis(x, points.map((point) => point.x)),
    y: axis(y, points.map((point) => point.y)),
    near: (plot, px, py) => {
      const far = (/** @type {Point} */ point) => Math.hypot(plot.xOf(point.x) - px, plot.yOf(point.y) - py);
      const [best] = points.filter((point) => far(point) < NEAR).sort((a, b) => far(a) - far(b));
      return best ? { x: best.x, y: best.y } : null;
    },
    words: (px, py) => at(px, py)?.name ?? '',
    chosen: (px, py) => {
      const point = at(px, py);
      if (point) chosen(point.name);
    },
    paint: (plot, context, colour) => points.forEach((point) => paintPoint(plot, context, point, colour)),
  };
}

/** Pixels within which a place means a point. */
const NEAR = 24;

/** @param {Plot} plot @param {CanvasRenderingContext2D} context @param {Point} point @param {(name: string) => string} colour */
function paintPoint(plot, context, { name, x, y, colour: own, isChosen }, colour) {
  const [at, up] = [plot.xOf(x), plot.yOf(y)];
  context.fillStyle = colour(own);
  context.strokeStyle = colour('text');
  context.beginPath();
  context.arc(at, up, isChosen ? 7 : 5, 0, 2 * Math.PI);
  context.fill();
  if (isChosen) context.stroke();
  context.fillStyle = colour('text');
  const isRight = at > plot.right - 130;
  context.textAlign = isRight ? 'right' : 'left';
  context.textBaseline = 'middle';
  context.fillText(name, at + (isRight ? -10 : 10), up);
}

/** The names of what is drawn, each with its colour. @param {Parts} parts */
export function namesOf({ bands = [], lines = [], limits = [], spans = [] }) {
  const key = (/** @type {string} */ kind, /** @type {string} */ name) => h('span', {}, h('i', { class: `key ${kind}`, 'aria-hidden': 'true' }), name);
  return [
    ...[...lines, ...limits].map(({ colour, name }) => key(colour, name)),
    ...bands.map(({ colour, name }) => key(`${colour} band`, name)),
    ...spans.slice(0, 1).map(({ name }) => key('beyond band', name)),
  ];
}
