// Buttons above a figure and the keys that do the same.

const HELP = "Drag to zoom, drag with Shift to move, double-click for all. Keys in the figure: ← → read values (faster with Shift), "
  + "+ and − zoom, comma and full stop move, 0 or Escape shows all, P, S and C save, L links.";

/** Label, name, keys and action of each button. */
const TOOLS = [
  ["+", "Zoom in", ["+", "="], (plot) => zoomBy(plot, 0.5)],
  ["−", "Zoom out", ["-"], (plot) => zoomBy(plot, 2)],
  ["◂", "Move left", [","], (plot) => panBy(plot, -0.25)],
  ["▸", "Move right", ["."], (plot) => panBy(plot, 0.25)],
  ["All", "Show all", ["0", "Escape"], (plot) => { zoomTo(plot, null); hideCursor(plot); }],
  ["PNG", "Save as PNG", ["p"], savePixels],
  ["SVG", "Save as SVG", ["s"], saveDrawing],
  ["CSV", "Save numbers as CSV", ["c"], saveNumbers],
  ["linked", "Figures of this recording linked: they zoom together", ["l"], toggleLink],
  ["?", "Help", ["?"], toggleHelp],
];

/** A row of buttons with one stop of the Tab key; arrow keys go from button to button. */
function addTools(plot) {
  const bar = document.createElement("div");
  bar.className = "tools";
  bar.setAttribute("role", "toolbar");
  bar.setAttribute("aria-label", `Tools of the figure ${plot.title}`);
  plot.buttons = TOOLS.map(([label, name, [key], action], number) => {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = label;
    button.title = `${name} (${key})`;
    button.setAttribute("aria-label", name);
    button.tabIndex = number === 0 ? 0 : -1;
    button.addEventListener("click", () => act(plot, action));
    return button;
  });
  bar.append(...plot.buttons);
  bar.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (!way) return;
    const all = plot.buttons.filter((button) => !button.hidden);
    const at = all.indexOf(document.activeElement);
    all[at].tabIndex = -1;
    const next = all[(at + way + all.length) % all.length];
    next.tabIndex = 0;
    next.focus();
    event.preventDefault();
  });
  plot.box.querySelector(".plot-head").append(bar);
  addHelp(plot);
}

/** After an action the cursor is where it was. */
function act(plot, action) {
  action(plot);
  if (plot.cursor !== null) showCursor(plot, plot.cursor);
}

const buttonOf = (plot, label) => plot.buttons[TOOLS.findIndex(([own]) => own === label)];

function addHelp(plot) {
  plot.help = document.createElement("p");
  plot.help.className = "help";
  plot.help.id = `help-${plots.length}`;
  plot.help.hidden = true;
  plot.help.textContent = HELP;
  plot.stage.before(plot.help);
  plot.root.setAttribute("aria-describedby", plot.help.id);
  const button = buttonOf(plot, "?");
  button.setAttribute("aria-expanded", "false");
  button.setAttribute("aria-controls", plot.help.id);
}

function toggleHelp(plot) {
  plot.help.hidden = !plot.help.hidden;
  buttonOf(plot, "?").setAttribute("aria-expanded", String(!plot.help.hidden));
}

function toggleLink(plot) {
  if (siblings(plot).length === 0) return;
  if (!unlinked.delete(plot.recording)) unlinked.add(plot.recording);
  plots.forEach(showLink);
  if (plot.domain) zoomTo(plot, plot.domain, plot.focus);
}

/** Whether zooming this figure zooms others; the button is there only where there are others. */
function showLink(plot) {
  const button = buttonOf(plot, "linked");
  button.hidden = siblings(plot).length === 0;
  button.setAttribute("aria-pressed", String(!unlinked.has(plot.recording)));
}

/** Keys of the buttons, and arrow keys that move the cursor. */
function listenToKeys(plot) {
  plot.root.addEventListener("keydown", (event) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    const way = { ArrowLeft: -1, ArrowRight: 1 }[key];
    const tool = TOOLS.find(([, , keys]) => keys.includes(key));
    if (!way && !tool) return;
    event.preventDefault();
    if (tool) act(plot, tool[3]);
    else moveCursor(plot, way * (event.shiftKey ? 40 : 4));
  });
  plot.root.addEventListener("focus", () => unpack(plot));
  plot.root.addEventListener("blur", () => hideCursor(plot));
}

function moveCursor(plot, way) {
  const [left, right] = ends(plot);
  const at = plot.cursor === null ? (left + right) / 2 : shown(plot, plot.cursor);
  showCursor(plot, drawn(plot, inside(plot, at + way)));
}
