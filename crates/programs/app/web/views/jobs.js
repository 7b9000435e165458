// Work: every command that was run, with what it said, and the session as a file that repeats it.

import { get, remove } from '../api.js';
import { fill, h, table } from '../dom.js';
import { typed } from '../work.js';

export const title = 'Work';

const WORDS = { running: 'running', ended: 'done', cancelled: 'cancelled', killed: 'ended from outside' };

/** @param {HTMLElement} element */
export function show(element) {
  let isOver = false;
  const list = h('div', {});
  const { place, look } = session();
  fill(element, h('h1', {}, 'Work'), place, h('h2', {}, 'Commands'), list);
  const round = async () => {
    if (isOver) return;
    const jobs = /** @type {import('../work.js').Job[]} */ (await get('jobs'));
    await look();
    fill(list, jobs.length ? jobs.map(entry) : h('p', {}, 'Nothing was run yet.'));
    setTimeout(round, 700);
  };
  round();
  return () => { isOver = true; };
}

/** The acts of the session, as commands and in Python. */
function session() {
  const name = h('input', { type: 'text', value: 'session', 'aria-label': 'Name of the files', oninput: () => named() });
  const files = { txt: h('a', { class: 'button', href: '/api/session/commands' }, 'Commands'), py: h('a', { class: 'button', href: '/api/session/python' }, 'Python') };
  const acts = h('div', {});
  let known = '';
  named();
  const place = h('section', {}, h('h2', {}, 'Session'),
    h('p', {}, 'All that was run and saved, in its order. Type ', h('code', {}, 'sh session.txt'), ' in a copy of the folder to repeat it without the app.'),
    h('div', { class: 'tools' }, h('label', {}, 'Save as ', name), files.txt, files.py,
      h('button', { onclick: async () => { await remove('session'); await look(); } }, 'Begin a new session')), acts);
  return { place, look };

  function named() {
    for (const [ending, link] of Object.entries(files)) link.download = `${name.value.trim() || 'session'}.${ending}`;
  }

  /** Shows the acts, where there are new ones. */
  async function look() {
    const all = /** @type {{ at_ms: number, command: string, python: string }[]} */ (await get('session'));
    if (JSON.stringify(all) === known) return;
    known = JSON.stringify(all);
    fill(acts, all.length
      ? table(['Time', 'Command', 'Python'], all.map((act) => [new Date(act.at_ms).toLocaleTimeString(), h('code', {}, act.command), h('code', {}, act.python)]), 'Acts of this session')
      : h('p', { class: 'soft' }, 'Nothing was run or saved yet.'));
  }
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
