// Values with their intervals over one another, in the cell of a table.

const [WIDTH, HEIGHT] = [160, 30];

/**
 * Paints values in the colours of their series; one without an interval counts as exact.
 * @param {HTMLCanvasElement} canvas @param {{ value: number, interval_95: [number, number] | null }[]} all
 */
export function intervals(canvas, all) {
  const paint = () => {
    const ratio = devicePixelRatio || 1;
    [canvas.width, canvas.height] = [WIDTH * ratio, HEIGHT * ratio];
    const context = canvas.getContext('2d');
    if (!context) return;
    const style = getComputedStyle(document.documentElement);
    const colour = (/** @type {string} */ name) => style.getPropertyValue(`--${name}`).trim();
    const ends = all.flatMap(({ value, interval_95: interval }) => interval ?? [value]);
    const [low, high] = [Math.min(...ends), Math.max(...ends)];
    const xOf = (/** @type {number} */ value) => (high > low ? 6 + ((value - low) / (high - low)) * (WIDTH - 12) : WIDTH / 2);
    context.scale(ratio, ratio);
    all.forEach(({ value, interval_95: interval }, index) => {
      const y = (HEIGHT * (index + 0.5)) / all.length;
      [context.strokeStyle, context.fillStyle] = [colour(`series-${index}`), colour(`series-${index}`)];
      context.lineWidth = 2;
      const [from, to] = interval ?? [value, value];
      context.beginPath();
      for (const x of [xOf(from), xOf(to)]) [context.moveTo(x, y - 3), context.lineTo(x, y + 3)];
      context.moveTo(xOf(from), y);
      context.lineTo(xOf(to), y);
      context.stroke();
      context.beginPath();
      context.arc(xOf(value), y, 3.5, 0, 2 * Math.PI);
      context.fill();
    });
  };
  paint();
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', paint);
}
