// Correlations of residuals with their limits, of one model or of several over one another.

import { h, table } from '../dom.js';
import { Curves } from './curves.js';
import { figure } from './scale.js';

/** @typedef {{ name: string, series: number, tests: any }} Tested */
/** @typedef {import('./curves.js').Layer} Layer */
/** @typedef {{ inputs: { name: string }[], outputs: { name: string }[] }} Channels */

/** Lags apart of the stems of two models. */
const APART = 0.12;

/** @param {HTMLElement} element @param {Tested[]} all @param {Channels} channels */
export function correlations(element, all, { inputs, outputs }) {
  outputs.forEach((output, k) => {
    const panels = [
      { name: `residuals of ${output.name} with themselves`, layers: all.flatMap((one) => stems(one, 1, one.tests.whiteness[k], 'auto')) },
      ...inputs.map((input, i) => ({ name: `with ${input.name}`, layers: all.flatMap((one) => stems(one, 0, one.tests.independence[k]?.[i], 'cross')) })),
    ];
    const level = Math.round(100 * all[0].tests.level);
    const curves = new Curves(element, `Correlations of the residuals of ${output.name}, with ${level} % limits`, { name: 'lag', unit: 'samples' });
    curves.show(panels.map(({ name, layers }) => ({ name, unit: '', height: 120, layers })));
  });
  element.append(table(['Model', 'Residuals of', 'Test', 'Outcome', 'By chance'], all.flatMap((one) => rows(one, inputs, outputs)), 'Tests of the residuals'));
}

/** @param {Tested} one @param {number} first @param {any} test @param {'auto' | 'cross'} which @returns {Layer[]} */
function stems({ name, series }, first, test, which) {
  if (!test) return [];
  const from = which === 'cross' ? -(test.cross.length - 1) / 2 : 0;
  const values = /** @type {(number | null)[]} */ (test[which]).slice(first);
  const bounds = /** @type {(number | null)[]} */ (test.bounds).slice(first);
  const lags = values.map((_, k) => from + first + k);
  return [
    { kind: 'band', series, x: lags, y: bounds, low: bounds.map((bound) => (bound === null ? null : -bound)) },
    { kind: 'stems', series, name, x: lags.map((lag) => lag + APART * series), y: values },
  ];
}

/** A probability. @param {number | null} p */
const chance = (p) => (p !== null && p < 1e-4 ? 'below 0.01 %' : p === null ? '–' : `${figure(100 * p)} %`);

/** @param {Tested} one @param {Channels['inputs']} inputs @param {Channels['outputs']} outputs */
function rows({ name, tests }, inputs, outputs) {
  const row = (/** @type {string} */ of, /** @type {string} */ what, /** @type {any} */ test) => [name, of, what,
    h('strong', { class: test.passed ? 'good' : 'bad' }, test.passed ? 'passed' : 'failed'), chance(test.p_value)];
  return outputs.flatMap((output, k) => [
    row(output.name, 'white', tests.whiteness[k].joint),
    ...inputs.flatMap((input, i) => {
      const test = tests.independence[k][i];
      return [row(output.name, `free of past ${input.name}`, test.dynamics), row(output.name, `no feedback to ${input.name}`, test.feedback)];
    }),
  ]);
}
