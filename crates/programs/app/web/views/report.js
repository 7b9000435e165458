// Reports: shown in a frame in which they can do nothing but show themselves.

import { get } from '../api.js';
import { fill, h } from '../dom.js';
import { link } from '../place.js';

export const title = 'Reports';

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
    h('iframe', { class: 'page', title: file, sandbox: 'allow-scripts allow-popups', src: `/api/report?file=${encodeURIComponent(file)}` }));
}
