// Dynamics of chosen models over one another: frequency and step responses, poles and zeros, residuals, figures, doubts.

import { get } from '../api.js';
import { correlations } from '../chart/correlations.js';
import { Curves } from '../chart/curves.js';
import { figure } from '../chart/scale.js';
import { fill, h, say, swatch, table, wordsOf } from '../dom.js';
import { typed } from '../work.js';

/** @typedef {import('./model.js').Fit} Fit */
/** @typedef {import('../chart/curves.js').Layer} Layer */

/** Points of the unit circle. */
const CIRCLE = 180;

/** A place for the dynamics of models. @param {HTMLElement} element */
export function dynamics(element) {
  /** @type {Map<string, any>} */
  const known = new Map();
  let channel = '';
  return { draw, forget: (/** @type {string} */ file) => known.delete(file) };

  /** @param {Fit[]} fits */
  async function draw(fits) {
    if (!fits.length) return fill(element, h('p', { class: 'soft' }, 'Choose fits in the list to draw them.'));
    /** @type {{ fit: Fit, found: any }[]} */
    const all = [];
    for (const fit of fits) {
      try {
        if (!known.has(fit.file)) known.set(fit.file, await get('dynamics', { file: fit.file }));
        all.push({ fit, found: known.get(fit.file) });
      } catch (error) {
        say(`${fit.file}: ${wordsOf(error)}`, true);
      }
    }
    const names = [...new Set(all.flatMap(({ found }) => found.bode.map((/** @type {any} */ curve) => curve.channel)))];
    if (!names.includes(channel)) channel = names[0] ?? '';
    const choice = h('select', { onchange: () => { channel = choice.value; draw(fits); } },
      names.map((each) => h('option', { value: each, selected: each === channel }, each)));
    const files = fits.map((fit) => fit.file);
    const charts = h('div', { class: 'charts' });
    fill(element, h('div', { class: 'tools' }, fits.map((fit) => h('span', {}, swatch(fit.series), ' ', fit.file)), names.length > 1 && h('label', {}, 'From input to output ', choice)),
      charts,
      h('p', {}, ['bode', 'step', 'poles'].map((view) => h('code', { class: 'typed' }, typed(['model', view, ...files])))));
    curves(charts, 'Frequency response', { name: 'frequency', unit: 'Hz', isLog: true }, all, 'bode', channel);
    curves(charts, 'Step response', { name: 'time', unit: 's' }, all, 'step', channel);
    for (const isDiscrete of [true, false]) plane(charts, all.filter(({ found }) => found.roots.some((/** @type {any} */ one) => (one.sample_time_s !== null) === isDiscrete)), isDiscrete, channel);
    residuals(charts, fits);
    element.append(sums(all, channel), figures(fits), doubts(fits), parameters(fits));
  }
}

/**
 * Curves of a channel, a panel for each quantity.
 * @param {HTMLElement} element @param {string} title @param {import('../chart/curves.js').Axis} axis
 * @param {{ fit: Fit, found: any }[]} all @param {'bode' | 'step'} which @param {string} channel
 */
function curves(element, title, axis, all, which, channel) {
  /** @type {Map<string, import('../chart/curves.js').Panel>} */
  const panels = new Map();
  for (const { fit, found } of all) {
    for (const curve of found[which].filter((/** @type {any} */ each) => each.channel === channel)) {
      for (const { name, unit, values, band } of curve.quantities) {
        const panel = panels.get(name) ?? { name, unit, height: 190, layers: /** @type {Layer[]} */ ([]) };
        panels.set(name, panel);
        const x = curve.frequency ?? curve.time;
        const low = band?.map((/** @type {number[]} */ pair) => pair[0]);
        const high = band?.map((/** @type {number[]} */ pair) => pair[1]);
        if (band) panel.layers.push({ kind: 'band', series: fit.series, x, y: high, low });
        panel.layers.push({ kind: 'line', series: fit.series, name: fit.file, x, y: values, low, high });
      }
    }
  }
  if (panels.size) new Curves(element, `${title} with 95 % bands`, axis).show([...panels.values()]);
}

/** @param {HTMLElement} element @param {{ fit: Fit, found: any }[]} all @param {boolean} isDiscrete @param {string} channel */
function plane(element, all, isDiscrete, channel) {
  if (!all.length) return;
  /** @type {Layer[]} */
  const layers = [];
  if (isDiscrete) {
    const angles = Array.from({ length: CIRCLE + 1 }, (_, k) => (2 * Math.PI * k) / CIRCLE);
    layers.push({ kind: 'guide', series: 0, x: angles.map(Math.cos), y: angles.map(Math.sin) });
  }
  const isOf = (/** @type {{ channels: string[] }} */ { channels }) => !channels.length || channels.includes(channel);
  for (const { fit, found } of all) {
    for (const { outline } of found.regions.filter(isOf)) {
      layers.push({ kind: 'path', series: fit.series, x: outline.map((/** @type {number[]} */ at) => at[0]), y: outline.map((/** @type {number[]} */ at) => at[1]) });
    }
    for (const [kind, word, sets] of /** @type {['cross' | 'ring', string, any[]][]} */ ([['cross', 'pole', found.roots.flatMap((/** @type {any} */ one) => one.poles)], ['ring', 'zero', found.roots.flatMap((/** @type {any} */ one) => one.zeros)]])) {
      const roots = sets.filter(isOf).flatMap((set) => set.roots);
      layers.push({ kind, series: fit.series, name: `${word} of ${fit.file}`, x: roots.map((root) => root.re), y: roots.map((root) => root.im) });
    }
  }
  const unit = isDiscrete ? '' : 'rad/s';
  const heading = `Poles (×) and zeros (○) ${isDiscrete ? 'in z, with the unit circle' : 'in s'}, with 95 % regions`;
  new Curves(element, heading, { name: 'real part', unit }, true).show([{ name: 'imaginary part', unit, height: 380, layers }]);
}

/** @param {HTMLElement} element @param {Fit[]} fits */
function residuals(element, fits) {
  const tested = fits.filter((fit) => fit.facts?.residuals);
  for (const { model } of tested.slice(0, 1)) {
    // Correlations stand over one another where the channels are the same.
    const same = tested.filter((fit) => String([fit.model.inputs, fit.model.outputs]) === String([model.inputs, model.outputs]));
    const place = h('div', { class: 'tested' });
    element.append(place);
    correlations(place, same.map((fit) => ({ name: fit.file, series: fit.series, tests: fit.facts.residuals })),
      { inputs: model.inputs.map((name) => ({ name })), outputs: model.outputs.map((name) => ({ name })) });
  }
}

/** Numbers that sum up the responses. @param {{ fit: Fit, found: any }[]} all @param {string} channel */
function sums(all, channel) {
  const rows = all.flatMap(({ fit, found }) => [...found.bode, ...found.step].filter((curve) => curve.channel === channel).flatMap((curve) => curve.summary.map((/** @type {any} */ fact) => [
    fit.file, fact.name, fact.value === null ? '' : `${figure(fact.value)} ${fact.unit}`, fact.interval ? `${figure(fact.interval[0])} … ${figure(fact.interval[1])}` : '', fact.remark])));
  return table(['Model', 'Quantity', 'Value', '95 % interval', 'Remark'], rows, `Dynamics ${channel}`);
}

/** @param {Fit[]} fits */
function figures(fits) {
  const known = fits.filter((fit) => fit.facts);
  if (!known.length) return h('p', { class: 'soft' }, 'Figures of a fit are shown where it was made in the app.');
  const fit = (/** @type {number[][] | null} */ values) => values?.flat().map((value) => `${figure(value)} %`).join(', ') ?? '–';
  const rows = known.flatMap(({ file, facts }) => facts.judged.map((/** @type {any} */ one) => [
    file, one.data, one.experiments.join(', '), one.error_simulated ?? fit(one.fit_percent_simulated), one.error_predicted ?? fit(one.fit_percent_predicted)]));
  const criteria = Object.keys(known[0].facts.criteria);
  return h('div', {}, table(['Model', 'Data', 'Recordings', 'Fit simulated', 'Fit predicted'], rows, 'Fit'),
    table(['Model', ...criteria.map((each) => each.toUpperCase())], known.map(({ file, facts }) => [file, ...criteria.map((each) => figure(facts.criteria[each]))]), 'Criteria: the smaller, the better'));
}

/** @param {Fit[]} fits */
function doubts(fits) {
  return h('section', {}, h('h3', {}, 'Doubts'), fits.filter((fit) => fit.facts).map(({ file, facts }) => h('div', {}, h('strong', {}, file),
    facts.doubts.length ? h('ul', {}, facts.doubts.map((/** @type {string} */ doubt) => h('li', {}, doubt))) : h('p', {}, 'There are no doubts.'),
    facts.adjustments.map((/** @type {string} */ text) => h('p', { class: 'soft' }, text)))));
}

/** @param {Fit[]} fits */
function parameters(fits) {
  const rows = fits.filter((fit) => fit.facts?.model.estimate).flatMap(({ file, facts }) => facts.model.estimate.parameter_names.map((/** @type {string} */ name, /** @type {number} */ k) => [
    file, name, figure(facts.model.estimate.parameters[k]), `${figure(facts.intervals_95[k]?.[0])} … ${figure(facts.intervals_95[k]?.[1])}`, facts.at_bound[k] ? 'at its bound' : '']));
  return h('details', {}, h('summary', {}, 'Parameters'), table(['Model', 'Parameter', 'Value', '95 % interval', ''], rows, 'Parameters of the fits'));
}
