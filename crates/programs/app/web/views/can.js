// A test on a bench: the answer, what comes nearest to its limit, and what other limits or other ramps would give.

import { get, post, remove } from '../api.js';
import { Plot } from '../chart/axes.js';
import { bandsOf, namesOf } from '../chart/bands.js';
import { figure, percent, rounded } from '../chart/scale.js';
import { failed, fill, h, say } from '../dom.js';
import { note } from '../place.js';
import { typed } from '../work.js';
import { noBench } from './start.js';

export const title = 'Can it run this?';

/** @typedef {{ name: string, unit: string, default: number, lowest: number, highest: number, meaning: string }} Parameter */
/** @typedef {{ of: string, key: string, name: string, unit: string, stated: number | null, largest: number | null, has_course: boolean }} Movable */

/** How fast a field that is moved starts a new run. */
const PAUSE_MS = 350;
const PACE_MS = 300;

const ANSWERS = /** @type {Record<string, string>} */ ({ yes: 'Yes', perhaps: 'Perhaps', no: 'No', not_shown: 'Not shown', not_judged: 'Not judged' });

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const [state, tests] = await Promise.all([get('state'), get('can/tests')]);
  if (!state.benches.length) {
    fill(element, noBench());
    return;
  }
  const models = state.models.map((/** @type {any} */ each) => each.file).filter((/** @type {string} */ file) => /(^|\/)model\.json$/.test(file));
  const now = {
    bench: given.bench ?? state.benches[0].file,
    model: given.model ?? models[0] ?? '',
    test: given.test ?? 'tip-in',
    map: given.map ?? '',
    vehicle: given.vehicle ?? '',
    require: given.require ?? '',
    benches: Number(given.benches) || 200,
    seed: Number(given.seed) || 1,
    of: given.of ?? '',
    draw: given.draw ?? '',
  };
  /** Numbers of the test that are not the usual ones. @type {Record<string, number>} */
  let numbers = given.numbers ? JSON.parse(given.numbers) : {};
  /** Limits that are not those of the bench file. @type {Record<string, number | null>} */
  let limits = given.limits ? JSON.parse(given.limits) : {};
  /** The prediction that is shown. @type {any} */
  let shown = null;
  let key = '';
  let turn = 0;
  let isOver = false;

  const command = h('code', {});
  const form = h('div', { class: 'ask' });
  const progress = h('div', { class: 'progress', role: 'status' });
  const answer = h('div', { class: 'answer', role: 'status' });
  const picture = h('div', { class: 'course curve' });
  const names = h('p', { class: 'names' });
  const below = h('div', { class: 'draws' });
  const sliders = h('div', { class: 'limits' });
  const basis = h('div', { class: 'basis' });
  const result = h('div', { class: 'verdict', hidden: true }, answer, picture, names, below, h('h2', {}, 'Limits'), sliders, basis);
  /** @type {Plot | undefined} */
  let plot;
  fill(element, h('h1', {}, title), h('div', { class: 'sides' }, form, h('div', { class: 'stage' }, h('p', { class: 'line' }, command), progress, result)));

  const shape = () => tests.shapes.find((/** @type {any} */ each) => each.name === now.test);
  const cycle = () => tests.cycles.find((/** @type {any} */ each) => each.name === now.test);

  function words() {
    const set = Object.entries(numbers).flatMap(([name, value]) => ['--set', `${name}=${value}`]);
    const own = now.require.split('\n').map((text) => text.trim()).filter(Boolean).flatMap((text) => ['--require', text]);
    return ['can', now.bench, now.test, ...(now.model ? ['--model', now.model] : []), ...set, ...(cycle() && now.map ? ['--engine-map', now.map] : []),
      ...(cycle()?.needs_vehicle && now.vehicle ? ['--vehicle', now.vehicle] : []), ...own,
      ...(now.benches === 200 ? [] : ['--samples', String(now.benches)]), ...(now.seed === 1 ? [] : ['--seed', String(now.seed)])];
  }

  function remember() {
    command.textContent = typed(words());
    const some = (/** @type {object} */ map) => (Object.keys(map).length ? JSON.stringify(map) : '');
    note('can', { ...now, benches: now.benches === 200 ? '' : now.benches, seed: now.seed === 1 ? '' : now.seed, numbers: some(numbers), limits: some(limits) }, false);
  }

  // The question.

  /** @param {string} label @param {HTMLElement} control @param {string} [help] */
  function field(label, control, help) {
    return h('div', { class: 'field' }, h('label', { for: control.id }, label), control, help && h('small', {}, help));
  }

  /** @param {string} id @param {string} value @param {[string, string][]} choices @param {(value: string) => void} changed */
  function choice(id, value, choices, changed) {
    const select = h('select', { id, onchange: () => changed(select.value) },
      choices.map(([each, name]) => h('option', { value: each, selected: each === value }, name)));
    return select;
  }

  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let pause;
  /** Notes a change of the question, and runs it after a pause, where one was run before. */
  function changed() {
    remember();
    clearTimeout(pause);
    if (key) pause = setTimeout(() => run(), PAUSE_MS);
  }

  /** A number as a slider and a field. @param {{ label: string, unit: string, value: number, low: number, high: number, help?: string, heard: (value: number) => void }} of */
  function number({ label, unit, value, low, high, help, heard }) {
    const id = `number-${label.replaceAll(' ', '-')}`;
    const box = h('input', { id, type: 'number', step: 'any', value: String(value), 'aria-label': `${label}, ${unit}` });
    const range = h('input', { type: 'range', min: low, max: high, step: (high - low) / 200, value: String(value), 'aria-label': `${label}, slider` });
    range.addEventListener('input', () => { box.value = rounded(Number(range.value)); heard(Number(box.value)); });
    box.addEventListener('change', () => { if (box.value.trim()) { range.value = box.value; heard(Number(box.value)); } });
    return h('div', { class: 'number' }, h('label', { for: id }, label, unit && h('span', { class: 'soft' }, ` in ${unit}`)), range, box, help && h('small', {}, help));
  }

  function ask() {
    const isFile = !shape() && !cycle();
    const choices = /** @type {[string, string][]} */ ([
      ...tests.shapes.map((/** @type {any} */ each) => [each.name, each.name]),
      ...tests.cycles.map((/** @type {any} */ each) => [each.name, `${each.name}, ${each.title}`]),
      ...state.recordings.map((/** @type {any} */ each) => [each.file, each.file]),
      ...(isFile ? [[now.test, now.test]] : []),
    ]);
    const files = /** @type {[string, string][]} */ ([['', '(choose)'], ...state.recordings.map((/** @type {any} */ each) => [each.file, each.file])]);
    const parameters = /** @type {Parameter[]} */ (shape()?.parameters ?? []);
    const vehicle = h('input', { id: 'vehicle', type: 'text', value: now.vehicle, placeholder: 'vehicle.toml', onchange: () => { now.vehicle = vehicle.value.trim(); changed(); } });
    const own = h('textarea', { id: 'require', rows: 2, value: now.require, placeholder: 'speed within 10 rpm for 95 %', onchange: () => { now.require = own.value; changed(); } });
    fill(form,
      field('Bench file', choice('bench', now.bench, state.benches.map((/** @type {any} */ each) => [each.file, each.file]), (value) => { now.bench = value; changed(); })),
      field('Model', choice('model', now.model, [...models.map((/** @type {string} */ file) => /** @type {[string, string]} */ ([file, file])), ['', 'none: the bench file alone']], (value) => { now.model = value; changed(); })),
      field('Test', choice('test', now.test, choices, (value) => { now.test = value; numbers = {}; ask(); changed(); }), shape()?.demands),
      cycle() && field('Engine map', choice('map', now.map, files, (value) => { now.map = value; changed(); }), 'A table of speed and torque at full load.'),
      cycle()?.needs_vehicle && field('Vehicle', vehicle, 'A TOML file of the vehicle and its gears.'),
      parameters.map((each) => number({
        label: each.name, unit: each.unit, value: numbers[each.name] ?? each.default, help: each.meaning, ...reach(each),
        heard: (value) => {
          if (value === each.default) delete numbers[each.name];
          else numbers[each.name] = value;
          changed();
        },
      })),
      field('Your requirements', own, 'One a line.'),
      number({ label: 'benches', unit: '', value: now.benches, low: 72, high: 1000, help: 'How many are drawn from what is known of this one.', heard: (value) => { now.benches = Math.max(72, Math.round(value)); changed(); } }),
      h('div', { class: 'tools' }, h('button', { class: 'button', onclick: () => run() }, 'Calculate')));
  }

  /** Where the slider of a number ends: what tests usually have, within what is allowed. @param {Parameter} of */
  function reach(of) {
    const size = 3 * Math.max(Math.abs(of.default), of.unit === 's' ? 1 / 3 : 20);
    return { low: Math.max(of.lowest, of.default < 0 || ['torque', 'to', 'height'].includes(of.name) ? -size : 0), high: Math.min(of.highest, size) };
  }

  // The run.

  async function run() {
    const mine = (turn += 1);
    clearTimeout(pause);
    say('');
    remember();
    result.classList.add('stale');
    const bar = h('progress', { max: 1, 'aria-label': 'Progress of the prediction' });
    fill(progress, h('strong', {}, 'calculating'), bar, h('button', { onclick: () => stop() }, 'Cancel'));
    try {
      const asked = { bench: now.bench, model: now.model || null, test: now.test, given: Object.entries(numbers).map(([name, value]) => [name, String(value)]),
        engine_map: (cycle() && now.map) || null, vehicle: (cycle()?.needs_vehicle && now.vehicle) || null, by: [],
        require: now.require.split('\n').map((text) => text.trim()).filter(Boolean), benches: now.benches, seed: now.seed };
      let stand = await post('can', asked);
      key = stand.key;
      while (!stand.is_done) {
        bar.value = stand.fraction;
        await new Promise((done) => setTimeout(done, PACE_MS));
        if (isOver) return;
        if (mine !== turn) {
          if (key !== stand.key) remove(`can/${stand.key}`);
          return;
        }
        stand = await get(`can/${stand.key}`);
      }
      if (stand.reason) throw new Error(stand.reason);
      const found = await get(`can/${stand.key}/answer`);
      if (mine !== turn || isOver) return;
      shown = { ...found, key: stand.key };
      fill(progress);
      result.classList.remove('stale');
      result.hidden = false;
      if (!shown.movable.some((/** @type {Movable} */ each) => each.of === now.of && each.has_course)) now.of = '';
      limitsOf();
      restsOn();
      await judge();
    } catch (error) {
      if (mine !== turn) return;
      fill(progress, shown && h('span', { class: 'soft' }, 'Below is the last answer, to another question.'));
      failed(error);
    }
  }

  function stop() {
    turn += 1;
    remove(`can/${key}`).catch(failed);
    key = shown?.key ?? '';
    fill(progress, 'Cancelled.', shown && ' Below is the last answer, to another question.');
  }

  // The answer.

  let isJudging = false;
  let isAgain = false;
  /** Judges by the limits as they are now; of several wishes while one is under way, the last. */
  async function judge() {
    if (isJudging) {
      isAgain = true;
      return;
    }
    isJudging = true;
    remember();
    try {
      const { key: of } = shown;
      const judged = Object.keys(limits).length ? await get(`can/${of}/judged`, { limits }) : { ...shown.answer, binding: shown.binding };
      if (of === shown.key) {
        answered(judged);
        await drawCourse(judged);
        say('');
      }
    } catch (error) {
      failed(error);
    }
    isJudging = false;
    if (isAgain) {
      isAgain = false;
      judge();
    }
  }

  /** @param {any} judged */
  function answered(judged) {
    fill(answer,
      h('p', { class: `said ${judged.answer}` }, h('strong', {}, ANSWERS[judged.answer]), ` ${percent(judged.kept)} of ${judged.samples} benches like yours keep everything.`),
      h('p', {}, `${judged.test}: ${judged.sentence}.`),
      Object.keys(limits).length > 0 && h('p', { class: 'soft' }, 'By the limits below, not those of the bench file. No new run was needed.'));
    for (const limit of judged.limits) {
      const row = sliders.querySelector(`[data-of="${limit.of}"] .found`);
      if (row) row.textContent = found(limit);
    }
  }

  /** What the benches do, beside a limit. @param {any} limit */
  function found(limit) {
    const { median, quantile_95: beyond, margin, reached, unit } = limit;
    const values = `half of the benches stay below ${rounded(median)} ${unit}, 95 % below ${rounded(beyond)} ${unit}`;
    if (!reached) return `${values}. No limit is stated.`;
    const left = margin >= 0 ? `${rounded(100 * margin)} % are left` : `${rounded(-100 * margin)} % too much`;
    return `${values}: ${left}. Reached on ${percent(reached)} of the benches.`;
  }

  function limitsOf() {
    const known = new Map(shown.answer.limits.map((/** @type {any} */ each) => [each.of, each]));
    fill(sliders, shown.movable.map((/** @type {Movable} */ each) => slider(each, known.get(each.of))),
      h('div', { class: 'tools' }, h('button', { onclick: () => { limits = {}; limitsOf(); judge(); } }, 'As in the bench file')),
      h('pre', { class: 'stated', hidden: true }));
    stated();
  }

  /** @param {Movable} of @param {any} limit */
  function slider(of, limit) {
    const id = `limit-${of.of}`;
    const value = of.of in limits ? limits[of.of] : of.stated;
    const high = of.largest ?? 2 * (Math.max(of.stated ?? 0, limit.quantile_95 ?? 0) || 1);
    const box = h('input', { id, type: 'number', step: 'any', min: 0, value: value === null ? '' : rounded(value), placeholder: 'none' });
    const range = h('input', { type: 'range', min: 0, max: high, step: high / 500, value: String(value ?? high), 'aria-label': `Limit of the ${of.name}, slider` });
    const moved = (/** @type {number | null} */ next) => {
      if (next === of.stated) delete limits[of.of];
      else limits[of.of] = next;
      stated();
      judge();
    };
    range.addEventListener('input', () => { box.value = rounded(Math.max(Number(range.value), high / 500)); moved(Number(box.value)); });
    box.addEventListener('change', () => {
      const next = box.value.trim() ? Number(box.value) : null;
      range.value = String(next ?? high);
      moved(next);
    });
    return h('div', { class: 'number', 'data-of': of.of },
      h('label', { for: id }, of.name, h('span', { class: 'soft' }, ` in ${of.unit}`)), range, box,
      h('small', {}, h('span', { class: 'found' }, found(limit)),
        of.largest !== null && ` The drive gives no more than ${rounded(of.largest)} ${of.unit}; a larger one needs another bench file.`));
  }

  /** The moved limits as a bench file has them. */
  function stated() {
    const place = /** @type {HTMLElement} */ (sliders.querySelector('.stated'));
    const rows = shown.movable.filter((/** @type {Movable} */ each) => typeof limits[each.of] === 'number')
      .map((/** @type {Movable} */ each) => `${each.key} = "${limits[each.of]} ${each.unit}"`);
    place.hidden = rows.length === 0;
    place.textContent = ['[limits]', ...rows].join('\n');
  }

  /** @param {any} judged */
  async function drawCourse(judged) {
    const drawable = shown.movable.filter((/** @type {Movable} */ each) => each.has_course);
    const binding = drawable.find((/** @type {Movable} */ each) => each.of === shown.binding) ?? drawable[0];
    const of = drawable.find((/** @type {Movable} */ each) => each.of === now.of) ?? binding;
    const bench = now.draw === '' ? undefined : Number(now.draw) - 1;
    const course = await get(`can/${shown.key}/course`, { of: of.of, bench, limits });
    const limit = judged.limits.find((/** @type {any} */ each) => each.of === of.of)?.limit ?? null;
    const spans = shown.beyond_model_s.map((/** @type {number[]} */ [from, to]) => ({ name: 'the model was not tested here', from, to }));
    const end = course.time_s.at(-1) ?? 0;
    const parts = {
      spans,
      bands: [{ name: '90 % of the benches', x: course.time_s, low: course.low, high: course.high, colour: 'series-0' }],
      lines: [
        { name: 'nominal bench', x: course.time_s, y: course.nominal, colour: 'series-0' },
        ...(course.bench?.values.length ? [{ name: `bench ${now.draw}`, x: course.time_s, y: course.bench.values, colour: 'series-2' }] : []),
      ],
      limits: limit === null ? [] : [{ name: `limit, ${rounded(limit)} ${course.unit}`, at: limit, colour: 'fault' }],
    };
    const drawing = bandsOf({
      ...parts,
      label: `Largest ${course.name} over time, from ${figure(course.time_s[0])} to ${figure(end)} s, with its limit`,
      x: { name: 'time [s]', from: course.time_s[0], to: end },
      y: { name: `${course.name} [${course.unit}]`, from: 0 },
      words: (at, value) => {
        const k = course.time_s.indexOf(at);
        return `${figure(at)} s: the nominal bench ${figure(value)} ${course.unit}, 90 % of the benches ${figure(course.low[k])} … ${figure(course.high[k])} ${course.unit}`;
      },
    });
    if (plot) plot.show(drawing);
    else plot = new Plot(picture, drawing);
    fill(names, namesOf(parts));
    draws(drawable, of, course.bench, judged);
  }

  /** @param {Movable[]} drawable @param {Movable} of @param {any} bench @param {any} judged */
  function draws(drawable, of, bench, judged) {
    const focused = below.contains(document.activeElement) ? document.activeElement?.id : '';
    const which = choice('quantity', of.of, drawable.map((each) => [each.of, each.name]), (value) => { now.of = value; judge(); });
    const box = h('input', { id: 'draw', type: 'number', min: 1, max: judged.samples, value: now.draw, placeholder: 'none',
      onchange: () => go(box.value.trim() ? Number(box.value) : null) });
    const go = (/** @type {number | null} */ next) => {
      now.draw = next === null ? '' : String(Math.min(judged.samples, Math.max(1, Math.round(next))));
      judge();
    };
    const at = Number(now.draw) || 0;
    const said = bench && (bench.keeps ? 'keeps everything' : !bench.is_stable ? 'is not stable' : bench.reaches.length ? `reaches: ${bench.reaches.join(', ')}` : 'misses a requirement');
    const first = shown.beyond_model_s.length > 0 && 'Shaded: the recordings did not test the model there.';
    fill(below, h('div', { class: 'tools' },
      h('label', { for: 'quantity' }, 'Course of'), which,
      h('label', { for: 'draw' }, 'One bench of those drawn'),
      h('button', { id: 'draw-before', 'aria-label': 'The bench before', disabled: at <= 1, onclick: () => go(at - 1) }, '‹'), box,
      h('button', { id: 'draw-next', 'aria-label': 'The next bench', disabled: at >= judged.samples, onclick: () => go(at + 1) }, '›'),
      said && h('span', {}, `Bench ${now.draw} of ${judged.samples} ${said}.`)),
    h('p', { class: 'soft' }, 'The largest magnitude in each stretch of the test', cycle() ? ', without firing pulses, which the numbers below have.' : '.', first && ` ${first}`));
    if (focused) document.getElementById(focused)?.focus();
  }

  function restsOn() {
    const { easier, beyond } = shown.answer;
    fill(basis,
      easier.length > 0 && [h('h2', {}, 'What would make it possible'), h('ul', {}, easier.map((/** @type {any} */ each) => h('li', {}, `${each.words}: then ${percent(each.kept)} keep everything.`)))],
      h('h2', {}, 'What the answer rests on'),
      beyond.length === 0 && now.model && h('p', {}, 'The test stays within the speeds and torques of the recordings that the model is from.'),
      !now.model && h('p', {}, 'There is no model of a study: no recording shows where these predictions hold.'),
      h('ul', {}, shown.rests_on.map((/** @type {any} */ each) => h('li', { class: each.is_doubt ? 'doubt' : '' }, h('strong', {}, `${each.severity}: `), each.words))));
  }

  ask();
  remember();
  if (given.test) run();
  return () => {
    isOver = true;
    clearTimeout(pause);
    plot?.end();
  };
}
