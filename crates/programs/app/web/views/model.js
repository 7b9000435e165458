// The toolbox: fit a linear model to a stretch of a recording, and look at fits side by side.

import { extent, get, printed } from '../api.js';
import { Panels } from '../chart/panels.js';
import { figure } from '../chart/scale.js';
import { failed, fill, h, say, swatch, table } from '../dom.js';
import { link, note } from '../place.js';
import { isDone, result, typed } from '../work.js';
import { dynamics } from './dynamics.js';

export const title = 'Model';

/** @typedef {import('./command.js').Argument} Argument */
/** @typedef {{ words: string[], about: string, arguments: Argument[] }} Command */
/** @typedef {{ file: string, kind: string, inputs: string[], outputs: string[], method: string | null, recordings: string[] }} Model */
/** @typedef {{ file: string, series: number, facts: any, model: Model }} Fit */

/** Arguments that this page has as controls of its own. */
const OWN = new Set(['recordings', 'inputs', 'outputs', 'from_s', 'to_s', 'out', 'plot']);
/** Channels that the list shows at once. */
const MOST = 200;

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const [state, commands] = await Promise.all([get('state'), get('commands')]);
  if (!state.recordings.length) {
    fill(element, h('p', {}, 'There are no recordings in this folder. Start the app on the folder that has them.'));
    return undefined;
  }
  const structures = /** @type {Command[]} */ (commands.filter((/** @type {Command} */ each) => each.words[0] === 'fit'));
  const chosen = {
    recording: given.recording ?? state.recordings[0].file,
    inputs: /** @type {string[]} */ (given.inputs ? JSON.parse(given.inputs) : []),
    outputs: /** @type {string[]} */ (given.outputs ? JSON.parse(given.outputs) : []),
    from: given.from ?? '', to: given.to ?? '',
    structure: given.structure ?? structures[0].words[1],
    values: /** @type {Record<string, string>} */ (given.values ? JSON.parse(given.values) : {}),
    name: given.name ?? '',
    shown: /** @type {string[]} */ (given.shown ? JSON.parse(given.shown) : []),
  };
  /** @type {{ name: string, unit: string, comment?: string }[]} */
  let channels = [];
  const recording = h('select', { 'aria-label': 'Recording', onchange: () => open(recording.value).catch(failed) },
    state.recordings.map((/** @type {any} */ each) => h('option', { value: each.file, selected: each.file === chosen.recording }, each.file)));
  const filter = h('input', { type: 'search', placeholder: 'Find a channel', 'aria-label': 'Find a channel', oninput: () => list() });
  const [rows, plots] = [h('tbody', {}), h('div', { class: 'plots stretch' })];
  const [from, to] = [bound('from'), bound('to')];
  const structure = h('select', { 'aria-label': 'Structure', onchange: () => { chosen.structure = structure.value; chosen.values = {}; options(); } },
    structures.map(({ words }) => h('option', { value: words[1], selected: words[1] === chosen.structure }, words[1])));
  const [about, orders, more] = [h('p', { class: 'soft' }), h('div', { class: 'orders' }), h('div', { class: 'orders' })];
  const name = h('input', { type: 'text', 'aria-label': 'File of the model', value: chosen.name, oninput: () => { chosen.name = name.value.trim(); changed(); } });
  const [line, run, bar] = [h('code', {}), h('button', { class: 'button', type: 'submit' }, 'Fit'), h('progress', { max: 1, hidden: true, 'aria-label': 'Progress of the fit' })];
  const [fits, drawn] = [h('div', {}), h('div', { class: 'drawn' })];
  fill(element, h('h1', {}, 'Model'),
    h('form', { class: 'toolbox', onsubmit: (/** @type {Event} */ event) => { event.preventDefault(); go(); } },
      h('fieldset', {}, h('legend', {}, 'Channels'), h('label', {}, 'Recording ', recording), filter,
        h('div', { class: 'scroll channels', tabindex: 0, role: 'region', 'aria-label': 'Channels' },
          h('table', {}, h('thead', {}, h('tr', {}, ['Channel', 'Unit', 'Input', 'Output'].map((head) => h('th', { scope: 'col' }, head)))), rows))),
      h('fieldset', {}, h('legend', {}, 'Stretch'), plots,
        h('div', { class: 'tools' }, h('label', {}, 'From, s ', from), h('label', {}, 'To, s ', to), h('span', { class: 'soft' }, 'or two clicks into the plot'))),
      h('fieldset', {}, h('legend', {}, 'Structure'), h('label', {}, 'Structure ', structure), about, orders,
        h('details', {}, h('summary', {}, 'More options'), more),
        h('label', {}, 'File of the model ', name),
        h('div', { class: 'tools' }, run, bar, line))),
    h('section', {}, h('h2', {}, 'Fits'), fits), drawn);
  const panels = new Panels(plots, { moved: () => {}, marked: () => { marked(); }, failed });
  const view = dynamics(drawn);
  /** @type {Map<string, any>} */
  const known = new Map();
  options();
  await open(chosen.recording).catch(failed);
  await overview().catch(failed);
  return undefined;

  /** @param {'from' | 'to'} which */
  function bound(which) {
    const input = h('input', { type: 'number', step: 'any', value: chosen[which], oninput: () => { chosen[which] = input.value; changed(); shade(); } });
    return input;
  }

  /** @param {string} file */
  async function open(file) {
    chosen.recording = file;
    say('');
    channels = (await get('channels', { file })).channels;
    const names = new Set(channels.map((channel) => channel.name));
    chosen.inputs = chosen.inputs.filter((each) => names.has(each));
    chosen.outputs = chosen.outputs.filter((each) => names.has(each));
    list();
    await trace();
    changed();
  }

  function list() {
    const words = filter.value.toLowerCase();
    const found = channels.filter((channel) => channel.name.toLowerCase().includes(words)).slice(0, MOST);
    fill(rows, found.map((channel) => h('tr', {}, h('th', { scope: 'row', title: channel.comment || channel.name }, channel.name), h('td', {}, channel.unit),
      h('td', {}, box(channel.name, 'inputs')), h('td', {}, box(channel.name, 'outputs')))));
  }

  /** @param {string} channel @param {'inputs' | 'outputs'} kind */
  function box(channel, kind) {
    const other = kind === 'inputs' ? 'outputs' : 'inputs';
    const input = h('input', {
      type: 'checkbox', checked: chosen[kind].includes(channel), 'aria-label': `${channel} is an ${kind.slice(0, -1)}`,
      onchange: () => {
        chosen[kind] = input.checked ? [...chosen[kind], channel] : chosen[kind].filter((each) => each !== channel);
        if (input.checked) chosen[other] = chosen[other].filter((each) => each !== channel);
        list();
        options();
        trace().catch(failed);
        // The list is new, so the focus would be lost.
        /** @type {HTMLElement | null} */ (rows.querySelector(`input[aria-label="${CSS.escape(channel)} is an ${kind.slice(0, -1)}"]`))?.focus();
      },
    });
    return input;
  }

  /** Draws the channels that are chosen, where the stretch is to be seen. */
  async function trace() {
    const names = [...chosen.inputs, ...chosen.outputs];
    plots.hidden = !names.length;
    if (!names.length) return;
    panels.whole = await extent(chosen.recording, names);
    [panels.from, panels.to] = [panels.whole.from, panels.whole.to];
    panels.show(names.map((channel) => ({
      traces: [{ file: chosen.recording, channel, unit: channels.find((each) => each.name === channel)?.unit ?? '', offset_s: 0, columns: new Float64Array(), held: null }],
    })));
    shade();
  }

  function marked() {
    const [a, b] = panels.cursors;
    if (a === null || b === null || a === b) return;
    [chosen.from, chosen.to] = [Math.min(a, b), Math.max(a, b)].map((time) => String(Number(time.toPrecision(5))));
    [from.value, to.value] = [chosen.from, chosen.to];
    shade();
    changed();
  }

  function shade() {
    const [from_s, to_s] = [chosen.from === '' ? panels.whole.from : Number(chosen.from), chosen.to === '' ? panels.whole.to : Number(chosen.to)];
    panels.stretches = chosen.from === '' && chosen.to === '' ? [] : [{ from_s, to_s, kind: 'estimate', text: '' }];
    panels.draw();
  }

  function command() {
    return /** @type {Command} */ (structures.find(({ words }) => words[1] === chosen.structure) ?? structures[0]);
  }

  /** Orders as steppers, and whatever else the structure has. */
  function options() {
    const { about: text, arguments: all } = command();
    about.textContent = text;
    const own = all.filter((argument) => !OWN.has(argument.name) && !isOfAnother(argument, text));
    const isFirst = (/** @type {Argument} */ argument) => argument.kind === 'count' || argument.is_required || (!argument.heading && argument.kind === 'text');
    const shared = (/** @type {Argument} */ argument) => argument.heading !== null || argument.name === 'split' || argument.name === 'validate';
    fill(orders, own.filter((argument) => isFirst(argument) && !shared(argument)).map(field));
    fill(more, own.filter((argument) => !isFirst(argument) || shared(argument)).map(field));
    changed();
  }

  /** @param {Argument} argument @returns {HTMLElement} */
  function field(argument) {
    const id = `fit-${argument.name}`;
    const text = argument.option?.slice(2) ?? argument.name;
    const now = chosen.values[argument.name] ?? '';
    const set = (/** @type {string} */ value) => {
      if (value) chosen.values[argument.name] = value;
      else delete chosen.values[argument.name];
      changed();
    };
    if (argument.kind === 'count') return counts(argument, text, now, set);
    const common = { id, 'aria-describedby': `${id}-help` };
    /** @type {HTMLInputElement | HTMLSelectElement} */
    let control;
    if (argument.kind === 'flag') control = h('input', { ...common, type: 'checkbox', checked: now === 'yes', onchange: () => set(/** @type {HTMLInputElement} */ (control).checked ? 'yes' : '') });
    else if (argument.choices.length) {
      control = h('select', { ...common, onchange: () => set(control.value) }, h('option', { value: '' }, argument.default ? `${argument.default} (usual)` : ''),
        argument.choices.map((choice) => h('option', { value: choice, selected: choice === now }, choice)));
    } else control = h('input', { ...common, type: 'text', value: now, placeholder: argument.default ?? argument.value ?? '', oninput: () => set(control.value.trim()) });
    return h('div', { class: 'field' }, h('label', { for: id }, text), control, h('small', { id: `${id}-help` }, argument.help));
  }

  /**
   * Steppers of an order; one an input, where it may differ between them.
   * @param {Argument} argument @param {string} text @param {string} now @param {(value: string) => void} set
   */
  function counts(argument, text, now, set) {
    const count = argument.is_repeated ? Math.max(1, chosen.inputs.length) : 1;
    const values = now.split(',');
    const inputs = Array.from({ length: count }, (_, k) => h('input', {
      type: 'number', min: 0, step: 1, value: values[k] ?? values[0], placeholder: argument.default ?? '–',
      'aria-label': count > 1 ? `${text} of ${chosen.inputs[k]}` : text, oninput: () => gather(),
    }));
    const gather = () => {
      const given = inputs.map((input) => input.value);
      // One that is left empty has the usual order, or that of the first.
      const usual = argument.default ?? given.find((value) => value !== '') ?? '';
      set(given.every((value) => value === '') ? '' : given.map((value) => (value === '' ? usual : value)).join(','));
    };
    const step = (/** @type {HTMLInputElement} */ input, /** @type {number} */ by) => {
      input.value = String(Math.max(0, Number(input.value || argument.default || 0) + by));
      gather();
    };
    return h('div', { class: 'field', role: 'group', 'aria-label': text }, h('span', { title: argument.help }, text), inputs.map((input) => h('span', { class: 'stepper' },
      h('button', { type: 'button', 'aria-label': `Less: ${input.getAttribute('aria-label')}`, onclick: () => step(input, -1) }, '−'), input,
      h('button', { type: 'button', 'aria-label': `More: ${input.getAttribute('aria-label')}`, onclick: () => step(input, 1) }, '+'))), h('small', {}, argument.help));
  }

  /** The file of the next model: its structure and orders, and a number where that is taken. */
  function proposed() {
    const numbers = command().arguments.filter((argument) => argument.kind === 'count' && chosen.values[argument.name]);
    const parts = [chosen.structure, ...numbers.map((argument) => chosen.values[argument.name].replaceAll(',', '.'))];
    const base = `model-${parts.join('-')}`;
    const taken = (/** @type {string} */ file) => known.has(file);
    let file = `${base}.json`;
    for (let k = 2; taken(file); k += 1) file = `${base}-${k}.json`;
    return file;
  }

  function words() {
    const options = command().arguments.filter((argument) => chosen.values[argument.name] && !OWN.has(argument.name)).flatMap((argument) => {
      const value = chosen.values[argument.name];
      if (argument.kind === 'flag') return [`${argument.option}`];
      return argument.option ? [`${argument.option}=${value}`] : [value];
    });
    return ['fit', chosen.structure, chosen.recording, ...chosen.inputs.map((each) => `--input=${each}`), ...chosen.outputs.map((each) => `--output=${each}`),
      ...(chosen.from === '' ? [] : [`--from=${chosen.from}`]), ...(chosen.to === '' ? [] : [`--to=${chosen.to}`]),
      ...options, `--out=${chosen.name || proposed()}`];
  }

  function changed() {
    name.placeholder = proposed();
    run.disabled = !chosen.outputs.length;
    line.textContent = chosen.outputs.length ? typed(words()) : 'Choose an output first.';
    note('model', {
      recording: chosen.recording, inputs: JSON.stringify(chosen.inputs), outputs: JSON.stringify(chosen.outputs), from: chosen.from, to: chosen.to,
      structure: chosen.structure, values: JSON.stringify(chosen.values), name: chosen.name, shown: JSON.stringify(chosen.shown),
    }, false);
  }

  async function go() {
    const file = chosen.name || proposed();
    run.disabled = true;
    bar.hidden = false;
    bar.removeAttribute('value');
    say('');
    try {
      await result(words(), ({ fraction }) => { if (fraction !== null) bar.value = fraction; });
      if (!chosen.shown.includes(file)) chosen.shown.push(file);
      view.forget(file);
      await overview();
    } catch (error) {
      failed(error);
    }
    bar.hidden = true;
    changed();
  }

  /** All fits of the folder, with their figures where the fit was made here. */
  async function overview() {
    const [models, jobs] = await Promise.all([get('models'), get('jobs')]);
    const linear = /** @type {Model[]} */ (models.filter((/** @type {Model} */ model) => model.kind === 'linear'));
    chosen.shown = chosen.shown.filter((file) => linear.some((model) => model.file === file));
    const facts = await Promise.all(linear.map((model) => figuresOf(model.file, jobs)));
    known.clear();
    linear.forEach((model, k) => known.set(model.file, facts[k]));
    const rows = linear.map((model, k) => {
      const box = h('input', { type: 'checkbox', checked: chosen.shown.includes(model.file), 'aria-label': `Draw ${model.file}`, onchange: () => {
        chosen.shown = box.checked ? [...chosen.shown, model.file] : chosen.shown.filter((each) => each !== model.file);
        changed();
        overview().catch(failed);
      } });
      const series = chosen.shown.indexOf(model.file);
      return [[box, series >= 0 && swatch(series)], model.file, model.method ?? '', channelsOf(model), model.recordings.join(', '), ...fitsOf(facts[k])];
    });
    fill(fits, linear.length
      ? table(['Draw', 'File', 'Method', 'Channels', 'Recordings', 'Fit simulated', 'Fit predicted', 'AIC', 'Doubts'], rows, 'Fits of this folder')
      : h('p', {}, 'There are no fits yet. Choose channels and a structure above.'),
    h('p', {}, h('a', { href: link('compare', { models: JSON.stringify(chosen.shown) }) }, 'The chosen fits on other recordings')));
    changed();
    await view.draw(chosen.shown.map((file, series) => ({ file, series, facts: known.get(file), model: /** @type {Model} */ (linear.find((model) => model.file === file)) })));
  }
}

/** The figures of the fit that wrote a model; none where it was fitted elsewhere. @param {string} file @param {any[]} jobs */
async function figuresOf(file, jobs) {
  const job = jobs.find((each) => each.arguments[0] === 'fit' && each.arguments.includes(`--out=${file}`) && each.arguments.includes('--json') && isDone(each));
  return job ? JSON.parse(await printed(job.id)) : null;
}

/** Tells whether an argument is the order of a polynomial that the formula of a structure does not have. @param {Argument} argument @param {string} about */
function isOfAnother({ name }, about) {
  const [, letter] = /^n([abcdf])$/.exec(name) ?? [];
  return letter !== undefined && about.includes('=') && !new RegExp(`\\b${letter.toUpperCase()}\\b`).test(about);
}

/** @param {Model} model */
const channelsOf = (model) => `${model.inputs.join(', ')} → ${model.outputs.join(', ')}`;

/** @param {any} facts */
function fitsOf(facts) {
  if (!facts) return ['', '', '', 'fitted elsewhere'];
  const all = (/** @type {string} */ name) => {
    const judged = facts.judged.map((/** @type {any} */ one) => one[name]?.flat().map(percent).join(', ')).filter(Boolean);
    return judged.join(' / ') || '–';
  };
  return [all('fit_percent_simulated'), all('fit_percent_predicted'), figure(facts.criteria.aic), String(facts.doubts.length)];
}

/** @param {number | null} value */
const percent = (value) => (value === null ? '–' : `${value.toFixed(1).replace('-', '−')} %`);
