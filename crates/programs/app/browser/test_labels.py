"""Experiments of recordings: proposed from the data, stated in the bench file, and what it does not use."""

from __future__ import annotations

import shutil

from playwright.sync_api import Page, expect

from conftest import App


def experiments(page: Page) -> None:
    page.locator("#tasks").get_by_role("link", name="Experiments").click()
    expect(page.locator(".experiments li").first).to_be_visible()


def test_an_unnamed_recording_gets_the_experiment_that_its_data_show(page: Page, app: App) -> None:
    shutil.copy(next(app.folder.rglob("Step_T_TN_*.mf4")), app.folder / "run_17.mf4")
    experiments(page)
    card = page.locator(".experiments li", has_text="run_17.mf4")
    card.scroll_into_view_if_needed()
    expect(card.locator(".why")).to_contain_text("The data look like Step_T_TN", timeout=60_000)
    card.get_by_role("button", name="Take Step_T_TN").click()
    expect(card.locator(".why")).to_contain_text("The data agree")
    card.get_by_role("button", name="Use run_17.mf4").click()
    expect(page.get_by_text("The bench file uses all of them.")).to_be_visible()
    page.get_by_role("button", name="Save").click()
    expect(page.get_by_text("saved", exact=True)).to_be_visible()
    text = (app.folder / "bench.toml").read_text(encoding="utf-8")
    assert '[[recordings.label]]\nfile = "run_17.mf4"\nlabel = "Step_T_TN"\n' in text
    assert '"run_17.mf4"' in text.split("[[recordings.label]]")[0]
    page.get_by_role("button", name="Undo").click()
    expect(page.get_by_text("does not use 1 of them")).to_be_visible()


def test_a_word_that_is_no_experiment_is_a_fault_with_its_line(page: Page) -> None:
    experiments(page)
    name = page.locator(".experiments input").first
    name.fill("nothing")
    name.press("Tab")
    expect(page.locator(".faults")).to_contain_text("recordings.label.label: `nothing` is no label")
