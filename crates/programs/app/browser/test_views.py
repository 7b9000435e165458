"""Every view: without a fault in the console, and accessible (WCAG 2.2 AA) at two widths, in light and dark."""

from __future__ import annotations

import os
import pathlib

import pytest
from playwright.sync_api import Browser

from conftest import App

ANALYSIS = "look?analysis=%7B%22kind%22%3A%22spectrogram%22%7D"
VIEWS = ["", "look", ANALYSIS, "labels", "roles", "bench", "study", "can", "next", "report", "jobs"]
VIEWS += ["compare", "model", "campbell", "command", "command?command=fit+arx", "command?command=can"]
RULES = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
#: A folder for pictures of all views, where somebody wants to look at them.
PICTURES = os.environ.get("DYNOID_PICTURES")

#: Each scheme and each kind of screen once; for pictures all of them.
LOOKS = [("light", 1440), ("dark", 390)]
if PICTURES:
    LOOKS = [(scheme, width) for scheme in ["light", "dark"] for width in [1440, 1024, 390]]


@pytest.fixture(scope="module")
def shared(bench: pathlib.Path) -> App:
    app = App(bench)
    yield app
    app.kill()


@pytest.fixture(scope="module")
def state(shared: App, browser: Browser) -> dict:
    """The cookie of a browser that was let in."""
    context = browser.new_context()
    context.new_page().goto(shared.address)
    state = context.storage_state()
    context.close()
    return state


@pytest.mark.parametrize(("scheme", "width"), LOOKS)
@pytest.mark.parametrize("view", VIEWS)
def test_a_view_is_accessible(shared: App, browser: Browser, state: dict, view: str, scheme: str, width: int) -> None:
    context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme, storage_state=state)
    page = context.new_page()
    said: list[str] = []
    page.on("console", lambda message: said.append(message.text) if message.type == "error" else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(shared.at(view))
    page.wait_for_selector(".view > *")
    page.wait_for_timeout(600)
    if PICTURES:
        name = view.partition("%")[0].replace("?command=", "-").replace("?", "-").replace("+", "-") or "start"
        page.screenshot(path=f"{PICTURES}/{name}-{scheme}-{width}.png")
    wide = page.evaluate("document.documentElement.scrollWidth")
    script = os.environ.get("DYNOID_AXE")
    if script:
        page.evaluate(pathlib.Path(script).read_text(encoding="utf-8"))
        found = page.evaluate(
            "async (rules) => (await axe.run({ exclude: ['iframe'] }, { runOnly: rules })).violations"
            ".map(({ id, nodes }) => [id, nodes[0].html, nodes[0].failureSummary])",
            RULES,
        )
        assert not found, found
    context.close()
    assert not said, said
    assert wide <= width, f"the page is {wide} pixels wide"
