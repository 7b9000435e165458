// The Campbell map: lines over the speed of a run-up, their causes, and where they show at another sample rate.

import { get } from '../api.js';
import { kept, prepared } from '../chart/canvas.js';
import { figure, shown, ticks } from '../chart/scale.js';
import { failed, fill, h, say, table } from '../dom.js';
import { link, note } from '../place.js';
import { typed } from '../work.js';

export const title = 'Campbell';

/** @typedef {{ speed_rpm: number, hz: number, shown_hz: number }} Point */
/** @typedef {{ cause: string, order: number | null, amplitude: number, standard_error: number | null, at_rpm: number | null, points: Point[] }} Line */
/** @typedef {{ signal: string, unit: string, sample_rate_hz: number, speed_rpm: [number, number], top_hz: number, shades: string[], shade_db: number, lines: Line[] }} Signal */

const [LEFT, RIGHT, TOP, BOTTOM, HEIGHT] = [60, 34, 12, 40, 460];
/** Darkest shade. */
const DARKEST = 9;
/** Pixels within which a click means a line. */
const NEAR = 14;

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const { benches, recordings } = await get('state');
  if (!benches.length || !recordings.length) {
    fill(element, h('p', {}, 'A map needs a bench file and a recording. ', h('a', { href: link('bench') }, 'Describe the bench'), ' first.'));
    return undefined;
  }
  const files = recordings.map((/** @type {any} */ each) => each.file);
  const list = (/** @type {string} */ name, /** @type {string[]} */ all, /** @type {string | undefined} */ value) => h('select', { 'aria-label': name, onchange: () => open() },
    all.map((each) => h('option', { value: each, selected: each === value }, each)));
  const bench = list('Bench', benches.map((/** @type {any} */ each) => each.file), given.bench);
  const recording = list('Recording', files, given.recording ?? files.find((/** @type {string} */ file) => /ramp/i.test(file)));
  const signals = h('select', { 'aria-label': 'Signal', onchange: () => { line = 0; draw(); } });
  const rate = h('input', { type: 'number', min: 0, step: 'any', value: given.rate ?? '', 'aria-label': 'Another sample rate, Hz', oninput: () => describe() });
  const canvas = h('canvas', { tabindex: 0, role: 'application', 'aria-label': 'Campbell map. Up and down choose a line.' });
  const [command, stand, about] = [h('code', {}), h('p', { role: 'status' }), h('div', { role: 'status' })];
  const picture = h('div', { class: 'map' }, canvas);
  fill(element, h('h1', {}, 'Campbell map'),
    h('div', { class: 'tools' }, h('label', {}, 'Bench ', bench), h('label', {}, 'Recording ', recording), h('label', {}, 'Signal ', signals), command),
    stand, picture, h('p', { class: 'soft' }, 'Darker is stronger. Solid lines show at their frequency; dashed lines are aliases. Click a line, or choose it with the arrow keys up and down.'),
    h('div', { class: 'tools' }, h('label', {}, 'Where does it show at another sample rate, Hz? ', rate)), about);
  /** @type {Signal[]} */
  let maps = [];
  let line = Number(given.line ?? 0);
  /** @type {{ xOf: (rpm: number) => number, yOf: (hz: number) => number } | undefined} */
  let scale;
  /** @type {AbortController | undefined} */
  let asking;
  const end = kept(picture, () => paint());
  canvas.addEventListener('click', (event) => { choose(nearest(event.offsetX, event.offsetY)); });
  canvas.addEventListener('keydown', (event) => {
    const step = event.key === 'ArrowUp' ? -1 : event.key === 'ArrowDown' ? 1 : 0;
    const count = signal()?.lines.length ?? 0;
    if (!step || !count) return;
    event.preventDefault();
    choose((line + step + count) % count);
  });
  await open(given.signal);
  return () => {
    asking?.abort();
    end();
  };

  function signal() {
    return maps[signals.selectedIndex];
  }

  /** @param {string} [wanted] */
  async function open(wanted) {
    asking?.abort();
    asking = new AbortController();
    const { signal: asked } = asking;
    say('');
    maps = [];
    fill(about);
    fill(stand, 'The lines are searched. This takes some seconds.');
    picture.hidden = true;
    command.textContent = typed(['lines', bench.value, recording.value, '--plot=campbell.html']);
    try {
      maps = await get('campbell', { bench: bench.value, recording: recording.value }, asked);
      fill(signals, maps.map((map) => h('option', { value: map.signal, selected: map.signal === wanted }, map.signal)));
      fill(stand, maps.length ? '' : 'The speed of this recording does not change. Choose a run-up or a ramp.');
      draw();
    } catch (error) {
      if (asked.aborted) return;
      fill(stand);
      failed(error);
    }
  }

  function draw() {
    picture.hidden = !maps.length;
    paint();
    describe();
  }

  /** @param {number} index */
  function choose(index) {
    line = index;
    draw();
  }

  /** The line at a place of the picture; the one that is chosen where there is none. @param {number} x @param {number} y */
  function nearest(x, y) {
    const map = signal();
    if (!map || !scale) return line;
    const { xOf, yOf } = scale;
    const far = map.lines.map((each) => Math.min(...each.points.map((point) => Math.hypot(xOf(point.speed_rpm) - x, yOf(point.shown_hz) - y))));
    const best = far.indexOf(Math.min(...far));
    return far[best] <= NEAR ? best : line;
  }

  async function describe() {
    const map = signal();
    const one = map?.lines[line] ?? map?.lines[0];
    note('campbell', { bench: bench.value, recording: recording.value, signal: map?.signal, line, rate: rate.value }, false);
    if (!map || !one) return fill(about);
    const ends = [one.points[0], one.points[one.points.length - 1]];
    const at = ends.map((point) => point.hz);
    const other = Number(rate.value);
    const folded = other > 0 ? await get('folded', { hz: at, rate_hz: other }) : null;
    const column = (/** @type {(point: Point, k: number) => number} */ of) => ends.map((point, k) => `${figure(of(point, k))} Hz`);
    const rows = [
      ['Frequency', ...column((point) => point.hz)],
      [`Shows here, at ${figure(map.sample_rate_hz)} samples a second, at`, ...column((point) => point.shown_hz)],
      ...(folded ? [[`Shows at ${figure(other)} samples a second at`, ...column((_point, k) => folded[k])]] : []),
    ];
    const largest = `${figure(one.amplitude)}${one.standard_error === null ? '' : ` ± ${figure(one.standard_error)}`} ${map.unit}`;
    fill(about, h('h2', {}, one.cause),
      h('p', {}, `Largest amplitude (± standard error): ${largest}${one.at_rpm === null ? '' : `, at ${figure(one.at_rpm)} rpm`}.`),
      table(['', ...ends.map((point) => `at ${figure(point.speed_rpm)} rpm`)], rows, one.order === null ? 'A line that stays where it is' : `Order ${one.order} over the speed`));
  }

  function paint() {
    const map = signal();
    const width = picture.clientWidth;
    if (!map || !width) return;
    canvas.style.height = `${HEIGHT}px`;
    const drawn = prepared(canvas, width, HEIGHT);
    if (!drawn) return;
    const { context, colour } = drawn;
    const [low, high] = map.speed_rpm;
    const top = map.sample_rate_hz / 2;
    const xOf = (/** @type {number} */ rpm) => LEFT + ((rpm - low) / (high - low)) * (width - LEFT - RIGHT);
    const yOf = (/** @type {number} */ hz) => HEIGHT - BOTTOM - (hz / top) * (HEIGHT - TOP - BOTTOM);
    scale = { xOf, yOf };
    paintShades(context, colour, map, scale);
    paintAxes(context, colour, map, scale, width);
    map.lines.forEach((each, index) => paintLine(context, colour, map, each, scale ?? { xOf, yOf }, index === line));
  }
}

/** @typedef {{ xOf: (rpm: number) => number, yOf: (hz: number) => number }} Scale */

/** @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour @param {Signal} map @param {Scale} scale */
function paintShades(context, colour, map, { xOf, yOf }) {
  const [low, high] = map.speed_rpm;
  const wide = (high - low) / map.shades.length;
  context.fillStyle = colour('text');
  map.shades.forEach((column, k) => {
    const [left, right] = [Math.round(xOf(low + k * wide)), Math.round(xOf(low + (k + 1) * wide))];
    const tall = map.top_hz / column.length;
    [...column].forEach((digit, row) => {
      const [from, to] = [Math.round(yOf(row * tall)), Math.round(Math.max(TOP, yOf((row + 1) * tall)))];
      if (digit === '0' || to >= from) return;
      context.globalAlpha = (0.75 * Number(digit)) / DARKEST;
      context.fillRect(left, to, right - left, from - to);
    });
  });
  context.globalAlpha = 1;
}

/** @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour @param {Signal} map @param {Scale} scale @param {number} width */
function paintAxes(context, colour, map, { xOf, yOf }, width) {
  const [low, high] = map.speed_rpm;
  const [columns, rows] = [ticks(low, high, width / 90), ticks(0, map.sample_rate_hz / 2, 10)];
  context.strokeStyle = colour('line');
  context.strokeRect(LEFT + 0.5, TOP + 0.5, width - LEFT - RIGHT - 1, HEIGHT - TOP - BOTTOM - 1);
  context.fillStyle = colour('text-soft');
  context.textAlign = 'center';
  context.textBaseline = 'top';
  for (const place of columns.places) context.fillText(shown(place, columns.step), xOf(place), HEIGHT - BOTTOM + 5);
  context.textAlign = 'right';
  context.textBaseline = 'middle';
  for (const place of rows.places) context.fillText(`${shown(place, rows.step)}${place === rows.places.at(-1) ? ' Hz' : ''}`, LEFT - 6, yOf(place));
  context.textBaseline = 'bottom';
  context.fillText('speed [rpm]', width - RIGHT, HEIGHT - 4);
}

/**
 * @param {CanvasRenderingContext2D} context @param {(name: string) => string} colour @param {Signal} map @param {Line} line
 * @param {Scale} scale @param {boolean} isChosen
 */
function paintLine(context, colour, map, line, { xOf, yOf }, isChosen) {
  context.strokeStyle = colour(isChosen ? 'series-1' : line.order === null ? 'series-2' : 'series-0');
  context.lineWidth = isChosen ? 3 : 1.25;
  for (const isFolded of [false, true]) {
    context.setLineDash(isFolded ? [6, 4] : []);
    context.beginPath();
    let isApart = true;
    for (const { speed_rpm: rpm, hz, shown_hz: at } of line.points) {
      if (hz > map.sample_rate_hz / 2 !== isFolded) isApart = true;
      else if (isApart) [isApart] = [false, context.moveTo(xOf(rpm), yOf(at))];
      else context.lineTo(xOf(rpm), yOf(at));
    }
    context.stroke();
  }
  context.setLineDash([]);
  context.lineWidth = 1;
  const last = line.points[line.points.length - 1];
  context.fillStyle = context.strokeStyle;
  context.textAlign = 'left';
  context.textBaseline = 'middle';
  if (line.order !== null) context.fillText(String(line.order), xOf(last.speed_rpm) + 4, yOf(last.shown_hz));
}
