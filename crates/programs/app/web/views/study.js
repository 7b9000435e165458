// The study: run it, follow it, read its answer.

import { get, remove } from '../api.js';
import { failed, fill, h, say } from '../dom.js';
import { link } from '../place.js';
import { ended, isDone, start, typed } from '../work.js';
import { frame } from './report.js';

export const title = 'Study';

const NAME = 'Report of the study';

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const { benches, reports } = await get('state');
  const bench = given.bench ?? benches[0]?.file;
  if (!bench) {
    fill(element, h('p', {}, 'There is no bench file yet. ', h('a', { href: link('bench') }, 'Describe the bench'), ' first.'));
    return;
  }
  const full = h('input', { type: 'checkbox' });
  const words = () => ['study', bench, ...(full.checked ? ['--full'] : [])];
  const command = h('code', {}, typed(words()));
  full.addEventListener('change', () => { command.textContent = typed(words()); });
  const progress = h('div', { class: 'progress' });
  const run = h('button', { class: 'button', onclick: () => go() }, 'Study');
  const folder = bench.includes('/') ? bench.slice(0, bench.lastIndexOf('/') + 1) : '';
  const last = reports.find((/** @type {any} */ report) => report.file === `${folder}study/report.html`);
  const shown = h('div', { class: 'result' }, last && frame(last.file, NAME));
  fill(element, h('h1', {}, `Study of ${bench}`),
    h('div', { class: 'tools' }, run, h('label', {}, full, ' with all analyses of single parts'), command), progress, shown);

  let isOver = false;
  async function go() {
    run.disabled = true;
    try {
      const job = await start(words());
      await watch(job.id);
    } catch (error) {
      failed(error);
    }
    run.disabled = false;
  }
  /** @param {string} id */
  async function watch(id) {
    const bar = h('progress', { max: 1, 'aria-label': 'Progress of the study' });
    const doing = h('span', {});
    fill(progress, bar, doing, h('button', { onclick: () => remove(`jobs/${id}`) }, 'Cancel'));
    const job = await ended(id, ({ fraction, doing: now }) => {
      if (fraction !== null) bar.value = fraction;
      doing.textContent = now ?? '';
    });
    if (isOver) return;
    fill(progress, job.said && h('pre', {}, job.said));
    if (isDone(job)) fill(shown, frame(`${folder}study/report.html`, NAME));
    else say(job.stand === 'cancelled' ? 'The study was cancelled. The last one is still there.' : 'The study failed; its reason is above.', job.stand !== 'cancelled');
  }
  const running = (await get('jobs')).find((/** @type {any} */ job) => job.stand === 'running' && job.arguments[0] === 'study' && job.arguments.includes(bench));
  if (running) {
    run.disabled = true;
    watch(running.id).finally(() => { run.disabled = false; });
  }
  return () => { isOver = true; };
}
