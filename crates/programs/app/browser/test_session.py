"""The session: acts at pages are repeated without the app, with the same outputs."""

from __future__ import annotations

import pathlib
import shutil
import sys

import pytest
from playwright.sync_api import Page, expect

from conftest import App, repeat

RECORDING = "recordings/WhiteNoise_T_TN_1200.mf4"


@pytest.mark.skipif(sys.platform == "win32", reason="the commands are for a shell")
def test_a_session_is_repeated_without_the_app(page: Page, app: App, tmp_path: pathlib.Path) -> None:
    again = tmp_path / "again"
    shutil.copytree(app.folder, again)
    page.goto(app.at("bench?file=bench.toml"))
    text = page.get_by_label("Text of bench.toml")
    text.fill(text.input_value() + "# it's checked\n")
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_text("saved", exact=True)).to_be_visible()
    page.goto(app.at(f'model?recording={RECORDING}&inputs=["DynoTorqueDemand"]&outputs=["DynoTorqueCalc"]&structure=arx'))
    page.get_by_role("button", name="Fit").click()
    expect(page.get_by_label("Draw model-arx.json")).to_be_checked(timeout=60_000)

    page.goto(app.at("jobs"))
    acts = page.get_by_label("Acts of this session")
    expect(acts).to_contain_text("dynoid fit arx")
    expect(acts).to_contain_text("dynoid.fit.arx(dynoid.read(")
    page.get_by_label("Name of the files").fill("Monday")
    with page.expect_download() as download:
        page.get_by_role("link", name="Commands", exact=True).last.click()
    assert download.value.suggested_filename == "Monday.txt"
    download.value.save_as(again / "Monday.txt")
    repeat(again / "Monday.txt").check_returncode()
    for name in ["bench.toml", "model-arx.json"]:
        assert (again / name).read_bytes() == (app.folder / name).read_bytes(), name
