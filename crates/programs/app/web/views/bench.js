// The bench file as a form and as text, side by side.

import { faults, get } from '../api.js';
import { fill, h, say } from '../dom.js';
import { Edit } from '../edit.js';
import { link } from '../place.js';
import { ended, start } from '../work.js';

export const title = 'Bench';

/** @typedef {{ table: string, name: string, what: string, example: string, is_required: boolean }} Key */

const TABLES = { bench: 'The bench', limits: 'Its limits', shaft: 'Prior knowledge of the shaft', report: 'The report' };

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const { benches, recordings } = await get('state');
  const file = given.file || benches[0]?.file || 'bench.toml';
  if (!benches.some((/** @type {any} */ each) => each.file === file) && recordings.length) return propose(element, file, recordings);
  const [edit, keys] = await Promise.all([Edit.open(file), get('keys')]);
  const text = h('textarea', { spellcheck: false, 'aria-label': `Text of ${file}`, value: edit.now, oninput: () => edit.changed(text.value) });
  const list = h('div', { class: 'faults' });
  const form = h('div', { class: 'form' });
  edit.tools.append(h('a', { href: link('roles', { file }) }, 'Channels'), h('a', { href: link('study', { bench: file }) }, 'Study this bench'));
  fill(element, h('h1', {}, file), edit.tools, list, h('div', { class: 'halves' }, form, text));
  edit.listen(element);
  edit.heard = (now, isSettled) => {
    if (text.value !== now) text.value = now;
    if (isSettled) check();
  };
  await check();

  async function check() {
    const { faults: found, values } = await faults(file, edit.now);
    fill(list, found.length === 0
      ? h('p', { class: 'soft' }, 'The file has no faults.')
      : [h('p', {}, `${found.length} to fill in or to correct:`), h('ul', {}, found.map((fault) => h('li', {},
        h('button', { class: 'line', onclick: () => goTo(fault.line) }, `Line ${fault.line}`), ' ', fault.text)))]);
    if (values && !form.contains(document.activeElement)) fill(form, fields(values));
  }

  /** @param {Record<string, any>} values */
  function fields(values) {
    return Object.entries(TABLES).map(([table, name]) => h('fieldset', {}, h('legend', {}, name),
      keys.filter((/** @type {Key} */ key) => key.table === table).map((/** @type {Key} */ key) => field(key, values[table]?.[key.name]))));
  }

  /** @param {Key} key @param {any} value */
  function field(key, value) {
    const id = `${key.table}-${key.name}`;
    const input = h('input', {
      id, type: 'text', value: value ?? '', placeholder: key.example.replaceAll('"', ''), 'aria-required': key.is_required,
      onchange: () => edit.set([{ key: [key.table, key.name], value: written(input.value, key.example) }]),
    });
    return h('div', { class: 'field' }, h('label', { for: id }, key.what, key.is_required && ' *'), input);
  }

  /** @param {number} line */
  function goTo(line) {
    const lines = edit.now.split('\n');
    const before = lines.slice(0, line - 1).join('\n').length + (line > 1 ? 1 : 0);
    text.focus();
    text.setSelectionRange(before, before + (lines[line - 1] ?? '').length);
    text.scrollTop = (text.scrollHeight / lines.length) * Math.max(0, line - 6);
  }
}

/**
 * A value of a form as the file has it: a number, or a text; nothing takes the key away. A decimal comma becomes a point.
 * @param {string} typed @param {string} example
 */
export function written(typed, example) {
  const value = typed.trim().replace(/^([-+−]?\d+),(\d+)(?![\d,])/, '$1.$2').replace('−', '-');
  if (value === '') return null;
  return !example.startsWith('"') && /^[-+]?[\d.]+(e[-+]?\d+)?$/i.test(value) ? Number(value) : value;
}

/** @param {HTMLElement} element @param {string} file @param {{ file: string }[]} recordings */
function propose(element, file, recordings) {
  const button = h('button', {
    class: 'button',
    onclick: async () => {
      button.disabled = true;
      const job = await ended((await start(['init', ...recordings.map((each) => each.file), '--out', file])).id);
      if (job.exit_code) say(job.said, true);
      else await show(element, { file });
      button.disabled = false;
    },
  }, 'Propose a bench file');
  fill(element, h('h1', {}, 'Describe the bench'),
    h('p', {}, `There is no ${file} yet. It can be proposed from the ${recordings.length} recordings of this folder.`), button);
}
