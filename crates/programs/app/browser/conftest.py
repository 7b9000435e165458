"""A browser on the app, which runs on a folder with recordings of a virtual bench."""

from __future__ import annotations

import atexit
import os
import pathlib
import re
import shutil
import subprocess
import tempfile
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, BrowserContext, Page, sync_playwright

PROGRAM = os.environ.get("DYNOID", "dynoid")


class App:
    """The app on a folder."""

    def __init__(self, folder: pathlib.Path, port: int = 0) -> None:
        self.folder = folder
        command = [PROGRAM, "app", str(folder), "--no-browser", "--port", str(port)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, encoding="utf-8")
        atexit.register(self.kill)
        self.address = self.process.stdout.readline().strip()
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/enter\?token=\w+", self.address), self.address
        self.port = int(re.search(r":(\d+)/", self.address).group(1))

    def kill(self) -> None:
        self.process.kill()
        self.process.wait()

    def at(self, place: str) -> str:
        return f"http://127.0.0.1:{self.port}/#/{place}"


def repeat(session: pathlib.Path) -> subprocess.CompletedProcess:
    """Runs a session's commands in its folder, by the program that is tested."""
    with tempfile.TemporaryDirectory() as named:
        (pathlib.Path(named) / "dynoid").symlink_to(pathlib.Path(shutil.which(PROGRAM) or PROGRAM).resolve())
        path = f"{named}{os.pathsep}{os.environ['PATH']}"
        return subprocess.run(
            ["sh", session.name], cwd=session.parent, check=False, env=os.environ | {"PATH": path}, capture_output=True
        )


@pytest.fixture(scope="session")
def bench(tmp_path_factory: pytest.TempPathFactory) -> pathlib.Path:
    """A folder with the recordings and the bench file of the demonstration."""
    folder = tmp_path_factory.mktemp("bench")
    subprocess.run([PROGRAM, "demo", "--out", str(folder / "demo"), "--quiet"], check=True, capture_output=True)
    return folder / "demo"


@pytest.fixture
def app(bench: pathlib.Path, tmp_path: pathlib.Path) -> Iterator[App]:
    folder = tmp_path / "bench"
    shutil.copytree(bench, folder)
    app = App(folder)
    yield app
    app.kill()


@pytest.fixture(scope="session")
def browser() -> Iterator[Browser]:
    with sync_playwright() as playwright:
        path = shutil.which(os.environ.get("CHROMIUM", "chromium"))
        yield playwright.chromium.launch(executable_path=path, args=["--lang=en-US"])


@pytest.fixture
def context(browser: Browser) -> Iterator[BrowserContext]:
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    yield context
    context.close()


@pytest.fixture
def page(app: App, context: BrowserContext, request: pytest.FixtureRequest) -> Iterator[Page]:
    """The start page; at the end nothing has been complained of in the console, but what a test expects to be refused."""
    page = context.new_page()
    said: list[str] = []
    # A refusal is an answer in words, which the browser notes as a fault.
    expected = [mark.args[0] for mark in request.node.iter_markers("refused")]
    is_fault = lambda message: message.type == "error" and not any(code in message.text for code in expected)  # noqa: E731
    page.on("console", lambda message: said.append(message.text) if is_fault(message) else None)
    page.on("pageerror", lambda error: said.append(str(error)))
    page.goto(app.address)
    page.wait_for_selector("h1")
    yield page
    assert not said, said
