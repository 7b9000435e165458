"""Takes the pictures of the tour in the book. Run by hand: `python tour.py FOLDER PICTURES [SCHEME WIDTH]`.

FOLDER has what `dynoid demo` writes; it is copied first. `DYNOID` and `CHROMIUM` name the program and the browser, `STEPS`
some steps in place of all. At each step it prints how many clicks led there from the start page.
"""

from __future__ import annotations

import os
import pathlib
import shutil
import sys
import tempfile
from collections.abc import Callable

from playwright.sync_api import Page, expect, sync_playwright

from conftest import App

LONG = 300_000
NOISE = "recordings/WhiteNoise_T_TN_1200.mf4"


class Tour:
    """Walks through the tasks, and takes a picture at each."""

    def __init__(self, app: App, page: Page, pictures: pathlib.Path, suffix: str) -> None:
        self.app = app
        self.page = page
        self.pictures = pictures
        self.suffix = suffix
        self.clicks = 0

    def begin(self) -> None:
        self.page.goto(self.app.at(""))
        self.page.wait_for_selector("h1")
        self.clicks = 0

    def click(self, find: Callable[[Page], object]) -> None:
        find(self.page).click()
        self.clicks += 1

    def task(self, name: str) -> None:
        self.click(lambda page: page.locator("#tasks").get_by_role("link", name=name, exact=True))

    def picture(self, name: str) -> None:
        self.page.wait_for_timeout(800)
        path = self.pictures / f"app-{name}{self.suffix}.jpg"
        self.page.screenshot(path=path, type="jpeg", quality=82)
        print(f"{name}: {self.clicks} clicks from the start page, {path.stat().st_size // 1000} kB", flush=True)

    def start(self) -> None:
        self.begin()
        self.picture("start")

    def look(self) -> None:
        self.begin()
        self.click(lambda page: page.get_by_role("link", name="Look at recordings"))
        self.page.wait_for_timeout(1000)
        box = self.page.locator(".plots canvas").bounding_box()
        for x in [0.35, 0.55]:
            self.page.mouse.click(box["x"] + x * box["width"], box["y"] + 60)
            self.clicks += 1
        expect(self.page.locator(".figures caption")).to_contain_text("Δt")
        self.picture("look")

    def spectrogram(self) -> None:
        self.begin()
        self.click(lambda page: page.get_by_role("link", name="Look at recordings"))
        self.page.get_by_label("Analysis", exact=True).select_option("spectrogram")
        self.clicks += 1
        self.page.locator(".curve canvas").scroll_into_view_if_needed()
        self.picture("spectrogram")

    def labels(self) -> None:
        self.begin()
        self.task("Experiments")
        expect(self.page.locator(".experiments li")).not_to_have_count(0)
        self.page.wait_for_timeout(3000)
        self.picture("experiments")

    def marks(self) -> None:
        self.begin()
        self.click(lambda page: page.get_by_role("link", name="Look at recordings"))
        self.page.wait_for_timeout(1000)
        self.click(lambda page: page.get_by_role("button", name="Mark", exact=True))
        box = self.page.locator(".plots canvas").bounding_box()
        self.page.mouse.move(box["x"] + 0.3 * box["width"], box["y"] + 60)
        self.page.mouse.down()
        self.page.mouse.move(box["x"] + 0.4 * box["width"], box["y"] + 60, steps=4)
        self.page.mouse.up()
        self.clicks += 1
        expect(self.page.locator(".marks li")).to_have_count(1)
        self.picture("marks")

    def roles(self) -> None:
        self.begin()
        self.task("Channels")
        self.click(lambda page: page.get_by_role("button", name="Propose roles from the recordings"))
        expect(self.page.locator(".why").first).to_contain_text("Proposed", timeout=LONG)
        self.picture("channels")

    def bench(self) -> None:
        self.begin()
        self.click(lambda page: page.get_by_role("link", name="Edit the bench"))
        self.page.wait_for_selector("textarea")
        self.picture("bench")

    def study(self) -> None:
        self.begin()
        self.click(lambda page: page.get_by_role("link", name="Study the bench"))
        self.click(lambda page: page.get_by_role("button", name="Study", exact=True))
        expect(self.page.locator("progress").first).to_be_visible(timeout=LONG)
        expect(self.page.locator("progress")).to_have_count(0, timeout=LONG)
        expect(self.page.locator("iframe.page")).to_be_visible(timeout=LONG)
        self.click(lambda page: page.locator(".result summary"))
        self.picture("study")

    def can(self) -> None:
        self.begin()
        self.task("Can it run this?")
        self.click(lambda page: page.get_by_role("button", name="Calculate"))
        expect(self.page.locator(".said")).to_be_visible(timeout=LONG)
        self.picture("can")

    def next(self) -> None:
        self.begin()
        self.task("Next experiment")
        self.click(lambda page: page.get_by_role("button", name="Look for experiments"))
        expect(self.page.locator(".verdict tbody tr")).not_to_have_count(0, timeout=LONG)
        self.picture("next")

    def model(self) -> None:
        self.begin()
        self.task("Model")
        self.page.get_by_label("Recording", exact=True).select_option(NOISE)
        self.click(lambda page: page.get_by_label("DynoTorqueDemand is an input"))
        self.click(lambda page: page.get_by_label("DynoTorqueCalc is an output"))
        self.clicks += 1
        self.click(lambda page: page.get_by_role("button", name="Fit", exact=True))
        expect(self.page.locator(".curves canvas")).not_to_have_count(0, timeout=LONG)
        self.page.locator(".curves canvas").first.scroll_into_view_if_needed()
        self.picture("model")

    def compare(self) -> None:
        self.begin()
        self.task("Compare")
        self.page.wait_for_timeout(4000)
        self.page.locator(".compare section").last.scroll_into_view_if_needed()
        self.picture("compare")

    def campbell(self) -> None:
        self.begin()
        self.task("Campbell")
        expect(self.page.locator(".map canvas")).to_be_visible(timeout=LONG)
        self.page.wait_for_timeout(1000)
        self.page.locator(".map canvas").focus()
        self.page.keyboard.press("ArrowDown")
        self.clicks += 1
        self.picture("campbell")


STEPS = ["start", "look", "spectrogram", "labels", "marks", "roles", "bench", "study", "can", "next", "model", "compare", "campbell"]


def main() -> None:
    source, pictures = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    scheme, width = (sys.argv[3], int(sys.argv[4])) if len(sys.argv) > 4 else ("light", 1280)
    suffix = f"-{scheme}-{width}" if len(sys.argv) > 4 else ""
    folder = pathlib.Path(tempfile.mkdtemp(prefix="tour-")) / "Cell 4"
    shutil.copytree(source, folder)
    pictures.mkdir(parents=True, exist_ok=True)
    app = App(folder)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=shutil.which(os.environ.get("CHROMIUM", "chromium")))
        page = browser.new_context(viewport={"width": width, "height": 800}, color_scheme=scheme).new_page()
        page.goto(app.address)
        tour = Tour(app, page, pictures, suffix)
        for step in os.environ.get("STEPS", " ".join(STEPS)).split():
            getattr(tour, step)()
    app.kill()


if __name__ == "__main__":
    main()
