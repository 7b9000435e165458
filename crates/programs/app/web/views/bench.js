// The bench file as text: nothing that was typed is lost, and nobody's change is overwritten.

import { Fault, faults, forget, get, keep, save } from '../api.js';
import { fill, h, say } from '../dom.js';
import { link } from '../place.js';
import { ended, start } from '../work.js';

export const title = 'Bench';

/** After so long without a key what was typed is kept. */
const PAUSE_MS = 300;

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const { benches, recordings } = await get('state');
  const file = given.file || benches[0]?.file || 'bench.toml';
  const read = await get('text', { file });
  if (read.state === null && recordings.length) return propose(element, file, recordings);
  /** @type {string | null} */
  let state = read.state;
  const kept = await get('draft', { file });
  const text = h('textarea', { spellcheck: false, 'aria-label': `Text of ${file}`, value: kept.text ?? read.text });
  const stand = h('span', { class: 'soft', role: 'status' });
  const list = h('div', { class: 'faults' });
  const write = h('button', { class: 'button', onclick: () => store() }, 'Save');
  const drop = h('button', { onclick: () => reload() }, 'Load again');
  fill(element, h('h1', {}, file),
    h('div', { class: 'tools' }, write, drop, h('a', { href: link('study', { bench: file }) }, 'Study this bench'), stand), text, list);
  check();

  /** @type {ReturnType<typeof setTimeout> | undefined} */
  let pause;
  text.addEventListener('input', () => {
    stand.textContent = 'not saved';
    clearTimeout(pause);
    pause = setTimeout(() => {
      keep(file, text.value, state);
      check();
    }, PAUSE_MS);
  });
  text.addEventListener('keydown', (event) => {
    if (event.key === 's' && (event.ctrlKey || event.metaKey)) {
      event.preventDefault();
      store();
    }
  });
  if (kept.text !== null && kept.text !== read.text) {
    stand.textContent = kept.of === read.state ? 'typed earlier, not saved' : 'typed earlier; the file was changed since';
  }

  async function check() {
    const found = /** @type {{ line: number, text: string }[]} */ (await faults(file, text.value));
    fill(list, found.length === 0
      ? h('p', { class: 'soft' }, 'The file has no faults.')
      : [h('p', {}, `${found.length} to fill in or to correct:`), h('ul', {}, found.map((fault) => h('li', {},
        h('button', { class: 'line', onclick: () => goTo(fault.line) }, `Line ${fault.line}`), ' ', fault.text)))]);
  }

  /** @param {number} line */
  function goTo(line) {
    const before = text.value.split('\n').slice(0, line - 1).join('\n').length + (line > 1 ? 1 : 0);
    const end = text.value.indexOf('\n', before);
    text.focus();
    text.setSelectionRange(before, end < 0 ? text.value.length : end);
    text.scrollTop = (text.scrollHeight / text.value.split('\n').length) * Math.max(0, line - 6);
  }

  async function store() {
    clearTimeout(pause);
    try {
      state = (await save(file, text.value, state)).state;
      stand.textContent = 'saved';
      say('');
    } catch (error) {
      await keep(file, text.value, state);
      say(error instanceof Fault ? error.message : String(error), true);
    }
  }

  async function reload() {
    const fresh = await get('text', { file });
    [state, text.value] = [fresh.state, fresh.text];
    check();
    await forget(file);
    stand.textContent = '';
    say('');
  }
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
