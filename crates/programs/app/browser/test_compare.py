"""Comparison: two studies beside each other, and models on recordings."""

from __future__ import annotations

import json
import shutil
import subprocess

import pytest
from playwright.sync_api import Page, expect

from conftest import PROGRAM, App

RECORDING = "recordings/WhiteNoise_T_TN_1200.mf4"


def changed_model(app: App, *, is_whole: bool = True) -> None:
    """A second bench, whose shaft is a tenth stiffer; if not whole, in its list of parameters alone."""
    folder = app.folder / "later"
    folder.mkdir()
    model = json.loads((app.folder / "model.json").read_text(encoding="utf-8"))
    stiffness = next(each for each in model["parameters"] if each["parameter"] == "stiffness")
    stiffness["value"] *= 1.1
    stiffness["interval_95"] = [1.1 * end for end in stiffness["interval_95"]]
    if is_whole:
        model["model"]["mechanics"]["stiffness_nm_per_rad"] *= 1.1
    (folder / "model.json").write_text(json.dumps(model), encoding="utf-8")


def test_two_studies_show_the_part_that_changed(page: Page, app: App) -> None:
    changed_model(app)
    page.goto(app.at("compare?first=model.json&second=later/model.json"))
    shaft = page.locator("tr.part", has_text="Inertias and shaft")
    expect(shaft).to_contain_text("changed")
    expect(shaft).to_contain_text("below 0.01 %")
    expect(page.locator("tr.part", has_text="Speed controller")).to_contain_text("no change found")
    expect(page.locator(".verdicts")).to_contain_text("The model is good")
    page.wait_for_timeout(300)
    page.reload()
    expect(page.get_by_label("Second", exact=True)).to_have_value("later/model.json")


@pytest.mark.refused("422")
def test_a_model_that_cannot_be_read_is_not_replaced_by_another(page: Page, app: App) -> None:
    changed_model(app, is_whole=False)
    page.goto(app.at("compare?first=model.json&second=later/model.json"))
    expect(page.locator("#notice.fault")).to_contain_text("make the two the same")
    expect(page.get_by_label("Second", exact=True)).to_have_value("later/model.json")
    expect(page.locator("tr.part")).to_have_count(0)


def test_models_meet_recordings_and_a_cell_shows_both_courses(page: Page, app: App) -> None:
    fit = [PROGRAM, "fit", "oe", RECORDING, "-u", "DynoTorqueDemand", "-y", "DynoTorqueCalc", "--nf", "1", "--out", "oe.json"]
    subprocess.run(fit, check=True, cwd=app.folder, capture_output=True)
    shutil.rmtree(app.folder / ".dynoid", ignore_errors=True)
    page.goto(app.at("compare?recordings=" + json.dumps(["recordings/Step_T_TN_1200.mf4", RECORDING])))
    cell = page.locator("button.cell").nth(2)
    expect(cell).to_contain_text("DynoTorqueCalc", timeout=60_000)
    expect(page.locator("button.cell").nth(3)).to_contain_text("estimated from it", timeout=60_000)
    cell.click()
    expect(page.locator(".meeting h3")).to_have_text("oe.json on recordings/Step_T_TN_1200.mf4")
    expect(page.locator(".meeting .plots canvas")).to_be_visible()
    expect(page.get_by_label("Tests of the residuals")).to_contain_text("white")
    page.get_by_label("Samples ahead").fill("5")
    page.get_by_label("Samples ahead").press("Tab")
    expect(page.locator("section > code")).to_contain_text("--horizon=5")
