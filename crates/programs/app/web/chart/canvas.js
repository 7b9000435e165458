// What every drawing begins with: a canvas as sharp as the screen, in the colours and the font of the page.

/**
 * Context of an empty canvas of a size in pixels of the page, and the colours by their names.
 * @param {HTMLCanvasElement} canvas @param {number} width @param {number} height
 * @returns {{ context: CanvasRenderingContext2D, colour: (name: string) => string } | null}
 */
export function prepared(canvas, width, height) {
  const context = canvas.getContext('2d');
  if (!context) return null;
  const ratio = devicePixelRatio || 1;
  const [across, along] = [Math.round(width * ratio), Math.round(height * ratio)];
  // A canvas that gets another size needs other memory, too slow for each frame of a movement.
  if (canvas.width !== across || canvas.height !== along) [canvas.width, canvas.height] = [across, along];
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  context.font = `12px ${getComputedStyle(document.body).fontFamily}`;
  const style = getComputedStyle(document.documentElement);
  return { context, colour: (name) => style.getPropertyValue(`--${name}`).trim() };
}

/**
 * Paints anew when an element changes its size or the page its colours, until the element is gone or the answer called.
 * @param {Element} element @param {() => void} paint
 */
export function kept(element, paint) {
  const sizes = new ResizeObserver(() => paint());
  const scheme = matchMedia('(prefers-color-scheme: dark)');
  const changed = () => (element.isConnected ? paint() : end());
  sizes.observe(element);
  scheme.addEventListener('change', changed);
  return end;

  function end() {
    sizes.disconnect();
    scheme.removeEventListener('change', changed);
  }
}

/** @param {CanvasRenderingContext2D} context @param {number[][]} path */
export function stroke(context, path) {
  context.beginPath();
  path.forEach(([x, y]) => context.lineTo(x, y));
  context.stroke();
}
