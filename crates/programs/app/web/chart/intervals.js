// Values with their intervals over one another, in the cell of a table.

import { kept, prepared } from './canvas.js';

const [WIDTH, HEIGHT] = [160, 30];

/**
 * Paints values in the colours of their series; one without an interval counts as exact.
 * @param {HTMLCanvasElement} canvas @param {{ value: number, interval_95: [number, number] | null }[]} all
 */
export function intervals(canvas, all) {
  const paint = () => {
    const drawn = prepared(canvas, WIDTH, HEIGHT);
    if (!drawn) return;
    const { context, colour } = drawn;
    const ends = all.flatMap(({ value, interval_95: interval }) => interval ?? [value]);
    const [low, high] = [Math.min(...ends), Math.max(...ends)];
    const xOf = (/** @type {number} */ value) => (high > low ? 6 + ((value - low) / (high - low)) * (WIDTH - 12) : WIDTH / 2);
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
  kept(canvas, paint);
}
