"""Measures frames a second while long recordings are moved and zoomed. Run by hand: `python frames.py FOLDER`.

The folder must not be there yet. It gets two recordings, 400 MB each: one channel of 1e8 samples, and 100 channels of 1e6.
At the end it is removed. `DYNOID` and `CHROMIUM` name the program and the browser, as for the tests.
"""

from __future__ import annotations

import array
import json
import math
import os
import pathlib
import random
import shutil
import statistics
import struct
import sys
import time
import urllib.parse

from playwright.sync_api import Page, sync_playwright

from conftest import App

SAMPLE_TIME_S = 1e-4
#: Each act is this long.
ACT_S = 4.0

#: Counts the frames, and the longest time between two, while something is done in each of them.
COUNTED = """
async ([kind, seconds]) => {
  const canvas = document.querySelector('.plots canvas');
  const box = canvas.getBoundingClientRect();
  const same = { clientY: box.top + 60, bubbles: true, cancelable: true, pointerId: 1, button: 0 };
  const at = (x) => ({ clientX: box.left + x, ...same });
  canvas.setPointerCapture = () => {};
  if (kind === 'move') canvas.dispatchEvent(new PointerEvent('pointerdown', at(600)));
  const begin = performance.now();
  const gaps = [];
  for (let last = begin, k = 0; last - begin < 1000 * seconds; k += 1) {
    if (kind === 'move') canvas.dispatchEvent(new PointerEvent('pointermove', at(600 + 300 * Math.sin(k / 15))));
    else canvas.dispatchEvent(new WheelEvent('wheel', { ...at(600), deltaY: Math.sin(k / 30) > 0 ? -40 : 40 }));
    const now = await new Promise((done) => requestAnimationFrame(done));
    gaps.push(now - last);
    last = now;
  }
  if (kind === 'move') canvas.dispatchEvent(new PointerEvent('pointerup', at(600)));
  return gaps.slice(2);
}
"""


def block(kind: bytes, links: list[int], data: bytes) -> bytes:
    """A block of MDF 4."""
    body = struct.pack(f"<{len(links)}Q", *links) + data
    body += b"\0" * (-len(body) % 8)
    return b"##" + kind + struct.pack("<IQQ", 0, 24 + len(body), len(links)) + body


def channel_block(links: list[int], kind: int, sync: int, numbers: int, offset: int, bits: int) -> bytes:
    data = struct.pack("<BBBBIIIIBBH6d", kind, sync, numbers, 0, offset, bits, 0, 0, 0, 0, 0, *[0.0] * 6)
    return block(b"CN", links, data)


def write(path: pathlib.Path, samples: int, channels: int) -> None:
    """A recording in MDF 4.10: numbers of 32 bits, on a clock that is counted."""
    start, blocks = 64 + 104 + 64 + 104, []
    place = start

    def put(made: bytes) -> int:
        nonlocal place
        blocks.append(made)
        place += len(made)
        return place - len(made)

    linear = put(block(b"CC", [0] * 4, struct.pack("<BBHHH4d", 1, 0, 0, 0, 2, 0.0, 0.0, 0.0, SAMPLE_TIME_S)))
    following = 0
    for k in reversed(range(channels)):
        name = put(block(b"TX", [], f"channel {k}\0".encode()))
        following = put(channel_block([following, 0, name, 0, 0, 0, 0, 0], 0, 0, 4, 4 * k, 32))
    name, unit = put(block(b"TX", [], b"time\0")), put(block(b"TX", [], b"s\0"))
    master = put(channel_block([following, 0, name, 0, linear, 0, unit, 0], 3, 1, 0, 0, 0))
    header = block(b"HD", [64 + 104, 0, 0, 0, 0, 0], struct.pack("<QhhBBBBdd", 0, 0, 0, 0, 0, 0, 0, 0.0, 0.0))
    group = block(b"DG", [0, 64 + 104 + 64, place, 0], b"\0" * 8)
    cycle = struct.pack("<QQHHIII", 0, samples, 0, 0, 0, 4 * channels, 0)
    records = block(b"CG", [0, master, 0, 0, 0, 0], cycle)
    identification = struct.pack("<8s8s8s4sH30sHH", b"MDF     ", b"4.10    ", b"dynoid  ", b"", 410, b"", 0, 0)
    draw = random.Random(1)
    rows = min(samples, 1_000_000 // channels)
    pieces = [
        array.array("f", (math.sin(k / 977) + draw.gauss(0, 0.1) for k in range(rows * channels))) for _ in range(3)
    ]
    with path.open("wb") as file:
        file.write(b"".join([identification, header, group, records, *blocks]))
        file.write(b"##DT" + struct.pack("<IQQ", 0, 24 + 4 * samples * channels, 0))
        for k in range(samples // rows):
            pieces[k % 3].tofile(file)


def measure(page: Page, app: App, file: str, channels: int) -> None:
    shown = [{"file": file, "channel": f"channel {k}", "panel": k // 10, "offset_s": 0} for k in range(channels)]
    begin = time.monotonic()
    page.goto(app.at("look?" + urllib.parse.urlencode({"file": file, "show": json.dumps(shown)})))
    page.wait_for_selector(".plots canvas")
    page.wait_for_load_state("networkidle")
    print(f"{file}: {channels} channel(s), drawn {time.monotonic() - begin:.1f} s after it was asked for")
    for kind in ["zoom", "move"]:
        gaps = page.evaluate(COUNTED, [kind, ACT_S])
        gaps.sort()
        print(
            f"  {kind}: {1000 / statistics.mean(gaps):.0f} frames a second; median {statistics.median(gaps):.0f} ms, "
            f"95 % within {gaps[int(0.95 * len(gaps))]:.0f} ms, longest {gaps[-1]:.0f} ms"
        )


def main() -> None:
    folder = pathlib.Path(sys.argv[1])
    folder.mkdir(parents=True)
    try:
        write(folder / "long.mf4", 100_000_000, 1)
        write(folder / "wide.mf4", 1_000_000, 100)
        app = App(folder)
        print(f"load of this computer: {os.getloadavg()[0]:.1f} on {os.cpu_count()} cores")
        with sync_playwright() as playwright:
            path = shutil.which(os.environ.get("CHROMIUM", "chromium"))
            page = playwright.chromium.launch(executable_path=path).new_page(viewport={"width": 1440, "height": 900})
            page.goto(app.address)
            page.wait_for_selector("h1")
            measure(page, app, "long.mf4", 1)
            measure(page, app, "wide.mf4", 10)
            measure(page, app, "wide.mf4", 100)
        app.kill()
    finally:
        shutil.rmtree(folder)


if __name__ == "__main__":
    main()
