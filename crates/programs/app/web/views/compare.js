// Comparison: two studies beside each other, and models on recordings.

import { extent, get } from '../api.js';
import { correlations } from '../chart/correlations.js';
import { intervals } from '../chart/intervals.js';
import { Panels } from '../chart/panels.js';
import { figure } from '../chart/scale.js';
import { failed, fill, h, say, swatch, table, wordsOf } from '../dom.js';
import { link, note } from '../place.js';
import { typed } from '../work.js';

export const title = 'Compare';

/** @typedef {{ file: string, is_study: boolean, kind: 'bench' | 'linear', bench?: string, date?: string, method?: string }} Model */
/** @typedef {{ model: string, recording: string }} Cell */

/** Cells that are asked for at once. */
const AT_ONCE = 2;

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const [models, state] = await Promise.all([get('models'), get('state')]);
  const parts = { studies: h('section', {}), matrix: h('section', {}) };
  const asked = { ...given };
  const remember = (/** @type {Record<string, any>} */ changes) => {
    Object.assign(asked, changes);
    note('compare', asked, false);
  };
  fill(element, h('h1', {}, 'Compare'), parts.studies, parts.matrix);
  studies(parts.studies, models, asked, remember);
  return matrix(parts.matrix, models, state.recordings, asked, remember);
}

/**
 * @param {HTMLElement} element @param {Model[]} models @param {Record<string, any>} asked
 * @param {(changes: Record<string, any>) => void} remember
 */
function studies(element, models, asked, remember) {
  const benches = models.filter((model) => model.kind === 'bench');
  if (benches.length < 1) {
    fill(element, h('h2', {}, 'Two studies'), h('p', {}, 'There is no study in this folder yet. ', h('a', { href: link('study') }, 'Study a bench'), ' first.'));
    return;
  }
  const list = (/** @type {string} */ name, /** @type {string} */ value) => h('select', { 'aria-label': name, onchange: () => go() },
    benches.map((model) => h('option', { value: model.file, selected: model.file === value }, `${model.file} (${model.bench}, ${model.date})`)),
    // A file that cannot be read is no reason to show another one.
    benches.some((model) => model.file === value) ? [] : [h('option', { value, selected: true }, value)]);
  const studied = benches.filter((model) => !model.is_study);
  const first = list('First', asked.first ?? studied[0]?.file);
  const second = list('Second', asked.second ?? (studied[1] ?? studied[0])?.file);
  const [command, found] = [h('code', {}), h('div', { class: 'pair' })];
  fill(element, h('h2', {}, 'Two studies'),
    h('div', { class: 'tools' }, h('label', {}, 'First ', first), h('label', {}, 'Second ', second), command), found);
  go();

  async function go() {
    remember({ first: first.value, second: second.value });
    command.textContent = typed(['diff', first.value, second.value]);
    try {
      fill(found, pair(await get('pair', { first: first.value, second: second.value })));
      say('');
    } catch (error) {
      fill(found);
      failed(error);
    }
  }
}

/** @param {any} found */
function pair(found) {
  const heads = ['', 'First and second', 'By chance', 'Second less first', 'First', 'Second'];
  const body = found.parts.flatMap((/** @type {any} */ part) => [
    h('tr', { class: 'part' }, h('th', { scope: 'row', colspan: 2 }, part.name, ' ',
      h('strong', { class: part.changed ? 'bad' : 'good' }, part.changed ? 'changed' : 'no change found')), h('td', { colspan: 4 }, part.chance)),
    ...part.parameters.map(parameter),
  ]);
  return [
    h('p', { class: found.changed ? 'bad' : 'good' }, found.title, '. ', h('span', { class: 'soft' }, found.sources)),
    found.remarks.map((/** @type {string} */ remark) => h('p', { class: 'soft' }, remark)),
    h('p', {}, swatch(0), ` First: ${found.first.bench}, ${found.first.date}. `, swatch(1), ` Second: ${found.second.bench}, ${found.second.date}.`),
    h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Parameters' }, h('table', {},
      h('caption', {}, 'Parameters with their 95 % intervals'),
      h('thead', {}, h('tr', {}, heads.map((head) => h('th', { scope: 'col' }, head)))), h('tbody', {}, body))),
    verdicts(found.first.verdict, found.second.verdict),
  ].flat();
}

/** @param {any} one */
function parameter(one) {
  const picture = h('canvas', { class: 'intervals', role: 'img', 'aria-label': `Intervals of ${one.name}` });
  intervals(picture, [one.first, one.second]);
  const difference = one.interval_95 ? `${figure(one.difference)} (${within(one.interval_95)})` : one.difference === 0 ? 'exact' : 'stated differently';
  return h('tr', {}, h('th', { scope: 'row' }, one.symbol, ' ', h('span', { class: 'soft' }, `${one.name}${one.unit && `, ${one.unit}`}`)),
    h('td', {}, picture), h('td', {}, one.chance), h('td', {}, difference), h('td', {}, valued(one.first)), h('td', {}, valued(one.second)));
}

const within = (/** @type {number[]} */ [low, high]) => `${figure(low)} … ${figure(high)}`;
const valued = (/** @type {any} */ { value, interval_95: interval }) => (interval ? `${figure(value)} (${within(interval)})` : figure(value));

/** @param {any} first @param {any} second */
function verdicts(first, second) {
  if (!first && !second) return h('p', { class: 'soft' }, 'No study.json is beside the models, so there are no verdicts.');
  const cell = (/** @type {any} */ rule) => (rule ? `${rule.outcome}: ${rule.found}` : '–');
  const rules = (first ?? second).rules.map((/** @type {any} */ rule, /** @type {number} */ k) => [rule.asks, cell(first?.rules[k]), cell(second?.rules[k])]);
  const whole = ['The whole', first?.headline ?? 'no study beside the model', second?.headline ?? 'no study beside the model'];
  const element = table(['Rule', 'First', 'Second'], [whole, ...rules], 'Verdicts');
  element.classList.add('verdicts');
  return element;
}

/**
 * @param {HTMLElement} element @param {Model[]} models @param {{ file: string }[]} recordings
 * @param {Record<string, any>} asked @param {(changes: Record<string, any>) => void} remember
 */
function matrix(element, models, recordings, asked, remember) {
  const all = models.filter((model) => !model.is_study);
  if (!all.length || !recordings.length) {
    fill(element, h('h2', {}, 'Models on recordings'), h('p', {}, 'This needs a model and a recording. ', h('a', { href: link('model') }, 'Fit a model'), '.'));
    return undefined;
  }
  const chosen = {
    models: new Set(asked.models ? JSON.parse(asked.models) : all.map((model) => model.file).slice(0, 4)),
    recordings: new Set(asked.recordings ? JSON.parse(asked.recordings) : recordings.map((each) => each.file).slice(0, 3)),
  };
  const horizon = h('input', { type: 'number', min: 1, step: 1, value: asked.horizon ?? '', placeholder: 'simulate', 'aria-label': 'Samples ahead', onchange: () => draw() });
  const [grid, command, detail] = [h('div', {}), h('code', {}), h('div', { class: 'meeting' })];
  const boxes = (/** @type {'models' | 'recordings'} */ kind, /** @type {string[]} */ names) => h('fieldset', { class: 'choice' },
    h('legend', {}, kind === 'models' ? 'Models' : 'Recordings'), names.map((name) => {
      const box = h('input', { type: 'checkbox', checked: chosen[kind].has(name), onchange: () => {
        if (box.checked) chosen[kind].add(name);
        else chosen[kind].delete(name);
        draw();
      } });
      return h('label', {}, box, ' ', name);
    }));
  fill(element, h('h2', {}, 'Models on recordings'),
    boxes('models', all.map((model) => model.file)), boxes('recordings', recordings.map((each) => each.file)),
    h('div', { class: 'tools' }, h('label', {}, 'Linear models predict so many samples ahead: ', horizon), h('span', { class: 'soft' }, 'empty: they are simulated')),
    grid, command, detail);
  /** @type {AbortController | undefined} */
  let asking;
  draw();
  if (asked.cell) open(JSON.parse(asked.cell));
  return () => asking?.abort();

  /** The question of a cell. @param {Cell} cell */
  function wanted(cell) {
    const isLinear = all.find((model) => model.file === cell.model)?.kind === 'linear';
    return { ...cell, horizon: isLinear && Number(horizon.value) >= 1 ? Math.round(Number(horizon.value)) : undefined };
  }

  async function draw() {
    asking?.abort();
    asking = new AbortController();
    const { signal } = asking;
    const rows = all.filter((model) => chosen.models.has(model.file));
    const columns = recordings.filter((each) => chosen.recordings.has(each.file)).map((each) => each.file);
    remember({ models: JSON.stringify([...chosen.models]), recordings: JSON.stringify(columns), horizon: horizon.value });
    /** @type {(() => Promise<void>)[]} */
    const due = [];
    const body = rows.map((model) => [h('span', {}, model.file, ' ', h('span', { class: 'soft' }, model.method ?? model.bench ?? '')), ...columns.map((recording) => {
      const cell = { model: model.file, recording };
      const button = h('button', { class: 'cell', onclick: () => open(cell), 'aria-label': `${model.file} on ${recording}` }, '…');
      due.push(() => fit(button, cell, signal));
      return button;
    })]);
    fill(grid, table(['Model', ...columns], body, 'Fit of each model on each recording'));
    const linear = rows.filter((model) => model.kind === 'linear').map((model) => model.file);
    const benches = rows.filter((model) => model.kind === 'bench').map((model) => model.file);
    const ahead = Number(horizon.value) >= 1 ? [`--horizon=${Math.round(Number(horizon.value))}`] : [];
    const on = columns.map((recording) => `--on=${recording}`);
    const lines = [linear.length && typed(['model', 'compare', ...linear, ...on, ...ahead]), benches.length && typed(['model', 'compare', ...benches, ...on])];
    fill(command, columns.length ? lines.filter(Boolean).join('\n') : '');
    const next = async () => {
      for (let task = due.shift(); task && !signal.aborted; task = due.shift()) await task();
    };
    await Promise.all(Array.from({ length: AT_ONCE }, next));
  }

  /** @param {HTMLElement} button @param {Cell} cell @param {AbortSignal} signal */
  async function fit(button, cell, signal) {
    try {
      const met = await get('meet', wanted(cell), signal);
      if (met.failed) {
        fill(button, h('span', { class: 'soft' }, 'no fit'));
        button.title = met.failed;
        return;
      }
      fill(button, met.signals.map((/** @type {any} */ one) => h('span', { class: 'line-of-cell' }, `${named(one)} ${percent(one.fit_percent)}`)),
        met.residuals && h('span', { class: 'line-of-cell soft' }, passed(met.residuals)), met.seen_in_estimation && h('span', { class: 'line-of-cell soft' }, 'estimated from it'));
      button.removeAttribute('aria-label');
    } catch (error) {
      if (signal.aborted) return;
      fill(button, '–');
      failed(error);
    }
  }

  /** @param {Cell} cell */
  async function open(cell) {
    remember({ cell: JSON.stringify(cell) });
    fill(detail, h('p', { class: 'soft' }, `${cell.model} on ${cell.recording} …`));
    try {
      const asked = wanted(cell);
      const met = await get('meet', asked);
      if (met.failed) {
        fill(detail, h('p', {}, `${cell.model} on ${cell.recording}: ${met.failed}`));
        return;
      }
      await drawMeeting(detail, asked, met, all.find((model) => model.file === cell.model)?.kind === 'bench');
    } catch (error) {
      fill(detail, h('p', { class: 'fault' }, wordsOf(error)));
    }
  }
}

/** A signal, with its part where gaps divide the recording. @param {{ name: string, part: number }} one */
const named = ({ name, part }) => (part ? `${name}, part ${part + 1}` : name);

/** @param {number | null} value */
const percent = (value) => (value === null ? '–' : `${value.toFixed(1).replace('-', '−')} %`);

/** Outcomes of the tests in short. @param {any} tests */
function passed(tests) {
  const isWhite = tests.whiteness.every((/** @type {any} */ test) => test.joint.passed);
  const isFree = tests.independence.flat().every((/** @type {any} */ test) => test.dynamics.passed);
  return `${isWhite ? 'white' : 'not white'}${tests.inputs.length ? `, ${isFree ? 'dynamics captured' : 'dynamics missing'}` : ''}`;
}

/** @param {HTMLElement} element @param {Cell & { horizon?: number }} cell @param {any} met @param {boolean} isBench */
async function drawMeeting(element, cell, met, isBench) {
  const { horizon } = cell;
  const words = horizon ? ['model', 'predict', cell.model, `--on=${cell.recording}`, `--horizon=${horizon}`] : ['model', 'simulate', cell.model, `--on=${cell.recording}`];
  const plots = h('div', { class: 'plots' });
  const [tests, curves] = [h('div', {}), h('div', {})];
  fill(element, h('h3', {}, `${cell.model} on ${cell.recording}`),
    h('p', {}, h('code', {}, typed(words))),
    met.seen_in_estimation && h('p', { class: 'soft' }, 'The model was estimated from this recording, so its fit here proves little.'),
    met.notes.map((/** @type {string} */ text) => h('p', { class: 'soft' }, text)),
    table(['Signal', 'Fit', 'RMS error'], met.signals.map((/** @type {any} */ one) => [named(one), percent(one.fit_percent), `${figure(one.rms_error)} ${one.unit}`]), 'Fit'),
    plots, tests, curves);  const panels = new Panels(plots, { moved: () => {}, marked: () => {}, failed });
  const units = new Map(met.signals.map((/** @type {any} */ one) => [one.name, one.unit]));
  panels.whole = await extent(met.beside, met.plots.flat(2));
  [panels.from, panels.to] = [panels.whole.from, panels.whole.to];
  panels.show(met.plots.flat().map((/** @type {string[]} */ channels) => ({
    traces: channels.map((channel) => ({ file: met.beside, channel, unit: units.get(channel.slice(0, channel.lastIndexOf('_'))) ?? '', offset_s: 0, columns: new Float64Array(), held: null })),
  })));
  if (!met.residuals) {
    fill(tests, met.untested && !isBench && h('p', { class: 'soft' }, `Residuals are not tested: ${met.untested}`));
    return;
  }
  fill(tests, h('p', {}, h('code', {}, typed(['model', 'residuals', cell.model, `--on=${cell.recording}`]))));
  correlations(curves, [{ name: met.model, series: 0, tests: met.residuals }], met.residuals);
}
