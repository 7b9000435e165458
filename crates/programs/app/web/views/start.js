// The start: what is in the folder, and what to do next.

import { get } from '../api.js';
import { fill, h, table } from '../dom.js';
import { link } from '../place.js';

export const title = 'Start';

/** @param {number} bytes */
export function size(bytes) {
  const units = ['B', 'kB', 'MB', 'GB'];
  let power = 0;
  while (bytes >= 1000 && power < units.length - 1) {
    bytes /= 1000;
    power += 1;
  }
  return `${power && bytes < 10 ? bytes.toFixed(1) : Math.round(bytes)} ${units[power]}`;
}

/** What a page says that needs a bench file where there is none. */
export const noBench = () => h('p', {}, 'There is no bench file yet. ', h('a', { href: link('bench') }, 'Describe the bench'), ' first.');

/** @param {HTMLElement} element */
export async function show(element) {
  const state = await get('state');
  const day = (/** @type {number | null} */ ms) => (ms === null ? '' : new Date(ms).toISOString().slice(0, 16).replace('T', ' '));
  const [bench] = state.benches;
  fill(element,
    h('h1', {}, state.folder),
    h('ul', { class: 'next' },
      h('li', {}, h('a', { class: 'button', href: link('look', { file: state.recordings[0]?.file }) }, 'Look at recordings')),
      h('li', {}, h('a', { class: 'button', href: link('bench', { file: bench?.file }) }, bench ? 'Edit the bench' : 'Describe the bench')),
      bench && h('li', {}, h('a', { class: 'button', href: link('study', { bench: bench.file }) }, 'Study the bench'))),
    state.recordings.length
      ? table(['Recording', 'Size', 'Changed'], state.recordings.map((/** @type {any} */ file) => [
        h('a', { href: link('look', { file: file.file }) }, file.file), size(file.bytes), day(file.changed_ms)]), 'Recordings')
      : h('p', {}, 'There are no recordings in this folder. Start the app on the folder that has them.'),
    state.benches.length > 0 && table(['Bench file', 'Changed'], state.benches.map((/** @type {any} */ file) => [
      h('a', { href: link('bench', { file: file.file }) }, file.file), day(file.changed_ms)]), 'Benches'),
    state.reports.length > 0 && table(['Report', 'Changed'], state.reports.map((/** @type {any} */ file) => [
      h('a', { href: link('report', { file: file.file }) }, file.file), day(file.changed_ms)]), 'Reports'));
}
