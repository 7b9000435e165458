"""The toolbox: channels, a stretch and orders chosen, a model fitted and drawn."""

from __future__ import annotations

import json

from playwright.sync_api import Page, expect

from conftest import App

RECORDING = "recordings/WhiteNoise_T_TN_1200.mf4"


def choose(page: Page, app: App) -> None:
    page.goto(app.at("model?recording=" + RECORDING))
    page.get_by_label("DynoTorqueDemand is an input").check()
    page.get_by_label("DynoTorqueCalc is an output").check()
    page.get_by_label("Structure", exact=True).select_option("oe")
    page.get_by_label("More: nf").click()
    page.get_by_label("From, s").fill("5")


def test_a_model_is_fitted_and_drawn_beside_another(page: Page, app: App) -> None:
    choose(page, app)
    expect(page.locator(".toolbox code")).to_contain_text("--from=5 --nf=1 --out=model-oe-1.json")
    page.get_by_role("button", name="Fit").click()
    expect(page.get_by_label("Draw model-oe-1.json")).to_be_checked(timeout=60_000)
    for picture in ["Frequency response", "Step response", "Poles", "Correlations"]:
        expect(page.locator("figcaption", has_text=picture)).to_be_visible()
    page.get_by_label("More: nf").click()
    page.get_by_role("button", name="Fit").click()
    expect(page.get_by_label("Draw model-oe-2.json")).to_be_checked(timeout=60_000)
    bode = page.locator("figure", has_text="Frequency response")
    bode.locator("canvas").focus()
    page.keyboard.press("ArrowRight")
    expect(bode.locator(".readout")).to_contain_text("model-oe-1.json: magnitude")
    expect(bode.locator(".readout")).to_contain_text("model-oe-2.json: phase")
    expect(page.get_by_label("Fit", exact=True).locator("tbody tr")).to_have_count(2)
    page.wait_for_timeout(300)
    page.reload()
    expect(page.get_by_label("Draw model-oe-2.json")).to_be_checked(timeout=20_000)
    assert json.loads((app.folder / "model-oe-1.json").read_text(encoding="utf-8"))["format"] == "dynoid model"


def test_two_clicks_set_the_stretch(page: Page, app: App) -> None:
    choose(page, app)
    box = page.locator(".stretch canvas").bounding_box()
    page.mouse.click(box["x"] + 150, box["y"] + 60)
    page.mouse.click(box["x"] + 300, box["y"] + 60)
    expect(page.locator(".toolbox code")).to_contain_text("--to=")
    assert float(page.get_by_label("From, s").input_value()) < float(page.get_by_label("To, s").input_value())
