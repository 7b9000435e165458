// The app: one view a task, chosen by the address.

import { failed, fill, h, say } from './dom.js';
import { here } from './place.js';
import { follow } from './work.js';
import * as bench from './views/bench.js';
import * as campbell from './views/campbell.js';
import * as can from './views/can.js';
import * as command from './views/command.js';
import * as compare from './views/compare.js';
import * as jobs from './views/jobs.js';
import * as labels from './views/labels.js';
import * as look from './views/look.js';
import * as model from './views/model.js';
import * as next from './views/next.js';
import * as report from './views/report.js';
import * as roles from './views/roles.js';
import * as start from './views/start.js';
import * as study from './views/study.js';

/**
 * A view fills an element, and may return what ends it.
 * @typedef {{ title: string, show: (element: HTMLElement, given: Record<string, string>) => void | (() => void) | Promise<void | (() => void)> }} View
 */

/** @type {Record<string, View>} */
const VIEWS = { '': start, look, labels, roles, bench, study, report, can, next, compare, model, campbell, command, jobs };

/** Tasks in the bar, in the order of the work. */
const TASKS = ['look', 'labels', 'roles', 'bench', 'study', 'report', 'can', 'next', 'compare', 'model', 'campbell', 'command'];

/** @type {void | (() => void)} */
let end;
let shown = 0;

async function show() {
  const { task, given } = here();
  const view = VIEWS[task] ?? start;
  const turn = (shown += 1);
  end?.();
  end = undefined;
  say('');
  document.title = task ? `${view.title} – dynoid` : 'dynoid';
  fill(bar(), TASKS.map((name) => h('a', { href: `#/${name}`, 'aria-current': name === task && 'page' }, VIEWS[name].title)));
  const main = /** @type {HTMLElement} */ (document.getElementById('view'));
  const element = h('div', { class: `view ${task || 'start'}` });
  fill(main, element);
  try {
    const ending = await view.show(element, given);
    if (turn === shown) end = ending;
    else ending?.();
  } catch (error) {
    failed(error);
  }
}

const bar = () => /** @type {HTMLElement} */ (document.getElementById('tasks'));

addEventListener('hashchange', show);
addEventListener('popstate', show);
addEventListener('unhandledrejection', (event) => say(String(event.reason?.message ?? event.reason), true));
show();
follow(/** @type {HTMLAnchorElement} */ (document.getElementById('work')));
