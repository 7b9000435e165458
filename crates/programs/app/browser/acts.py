"""Random acts at the pages, and the same acts again by commands. Run by hand: `python acts.py FOLDER [ACTS] [SEED]`.

FOLDER has a bench file and recordings, such as `dynoid demo` writes; it is copied twice, and stays as it is. One copy is
open in the app while acts are drawn: links, buttons, choices, numbers, texts, keys, places in plots, back and forward,
loading again, edits that are saved, and fits. Afterwards the session's commands run in the other copy. It is an error if
the console has a fault, the server fails, or a file of the two copies differs. `DYNOID` and `CHROMIUM` name the program
and the browser.
"""

from __future__ import annotations

import collections
import json
import os
import pathlib
import random
import re
import shutil
import sys
import tempfile
import time

from playwright.sync_api import Error, Page, Request, Response, sync_playwright

from conftest import App, repeat

#: Acts that begin work of minutes are drawn this often at most.
MOST_WORK = 12
LONG = re.compile(r"^(Study|Look for experiments|Gain and safety with these|Run|Calculate|Write its demands)$")
#: A view of its own is opened from time to time, so that none is left out.
VIEWS = ["", "look", "labels", "roles", "bench", "study", "report", "can", "next", "compare", "model", "campbell", "command", "jobs"]
TEXTS = ["", "0", "-1", "1e9", "12,5", "NaN", "../../x", "<b>bold</b>", "Drehzahl €", "a" * 300, "0.5"]
KEYS = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown", "Home", "Escape", "Enter", "Tab", "a", "b", "m", "+", "-", "Control+z", "Control+y"]
CONTROLS = "a:visible, button:visible:enabled, select:visible:enabled, input:visible:enabled, textarea:visible:enabled, canvas:visible, summary:visible"
RECORDING = "recordings/WhiteNoise_T_TN_1200.mf4"
INPUT, OUTPUT = '["DynoTorqueDemand"]', '["DynoTorqueCalc"]'
OUT_OF_REACH = ["Timeout", "not attached", "Element is not a", "cannot be filled"]
#: Files that say when and where a result was made.
DATED = re.compile(r'"(date|studied_on|time_s|seconds|program|created)":\s*("[^"]*"|[0-9.eE+-]+)')


class Acts:
    """Draws acts at a page, and notes what it complains of."""

    def __init__(self, app: App, page: Page, seed: int) -> None:
        self.app = app
        self.page = page
        self.draw = random.Random(seed)
        self.work = 0
        self.done: collections.Counter[str] = collections.Counter()
        self.faults: list[str] = []
        self.last = ""
        page.on("pageerror", lambda error: self.fault(f"error: {error}"))
        page.on("console", lambda message: self.console(message.type, message.text))
        page.on("response", self.response)
        page.on("requestfailed", self.failed)
        page.on("dialog", lambda dialog: dialog.accept())

    def fault(self, text: str) -> None:
        self.faults.append(f"{self.page.url} after {self.last}: {text}")

    def console(self, kind: str, text: str) -> None:
        # A refusal in words (4xx) is an answer; the browser notes it all the same.
        if kind == "error" and not re.search(r"status of 4\d\d", text):
            self.fault(text)

    def response(self, response: Response) -> None:
        if response.status >= 500:
            self.fault(f"{response.status} {response.url}")

    def failed(self, request: Request) -> None:
        if request.failure and "ABORTED" not in request.failure:
            self.fault(f"{request.failure} {request.url}")

    def act(self) -> None:
        kind = self.draw.choices(["control", "key", "view", "history", "reload", "write"], [76, 8, 7, 3, 2, 4])[0]
        try:
            getattr(self, kind)()
            self.done[kind] += 1
        except Error as error:
            # An element may be gone, hidden, or another one, before it is reached.
            if not any(known in str(error) for known in OUT_OF_REACH):
                self.fault(str(error).splitlines()[0])
            self.done["out of reach"] += 1
        self.page.wait_for_timeout(self.draw.choice([0, 20, 200]))

    def view(self) -> None:
        self.last = f"view {self.draw.choice(VIEWS)}"
        self.page.goto(self.app.at(self.last.split()[-1] if self.last != "view " else ""))

    def write(self) -> None:
        """An act that leaves a file: a chance alone would seldom find one."""
        if self.draw.random() < 0.5:
            self.last = "an edit"
            self.page.goto(self.app.at("bench?file=bench.toml"))
            text = self.page.get_by_label("Text of bench.toml")
            text.fill(text.input_value(timeout=5000) + f"# {self.draw.choice(TEXTS[4:9])}\n", timeout=5000)
            self.page.get_by_role("button", name="Save", exact=True).click(timeout=5000)
            self.page.get_by_text("saved", exact=True).wait_for(timeout=5000)
            return
        structure = self.draw.choice(["arx", "armax", "oe", "bj", "tf", "ss"])
        self.last = f"a fit of {structure}"
        self.page.goto(self.app.at(f"model?recording={RECORDING}&inputs={INPUT}&outputs={OUTPUT}&structure={structure}"))
        self.page.get_by_role("button", name="Fit", exact=True).click(timeout=5000)
        self.ended()

    def ended(self) -> None:
        """Waits for what runs, so that the acts have one order, as in the session."""
        for _ in range(120):
            jobs = self.page.evaluate("fetch('/api/jobs').then((answer) => answer.json())")
            if not any(job["stand"] == "running" for job in jobs):
                return
            self.page.wait_for_timeout(500)

    def history(self) -> None:
        self.last = "history"
        self.page.evaluate(f"history.go({self.draw.choice([-1, -1, 1])})")

    def reload(self) -> None:
        self.last = "reload"
        self.page.reload()

    def key(self) -> None:
        self.last = f"key {self.draw.choice(KEYS)}"
        self.page.keyboard.press(self.last.split()[-1])

    def control(self) -> None:
        controls = self.page.locator(CONTROLS)
        count = controls.count()
        if not count:
            return
        control = controls.nth(self.draw.randrange(count))
        tag, kind, words = control.evaluate("(e) => [e.tagName, e.type ?? '', (e.getAttribute('aria-label') ?? e.textContent ?? '').trim()]", timeout=1000)
        self.last = f"{tag} {kind} {words[:40]!r}"
        if tag == "BUTTON" and LONG.match(words):
            self.work += 1
            if self.work > MOST_WORK:
                return
        # The session of all acts is wanted at the end.
        if "new session" in words or (tag == "A" and (control.get_attribute("href") or "").startswith("http")):
            return
        if tag == "SELECT":
            options = control.locator("option")
            control.select_option(index=self.draw.randrange(max(1, options.count())), timeout=1000)
        elif tag == "CANVAS":
            self.plot(control)
        elif kind in {"checkbox", "radio"}:
            control.click(timeout=1000)
        elif kind == "range":
            control.press(self.draw.choice(["ArrowLeft", "ArrowRight", "PageUp", "Home"]), timeout=1000)
        elif kind == "number":
            control.fill(self.draw.choice(["", "0", "-1", "1", "3", "0.5", "1e9"]), timeout=1000)
            control.press("Tab", timeout=1000)
        elif tag in {"INPUT", "TEXTAREA"}:
            if words.startswith("Text of"):
                control.press_sequentially("# remark\n", timeout=1000)
            else:
                control.fill(self.draw.choice(TEXTS), timeout=1000)
                control.press("Tab", timeout=1000)
        else:
            control.click(timeout=1000)

    def plot(self, canvas: object) -> None:
        box = canvas.bounding_box()
        if not box:
            return
        places = [(box["x"] + self.draw.random() * box["width"], box["y"] + self.draw.random() * box["height"]) for _ in range(2)]
        mouse = self.page.mouse
        mouse.move(*places[0])
        if self.draw.random() < 0.4:
            mouse.wheel(0, self.draw.choice([-300, 300]))
        elif self.draw.random() < 0.5:
            mouse.click(*places[0])
        else:
            mouse.down()
            mouse.move(*places[1], steps=5)
            mouse.up()


def settled(app: App, page: Page) -> None:
    """Ends what still runs."""
    for job in page.evaluate("fetch('/api/jobs').then((answer) => answer.json())"):
        if job["stand"] == "running":
            page.evaluate("(id) => fetch(`/api/jobs/${id}`, { method: 'DELETE' })", job["id"])
    time.sleep(3)


def contents(folder: pathlib.Path) -> dict[str, bytes]:
    """The files below a folder, but the app's own, without what says when they were made."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_file() and not name.startswith(".dynoid") and name != "session.txt":
            bytes_of = path.read_bytes()
            if path.suffix == ".json":
                bytes_of = DATED.sub("", bytes_of.decode(errors="replace")).encode()
            found[name] = bytes_of
    return found


def again(session: str, folder: pathlib.Path) -> None:
    """Runs the session's commands. One that was refused at the page is refused again, so the others go on."""
    (folder / "session.txt").write_text(session.replace("set -e\n", ""), encoding="utf-8")
    repeat(folder / "session.txt")


def main() -> None:
    source = pathlib.Path(sys.argv[1])
    count = int(sys.argv[2]) if len(sys.argv) > 2 else 1000
    seed = int(sys.argv[3]) if len(sys.argv) > 3 else 1
    work = pathlib.Path(tempfile.mkdtemp(prefix="acts-"))
    opened, repeated = work / "opened", work / "repeated"
    shutil.copytree(source, opened)
    shutil.copytree(source, repeated)
    app = App(opened)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which(os.environ.get("CHROMIUM", "chromium")))
        page = browser.new_context(viewport={"width": 1280, "height": 900}).new_page()
        acts = Acts(app, page, seed)
        page.goto(app.address)
        for k in range(count):
            acts.act()
            if k % 100 == 99:
                print(f"{k + 1} acts, {len(acts.faults)} faults", flush=True)
        settled(app, page)
        session = page.evaluate("fetch('/api/session/commands').then((answer) => answer.text())")
        jobs = page.evaluate("fetch('/api/jobs').then((answer) => answer.json())")
    app.kill()
    # A command that was cancelled at the page is not repeated.
    cancelled = {" ".join(["dynoid", *job["arguments"]]) for job in jobs if job["stand"] == "cancelled"}
    session = "\n".join(line for line in session.splitlines() if line not in cancelled) + "\n"
    again(session, repeated)
    one, other = contents(opened), contents(repeated)
    differ = sorted(name for name in one.keys() | other.keys() if one.get(name) != other.get(name))
    print(json.dumps({
        "acts": dict(acts.done), "commands": sum(line.startswith("dynoid ") for line in session.splitlines()),
        "cancelled": len(cancelled), "faults": acts.faults, "files": len(one), "differ": differ, "work": str(work),
    }, indent=1))
    sys.exit(1 if acts.faults or differ else 0)


if __name__ == "__main__":
    main()
