// Elements. Text never becomes markup: names and comments come from recordings.

/** @typedef {Node | string | number | null | undefined | false} Child */

/**
 * An element with attributes, listeners (`onclick`), properties (`value`, `checked`) and children.
 * @template {keyof HTMLElementTagNameMap} T
 * @param {T} tag
 * @param {Record<string, any>} [attributes]
 * @param {...(Child | Child[])} children
 * @returns {HTMLElementTagNameMap[T]}
 */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === undefined || value === null || value === false) continue;
    if (name.startsWith('on')) element.addEventListener(name.slice(2), value);
    else if (PROPERTIES.has(name)) /** @type {any} */ (element)[name] = value;
    else element.setAttribute(name, value === true ? '' : String(value));
  }
  fill(element, ...children);
  return element;
}

const PROPERTIES = new Set(['value', 'checked', 'selected', 'disabled', 'hidden', 'indeterminate']);

/**
 * Puts children into an element in place of those that are there.
 * @param {Element} element
 * @param {...(Child | Child[])} children
 */
export function fill(element, ...children) {
  const kept = children.flat().filter((child) => child !== null && child !== undefined && child !== false);
  element.replaceChildren(...kept.map((child) => (child instanceof Node ? child : String(child))));
}

/**
 * Says something in the line for it, for screen readers too.
 * @param {string} text
 * @param {boolean} [isFault]
 */
export function say(text, isFault = false) {
  const line = /** @type {HTMLElement} */ (document.getElementById('notice'));
  line.textContent = text;
  line.classList.toggle('fault', isFault);
}

/** An error in words. @param {unknown} error */
export const wordsOf = (error) => (error instanceof Error ? error.message : String(error));

/** Says an error. @param {unknown} error */
export const failed = (error) => say(wordsOf(error), true);

/**
 * A table with a heading row.
 * @param {string[]} heads
 * @param {(Child | Child[])[][]} rows
 * @param {string} caption
 */
export function table(heads, rows, caption) {
  return h('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption },
    h('table', {},
      h('caption', {}, caption),
      h('thead', {}, h('tr', {}, heads.map((head) => h('th', { scope: 'col' }, head)))),
      h('tbody', {}, rows.map((row) => h('tr', {}, row.map((cell) => h('td', {}, ...[cell].flat())))))));
}

/** A patch in the colour of a series. @param {number} series */
export const swatch = (series) => h('span', { class: `swatch series-${series % 8}`, 'aria-hidden': 'true' });
