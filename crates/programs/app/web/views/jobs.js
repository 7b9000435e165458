// Work: every command that was run, with what it said.

import { get, remove } from '../api.js';
import { fill, h } from '../dom.js';
import { typed } from '../work.js';

export const title = 'Work';

const WORDS = { running: 'running', ended: 'done', cancelled: 'cancelled', killed: 'ended from outside' };

/** @param {HTMLElement} element */
export function show(element) {
  let isOver = false;
  const list = h('div', {});
  fill(element, h('h1', {}, 'Work'), list);
  const round = async () => {
    if (isOver) return;
    const jobs = /** @type {import('../work.js').Job[]} */ (await get('jobs'));
    fill(list, jobs.length ? jobs.map(entry) : h('p', {}, 'Nothing was run yet.'));
    setTimeout(round, 700);
  };
  round();
  return () => { isOver = true; };
}

/** @param {import('../work.js').Job} job */
function entry(job) {
  const stand = job.exit_code && job.exit_code > 1 ? `failed (exit code ${job.exit_code})` : WORDS[job.stand];
  return h('article', { class: 'job' },
    h('code', {}, typed(job.arguments)),
    h('p', {}, stand, job.doing && ` – ${job.doing}`),
    job.fraction !== null && h('progress', { max: 1, value: job.fraction, 'aria-label': job.doing ?? 'progress' }),
    job.stand === 'running' && h('button', { onclick: () => remove(`jobs/${job.id}`) }, 'Cancel'),
    job.said && h('pre', {}, job.said));
}
