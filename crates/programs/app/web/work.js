// Jobs: commands that run beside the page. Short questions at a slow pace; no stream is held open.

import { get, post, printed } from './api.js';

/**
 * @typedef {object} Job
 * @property {string} id
 * @property {string[]} arguments
 * @property {'running' | 'ended' | 'cancelled' | 'killed'} stand
 * @property {number | null} exit_code
 * @property {number | null} fraction
 * @property {string | null} doing
 * @property {string} said
 */

const PACE_MS = 400;

/** Starts a command. @param {string[]} words @returns {Promise<Job>} */
export function start(words) {
  return post('jobs', { arguments: words });
}

/**
 * Follows a job to its end.
 * @param {string} id @param {(job: Job) => void} [heard]
 * @returns {Promise<Job>}
 */
export async function ended(id, heard) {
  for (let pace = 60; ; pace = Math.min(PACE_MS, 1.5 * pace)) {
    const job = await get(`jobs/${id}`);
    heard?.(job);
    if (job.stand !== 'running') return job;
    await new Promise((done) => setTimeout(done, pace));
  }
}

/** Whether a job wrote its results. @param {Job} job */
export const isDone = (job) => job.stand === 'ended' && (job.exit_code ?? 5) <= 1;

/** Runs a command to its end and gives its result. @param {string[]} words @param {(job: Job) => void} [heard] */
export async function result(words, heard) {
  const job = await ended((await start([...words, '--json'])).id, heard);
  if (!isDone(job)) throw new Error(job.said.trim() || `the command was ${job.stand}`);
  return JSON.parse(await printed(job.id));
}

/** A command as one types it. @param {string[]} words */
export function typed(words) {
  const quoted = words.map((word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replace(/'/g, "'\\''")}'`));
  return ['dynoid', ...quoted].join(' ');
}

/** Shows what runs, on every page. @param {HTMLAnchorElement} place */
export async function follow(place) {
  for (;;) {
    const jobs = /** @type {Job[]} */ (await get('jobs').catch(() => []));
    const running = jobs.filter((job) => job.stand === 'running');
    place.hidden = jobs.length === 0;
    const [first] = running;
    place.textContent = first
      ? `${first.arguments[0]}: ${first.fraction === null ? 'running' : `${Math.round(100 * first.fraction)} %`}${running.length > 1 ? ` and ${running.length - 1} more` : ''}`
      : 'Work done';
    await new Promise((done) => setTimeout(done, running.length ? PACE_MS : 5 * PACE_MS));
  }
}
