// Analyses of a stretch of a recording: histogram, spectrum, spectrogram, and one channel over another. The program
// computes them; this shows them.

import { get } from '../api.js';
import { Plot, about } from '../chart/axes.js';
import { barsOf, dotsOf, lineOf } from '../chart/curve.js';
import { imageOf } from '../chart/image.js';
import { figure } from '../chart/scale.js';
import { fill, h, wordsOf } from '../dom.js';
import { typed } from '../work.js';

/** @typedef {import('../chart/axes.js').Drawing} Drawing */
/** @typedef {{ file: string, channel: string, offset_s: number }} Line */

/**
 * How a stretch is looked at, as the address has it.
 * @typedef {object} Looks
 * @property {string} [kind]
 * @property {string} [of] file and channel
 * @property {string} [over] the channel along x
 * @property {string} [segment]
 * @property {string} [bins]
 * @property {string} [up_to_hz]
 * @property {boolean} [density] whether the spectrum is power density, not amplitude
 * @property {boolean} [log_x]
 * @property {boolean} [lin_y]
 */

/** @typedef {{ drawing: Drawing, words: (string | false | null)[], command?: string[] }} Shown */

const KINDS = { '': 'none', histogram: 'Histogram', spectrum: 'Spectrum', spectrogram: 'Spectrogram', pairs: 'XY' };
const SEGMENTS = [64, 128, 256, 512, 1024, 2048, 4096, 8192, 16384, 32768, 65536];
/** The stretch may still be moving. */
const PAUSE_MS = 250;

export class Stretch {
  /**
   * @param {Looks} looks
   * @param {{ lines: () => Line[], span: () => { from: number, to: number, words: string }, changed: () => void }} given
   */
  constructor(looks, given) {
    this.looks = looks;
    this.given = given;
    this.tools = h('div', { class: 'tools' });
    this.place = h('div', { class: 'curve' });
    this.words = h('div', { class: 'soft', role: 'status' });
    this.element = h('section', { class: 'stretch', 'aria-label': 'Analysis of the stretch' }, this.tools, this.place, this.words);
    /** @type {Plot | undefined} */
    this.plot = undefined;
    /** @type {AbortController | undefined} */
    this.asking = undefined;
    this.lines = '';
    this.choices();
  }

  end() {
    this.asking?.abort();
    this.plot?.end();
  }

  /** The channels or the stretch are other ones. */
  update() {
    const lines = JSON.stringify(this.given.lines().map(key));
    if (lines !== this.lines) {
      this.lines = lines;
      this.choices();
    }
    this.draw();
  }

  /** @param {Partial<Looks>} looks */
  set(looks) {
    Object.assign(this.looks, looks);
    this.choices();
    this.draw();
    this.given.changed();
  }

  /** The line that is analysed: the chosen one, or else the first. */
  get line() {
    const lines = this.given.lines();
    return lines.find((each) => key(each) === this.looks.of) ?? lines[0];
  }

  choices() {
    const { looks, line } = this;
    const lines = this.given.lines();
    const several = new Set(lines.map((each) => each.file)).size > 1;
    const name = (/** @type {Line} */ each) => (several ? `${each.channel} of ${each.file}` : each.channel);
    const own = line ? lines.filter((each) => each.file === line.file) : [];
    const isSpectral = looks.kind === 'spectrum' || looks.kind === 'spectrogram';
    const focused = this.tools.contains(document.activeElement) ? document.activeElement?.getAttribute('aria-label') : null;
    fill(this.tools,
      choice('Analysis', Object.entries(KINDS), looks.kind ?? '', (kind) => this.set({ kind })),
      looks.kind && line && choice(looks.kind === 'pairs' ? 'Channel along y' : 'Channel analysed', lines.map((each) => [key(each), name(each)]), key(line), (of) => this.set({ of })),
      looks.kind === 'pairs' && line && choice('Channel along x', own.map((each) => [each.channel, each.channel]), this.along_x(), (over) => this.set({ over })),
      looks.kind === 'spectrum' && choice('Quantity', [['', 'amplitude'], ['density', 'power density']], looks.density ? 'density' : '', (of) => this.set({ density: of === 'density' })),
      isSpectral && choice('Samples in a segment', [['', 'usual length'], ...SEGMENTS.map((each) => [String(each), `${each} samples`])], looks.segment ?? '', (segment) => this.set({ segment })),
      isSpectral && number('Up to Hz', looks.up_to_hz, (up_to_hz) => this.set({ up_to_hz })),
      looks.kind === 'histogram' && number('Bins', looks.bins, (bins) => this.set({ bins })),
      looks.kind === 'spectrum' && tick('logarithmic frequency', Boolean(looks.log_x), (log_x) => this.set({ log_x })),
      looks.kind === 'spectrum' && tick('logarithmic value', !looks.lin_y, (log_y) => this.set({ lin_y: !log_y })));
    for (const each of this.tools.querySelectorAll('[aria-label]')) {
      if (focused && each.getAttribute('aria-label') === focused && each instanceof HTMLElement) each.focus();
    }
  }

  /** The channel along x: the chosen one, or else another than that along y. */
  along_x() {
    const own = this.given.lines().filter((each) => each.file === this.line?.file).map((each) => each.channel);
    const over = this.looks.over ?? '';
    return own.includes(over) ? over : own.find((channel) => channel !== this.line?.channel) ?? own[0];
  }

  async draw() {
    this.asking?.abort();
    const { looks: { kind }, line } = this;
    this.element.classList.toggle('open', Boolean(kind && line));
    if (!kind || !line) return this.clear();
    const asking = new AbortController();
    this.asking = asking;
    await new Promise((done) => setTimeout(done, PAUSE_MS));
    if (asking.signal.aborted) return;
    const { from, to, words } = this.given.span();
    const given = { file: line.file, channels: [line.channel], from_s: from - line.offset_s, to_s: to - line.offset_s };
    try {
      const found = await FIND[/** @type {keyof typeof FIND} */ (kind)](this, line, given, asking.signal);
      if (asking.signal.aborted) return;
      this.plot?.end();
      this.plot = new Plot(this.place, found.drawing);
      fill(this.words, h('p', {}, `${words}: ${found.words.filter(Boolean).join('; ')}.`), found.command ? h('code', {}, typed(found.command)) : null);
    } catch (error) {
      if (asking.signal.aborted) return;
      this.clear();
      fill(this.words, h('p', { class: 'fault' }, wordsOf(error)));
    }
  }

  clear() {
    this.plot?.end();
    this.plot = undefined;
    fill(this.place);
    fill(this.words);
  }
}

/** @typedef {{ file: string, channels: string[], from_s: number, to_s: number }} Given */

const FIND = { histogram, spectrum, spectrogram, pairs };

/** @param {Stretch} view @param {Line} line @param {Given} given @param {AbortSignal} signal @returns {Promise<Shown>} */
async function histogram({ looks }, line, given, signal) {
  const { unit, figures, low, width, counts } = await get('histogram', { ...given, bins: looks.bins || undefined }, signal);
  const end = low + counts.length * width;
  return {
    drawing: barsOf({
      label: `Histogram of ${line.channel}`, low, width, heights: counts,
      x: { low, high: end, name: named(line.channel, unit) }, y: { ...about([0, ...counts], 'samples', false), low: 0 },
      words: (x, y) => `${figure(x - width / 2)} to ${figure(x + width / 2)} ${unit}: ${y} samples`,
    }),
    words: [
      `${figures.samples} samples`, figures.missing > 0 && `${figures.missing} missing`, `${counts.length} bins of ${figure(width)} ${unit}`,
      `mean ${figure(figures.mean)}, standard deviation ${figure(figures.standard_deviation)}, least ${figure(figures.least)}, largest ${figure(figures.largest)} ${unit}`,
    ],
  };
}

/** @param {Stretch} view @param {Line} line @param {Given} given @param {AbortSignal} signal @returns {Promise<Shown>} */
async function spectrum({ looks }, line, given, signal) {
  const found = await get('spectrum', { ...given, segment: looks.segment || undefined }, signal);
  const { frequency_hz: all, density, amplitude, interval_95: [low, high] } = found;
  const unit = looks.density ? found.density_unit : found.unit;
  // At rest there is nothing: the mean of each segment is removed.
  const up_to = Number(looks.up_to_hz) || Infinity;
  const end = Math.max(2, all.findLastIndex((/** @type {number} */ hz) => hz <= up_to) + 1);
  const [xs, ys] = [all.slice(1, end), (looks.density ? density : amplitude).slice(1, end)];
  const quantity = looks.density ? 'power density' : 'amplitude';
  return {
    drawing: lineOf({
      label: `Spectrum of ${line.channel}`, xs, ys,
      x: about(xs, 'frequency, Hz', Boolean(looks.log_x), 0), y: about(ys, named(quantity, unit), !looks.lin_y),
      words: (x, y) => `${figure(x)} Hz: ${quantity} ${figure(y)} ${unit}`,
    }),
    words: [
      ...cut(found.segments),
      looks.density ? `with probability 0.95 a density of noise is ${figure(low)} to ${figure(high)} times that shown` : 'a sine between two lines shows down to 0.85 of its amplitude',
    ],
    command: ['data', 'spectrum', given.file, '-y', line.channel, `--from=${given.from_s}`, `--to=${given.to_s}`, `--window=${found.segments.segment}`],
  };
}

/** @param {Stretch} view @param {Line} line @param {Given} given @param {AbortSignal} signal @returns {Promise<Shown>} */
async function spectrogram({ looks, place }, line, given, signal) {
  const columns = Math.max(100, Math.round(place.clientWidth / 2));
  const found = await get('spectrogram', { ...given, segment: looks.segment || undefined, up_to_hz: looks.up_to_hz || undefined, columns }, signal);
  const { levels_db: values, first_hz, band_hz, density_unit } = found;
  const [from, to] = [found.from_s + line.offset_s, found.to_s + line.offset_s];
  return {
    drawing: imageOf({
      label: `Spectrogram of ${line.channel}`, values, range: found.range_db ?? [0, 1], scale: 'dB',
      x: { low: from, high: to, name: 'time, s' }, y: { low: 0, high: first_hz + values[0].length * band_hz, name: 'frequency, Hz' },
      along_x: [from, (to - from) / values.length], along_y: [first_hz, band_hz],
      words: (x, y, value) => `${figure(x)} s, ${figure(y)} Hz: ${value === null ? 'no segment without missing samples' : `${figure(value)} dB of 1 ${density_unit}`}`,
    }),
    words: [
      ...cut(found.segments), `colours are power density in dB of 1 ${density_unit}`,
      found.segments.segments > values.length && `each of ${values.length} columns is a mean`,
      found.frequencies_a_band > 1 && `each row is the largest of ${found.frequencies_a_band} frequencies`,
    ],
  };
}

/** @param {Stretch} view @param {Line} line @param {Given} given @param {AbortSignal} signal @returns {Promise<Shown>} */
async function pairs(view, line, given, signal) {
  const over = view.along_x();
  const found = await get('pairs', { ...given, channels: [over, line.channel] }, signal);
  const { points, cells, units: [unit_x, unit_y] } = found;
  const [name_x, name_y] = [named(over, unit_x), named(line.channel, unit_y)];
  const label = `${line.channel} over ${over}`;
  const at = (/** @type {number} */ x, /** @type {number} */ y) => `${figure(x)} ${unit_x}, ${figure(y)} ${unit_y}`;
  const words = [
    `${found.pairs} pairs, one every ${figure(found.sample_time_s)} s, on the clock of the slower channel`,
    found.is_cut && `only the time up to ${figure(found.to_s + line.offset_s)} s, since it is so long`,
    cells && 'colours are pairs in a cell',
    found.missing > 0 && `${found.missing} pairs are missing`, ...found.notes,
  ];
  if (!cells) {
    const [xs, ys] = [0, 1].map((axis) => points.map((/** @type {number[]} */ point) => point[axis]));
    return { drawing: dotsOf({ label, points, x: about(xs, name_x, false), y: about(ys, name_y, false), words: at }), words };
  }
  const { along_x, along_y, counts } = cells;
  const end = (/** @type {number[]} */ [low, width], /** @type {number} */ count) => low + count * width;
  return {
    drawing: imageOf({
      label, values: counts, along_x, along_y, isLog: true, scale: 'pairs', range: [1, Math.max(2, ...counts.map((/** @type {number[]} */ column) => Math.max(...column)))],
      x: { low: along_x[0], high: end(along_x, counts.length), name: name_x }, y: { low: along_y[0], high: end(along_y, counts[0].length), name: name_y },
      words: (x, y, value) => `${at(x, y)}: ${value ?? 0} pairs`,
    }),
    words,
  };
}

/** How a stretch was cut into segments, in words. @param {any} of */
function cut(of) {
  const seconds = of.segment * of.sample_time_s;
  return [
    `${of.samples} samples at ${figure(1 / of.sample_time_s)} Hz`, of.missing > 0 && `${of.missing} missing`,
    `${of.window} window over ${of.segment} samples (${figure(seconds)} s) that overlap by ${of.overlap}`,
    `${of.segments} segments averaged`, of.left_out > 0 && `${of.left_out} left out, since samples are missing in them`,
    `a line every ${figure(of.spacing_hz)} Hz, resolution ${figure(of.bandwidth_hz)} Hz`, ...of.notes,
  ];
}

/** @param {Line} line */
const key = ({ file, channel }) => `${file}\n${channel}`;

/** @param {string} name @param {string} unit */
const named = (name, unit) => (unit ? `${name}, ${unit}` : name);

/** @param {string} label @param {string[][]} options @param {string} now @param {(value: string) => void} chosen */
function choice(label, options, now, chosen) {
  const select = h('select', { 'aria-label': label, onchange: () => chosen(select.value) },
    options.map(([value, text]) => h('option', { value, selected: value === now }, text)));
  return h('label', {}, `${label} `, select);
}

/** @param {string} label @param {string | undefined} now @param {(value: string) => void} chosen */
function number(label, now, chosen) {
  const input = h('input', { type: 'number', min: 1, step: 'any', 'aria-label': label, value: now ?? '', placeholder: 'all', onchange: () => chosen(input.value) });
  return h('label', {}, `${label} `, input);
}

/** @param {string} label @param {boolean} now @param {(value: boolean) => void} chosen */
function tick(label, now, chosen) {
  const box = h('input', { type: 'checkbox', 'aria-label': label, checked: now, onchange: () => chosen(box.checked) });
  return h('label', {}, box, ` ${label}`);
}
