// What to record next: the gain of each experiment beside its safety, and the same of one that was changed by hand.

import { get, post, remove } from '../api.js';
import { Plot } from '../chart/axes.js';
import { pointsOf } from '../chart/bands.js';
import { percent, rounded } from '../chart/scale.js';
import { failed, fill, h, say, table } from '../dom.js';
import { note } from '../place.js';
import { give } from '../save.js';
import { result, typed } from '../work.js';
import { noBench } from './start.js';

export const title = 'Next experiment';

/** @typedef {{ name: string, unit: string, default: number, lowest: number, highest: number, meaning: string }} Parameter */
/**
 * @typedef {object} Rated
 * @property {string} label
 * @property {boolean} is_designed
 * @property {number} speed_rpm
 * @property {number} duration_s
 * @property {number} peak_shaft_torque_nm
 * @property {number} narrowing
 * @property {string[]} new
 * @property {string} gains
 * @property {string | null} safety
 * @property {any} kept
 * @property {{ name: string, reached: any }[]} reached
 * @property {string[]} unchecked
 * @property {Parameter[]} parameters
 * @property {Record<string, string>} [given] numbers that were changed by hand
 */

const PACE_MS = 500;

/** @param {Rated} one */
const named = (one) => `${one.label}${one.is_designed ? ', designed' : ''}${one.given ? ', yours' : ''}`;

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const state = await get('state');
  const benches = state.benches.map((/** @type {any} */ each) => each.file);
  if (!benches.length) {
    fill(element, noBench());
    return;
  }
  const now = { bench: given.bench ?? benches[0], speed: Number(given.speed) || 1200, duration: Number(given.duration) || 60 };
  /** @type {Record<string, number | null>} */
  const limits = given.limits ? JSON.parse(given.limits) : {};
  /** @type {Rated[]} */
  let rated = [];
  /** @type {any[]} */
  let stated = [];
  /** @type {Rated | null} */
  let chosen = null;
  let key = '';
  let turn = 0;
  let isOver = false;

  const command = h('code', {});
  const progress = h('div', { class: 'progress', role: 'status' });
  const said = h('p', { class: 'said' });
  const scatter = h('div', { class: 'scatter curve' });
  const rows = h('div', {});
  const editor = h('div', { class: 'editor' });
  const found = h('div', { class: 'verdict', hidden: true }, said, scatter, rows, editor);
  /** @type {Plot | undefined} */
  let plot;
  const bench = h('select', { id: 'bench', onchange: () => { now.bench = bench.value; remember(); } },
    benches.map((/** @type {string} */ file) => h('option', { value: file, selected: file === now.bench }, file)));
  const speed = h('input', { id: 'speed', type: 'number', min: 1, value: String(now.speed), onchange: () => { now.speed = Number(speed.value) || 1200; remember(); } });
  const duration = h('input', { id: 'duration', type: 'number', min: 5, value: String(now.duration), onchange: () => { now.duration = Number(duration.value) || 60; remember(); } });
  fill(element, h('h1', {}, title),
    h('p', {}, 'Each experiment of the method is simulated on a bench like yours, and studied beside your recordings. So its gain is known before it is recorded.'),
    h('div', { class: 'tools' },
      h('label', { for: 'bench' }, 'Bench file'), bench, h('label', { for: 'speed' }, 'Speed in rpm'), speed, h('label', { for: 'duration' }, 'Length in s'), duration,
      h('button', { class: 'button', onclick: () => look() }, 'Look for experiments')),
    h('p', { class: 'line' }, command), progress, found);

  const words = () => ['experiment', 'next', now.bench, '--speed', String(now.speed), '--duration', String(now.duration)];

  function remember() {
    command.textContent = typed(words());
    note('next', { ...now, limits: Object.keys(limits).length ? JSON.stringify(limits) : '' }, false);
  }

  /** Asks for experiments, and waits. @param {string | null} one @param {[string, string][]} numbers */
  async function ask(one, numbers) {
    const mine = (turn += 1);
    say('');
    const bar = h('progress', { max: 1, 'aria-label': 'Progress of the search' });
    const doing = h('span', { class: 'soft' });
    fill(progress, h('strong', {}, 'calculating'), bar, doing, h('button', { onclick: stop }, 'Cancel'));
    found.classList.add('stale');
    let stand = await post('next', { bench: now.bench, speed_rpm: now.speed, duration_s: now.duration, limits, one, given: numbers });
    key = stand.key;
    while (!stand.is_done) {
      bar.value = stand.fraction;
      doing.textContent = stand.doing ?? '';
      await new Promise((done) => setTimeout(done, PACE_MS));
      if (mine !== turn || isOver) return null;
      stand = await get(`next/${stand.key}`);
    }
    if (stand.reason) throw new Error(stand.reason);
    const answer = await get(`next/${stand.key}/answer`);
    if (mine !== turn || isOver) return null;
    fill(progress);
    found.classList.remove('stale');
    found.hidden = false;
    return answer;
  }

  function stop() {
    turn += 1;
    remove(`next/${key}`).catch(failed);
    found.classList.remove('stale');
    fill(progress, 'Cancelled.');
  }

  /** @param {unknown} error */
  function ended(error) {
    fill(progress);
    found.classList.remove('stale');
    failed(error);
  }

  async function look() {
    remember();
    try {
      const answer = await ask(null, []);
      if (!answer) return;
      [rated, stated] = [answer.experiments, answer.limits];
      said.textContent = answer.recommendation;
      choose(rated[0] ?? null);
    } catch (error) {
      ended(error);
    }
  }

  /** @param {Rated | null} one */
  function choose(one) {
    chosen = one;
    draw();
    edit();
  }

  function draw() {
    const checked = rated.filter((one) => one.kept);
    const drawing = pointsOf({
      label: 'Gain of each experiment over the share of benches that reach no limit',
      x: { name: 'benches that reach no limit [%]', from: 0, to: 105 },
      y: { name: 'intervals narrower, all factors multiplied', from: 0 },
      chosen: (name) => choose(rated.find((one) => named(one) === name) ?? null),
      points: checked.map((one) => ({
        name: named(one), x: 100 * one.kept.estimate, y: one.narrowing, isChosen: one === chosen,
        colour: one.given ? 'series-2' : one.safety === 'unsafe' ? 'fault' : 'series-0',
      })),
    });
    if (plot) plot.show(drawing);
    else plot = new Plot(scatter, drawing);
    const row = (/** @type {Rated} */ one) => [
      h('button', { 'aria-pressed': String(one === chosen), onclick: () => choose(one) }, named(one)),
      `${rounded(one.speed_rpm)} rpm, ${rounded(one.duration_s)} s`,
      `× ${rounded(one.narrowing)}${one.new.length ? `, and shows ${one.new.join(', ')}` : ''}`,
      one.kept ? `${percent(one.kept)} reach none` : 'not checked, as it gains nothing',
      one.reached.map(({ name, reached }) => `${name} ${percent(reached)}`).join(', ') || '–',
      `${rounded(one.peak_shaft_torque_nm)} Nm`,
      h('span', { class: 'why' }, one.gains || 'gains nothing'),
    ];
    fill(rows, table(['Experiment', 'Speed, length', 'Gain', 'Limits', 'Reached', 'T_shaft up to', 'In words'], rated.map(row), 'Experiments, the one that gains most first'));
  }

  // One experiment with other numbers.

  /** @param {Rated} one @param {Record<string, string>} numbers */
  function design(one, numbers) {
    const which = one.is_designed ? ['--optimal', 'K,B', '--speed', String(one.speed_rpm), '--duration', String(one.duration_s)]
      : [one.label, ...Object.entries(numbers).flatMap(([name, value]) => ['--set', `${name}=${value}`])];
    const folder = now.bench.includes('/') ? now.bench.slice(0, now.bench.lastIndexOf('/') + 1) : '';
    const model = [`${folder}study/model.json`, `${folder}model.json`].find((file) => state.models.some((/** @type {any} */ each) => each.file === file));
    return ['experiment', 'design', now.bench, ...which, ...(model ? ['--model', model] : [])];
  }

  function edit() {
    const one = chosen;
    if (!one) return fill(editor);
    /** @type {Record<string, string>} */
    const numbers = one.given ?? { speed: String(one.speed_rpm), duration: String(one.duration_s) };
    const line = h('code', {}, typed(design(one, numbers)));
    const parameter = (/** @type {Parameter} */ of) => {
      const id = `number-${of.name}`;
      const box = h('input', { id, type: 'number', step: 'any', value: numbers[of.name] ?? String(of.default), onchange: () => {
        numbers[of.name] = box.value;
        line.textContent = typed(design(one, numbers));
      } });
      return h('div', { class: 'field' }, h('label', { for: id }, `${of.name}${of.unit ? ` in ${of.unit}` : ''}`), box, h('small', {}, of.meaning));
    };
    const limit = (/** @type {any} */ of) => {
      const id = `limit-${of.of}`;
      const value = of.of in limits ? limits[of.of] : of.stated;
      const box = h('input', { id, type: 'number', step: 'any', min: 0, value: value === null ? '' : rounded(value), placeholder: 'none', onchange: () => {
        limits[of.of] = box.value.trim() ? Number(box.value) : null;
        if (limits[of.of] === of.stated) delete limits[of.of];
        remember();
      } });
      return h('div', { class: 'field' }, h('label', { for: id }, `${of.name} in ${of.unit}`), box);
    };
    const files = h('ul', { class: 'files' });
    fill(editor, h('h2', {}, named(one)),
      one.unchecked.length > 0 && h('p', {}, `Not checked, since the bench file states no limit: ${one.unchecked.join(', ')}.`),
      one.is_designed ? h('p', { class: 'soft' }, 'Its demand follows from the bench and its limits.')
        : h('fieldset', {}, h('legend', {}, 'Its numbers'), one.parameters.map(parameter)),
      h('fieldset', {}, h('legend', {}, 'Limits of the bench'), stated.map(limit)),
      h('div', { class: 'tools' },
        !one.is_designed && h('button', { class: 'button', onclick: () => tried(one, { ...numbers }) }, 'Gain and safety with these'),
        h('button', { onclick: (/** @type {Event} */ event) => demands(/** @type {HTMLButtonElement} */ (event.target), design(one, numbers), files) }, 'Write its demands')),
      h('p', { class: 'line' }, line), files);
  }

  /** @param {Rated} one @param {Record<string, string>} numbers */
  async function tried(one, numbers) {
    try {
      const answer = await ask(one.label, Object.entries(numbers));
      if (!answer) return;
      const own = { ...answer.experiments[0], given: numbers };
      rated = [...rated.filter((each) => named(each) !== named(own)), own];
      choose(own);
    } catch (error) {
      ended(error);
    }
  }

  /** Writes the files of the demands, and offers those that are text. @param {HTMLButtonElement} button @param {string[]} asked @param {HTMLElement} files */
  async function demands(button, asked, files) {
    button.disabled = true;
    try {
      const { files: written } = await result(asked);
      fill(files, written.map((/** @type {string} */ file) => h('li', {}, file, ' ', file.endsWith('.csv') && h('button', { onclick: () => download(file).catch(failed) }, 'Download'))));
    } catch (error) {
      failed(error);
    }
    button.disabled = false;
  }

  /** @param {string} file */
  async function download(file) {
    const { text } = await get('text', { file });
    give(new Blob([text], { type: 'text/csv' }), file.slice(file.lastIndexOf('/') + 1));
  }

  remember();
  return () => {
    isOver = true;
    plot?.end();
  };
}
