// Requests to the program.

/** A fault in words that a page can show. */
export class Fault extends Error {
  /** @param {string} text @param {number} status */
  constructor(text, status) {
    super(text);
    this.status = status;
  }
}

/**
 * @param {string} path
 * @param {RequestInit} [options]
 * @returns {Promise<Response>}
 */
async function ask(path, options) {
  let response;
  try {
    response = await fetch(`/api/${path}`, options);
  } catch (error) {
    if (error instanceof DOMException && error.name === 'AbortError') throw error;
    throw new Fault('The program does not answer. Start `dynoid app` again; nothing that was saved is lost.', 0);
  }
  if (response.ok) return response;
  const said = await response.json().catch(() => ({ error: response.statusText }));
  throw new Fault(said.error, response.status);
}

/** @param {string} path @param {Record<string, any>} [given] */
function address(path, given = {}) {
  const query = new URLSearchParams();
  for (const [name, value] of Object.entries(given)) {
    if (value !== undefined && value !== null) query.set(name, typeof value === 'object' ? JSON.stringify(value) : String(value));
  }
  return `${path}?${query}`;
}

/** @param {string} path @param {Record<string, any>} [given] @param {AbortSignal} [signal] */
export async function get(path, given, signal) {
  return (await ask(address(path, given), { signal })).json();
}

/** What a job printed, as text. @param {string} id */
export async function printed(id) {
  return (await ask(`jobs/${id}/printed`)).text();
}

/** @param {string} path @param {any} body */
export async function post(path, body) {
  const headers = { 'content-type': 'application/json' };
  return (await ask(path, { method: 'POST', headers, body: JSON.stringify(body) })).json();
}

/**
 * The faults of a text that is to be a bench file, and its values by tables.
 * @param {string} file @param {string} text
 * @returns {Promise<{ faults: { line: number, text: string }[], values: Record<string, any> | null }>}
 */
export async function faults(file, text) {
  return (await ask(address('check', { file }), { method: 'POST', body: text })).json();
}

/**
 * Makes changes in a text, and leaves all else of it as it is.
 * @param {string} file @param {string} text @param {{ key: string[], value: any }[]} changes
 * @returns {Promise<string>}
 */
export async function change(file, text, changes) {
  const headers = { 'content-type': 'application/json' };
  return (await ask(address('change', { file }), { method: 'POST', headers, body: JSON.stringify({ text, changes }) })).json();
}

/** How the text of a bench file uses the recordings of the folder. @param {string} bench @param {string} text */
export async function uses(bench, text) {
  return (await ask(address('uses', { file: bench }), { method: 'POST', body: text })).json();
}

/** The experiment that a recording shows by itself, by the channels of a bench file. @param {string} file @param {string} text */
export async function seen(file, text) {
  return (await ask(address('label', { file }), { method: 'POST', body: text })).json();
}

/** @param {string} path */
export async function remove(path) {
  return (await ask(path, { method: 'DELETE' })).json();
}

/**
 * Writes a text over the state that was read; `null` for a file that was not there.
 * @param {string} file @param {string} text @param {string | null} state
 */
export async function save(file, text, state) {
  return (await ask(address('text', { file }), { method: 'PUT', headers: over(state), body: text })).json();
}

/**
 * Keeps a text that was typed over a state of a file, and is not saved.
 * @param {string} file @param {string} text @param {string | null} state
 */
export async function keep(file, text, state) {
  await ask(address('draft', { file }), { method: 'PUT', headers: over(state), body: text });
}

/** @param {string} file */
export async function forget(file) {
  await ask(address('draft', { file }), { method: 'DELETE' });
}

/** @param {string | null} state @returns {Record<string, string>} */
const over = (state) => (state === null ? {} : { 'if-match': state });

/** Numbers of a column of a plot. */
export const COLUMN = 6;

/**
 * Columns of a plot: of each channel the first and last stamp, the least and the largest, and the first and the last
 * sample of each column.
 * @param {string} file @param {string[]} channels @param {number} from_s @param {number} to_s
 * @param {number} columns @param {AbortSignal} [signal]
 * @returns {Promise<Float64Array[]>}
 */
export async function view(file, channels, from_s, to_s, columns, signal) {
  const given = { file, channels, columns, ...(Number.isFinite(from_s) && { from_s }), ...(Number.isFinite(to_s) && { to_s }) };
  const numbers = new Float64Array(await (await ask(address('view', given), { signal })).arrayBuffer());
  const found = [];
  for (let at = 0; at < numbers.length; at += 1 + COLUMN * numbers[at]) {
    found.push(numbers.subarray(at + 1, at + 1 + COLUMN * numbers[at]));
  }
  return found;
}

/**
 * The time that some channels of a recording take.
 * @param {string} file @param {string[]} channels
 */
export async function extent(file, channels) {
  const found = await view(file, channels, -Infinity, Infinity, 1);
  const ends = found.filter((columns) => columns.length).map(([from, to]) => ({ from, to }));
  return { from: Math.min(...ends.map((end) => end.from)), to: Math.max(...ends.map((end) => end.to)) };
}
