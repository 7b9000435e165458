// Reports: shown in a frame in which they can do nothing but show themselves.

import { get } from '../api.js';
import { fill, h } from '../dom.js';
import { link } from '../place.js';

export const title = 'Reports';

/** A page of the program in its frame, as it is now. @param {string} file @param {string} name */
export function frame(file, name) {
  const src = `/api/report?file=${encodeURIComponent(file)}&at=${Date.now()}`;
  return h('iframe', { class: 'page', title: name, sandbox: 'allow-scripts allow-popups', src });
}

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const { reports } = await get('state');
  const file = given.file ?? reports[0]?.file;
  if (!file) {
    fill(element, h('p', {}, 'There are no reports yet. A study writes one.'));
    return;
  }
  const choice = h('select', { onchange: () => { location.hash = link('report', { file: choice.value }); } },
    reports.map((/** @type {any} */ report) => h('option', { value: report.file, selected: report.file === file }, report.file)));
  fill(element,
    h('div', { class: 'tools' }, h('label', {}, 'Report ', choice)),
    frame(file, file));
}
