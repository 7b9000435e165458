// Where the page is: a task and what it shows, all of it in the address, so that back, forward and bookmarks work.

/** @typedef {{ task: string, given: Record<string, string> }} Place */

/** @returns {Place} */
export function here() {
  const [task, query] = location.hash.replace(/^#\/?/, '').split('?');
  return { task, given: Object.fromEntries(new URLSearchParams(query ?? '')) };
}

/** @param {string} task @param {Record<string, string | number | undefined | null>} [given] */
export function link(task, given = {}) {
  const kept = Object.entries(given).filter(([, value]) => value !== undefined && value !== null && value !== '');
  const query = new URLSearchParams(kept.map(([name, value]) => [name, String(value)]));
  return `#/${task}${kept.length ? `?${query}` : ''}`;
}

/**
 * Notes what the page shows now, as a new entry of the history or in place of the last.
 * @param {string} task @param {Record<string, string | number | undefined | null>} given @param {boolean} isNew
 */
export function note(task, given, isNew) {
  const place = link(task, given);
  if (place === location.hash) return;
  if (isNew) history.pushState(null, '', place);
  else history.replaceState(null, '', place);
}
