// Recordings and their experiments: a small plot of each, what the data say it is, and what the bench file says.

import { faults, get, seen, uses } from '../api.js';
import { drawSmall, thumbnail } from '../chart/thumbnail.js';
import { failed, fill, h, wordsOf } from '../dom.js';
import { Edit } from '../edit.js';
import { link } from '../place.js';
import { typed } from '../work.js';

export const title = 'Experiments';

/** @typedef {{ file: string, name: string, is_used: boolean, stated: string | null, place: number | null, in_name: string | null }} Use */
/** @typedef {{ label: string | null, reasons: string[], channels: string[] }} Seen */

const WIDTH = 240;
const HEIGHT = 84;
const PLACEHOLDER = 'FILL IN';
/** Experiments that estimators take, in the order in which benches run them. */
const LABELS = ['BS_T_NT', 'WhiteNoise_T_TN', 'Step_T_TN', 'Sine_T_TN', 'Multisine_T_TN', 'Binary_T_TN', 'Ramp_N_NT', 'Levels_N_NT', 'Unfired_N_NT', 'NoShaft_N_NT'];

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const { benches, recordings } = await get('state');
  const file = given.file || benches[0]?.file;
  if (!file || !recordings.length) {
    fill(element, h('h1', {}, title), h('p', {}, recordings.length
      ? ['There is no bench file yet. ', h('a', { href: link('bench') }, 'Propose one'), ' from the recordings.']
      : 'There are no recordings in this folder. Start the app on the folder that has them.'));
    return;
  }
  const edit = await Edit.open(file);
  const count = h('p', { class: 'soft', role: 'status' });
  const wrong = h('div', { class: 'faults' });
  const grid = h('ul', { class: 'experiments' });
  const names = h('datalist', { id: 'experiment-names' }, LABELS.map((label) => h('option', { value: label })));
  edit.tools.append(h('a', { href: link('bench', { file }) }, 'The rest of the bench file'));
  fill(element, h('h1', {}, `Experiments of ${file}`), edit.tools, count, wrong, names, grid,
    h('p', { class: 'soft' }, 'The same by a command, which leaves the experiments to you: ', h('code', {}, typed(['init', '.', '--update', `--out=${file}`]))));
  edit.listen(element);
  edit.heard = (_now, isSettled) => { if (isSettled) refresh().catch(failed); };

  /** @type {Map<string, { take: (use: Use) => void, look: () => void }>} */
  const cards = new Map();
  const watcher = new IntersectionObserver((entries) => {
    for (const { isIntersecting, target } of entries) {
      if (!isIntersecting) continue;
      watcher.unobserve(target);
      cards.get(/** @type {HTMLElement} */ (target).dataset.file ?? '')?.look();
    }
  }, { rootMargin: '200px' });
  await refresh();
  return () => watcher.disconnect();

  async function refresh() {
    const [all, { faults: found }] = await Promise.all([/** @type {Promise<Use[]>} */ (uses(file, edit.now)), faults(file, edit.now)]);
    const own = found.filter((fault) => fault.text.startsWith('recordings'));
    fill(wrong, own.length > 0 && h('ul', {}, own.map((fault) => h('li', {}, `Line ${fault.line}: ${fault.text}`))));
    const unused = all.filter((use) => !use.is_used).length;
    fill(count, `${all.length} recordings. `, unused ? `The bench file does not use ${unused} of them.` : 'The bench file uses all of them.');
    for (const use of all) {
      const known = cards.get(use.file);
      if (known) known.take(use);
      else add(use);
    }
  }

  /** @param {Use} first */
  function add(first) {
    let use = first;
    /** @type {Seen | null} */
    let found = null;
    const plot = thumbnail(`Speed and torque of ${use.name}`, WIDTH, HEIGHT);
    const input = h('input', { type: 'text', list: 'experiment-names', 'aria-label': `Experiment of ${use.name}`, onchange: () => choose(input.value.trim()) });
    const origin = h('small', { class: 'soft' });
    const why = h('div', { class: 'why' }, h('small', { class: 'soft' }, 'The data are looked at when this comes into sight.'));
    const usage = h('div', {});
    const card = h('li', { 'data-file': use.file },
      h('h2', {}, h('a', { href: link('look', { file: use.file }) }, use.name)), plot, h('div', { class: 'field' }, input, origin), why, usage);
    grid.append(card);
    cards.set(use.file, { take, look });
    take(use);
    watcher.observe(card);

    /** @param {Use} now */
    function take(now) {
      use = now;
      const stated = use.stated === PLACEHOLDER ? null : use.stated;
      input.value = stated ?? use.in_name ?? '';
      input.placeholder = 'such as BS_T_NT';
      origin.textContent = stated ? 'as the bench file states' : use.in_name ? 'from the name of the file' : 'not stated yet';
      card.classList.toggle('unused', !use.is_used);
      fill(usage, use.is_used ? null : [h('strong', {}, 'Not used'), ' by the bench file ',
        h('button', { 'aria-label': `Use ${use.name}`, onclick: () => list().catch(failed) }, 'Use it')]);
      reason();
    }

    function reason() {
      if (!found) return;
      const now = input.value;
      const { label, reasons } = found;
      const because = reasons.length ? `: ${reasons.join('; ')}.` : '.';
      if (label === null) fill(why, `The data show no experiment${because}`);
      else if (label === now) fill(why, `The data agree${because}`);
      else fill(why, 'The data look like ', h('strong', {}, label), because, ' ',
        h('button', { 'aria-label': `Take ${label} for ${use.name}`, onclick: () => choose(label) }, `Take ${label}`));
    }

    async function look() {
      try {
        found = /** @type {Seen} */ (await seen(use.file, edit.now));
        reason();
        await drawSmall(plot, use.file, found.channels);
      } catch (error) {
        fill(why, h('span', { class: 'fault' }, wordsOf(error)));
      }
    }

    /** @param {string} label */
    async function choose(label) {
      const key = ['recordings', 'label'];
      const isOfName = label === '' || label === use.in_name;
      if (use.place === null) {
        if (!isOfName) await edit.set([{ key: [...key, '+'], value: { file: use.name, label } }]);
      } else if (isOfName) {
        await edit.set([{ key: [...key, String(use.place)], value: null }]);
      } else {
        await edit.set([{ key: [...key, String(use.place), 'label'], value: label }]);
      }
    }

    async function list() {
      await edit.set([{ key: ['recordings', 'files', '+'], value: use.name }]);
    }
  }
}
