// The study: run it, follow it, read its answer.

import { get, remove } from '../api.js';
import { failed, fill, h, say, table } from '../dom.js';
import { link } from '../place.js';
import { ended, isDone, start, typed } from '../work.js';
import { frame } from './report.js';
import { noBench } from './start.js';

export const title = 'Study';

const NAME = 'Report of the study';
/** Seconds that are shown on either side of a finding. */
const ABOUT_S = 0.5;

/** @typedef {{ severity: string, file: string | null, channel: string | null, time_s: number | null, text: string, advice: string }} Finding */

/** @param {HTMLElement} element @param {Record<string, string>} given */
export async function show(element, given) {
  const { benches, recordings, reports } = await get('state');
  const bench = given.bench ?? benches[0]?.file;
  if (!bench) {
    fill(element, noBench());
    return;
  }
  const full = h('input', { type: 'checkbox' });
  const words = () => ['study', bench, ...(full.checked ? ['--full'] : [])];
  const command = h('code', {}, typed(words()));
  full.addEventListener('change', () => { command.textContent = typed(words()); });
  const progress = h('div', { class: 'progress' });
  const run = h('button', { class: 'button', onclick: () => go() }, 'Study');
  const folder = bench.includes('/') ? bench.slice(0, bench.lastIndexOf('/') + 1) : '';
  // A study writes into its own folder; the demonstration has its results beside the bench file.
  const last = [`${folder}study/`, folder].find((each) => reports.some((/** @type {any} */ report) => report.file === `${each}report.html`));
  const shown = h('div', { class: 'result' });
  if (last !== undefined) answer(last);
  fill(element, h('h1', {}, `Study of ${bench}`),
    h('div', { class: 'tools' }, run, h('label', {}, full, ' with all analyses of single parts'), command), progress, shown);

  let isOver = false;
  /** Shows what the last study found, and its report. @param {string} results */
  function answer(results) {
    const found = h('details', {}, h('summary', {}, 'Findings'));
    fill(shown, found, frame(`${results}report.html`, NAME));
    // A report may be there without its study.
    get('study', { file: `${results}study.json` })
      .then((/** @type {{ findings: Finding[] }} */ { findings }) => fill(found, findingsOf(findings, recordings)))
      .catch(() => found.remove());
  }

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
    if (isDone(job)) answer(`${folder}study/`);
    else say(job.stand === 'cancelled' ? 'The study was cancelled. The last one is still there.' : 'The study failed; its reason is above.', job.stand !== 'cancelled');
  }
  const running = (await get('jobs')).find((/** @type {any} */ job) => job.stand === 'running' && job.arguments[0] === 'study' && job.arguments.includes(bench));
  if (running) {
    run.disabled = true;
    watch(running.id).finally(() => { run.disabled = false; });
  }
  return () => { isOver = true; };
}

/** Findings, each with the way to where it is seen. @param {Finding[]} findings @param {{ file: string }[]} recordings */
function findingsOf(findings, recordings) {
  const rows = findings.map((one) => {
    const name = one.file?.split('/').at(-1);
    const recording = name && recordings.find(({ file }) => file === one.file || file.split('/').at(-1) === name)?.file;
    return [one.severity, [one.text, one.advice && h('span', { class: 'soft' }, ` ${one.advice}`)], recording ? h('a', { href: seen(recording, one) }, place(one)) : place(one)];
  });
  return [h('summary', {}, findings.length === 1 ? '1 finding' : `${findings.length} findings`),
    rows.length ? table(['', 'Finding', 'Where'], rows, 'What the study doubts') : h('p', {}, 'There is nothing to doubt.')];
}

/** The view of a recording in which a finding is seen. @param {string} file @param {Finding} finding */
function seen(file, { channel, time_s: time }) {
  const about = time === null ? {} : { from: time - ABOUT_S, to: time + ABOUT_S, a: time };
  return link('look', { file, show: channel && JSON.stringify([{ file, channel, panel: 0, offset_s: 0 }]), ...about });
}

/** @param {Finding} finding */
const place = ({ file, channel, time_s: time }) => [file, channel, time === null ? null : `${Number(time.toPrecision(6))} s`].filter((part) => part !== null).join(', ');
