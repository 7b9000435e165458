// Any command as a form: what it is, its arguments, the line that one types, and its result.

import { get, printed } from '../api.js';
import { failed, fill, h } from '../dom.js';
import { link, note } from '../place.js';
import { ended, isDone, start, typed } from '../work.js';
import { frame } from './report.js';

export const title = 'Commands';

/**
 * @typedef {object} Argument
 * @property {string} name
 * @property {string | null} option
 * @property {string} help
 * @property {string | null} heading
 * @property {string | null} value
 * @property {'flag' | 'path' | 'count' | 'number' | 'text'} kind
 * @property {boolean} is_required
 * @property {boolean} is_repeated
 * @property {string | null} default
 * @property {string[]} choices
 */
/** @typedef {{ words: string[], about: string, after: string, arguments: Argument[] }} Command */

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const [commands, state] = await Promise.all([get('commands'), get('state')]);
  const command = commands.find((/** @type {Command} */ each) => each.words.join(' ') === given.command);
  if (command) form(element, command, state, given);
  else overview(element, commands);
}

/** @param {HTMLElement} element @param {Command[]} commands */
function overview(element, commands) {
  fill(element, h('h1', {}, 'Everything dynoid does'),
    h('ul', { class: 'commands' }, commands.map(({ words, about }) => h('li', {},
      h('a', { href: link('command', { command: words.join(' ') }) }, words.join(' ')), ' ', about))));
}

/** @param {HTMLElement} element @param {Command} command @param {any} state @param {Record<string, string>} given */
function form(element, command, state, given) {
  /** @type {Record<string, string>} */
  const values = given.values ? JSON.parse(given.values) : {};
  const plots = command.arguments.some((argument) => argument.option === '--plot');
  const line = h('code', {});
  const result = h('div', { class: 'result' });
  const run = h('button', { class: 'button', type: 'submit' }, 'Run');

  function words() {
    const after = [];
    const before = [];
    for (const argument of command.arguments) {
      const value = values[argument.name];
      if (!value) continue;
      const each = argument.is_repeated ? value.split('\n').map((part) => part.trim()).filter(Boolean) : [value];
      if (argument.kind === 'flag') after.push(/** @type {string} */ (argument.option));
      else if (argument.option) each.forEach((part) => after.push(`${argument.option}=${part}`));
      else before.push(...each);
    }
    return [...command.words, ...before, ...after];
  }

  function changed() {
    line.textContent = typed(words());
    note('command', { command: command.words.join(' '), values: JSON.stringify(values) }, false);
  }

  /** @param {Argument} argument */
  function field(argument) {
    const set = (/** @type {string} */ value) => {
      if (value) values[argument.name] = value;
      else delete values[argument.name];
      changed();
    };
    const id = `argument-${argument.name}`;
    const now = values[argument.name] ?? '';
    const common = { id, required: argument.is_required, 'aria-describedby': `${id}-help` };
    /** @type {HTMLElement} */
    let control;
    if (argument.kind === 'flag') {
      control = h('input', { ...common, type: 'checkbox', checked: now === 'yes', onchange: () => set(/** @type {HTMLInputElement} */ (control).checked ? 'yes' : '') });
    } else if (argument.choices.length) {
      control = h('select', { ...common, onchange: () => set(/** @type {HTMLSelectElement} */ (control).value) },
        h('option', { value: '' }, argument.default ? `${argument.default} (usual)` : ''),
        argument.choices.map((choice) => h('option', { value: choice, selected: choice === now }, choice)));
    } else if (argument.is_repeated) {
      control = h('textarea', { ...common, rows: 2, value: now, placeholder: 'one a line', oninput: () => set(/** @type {HTMLTextAreaElement} */ (control).value) });
    } else {
      control = h('input', {
        ...common, type: 'text', value: now, placeholder: argument.default ?? argument.value ?? '', list: argument.kind === 'path' ? 'files' : undefined,
        oninput: () => set(/** @type {HTMLInputElement} */ (control).value.trim()),
      });
    }
    return h('div', { class: 'field' }, h('label', { for: id }, argument.option?.slice(2) ?? argument.name.replaceAll('_', ' ')), control, h('small', { id: `${id}-help` }, argument.help));
  }

  async function go() {
    run.disabled = true;
    fill(result);
    try {
      const page = `.dynoid/pages/${Date.now()}.html`;
      const asked = words();
      const draws = plots && !values.plot;
      const started = await start(draws ? [...asked, `--plot=${page}`] : asked);
      const bar = h('progress', { max: 1, 'aria-label': 'Progress' });
      fill(result, bar);
      const job = await ended(started.id, ({ fraction }) => { if (fraction !== null) bar.value = fraction; });
      fill(result, job.said && h('pre', { class: isDone(job) ? '' : 'fault' }, job.said),
        isDone(job) && draws ? frame(page, `Result of ${command.words.join(' ')}`) : h('pre', {}, await printed(job.id)));
    } catch (error) {
      failed(error);
    }
    run.disabled = false;
  }

  const headings = [...new Set(command.arguments.map((argument) => argument.heading))];
  const files = [...state.recordings, ...state.benches, ...state.models].map((/** @type {any} */ each) => each.file);
  fill(element, h('h1', {}, command.words.join(' ')), h('p', {}, command.about),
    h('datalist', { id: 'files' }, files.map((file) => h('option', { value: file }))),
    h('form', { onsubmit: (/** @type {Event} */ event) => { event.preventDefault(); go(); } },
      headings.map((heading) => h('fieldset', {}, h('legend', {}, heading ?? 'What and how'),
        command.arguments.filter((argument) => argument.heading === heading).map(field))),
      h('div', { class: 'tools' }, run, line)),
    result,
    command.after && h('details', {}, h('summary', {}, 'Examples and remarks'), h('pre', {}, command.after)));
  changed();
}
