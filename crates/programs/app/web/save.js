// What is seen, as files: pictures of plots, and stretches of recordings in another format.

import { h, say } from './dom.js';
import { isDone, ended, start, typed } from './work.js';

/** Gives bytes as a file. @param {Blob} blob @param {string} name */
export function give(blob, name) {
  const address = URL.createObjectURL(blob);
  h('a', { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

/** Gives a canvas as a picture, with the page's background. @param {HTMLCanvasElement} canvas @param {string} name */
export function picture(canvas, name) {
  const copy = h('canvas', { width: canvas.width, height: canvas.height });
  const context = copy.getContext('2d');
  if (!context) return;
  context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue('--back');
  context.fillRect(0, 0, copy.width, copy.height);
  context.drawImage(canvas, 0, 0);
  copy.toBlob((blob) => {
    if (blob) give(blob, name);
  });
}

/** A name for what is made of a stretch of a recording. @param {string} file @param {number} from @param {number} to @param {string} ending */
export function nameOf(file, from, to, ending) {
  const seconds = (/** @type {number} */ at) => String(Number(at.toPrecision(6)));
  return `${file.replace(/\.[^./]*$/, '')}_${seconds(from)}_to_${seconds(to)}_s.${ending}`;
}

/**
 * Writes channels of a stretch beside the recording that has them, as a job.
 * @param {string} file @param {string[]} channels @param {number} from @param {number} to @param {string} ending
 */
export async function stretch(file, channels, from, to, ending) {
  const out = nameOf(file, from, to, ending);
  // Commas separate names; a question mark stands for any character.
  const names = channels.map((name) => name.replace(/,/g, '?')).join(',');
  const words = ['convert', file, `--channels=${names}`, `--start=${from}`, `--end=${to}`, `--out=${out}`];
  say(`Writing ${out} …`);
  const job = await ended((await start(words)).id);
  const said = job.said.trim();
  if (isDone(job)) say([`${out} is written. The same by hand: ${typed(words)}`, said].filter(Boolean).join('\n'));
  else say(said || `The command was ${job.stand}.`, true);
}
